"""An example made ready for any renderer: its file, its skies, its spectra, and the truth to it.

All of it is kept in a folder until the scene or the referee changes, so that each way to a picture
can be tried in a process of its own.
"""

import hashlib
import json
import pickle
from dataclasses import dataclass, fields, replace
from pathlib import Path

import bpy
import judging
import lit
import numpy as np
import referee
import stage as stages
from example import Example
from main_job import silenced
from stage import Stage

SAMPLES = 16
"""Of Eevee, a pixel: what is judged lies off all edges."""

LATER = -7.0, 35.0
"""Another hour: how far the sun's elevation and azimuth are from the example's [degrees]."""
LOWEST = -5.0
"""The sun's elevation at another hour at least [degrees]: later our sky ends."""


def later(elevation: float) -> float:
    """Return the sun's elevation at another hour than that of an elevation [degrees]."""
    return max(elevation + LATER[0], LOWEST)


@dataclass(frozen=True)
class Ready:
    """What lies in a scene's ``folder``; ``digest`` names the scene and its truth."""

    folder: Path
    digest: str
    stage: Stage
    elevation: float
    options: tuple[str, ...]
    verdict: referee.Verdict
    where: judging.Pixels

    @property
    def blend(self) -> Path:
        """The scene as an architect has it."""
        return self.folder / "scene.blend"

    @property
    def hour(self) -> tuple[Path, float]:
        """The sky of another hour, and its sun's elevation [degrees]."""
        return self.folder / "later.exr", later(self.elevation)

    def figures(self, picture: np.ndarray) -> dict[str, float]:
        """Return the errors of a picture (h, w, 3): the whole, its colour and its luminance."""
        true = self.verdict.spectral
        scale = (picture @ judging.LUMINANCE) / np.maximum(true @ judging.LUMINANCE, 1e-9)
        maps = {
            "": judging.error_map(picture, true, self.where),
            "colour_": judging.error_map(picture, true, self.where, colour=True),
            "luminance_": judging.error_map(true * scale[..., None], true, self.where),
        }
        return {
            f"{part}{name}": value
            for part, error in maps.items()
            for name, value in judging.figures(error).items()
        }

    def noise(self) -> dict[str, float]:
        """Return what is left of chance in the truth."""
        return judging.noise(self.verdict.spectral_seeds, self.where)


def ready(name: str, example: Example, out: Path, size: tuple[int, int]) -> Ready:
    """Return an example made ready, kept in the folder ``out``."""
    out = (out / name).resolve()
    out.mkdir(parents=True, exist_ok=True)
    digest = hashlib.sha256(repr((name, size, LATER, SAMPLES, bpy.app.version_string)).encode())
    for module in (stages, referee, judging, lit):
        digest.update(Path(str(module.__file__)).read_bytes())
    for file in sorted(Path(__file__).parent.glob("*_scenes.py")):
        digest.update(file.read_bytes())
    key = digest.hexdigest()[:16]
    kept = out / "ready.pickle"
    if not kept.is_file() or pickle.loads(kept.read_bytes())[0] != key:
        kept.write_bytes(pickle.dumps((key, *_made(example, out, size))))
    _, stage, where = pickle.loads(kept.read_bytes())
    with silenced(out / "blender.log"):
        verdict = referee.judge_once(stage, example.samples, out)
    white = judging.Pixels(**where)
    return Ready(out, key, stage, example.elevation, example.options, verdict, white)


def _made(example: Example, out: Path, size: tuple[int, int]) -> tuple[Stage, dict]:
    """Write a scene's files; return its stage, and which of its pixels are judged."""
    with silenced(out / "blender.log"):
        hour = replace(
            example, elevation=later(example.elevation), azimuth=example.azimuth + LATER[1]
        )
        lit.light(hour, out, size)
        (out / "sky.exr").replace(out / "later.exr")
        stage = example.build(lit.light(example, out, size))
        stages.build(stage, referee.Today(), str(out / "sky.exr"))
        rays = judging.cast(stage)
        stages.save(out / "scene.blend", SAMPLES)
        verdict = referee.judge_once(stage, example.samples, out)
    spectra = {n: m.measured for n, m in stage.matter.items() if m.measured is not None}
    lit.write_csv(out / "paints.csv", spectra)
    if stage.lamps:
        lit.write_csv(out / "lamps.csv", {n: lamp.spectrum for n, lamp in stage.lamps.items()})
    (out / "names.json").write_text(json.dumps({"paints": [*spectra], "lamps": [*stage.lamps]}))
    where = judging.pixels(rays, stage, verdict)
    return stage, {f.name: getattr(where, f.name) for f in fields(where)}
