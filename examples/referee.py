"""The referee: Cycles, three wavelengths at a time, and today's RGB × RGB along the same paths.

Nothing of the add-on is in it. Each lamp, the sun and the sky are a light group of their own, so
that every light keeps its full spectrum (see `bands`); two seeds give the picture and its noise.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import bands
import bpy
import numpy as np
import OpenEXR
import stage as stages
from stage import Lamp, Matter, Stage, Sun


class Wavelengths:
    """Three of the knots as red, green and blue; lights are flat, the sky is its quotient."""

    def __init__(self, triple: np.ndarray, sky_light: np.ndarray) -> None:
        self.triple, self.sky_light = triple, sky_light

    def of(self, spectra: np.ndarray) -> np.ndarray:
        return bands.at_knots(spectra)[..., self.triple]

    def sun(self, sun: Sun) -> np.ndarray:
        return np.ones(3)

    def lamp(self, lamp: Lamp) -> np.ndarray:
        return np.ones(3)

    def sky(self, sky: np.ndarray) -> np.ndarray:
        return self.of(sky / self.sky_light)

    def metal(self, tree: bpy.types.NodeTree, matter: Matter) -> bpy.types.Node:
        shader = tree.nodes.new("ShaderNodeBsdfMetallic")
        shader.fresnel_type = "PHYSICAL_CONDUCTOR"
        shader.inputs["Roughness"].default_value = matter.roughness
        for name, values in zip(("IOR", "Extinction"), matter.metal, strict=True):
            shader.inputs[name].default_value = self.of(values).tolist()
        return shader


class Today:
    """Colours as an architect has them: reflectances under D65, lights as the observer's RGB."""

    def of(self, spectra: np.ndarray) -> np.ndarray:
        return np.clip(bands.albedo(spectra), 0.0, 1.0)

    def sun(self, sun: Sun) -> np.ndarray:
        return np.maximum(bands.S @ sun.spectrum, 0.0)

    def lamp(self, lamp: Lamp) -> np.ndarray:
        return np.maximum(bands.S @ lamp.spectrum, 0.0)

    def sky(self, sky: np.ndarray) -> np.ndarray:
        return np.maximum(sky @ bands.S.T, 0.0)

    def metal(self, tree: bpy.types.NodeTree, matter: Matter) -> bpy.types.Node:
        n, k = matter.metal
        colour = self.of(((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2))
        shader = stages.principled(tree, colour, matter.roughness)
        shader.inputs["Metallic"].default_value = 1.0
        return shader


@dataclass(frozen=True)
class Verdict:
    """Linear Rec.709 pictures (h, w, 3) of one stage, each the mean of two seeds.

    ``spectral``, ``rgb``: the truth, and today's way; ``white``: what the perfect diffuser in a
    surface's place would be under the same light, 0 where nothing matt is seen; ``seeds``: the
    truth from either seed.
    """

    spectral: np.ndarray
    rgb: np.ndarray
    white: np.ndarray
    seeds: tuple[np.ndarray, np.ndarray]


def judge(stage: Stage, samples: int = 256, seeds: tuple[int, ...] = (1, 2)) -> Verdict:
    """Render a stage spectrally and as RGB, on the CPU, with ``samples`` a pixel and seed."""
    sky_light = stage.sky.reshape(-1, stage.sky.shape[-1]).mean(axis=0)
    lights = {"sky": sky_light}
    if stage.sun is not None:
        lights["sun"] = stage.sun.spectrum
    lights |= {name: lamp.spectrum for name, lamp in stage.lamps.items()}
    size = len(seeds), stage.camera.height, stage.camera.width
    quotients = {name: np.empty((*size, bands.KNOTS.size)) for name in lights}
    for triple in bands.TRIPLES:
        stages.build(stage, Wavelengths(triple, sky_light))
        for k, seed in enumerate(seeds):
            for name, picture in _render(stage, samples, seed).items():
                if name in lights:
                    quotients[name][k][..., triple] = picture
    truth = {name: bands.from_knots(quotients[name], light) for name, light in lights.items()}
    stages.build(stage, Today())
    today = [_render(stage, samples, seed) for seed in seeds]
    both = sum(truth.values())
    return Verdict(
        spectral=both.mean(axis=0),
        rgb=np.mean([sum(seed[name] for name in lights) for seed in today], axis=0),
        white=np.mean([seed["white"] for seed in today], axis=0),
        seeds=(both[0], both[-1]),
    )


def _render(stage: Stage, samples: int, seed: int) -> dict[str, np.ndarray]:
    """Return the open scene by light group, and as ``white`` the light on matt surfaces."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.light_sampling_threshold = 0.0
    cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = stage.bounces + 4
    cycles.diffuse_bounces, cycles.glossy_bounces = stage.bounces, 4
    cycles.transmission_bounces, cycles.transparent_max_bounces = 4, 8
    # Left to itself Cycles tabulates the sky far finer than it is, for seconds.
    scene.world.cycles.sampling_method = "MANUAL"
    scene.world.cycles.sample_map_resolution = stage.sky.shape[1]
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 1.0
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = True
    _light_groups(scene, layer)
    with tempfile.TemporaryDirectory() as folder:
        settings = scene.render.image_settings
        if hasattr(settings, "media_type"):  # Blender 5
            settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
        path = Path(folder) / "picture.exr"
        scene.render.filepath = str(path)
        bpy.ops.render.render(write_still=True)
        with OpenEXR.File(str(path), separate_channels=True) as file:
            # Blender 5 writes each pass as a part of its own.
            channels = {n: c.pixels.copy() for part in file.parts for n, c in part.channels.items()}

    def colour(*names: str) -> np.ndarray:
        name = next(name for name in names if f"{layer.name}.{name}.R" in channels)
        return np.stack([channels[f"{layer.name}.{name}.{c}"] for c in "RGB"], axis=-1).astype(
            float
        )

    groups = {group.name: colour(f"Combined_{group.name}") for group in layer.lightgroups}
    direct = colour("Diffuse Direct", "DiffDir")
    return {**groups, "white": direct + colour("Diffuse Indirect", "DiffInd")}


def _light_groups(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
    """Give the World and each lamp a light group of its name."""
    if len(layer.lightgroups):
        return
    layer.lightgroups.add(name="sky")
    scene.world.lightgroup = "sky"
    for light in (obj for obj in scene.objects if obj.type == "LIGHT"):
        layer.lightgroups.add(name=light.name)
        light.lightgroup = light.name
