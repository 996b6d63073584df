"""Ways to the whole picture: Eevee, ours and Cycles, each timed from the opened file on.

A way yields `Shot`s: one, or several that become better. Times are wall and processor seconds of
this process alone, to be had on any machine by `sh examples/run chart --scenes`.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import bands
import bpy
import gpu
import numpy as np
import OpenEXR
import pictures
import referee
import stage as stages
from ready import Ready

from spectral_skylight.addon.choices import AUTO, DOME, OPEN
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import storage
from spectral_skylight.addon.scene.files import blend_file
from spectral_skylight.addon.scene.lights import user_lamps
from spectral_skylight.addon.scene.output import render
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.spectra.working_spaces import rec709_to_working
from spectral_skylight.addon.transfer import assignment
from spectral_skylight.node_groups import baked_light

SAMPLES = 16
"""Of ours in Cycles, a pixel: its surfaces shine of their own, so that only edges need more."""


class Clock:
    """How long things have taken: wall and processor seconds (2,)."""

    def __init__(self) -> None:
        self.seconds = np.zeros(2)

    def __enter__(self) -> "Clock":
        self._began = np.array([time.perf_counter(), time.process_time()])
        return self

    def __exit__(self, *_: object) -> None:
        self.seconds += np.array([time.perf_counter(), time.process_time()]) - self._began


@dataclass
class Shot:
    """A picture (h, w, 3) in linear Rec.709, and what it took.

    ``seconds`` until it was there and of them ``setup`` before its render; of what comes
    ``again``: a further ``frame``, another ``hour``, another ``paint``; wall and processor (2,)
    each. ``megabytes`` of the file.
    """

    picture: np.ndarray
    seconds: np.ndarray
    setup: np.ndarray
    again: dict[str, np.ndarray] = field(default_factory=dict)
    megabytes: float = 0.0


@dataclass(frozen=True)
class Way:
    """A way to the picture: ``family``, its series in the chart; ``label``, which of it this is.

    ``shots`` yields the pictures of a scene, and with True also measures what comes ``again``.
    """

    family: str
    label: str
    shots: Callable[[Ready, bool], Iterator[Shot]]


def _opened(blend: Path) -> bpy.types.Scene:
    return blend_file.open_scene(blend)


# --- Cycles -------------------------------------------------------------------------------------


def cycles(ready: Ready, samples: int, denoise: bool, seed: int = 7) -> dict[str, np.ndarray]:
    """Render the open scene in Cycles with every bounce; return the picture ``Combined`` and those
    of its light groups."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.render.engine = "CYCLES"
    settings = scene.cycles
    _sample(scene, ready, samples)
    settings.seed, settings.use_denoising = seed, denoise
    settings.light_sampling_threshold = settings.sample_clamp_indirect = settings.blur_glossy = 0.0
    for kind in ("max", "diffuse", "glossy", "transmission", "transparent_max"):
        setattr(settings, f"{kind}_bounces", referee.BOUNCES)
    settings.pixel_filter_type, settings.filter_width = "BLACKMAN_HARRIS", 1.0
    form = scene.render.image_settings
    if hasattr(form, "media_type"):  # Blender 5
        form.media_type = "MULTI_LAYER_IMAGE"
    form.file_format, form.color_depth = "OPEN_EXR_MULTILAYER", "32"
    path = ready.folder / "cycles.exr"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {n: c.pixels.copy() for part in file.parts for n, c in part.channels.items()}
    path.unlink()
    names = ["Combined", *(f"Combined_{group.name}" for group in layer.lightgroups)]
    return {
        name: np.stack([channels[f"{layer.name}.{name}.{c}"] for c in "RGB"], -1).astype(float)
        for name in names
    }


def _sample(scene: bpy.types.Scene, ready: Ready, samples: int) -> None:
    """Let Cycles take so many samples of each pixel, and look at the sky as the referee does."""
    settings = scene.cycles
    settings.device, settings.samples = "CPU", samples
    settings.use_adaptive_sampling = settings.use_denoising = False
    scene.world.cycles.sampling_method = "MANUAL"  # left to itself it takes seconds
    scene.world.cycles.sample_map_resolution = ready.stage.sky.shape[1]


class Wide(referee.Today):
    """Today's colours in Linear Rec.2020: its numbers are multiplied as Rec.709's are."""

    to_wide = rec709_to_working("Linear Rec.2020")

    def of(self, spectra: np.ndarray) -> np.ndarray:
        return np.clip(bands.albedo(spectra) @ self.to_wide.T, 0.0, 1.0)

    def light(self, spectrum: np.ndarray) -> np.ndarray:
        return np.maximum(self.to_wide @ (bands.S @ spectrum), 0.0)

    def sky(self, sky: np.ndarray) -> np.ndarray:
        return np.maximum(sky @ bands.S.T @ self.to_wide.T, 0.0)


