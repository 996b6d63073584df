"""The referee: Cycles with every bounce, three wavelengths at a time; and Cycles' own RGB × RGB.

Nothing of the add-on is in it. The sky, the sun, each lamp and what shines are a light group of
their own, so that every light keeps its full spectrum (see `bands`). Two seeds give the picture and
its noise; RGB × RGB has two others, or it would share the noise that it is judged by.
"""

import hashlib
import pickle
import tempfile
from dataclasses import dataclass, fields
from pathlib import Path

import bands
import bpy
import numpy as np
import OpenEXR
import stage as stages
from stage import Matter, Stage

BOUNCES = 64
"""Of each path. Inside a closed white room, 0.9, all further ones together bring 0.9^64 = 0.1 % of
the light (`tests/test_referee.py` measures it); roulette ends nearly all paths long before."""


class Wavelengths:
    """Three of the knots as red, green and blue; lights are flat, the sky is its quotient."""

    def __init__(self, triple: np.ndarray, sky_light: np.ndarray) -> None:
        self.triple, self.sky_light = triple, sky_light

    def of(self, spectra: np.ndarray) -> np.ndarray:
        return bands.at_knots(spectra)[..., self.triple]

    def light(self, spectrum: np.ndarray) -> np.ndarray:
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

    def light(self, spectrum: np.ndarray) -> np.ndarray:
        return np.maximum(bands.S @ spectrum, 0.0)

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
    """Linear Rec.709 pictures of one stage.

    ``spectral_seeds``, ``rgb_seeds`` (seeds, h, w, 3): the truth, and today's way, by other seeds;
    ``white`` (h, w, 3): what the perfect diffuser in a surface's place would be under the same
    light, 0 where nothing matt is seen; ``direct`` (h, w, 3): the part of it that has not bounced.
    """

    spectral_seeds: np.ndarray
    rgb_seeds: np.ndarray
    white: np.ndarray
    direct: np.ndarray

    @property
    def spectral(self) -> np.ndarray:
        """The truth, of all seeds (h, w, 3)."""
        return self.spectral_seeds.mean(axis=0)

    @property
    def rgb(self) -> np.ndarray:
        """RGB × RGB in the same light, of all its seeds (h, w, 3)."""
        return self.rgb_seeds.mean(axis=0)


def judge(stage: Stage, samples: int, seeds: int = 2, bounces: int = BOUNCES) -> Verdict:
    """Render a stage spectrally and as RGB, on the CPU, with ``samples`` a pixel and seed."""
    lights = stage.lights()
    size = seeds, stage.camera.height, stage.camera.width
    quotients = {name: np.empty((*size, bands.KNOTS.size)) for name in lights}
    for triple in bands.TRIPLES:
        stages.build(stage, Wavelengths(triple, lights["sky"]))
        for seed in range(seeds):
            rendered = _render(stage, samples, seed, bounces)
            for name in lights:
                quotients[name][seed][..., triple] = rendered[name]
    truth = sum(bands.from_knots(quotients[name], light) for name, light in lights.items())
    stages.build(stage, Today())
    today = [_render(stage, samples, seeds + seed, bounces) for seed in range(seeds)]
    mean = {name: np.mean([seed[name] for seed in today], axis=0) for name in today[0]}
    return Verdict(
        spectral_seeds=truth,
        rgb_seeds=np.array([sum(seed[name] for name in lights) for seed in today]),
        white=mean["direct"] + mean["bounced"],
        direct=mean["direct"],
    )


def judge_once(stage: Stage, samples: int, folder: Path) -> Verdict:
    """Return `judge`'s verdict, kept in a folder until scene, samples or the referee change."""
    digest = hashlib.sha256(pickle.dumps((stage, samples, bpy.app.version_string)))
    for module in (__file__, bands.__file__, stages.__file__):
        digest.update(Path(module).read_bytes())
    path = folder / f"referee_{digest.hexdigest()[:16]}.npz"
    if not path.is_file():
        verdict = judge(stage, samples)
        for old in folder.glob("referee_*.npz"):
            old.unlink()
        np.savez_compressed(path, **{f.name: getattr(verdict, f.name) for f in fields(verdict)})
    with np.load(path) as kept:
        return Verdict(**kept)


def _render(stage: Stage, samples: int, seed: int, bounces: int) -> dict[str, np.ndarray]:
    """Return the open scene by light group, and the ``direct`` and ``bounced`` light on matt."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.light_sampling_threshold = 0.0
    cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    for kind in ("max", "diffuse", "glossy", "transmission", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", bounces)
    # Left to itself Cycles tabulates the sky far finer than it is, for seconds.
    scene.world.cycles.sampling_method = "MANUAL"
    scene.world.cycles.sample_map_resolution = stage.sky.shape[1]
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 1.0
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = True
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
    passes = {"direct": ("Diffuse Direct", "DiffDir"), "bounced": ("Diffuse Indirect", "DiffInd")}
    return groups | {name: colour(*names) for name, names in passes.items()}
