"""Cycles with every bounce: RGB × RGB, denoised or not, in two spaces; wavelength by wavelength."""

import tempfile
from collections.abc import Iterator

import bands
import bpy
import numpy as np
import OpenEXR
import referee
import stage as stages
from ready import Ready
from way import Clock, Shot, Way, sample

from spectral_skylight.addon.spectra.working_spaces import rec709_to_working


def cycles(
    ready: Ready, samples: int, denoise: bool, seed: int = 7, sky: int | None = None
) -> dict[str, np.ndarray]:
    """Render the open scene in Cycles with every bounce; return the picture ``Combined`` and those
    of its light groups. ``sky``: into how many columns Cycles cuts the sky to find what is bright;
    None: as `sample` has it."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.render.engine = "CYCLES"
    settings = scene.cycles
    sample(scene, ready, samples)
    if sky is not None:
        scene.world.cycles.sample_map_resolution = sky
    settings.seed, settings.use_denoising = seed, denoise
    settings.light_sampling_threshold = settings.sample_clamp_indirect = settings.blur_glossy = 0.0
    for kind in ("max", "diffuse", "glossy", "transmission", "transparent_max"):
        setattr(settings, f"{kind}_bounces", referee.BOUNCES)
    settings.pixel_filter_type, settings.filter_width = "BLACKMAN_HARRIS", 1.0
    form = scene.render.image_settings
    if hasattr(form, "media_type"):  # Blender 5
        form.media_type = "MULTI_LAYER_IMAGE"
    form.file_format, form.color_depth = "OPEN_EXR_MULTILAYER", "32"
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/cycles.exr"
        scene.render.filepath = path
        bpy.ops.render.render(write_still=True)
        with OpenEXR.File(path, separate_channels=True) as file:
            channels = {n: c.pixels.copy() for part in file.parts for n, c in part.channels.items()}
    names = ["Combined", *(f"Combined_{group.name}" for group in layer.lightgroups)]
    return {
        name: np.stack([channels[f"{layer.name}.{name}.{c}"] for c in "RGB"], -1).astype(float)
        for name in names
    }


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