def rgb(samples: int, denoise: bool = False, wide: bool = False) -> Way:
    """RGB × RGB with every bounce, in Rec.709 or ``wide`` in Rec.2020."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        stages.build(ready.stage, Wide() if wide else referee.Today())
        groups = bpy.context.view_layer.lightgroups
        while len(groups):  # which cost nobody time who needs none
            bpy.ops.scene.view_layer_remove_lightgroup()
        with Clock() as clock:
            picture = cycles(ready, samples, denoise)["Combined"]
        if wide:
            picture = picture @ np.linalg.inv(Wide.to_wide).T
        # Nothing is kept: whatever changes, all is traced anew.
        again = dict.fromkeys(("frame", "hour", "paint"), clock.seconds)
        size = ready.blend.stat().st_size / 1e6
        yield Shot(picture, clock.seconds, np.zeros(2), again, size)

    where, how = " in Rec.2020" * wide, ", denoised" * denoise
    return Way(f"Cycles RGB{where}{how}", f"{samples}", shots)


def wavelengths(samples: int) -> Way:
    """Cycles at fifteen wavelengths, three at a time, each light by its own spectrum."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        lights, clock = ready.stage.lights(), Clock()
        shape = ready.stage.camera.height, ready.stage.camera.width, bands.KNOTS.size
        quotients = {name: np.empty(shape) for name in lights}
        for triple in bands.TRIPLES:
            stages.build(ready.stage, referee.Wavelengths(triple, lights["sky"]))
            with clock:
                found = cycles(ready, samples, denoise=False)
            for name in lights:
                quotients[name][..., triple] = found[f"Combined_{name}"]
        picture = sum(bands.from_knots(quotients[name], light) for name, light in lights.items())
        again = dict.fromkeys(("frame", "hour", "paint"), clock.seconds)
        size = ready.blend.stat().st_size / 1e6
        yield Shot(np.asarray(picture), clock.seconds, np.zeros(2), again, size)

    return Way("Cycles by wavelength", f"{samples}", shots)


# --- Eevee as it is -----------------------------------------------------------------------------


def eevee(by_hand: bool = False) -> Way:
    """Eevee without the add-on; ``by_hand``: ray tracing, and a baked light-probe volume."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        scene, setup = _opened(ready.blend), Clock()
        if by_hand:
            _trace_rays(scene)
            with setup:
                _bake_probes(scene)
        picture, seconds = _rendered(scene, ready, "eevee")
        frame = _rendered(scene, ready, "eevee")[1] if more else seconds
        # Values alone change; probes are baked anew, which takes as long as at first.
        again = {"frame": frame, "hour": setup.seconds + frame, "paint": setup.seconds + frame}
        yield Shot(picture, setup.seconds + seconds, setup.seconds, again, _saved(ready))

    return Way("Eevee", "rays and probes" if by_hand else "as it comes", shots)


PROBES = 8
"""Light probes along the longest edge of the volume."""


def _trace_rays(scene: bpy.types.Scene) -> None:
    """Let Eevee trace rays on the screen, at full size and as far as it can."""
    settings = scene.eevee
    settings.use_raytracing = True
    settings.ray_tracing_method = "SCREEN"
    options = settings.ray_tracing_options
    options.resolution_scale, options.trace_max_roughness = "1", 1.0  # matt surfaces too
    options.screen_trace_quality, options.screen_trace_thickness = 1.0, 0.5


def _bake_probes(scene: bpy.types.Scene) -> None:
    """Bake one volume of light probes around what stands in the scene, its wide ground apart."""
    probe = next((obj for obj in scene.objects if obj.type == "LIGHT_PROBE"), None)
    if probe is None:
        corners = [
            (obj.matrix_world @ vertex.co)[:]
            for obj in scene.objects
            if obj.type == "MESH" and max(obj.dimensions) < 40.0
            for vertex in obj.data.vertices
        ]
        low, high = np.min(corners, axis=0) - 0.3, np.max(corners, axis=0) + 0.3
        data = bpy.data.lightprobes.new("probes", "VOLUME")
        probe = bpy.data.objects.new("probes", data)
        probe.location, probe.scale = ((low + high) / 2).tolist(), ((high - low) / 2).tolist()
        scene.collection.objects.link(probe)
        counts = np.clip(np.ceil(PROBES * (high - low) / (high - low).max()), 4, None).astype(int)
        data.resolution_x, data.resolution_y, data.resolution_z = counts.tolist()
        data.bake_samples = 64
    for other in scene.objects:
        other.select_set(other == probe)
    bpy.context.view_layer.objects.active = probe
    if not hasattr(gpu, "init"):
        raise RuntimeError("without a window this Blender has no GPU to bake light probes by")
    gpu.init()  # a render does so of itself; the bake alone waits for ever
    bpy.ops.object.lightprobe_cache_bake(subset="ALL")


# --- Ours ---------------------------------------------------------------------------------------


def ours(occlusion: str, engine: str, rays: int | None = None) -> Way:
    """The add-on under the open sky, live, or with all light by so many rays (None: its own)."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        scene, settings = _opened(ready.blend), _settings(ready, occlusion)
        setup = Clock()
        with setup:
            _make_spectral(scene, ready, settings)
            if occlusion == AUTO:
                run(use_cases.bake(scene, settings, rays=rays))
        picture, seconds = _rendered(scene, ready, engine)
        shot = Shot(picture, setup.seconds + seconds, setup.seconds, {}, _saved(ready))
        if more:
            shot.again["frame"] = _rendered(scene, ready, engine)[1]
            path, elevation = ready.hour
            later = _settings(ready, occlusion, elevation)
            with Clock() as clock:
                use_cases.load_sky(scene, path, later)
            shot.again["hour"] = clock.seconds + _rendered(scene, ready, engine)[1]
            with Clock() as clock:
                other = _reflectance(ready, _paints(ready)[-1])
                use_cases.make_spectral(scene, {_first_paint(ready): other}, later)
            shot.again["paint"] = clock.seconds + _rendered(scene, ready, engine)[1]
        yield shot

    label = {OPEN: "open sky", DOME: "live"}.get(occlusion, f"{rays} rays" if rays else "all light")
    return Way(f"Ours in {engine.capitalize()}", label, shots)


