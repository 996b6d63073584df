"""What an Eevee sample of each kind of material costs, beside one of plain Diffuse.

One plane fills the picture. The cost of a sample is the difference between renders of many and of
few, per sample: what a render costs whatever its samples drops out. Rounds take all materials in
turn, for other work on the machine hits all, and the least of each counts. Two clocks: the wall's,
and the processor time of this process, which on a software OpenGL is the whole cost and nearly
blind to what else the machine does.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups.skylight_surface import Features
from ... import tags
from ...sky.dome import dome
from ...sky.panorama import write_panorama
from ..blend_data import nodes
from ..lights import dome_lamps, sun_lamp
from ..materials import spectral_material
from ..world import hdri as worlds
from ..world import light_group
from . import render

OURS = "Skylight Surface"
"""All degrees, and scalar, diagonal and 3x3 alike: one topology, whose values alone change."""

LIT = {
    "Skylight Surface, sun": Features(probe=True),
    "Skylight Surface, baked": Features("baked"),
    "Skylight Surface, dome": Features("dome", probe=True),
}
"""With the light that scenes have; in each a lamp or those of a dome shine on it."""


@dataclass(frozen=True)
class Cost:
    """What a sample costs: ``ratio`` to one of Diffuse by processor time, ``wall_ratio`` by the
    wall's, and both times [ms]."""

    ratio: float
    wall_ratio: float
    ms_processor: float
    ms_wall: float


def sample_costs(
    size: int = 1024, samples: tuple[int, int] = (1, 3), rounds: int = 3
) -> Iterator[dict[str, Cost]]:
    """Yield after each round the cost of every material so far: Diffuse, Principled, Emission,
    an irradiance texture looked up by the normal, `OURS` and `LIT`.

    Renders ``size`` by ``size`` pixels with few and many ``samples``, in a scene of its own, which
    goes again. In small pictures a sample costs what Eevee does for each, whatever it shades.
    """
    scene = bpy.data.scenes.new("Cost")
    plane = bpy.data.meshes.new("Cost")
    plane.from_pydata([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [], [(0, 1, 2, 3)])
    camera = bpy.data.cameras.new("Cost")
    camera.type, camera.ortho_scale = "ORTHO", 2.0
    for data in (plane, camera):
        scene.collection.objects.link(bpy.data.objects.new("Cost", data))
    shown, scene.camera = scene.collection.objects
    scene.camera.location = (0.0, 0.0, 10.0)
    plane.materials.append(None)
    scene.render.engine = render.engine_id("eevee")
    scene.render.resolution_x = scene.render.resolution_y = size

    def seconds(material: bpy.types.Material, count: int) -> NDArray[np.float64]:
        shown.material_slots[0].material = material
        for lamp in (obj for obj in scene.objects if obj.type == "LIGHT"):
            lamp.hide_render = lamp[tags.LAMP] != lit_by.get(material.name)
        scene.eevee.taa_render_samples = count
        start = np.array([time.perf_counter(), time.process_time()])
        bpy.ops.render.render(scene=scene.name)
        return np.array([time.perf_counter(), time.process_time()]) - start

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sky.exr"
        write_panorama(path, np.ones((8, 16, 3)))
        world = worlds.set_sky(scene, path)
        kinds = {
            "Diffuse": _plain("ShaderNodeBsdfDiffuse"),
            "Principled": _plain("ShaderNodeBsdfPrincipled"),
            "Emission": _plain("ShaderNodeEmission"),
            "irradiance texture": _texture(worlds.sky_of(world).image),
            OURS: _ours(world, OURS, Features()),
            **{name: _ours(world.copy(), name, features) for name, features in LIT.items()},
        }
        with_sun, _, with_dome = LIT
        lit_by = {with_sun: sun_lamp.SUN, with_dome: dome_lamps.DOME}
        shown.material_slots[0].material = kinds[OURS]  # what lamps shine on is told by it
        sun_lamp.place(scene, np.array([0.0, 0.6, 0.8]), np.ones(3), 1.0)
        dome_lamps.place(scene, dome(np.ones((8, 16, 3))))
        try:
            for material in kinds.values():
                seconds(material, 1)  # compiles
            found: dict[str, list[list[NDArray]]] = {name: [] for name in kinds}
            for _ in range(rounds):
                for name, material in kinds.items():
                    found[name].append([seconds(material, count) for count in samples])
                yield _costs(found, samples[1] - samples[0])
        finally:
            sun_lamp.remove(scene, (sun_lamp.SUN, dome_lamps.DOME, sun_lamp.TURN))
            bpy.data.batch_remove([*kinds.values(), shown, scene.camera, plane, camera])
            bpy.data.scenes.remove(scene)


def _costs(found: dict[str, list[list[NDArray]]], samples: int) -> dict[str, Cost]:
    costs = {}
    for name, times in found.items():
        few, many = np.min(times, axis=0)
        costs[name] = (many - few) / samples
    return {
        name: Cost(
            *(float(ratio) for ratio in (cost / costs["Diffuse"])[::-1]),
            *(1e3 * float(time) for time in cost[::-1]),
        )
        for name, cost in costs.items()
    }


def blender_version() -> str:
    """Return the version of the Blender that this is."""
    return bpy.app.version_string


def _material(name: str) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    nodes.use(material)
    material.node_tree.nodes.clear()
    return material


def _plain(shader: str) -> bpy.types.Material:
    material = _material(shader)
    tree = material.node_tree
    node, output = tree.nodes.new(shader), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def _texture(image: bpy.types.Image) -> bpy.types.Material:
    material = _plain("ShaderNodeEmission")
    tree = material.node_tree
    normal, lookup = (
        tree.nodes.new(kind) for kind in ("ShaderNodeNewGeometry", "ShaderNodeTexEnvironment")
    )
    lookup.image = image
    tree.links.new(normal.outputs["Normal"], lookup.inputs["Vector"])
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(lookup.outputs["Color"], emission.inputs["Color"])
    return material


def _ours(world: bpy.types.World, name: str, features: Features) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    light_group.ensure(world, features)
    spectral_material.apply(material, world, spectral_material.Surface(0.5 * np.eye(3)))
    light_group.set_coefficients(world, np.full((49, 3), 0.02))
    return material
