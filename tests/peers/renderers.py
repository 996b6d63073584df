"""Renderers beside one another: colours against the truth, and seconds.

python -m spectral_skylight.tests.peers.renderers FOLDER
"""

from __future__ import annotations

import hashlib
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.tests.peers import scene
from spectral_skylight.tests.peers.peer import ANSWERS, ask
from spectral_skylight.tests.peers.pictures import draw_renderers
from spectral_skylight.tests.peers.skies import in_bands, write

BANDS = np.arange(390.0, 771.0, 20.0)


@dataclass(frozen=True)
class Method:
    """One way of rendering: a script, what it is told besides the scene, and what its values are.

    ``samples``: random samples a pixel; ours has no randomness and needs one.
    """

    name: str
    script: str
    told: dict[str, Any]
    note: str
    samples: int = scene.SAMPLES


def _blender(name: str, engine: str, basis: str | None, note: str) -> Method:
    told = {"engine": engine, "basis": basis, "file": "rgb"}
    return Method(name, "blender_render.py", told, note, scene.SAMPLES if basis is None else 1)


METHODS = (
    Method("Mitsuba 3, spectral", "mitsuba_render.py", {}, "its own spectral sky"),
    Method("Mitsuba 3, RGB sky", "mitsuba_render.py", {"file": "rgb"}, "sky upsampled from RGB"),
    Method("Radiance, 20 bands", "radiance_render.py", {"file": "bands"}, "rtrace -cs 20"),
    _blender("Cycles, RGB × RGB", "cycles", None, "diffuse, albedo under D65, Rec.709"),
    _blender("ours in Cycles, rayleigh", "cycles", "rayleigh", "no noise"),
    _blender("ours in Cycles, atmosphere", "cycles", "atmosphere", "no noise, elevation known"),
    _blender(
        "ours in Eevee, rayleigh",
        "eevee",
        "rayleigh",
        "no noise; cuts negative red; GL may be software",
    ),
)


@dataclass(frozen=True)
class Result:
    """A method's CIEDE2000 over 24 patches and three faces, its seconds for them, what to know.

    ``seconds`` count once everything is loaded, which takes ``start_seconds``; ``noise_delta_E``:
    the mean that chance alone makes; ``luminance_error``: the largest of a face.
    """

    method: str
    mean_delta_E: float
    p95_delta_E: float
    max_delta_E: float
    seconds: float
    note: str
    start_seconds: float
    noise_delta_E: float
    luminance_error: float


def render(method: Method, again: bool = False) -> tuple[NDArray[np.float64], float, float]:
    """Return a method's pictures in linear Rec.709, (3, rows, columns, 3), seconds and start's."""
    _, rho = colorchecker()
    told = dict(method.told)
    if "file" in told:
        told["file"] = str(_file(told["file"]))
    request = {
        "faces": [asdict(face) for face in scene.FACES],
        "pixels": scene.PIXELS,
        "samples": method.samples,
        "sun_elevation": scene.SUN_ELEVATION,
        **told,
    }
    if method.script == "mitsuba_render.py":
        request |= scene.SUNSKY
        request |= {"wavelengths": WAVELENGTHS.tolist(), "reflectances": rho.tolist()}
    if method.script == "radiance_render.py":
        request["reflectances"] = in_bands(rho, BANDS).tolist()
    answer = ask(method.script, request, again=again)
    pictures = answer["pictures"].astype(float)
    if method.script == "radiance_render.py":
        pictures = pictures @ in_bands_summed(observer() * scene.EXPOSURE).T
    elif method.script == "mitsuba_render.py" and "file" not in told:
        pictures = pictures * scene.EXPOSURE
    return pictures, float(answer["seconds"]), float(answer["start_seconds"])


def _file(kind: str) -> Path:
    """Return the sky as a file: RGB as OpenEXR, or 20 bands; named by what is in it."""
    spectra = scene.sky()
    if kind == "rgb":
        values = (spectra @ (observer() * scene.EXPOSURE).T).astype(np.float32)
    else:
        values = in_bands(spectra, BANDS).astype(np.float32)
    digest = hashlib.sha256(values.tobytes()).hexdigest()[:16]
    path = ANSWERS / f"sky-{digest}.{'exr' if kind == 'rgb' else 'npz'}"
    if not path.exists():
        write_panorama(path, values) if kind == "rgb" else np.savez(path, sky=values)
    return path


def in_bands_summed(sensitivities: NDArray) -> NDArray[np.float64]:
    """Return sensitivities (3, 81) as what each of the 20 bands counts, (3, 20)."""
    share = np.abs(WAVELENGTHS - BANDS[:, None])
    share = np.where(share < 10.0, 1.0, np.where(share == 10.0, 0.5, 0.0))
    share[0, 0] = share[-1, -1] = 1.0  # the ends' weights are halves already
    return sensitivities @ share.T


def patches(pictures: NDArray) -> NDArray[np.float64]:
    """Return the mean colours of every patch over two halves of its pixels, (2, 3, 24, 3).

    Its outermost pixels are left out: there a renderer's filter mixes neighbours in.
    """
    n = scene.PIXELS
    cut = pictures.reshape(-1, scene.ROWS, n, scene.COLUMNS, n, 3).swapaxes(2, 3)
    cut = cut[..., 1:-1, 1:-1, :].reshape(len(pictures), 24, n - 2, n - 2, 3)
    odd = np.indices((n - 2, n - 2)).sum(axis=0) % 2 == 1
    return np.stack([cut[:, :, half].mean(axis=2) for half in (odd, ~odd)])


def errors(method: Method, again: bool = False) -> tuple[NDArray[np.float64], Result]:
    """Return a method's CIEDE2000 for each face and patch, (3, 24), and what sums them up."""
    true, white = scene.true_colours()
    pictures, seconds, start = render(method, again)
    halves = patches(pictures)
    colours = halves.mean(axis=0)
    off = delta_E(colours, true, white[:, None])
    # Two halves are apart twice as far as their mean is from where it should be.
    noise = delta_E(*halves, white[:, None]).mean() / 2
    luminance = (colours.sum(axis=1) / true.sum(axis=1)) @ [0.2126, 0.7152, 0.0722] - 1
    return off, Result(
        method.name,
        float(off.mean()),
        float(np.percentile(off, 95)),
        float(off.max()),
        seconds,
        f"{method.note}; samples: {method.samples}",
        start,
        float(noise),
        float(np.abs(luminance).max()),
    )


def main(folder: Path) -> None:
    """Write renderers.csv and renderers.png, and print the first."""
    folder.mkdir(parents=True, exist_ok=True)
    found = [errors(method, again=True)[1] for method in METHODS]
    write(folder / "renderers.csv", found)
    draw_renderers(folder / "renderers.png", found)
    print((folder / "renderers.csv").read_text())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
