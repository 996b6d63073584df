"""The add-on: under the open sky, live, with all the light, and what is seen while it bakes."""

from collections.abc import Iterator

import bpy
import numpy as np
from ready import Ready
from way import Clock, Shot, Way, megabytes, opened, rendered
from ways_cycles import cycles

from spectral_skylight.addon.choices import AUTO, DOME, OPEN, TRACED
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import storage
from spectral_skylight.addon.scene.lights import user_lamps
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.spectra.working_spaces import rec709_to_working
from spectral_skylight.addon.transfer import assignment
from spectral_skylight.node_groups import baked_light

WIDE = "Linear Rec.2020"


def ours(occlusion: str, engine: str, rays: int | None = None) -> Way:
    """The add-on under the open sky, live, or with all light by so many rays (None: its own)."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        scene, settings = opened(ready), _settings(ready, occlusion)
        setup = Clock()
        with setup:
            _make_spectral(scene, ready, settings)
            if occlusion == AUTO:
                run(use_cases.bake(scene, settings, rays=rays))
        picture, seconds = rendered(scene, ready, engine)
        shot = Shot(picture, setup.seconds + seconds, setup.seconds, {}, megabytes())
        if more:
            shot.again["frame"] = rendered(scene, ready, engine)[1]
            path, elevation = ready.hour
            later = _settings(ready, occlusion, elevation)
            with Clock() as clock:
                use_cases.load_sky(scene, path, later)
            shot.again["hour"] = clock.seconds + rendered(scene, ready, engine)[1]
            with Clock() as clock:
                other = _reflectance(ready, _paints(ready)[-1])
                use_cases.make_spectral(scene, {_first_paint(ready): other}, later)
            shot.again["paint"] = clock.seconds + rendered(scene, ready, engine)[1]
        yield shot

    label = {OPEN: "open sky", DOME: "live"}.get(occlusion, f"{rays} rays" if rays else "all light")
    return Way(f"Ours in {engine.capitalize()}", label, shots)


def traced(samples: int, denoise: bool = False, wide: bool = False) -> Way:
    """The add-on's colors, their light traced by Cycles in so many samples, denoised or not, in
    Rec.709 or ``wide`` in Rec.2020."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        scene, settings = opened(ready), _settings(ready, TRACED)
        if wide:  # Blender 5
            bpy.ops.wm.set_working_color_space(working_space=WIDE, convert_colors=True)
        setup, clock = Clock(), Clock()
        with setup:
            _make_spectral(scene, ready, settings)
        groups = bpy.context.view_layer.lightgroups
        while len(groups):  # which cost nobody time who needs none
            bpy.ops.scene.view_layer_remove_lightgroup()
        with clock:
            sky = scene.world.cycles.sample_map_resolution  # as the add-on has it
            picture = cycles(ready, samples, denoise, sky=sky)["Combined"]
        if wide:
            picture = picture @ np.linalg.inv(rec709_to_working(WIDE)).T
        yield Shot(picture, setup.seconds + clock.seconds, setup.seconds, {}, megabytes())

    where, how = " in Rec.2020" * wide, ", denoised" * denoise
    return Way(f"Ours, traced{where}{how}", f"{samples}", shots)


def progressive(engine: str = "cycles") -> Way:
    """Ours after each whole light of one bake: what is seen while it goes on."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        scene, settings = opened(ready), _settings(ready, AUTO)
        clock = Clock()
        with clock:
            _make_spectral(scene, ready, settings)
        before, work = _held(), use_cases.bake(scene, settings)
        ends = False
        while not ends:
            with clock:
                ends = next(work, None) is None
            if (now := _held()) != before:
                before = now
                picture, seconds = rendered(scene, ready, engine)
                yield Shot(picture, clock.seconds + seconds, clock.seconds.copy())

    return Way(f"Ours in {engine.capitalize()}", "while it bakes", shots)


def _make_spectral(scene: bpy.types.Scene, ready: Ready, settings: Settings) -> None:
    for name in ready.stage.lamps:
        user_lamps.set_spectrum(bpy.data.objects[name].data, f"{ready.folder / 'lamps.csv'}:{name}")
    given = {bpy.data.materials[name]: _reflectance(ready, name) for name in _paints(ready)}
    use_cases.make_spectral(scene, given, settings)


def _settings(ready: Ready, occlusion: str, elevation: float | None = None) -> Settings:
    elevation = ready.elevation if elevation is None else elevation
    return Settings(occlusion=occlusion, sun_elevation=elevation)


def _paints(ready: Ready) -> list[str]:
    return [name for name, matter in ready.stage.matter.items() if matter.measured is not None]


def _first_paint(ready: Ready) -> bpy.types.Material:
    return bpy.data.materials[_paints(ready)[0]]


def _reflectance(ready: Ready, name: str) -> assignment.Assignment:
    return assignment.read(f"{ready.folder / 'paints.csv'}:{name}")


def _held() -> float:
    """What light all bakes hold, in one number."""
    total = 0.0
    for obj in bpy.data.objects:
        bake = storage.bake_of(obj)
        if bake is not None and baked_light.LIGHT in bake.data.attributes:
            held = bake.data.attributes[baked_light.LIGHT].data
            values = np.empty(4 * len(held), np.float32)
            held.foreach_get("color", values)
            total += float(values.sum(dtype=np.float64))
    return total