def progressive(engine: str = "cycles") -> Way:
    """Ours after each whole light of one bake: what is seen while it goes on."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        scene, settings = _opened(ready.blend), _settings(ready, AUTO)
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
                picture, seconds = _rendered(scene, ready, engine)
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


def _rendered(scene: bpy.types.Scene, ready: Ready, engine: str) -> tuple[np.ndarray, np.ndarray]:
    """Render a picture; return it and how long that took (2,)."""
    path = ready.folder / "way.exr"
    if engine == "cycles":
        _sample(scene, ready, SAMPLES)
    with Clock() as clock:
        render.render(scene, path, engine=engine)
    return pictures.read(path), clock.seconds


def _saved(ready: Ready) -> float:
    """Return the size of the open file [MB]."""
    path = ready.folder / "way.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, check_existing=False)
    size = path.stat().st_size / 1e6
    path.unlink()
    return size


RAYS = 64, 128, 256, 512, 1024

WAYS: dict[str, Way] = {
    "Ours, all light, in Cycles": ours(AUTO, "cycles"),
    "Ours, all light": ours(AUTO, "eevee"),
    "Cycles RGB, 64 samples": rgb(64),
    "Cycles RGB, 1024 samples": rgb(1024),
    "Eevee as it comes": eevee(),
    "Ours, open sky, in Cycles": ours(OPEN, "cycles"),
    "Ours, progressive": progressive(),
    **{f"Cycles RGB, {n} samples, denoised": rgb(n, True) for n in (16, 64, 256)},
    "Eevee, rays and probes by hand": eevee(by_hand=True),
    "Ours, live": ours(DOME, "eevee"),
    "Ours, open sky": ours(OPEN, "eevee"),
    **{f"Cycles by wavelength, {n} samples": wavelengths(n) for n in (16, 128)},
    **{f"Ours, {n} rays, in Cycles": ours(AUTO, "cycles", n) for n in RAYS},
    **{f"Cycles RGB in Rec.2020, {n} samples": rgb(n, wide=True) for n in (64, 1024)},
    **{f"Cycles RGB, {n} samples": rgb(n) for n in (16, 256, 4096)},
    **{f"Cycles RGB, {n} samples, denoised": rgb(n, True) for n in (1024,)},
    **{
        f"Cycles RGB in Rec.2020, {n} samples, denoised": rgb(n, True, wide=True) for n in (16, 256)
    },
}
"""All ways, those that tell most first."""
