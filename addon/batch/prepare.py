"""Making ready what a plan's tasks render from: one blend file a scene, sky and variant.

Each sky is simulated, read and analysed once, for all scenes, variants and cameras under it. What
is made needs Blender alone: matrices and coefficients lie in the file's sockets, the sky and the
scene's textures in `prepared/` beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any

from ..progress import run
from ..scene.output import plan_data
from ..sky.light import SkyLight
from ..whole_files import write_json
from .carry import carry
from .file_names import file_names
from .owner import check_links
from .plan import Prepared, prepared_files
from .report import record
from .scenes import SceneFile
from .study import Study, StudySky

FOLDER = "prepared"


@dataclass(frozen=True)
class Preparation:
    """How many skies were computed, and how many files were made and found ready."""

    skies: int
    made: int
    kept: int


def prepare(
    study: Study,
    scenes: tuple[SceneFile, ...],
    program: str,
    say: Callable[[str], None] = lambda line: None,
) -> Preparation:
    """Make the files of a plan that are not there yet, and take away those of older plans.

    ``say`` is told what is made next. A file and its record (`record`) are whole or absent.
    Raises `InputError` for what only now turns out, such as a material that is linked.
    """
    out = study.out
    (out / FOLDER).mkdir(parents=True, exist_ok=True)
    check_links(out / FOLDER)
    wanted = list(prepared_files(study, scenes, program))
    open_ = [each for each in wanted if record(out, each.blend) is None]
    place = {id(sky): number for number, sky in enumerate(study.skies)}
    by_sky = sorted(open_, key=lambda each: place[id(each.sky)])
    skies = 0
    for _, group in groupby(by_sky, key=lambda each: id(each.sky)):
        files = list(group)
        say(f"sky {files[0].sky.name}")
        picture = _sky_file(study, files[0].sky)
        skies += 1
        for each in files:
            say(each.name)
            _make(study, each, picture)
    _tidy(out, wanted)
    return Preparation(skies, len(open_), len(wanted) - len(open_))


def _sky_file(study: Study, sky: StudySky) -> Path | None:
    """Return the file that a sky is read from; it is simulated where it is none. None of a scene's
    own."""
    if sky.file is not None or sky.sun is None:
        return sky.file
    from ..sky.clear_sky import SCALE, header_of, picture
    from ..sky.panorama import write_panorama
    from ..sky.simulation import simulate
    from ..spectra.sensitivities import observer

    name = file_names([sky.name])[0]
    path = study.out / FOLDER / f"{name}.{sky.content[:8]}.{study.quality}-{study.sky_width}.exr"
    if not path.is_file():
        elevation, azimuth = sky.sun
        light = simulate(elevation, quality=study.quality)
        shines = elevation > 0.0
        rgb = picture(light, study.sky_width // 2, azimuth, shines, observer() * SCALE)
        write_panorama(path, rgb, header_of(light, azimuth, shines))
    return path


def _make(study: Study, wanted: Prepared, sky: Path | None) -> None:
    """Write one prepared file, then its record."""
    import bpy

    from ..scene import use_cases
    from ..scene.files import blend_file
    from ..scene.outcome import Outcome
    from ..scene.world import hdri as worlds
    from ..scene.world.settings import Settings, stored
    from ..transfer.white import AUTO

    scene = blend_file.open_scene(wanted.scene.path)
    options = dict(study.settings)
    estimated = options["white"] == AUTO and wanted.sky.file is not None
    settings = Settings(
        **{**options, "white": None if options["white"] == AUTO else options["white"]}
    )
    if wanted.sky.sun is not None:
        settings = replace(settings, sun_elevation=wanted.sky.sun[0])
    kept = use_cases.given_before(use_cases.in_scene(scene))
    notes = []
    if sky is None:
        settings = stored(scene.world) or settings
    else:
        if wanted.sky.north is not None:
            scene.world = None  # or one that shows this sky, turned as the scene wants it, stays
        world = worlds.set_sky(scene, sky)
        if wanted.sky.north is not None:
            _turn(world, wanted.sky.north)
    if estimated:
        settings, line = use_cases.with_estimated_white(world, settings)
        notes.append(line)
    named = {blend_file.material(name): one for name, one in wanted.variant.given.items()}
    given = {**kept, **use_cases.resolved(named)}
    found, chosen = Outcome(), None
    if sky is not None or named:  # else it is as it is
        found = run(use_cases.making_spectral_with_all_light(scene, given, settings))
        chosen = use_cases.chosen_light() if settings.is_choosing else None
    light = found.light
    elsewhere = [line for image in bpy.data.images if (line := carry(image, study.out / FOLDER))]
    path = plan_data.inside(study.out, wanted.blend, ".blend")
    record = {
        "format": plan_data.RECORD,
        "name": wanted.name,
        "scene": wanted.scene.path.stem,
        "sky": wanted.sky.name,
        "variant": wanted.variant.name,
        "sun": wanted.sky.sun or _sun(light),
        "blender": bpy.app.version_string,
        "materials": [_material(result) for result in found.results],
        "light": chosen,
        "notes": [*notes, *(light.notes if light else ()), *elsewhere],
        "elsewhere": elsewhere,
    }
    write_json(path.with_suffix(".json"), record)  # first: what has no record is nobody's
    blend_file.save(path)


def _sun(light: SkyLight | None) -> tuple[float, float] | None:
    """Where the sun of an HDRI stands, elevation and azimuth [degrees]."""
    sun = None if light is None else light.sun
    return None if sun is None else (sun.elevation, sun.azimuth)


def _material(result: Any) -> dict[str, Any]:
    """Return what is known of a material, with its color as bright as a swatch can be."""
    import numpy as np

    from ..spectra.working_spaces import srgb

    parts = srgb(np.array(result.colour) / max(1.0, *result.colour))
    swatch = "rgb(" + " ".join(f"{255 * part:.0f}" for part in parts) + ")"
    return {**asdict(result), "swatch": swatch}


def _turn(world: Any, north: float) -> None:
    """Turn a World about the vertical so that the sky's north stands at ``north``.

    In the HDRI north is +Y. A Mapping looks up direction v at Rz(angle) v, and what stands north in
    the scene, +Y turned clockwise by ``north`` seen from above, must be found at +Y.
    """
    from ..scene.world import hdri as worlds

    sky = worlds.sky_of(world)
    if sky.mapping is not None:
        angle = math.radians(north)
        mapping = world.node_tree.nodes[sky.mapping]
        mapping.inputs["Rotation"].default_value = (0.0, 0.0, -angle if sky.inverse else angle)


def _tidy(out: Path, wanted: Iterable[Prepared]) -> None:
    """Remove prepared files that no task reads any more: those that a record of ours names."""
    keep = {(out / each.blend).with_suffix(".json").name for each in wanted}
    for path in (out / FOLDER).glob("*.json"):
        if path.name not in keep and _is_ours(path):
            path.with_suffix(".blend").unlink(missing_ok=True)
            path.unlink(missing_ok=True)


def _is_ours(path: Path) -> bool:
    try:
        return plan_data.record(path).get("format") == plan_data.RECORD
    except (OSError, ValueError):
        return False
