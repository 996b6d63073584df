"""A small house under a low sun, so that the first minute needs no file at all.

It is a scene of its own: what the file holds stays as it is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
from mathutils import Vector

from .blend_data import nodes
from .world.simulated_sky import SkyPlace

NAME = "Skylight Example"

PLACE = SkyPlace("2026-09-22", "18:15", "+2", latitude=48.2, longitude=11.6, north=-35.0)
"""Munich in autumn, an hour before sunset, turned so that the sun strikes the front."""

PAINTS = {
    "Lawn": (0.06, 0.16, 0.03),
    "Paving": (0.38, 0.35, 0.31),
    "Brick": (0.35, 0.12, 0.07),
    "Plaster": (0.72, 0.61, 0.42),
    "Roof Tiles": (0.28, 0.09, 0.05),
    "White Trim": (0.80, 0.80, 0.77),
    "Blue Door": (0.05, 0.14, 0.34),
    "Window": (0.03, 0.04, 0.05),
    "Oak": (0.30, 0.17, 0.08),
    "Yew": (0.03, 0.08, 0.03),
}
"""Base colors, linear Rec.709."""

Corner = tuple[float, float, float]
Shape = tuple[list[Corner], list[tuple[int, ...]]]
"""A mesh's places, and the numbers of each face's corners."""

BOXES: dict[str, tuple[str, Corner, Corner]] = {
    "Ground": ("Lawn", (-40, -40, -0.3), (40, 40, 0)),
    "Terrace": ("Paving", (-4.6, -5.2, 0), (4.6, 0, 0.12)),
    "House": ("Plaster", (-4, 0, 0), (2.4, 5, 3)),
    "Wing": ("Brick", (2.4, -2.6, 0), (4.6, 3.4, 2.6)),
    "Plinth": ("Paving", (-4.06, -0.06, 0), (2.4, 5.06, 0.4)),
    "Wing Roof": ("White Trim", (2.1, -3.2, 2.6), (4.9, 3.7, 2.8)),
    "Door": ("Blue Door", (-0.5, -0.05, 0.12), (0.5, 0.0, 2.2)),
    "Door Frame": ("White Trim", (-0.65, -0.03, 0.12), (0.65, 0.0, 2.35)),
    "Window Left": ("Window", (-3.3, -0.04, 1.0), (-1.5, 0.0, 2.2)),
    "Window Sill": ("White Trim", (-3.45, -0.16, 0.9), (-1.35, 0.0, 1.0)),
    "Window Wing": ("Window", (2.36, -2.0, 1.0), (2.4, -0.8, 2.0)),
    "Garden Wall": ("Brick", (-8.5, -5.2, 0), (-4.6, -4.9, 1.3)),
    "Hedge": ("Yew", (-8.2, 1.0, 0), (-7.2, 7.0, 1.6)),
    "Bench Seat": ("Oak", (-3.9, -1.4, 0.5), (-1.7, -0.9, 0.58)),
    "Bench Left": ("Oak", (-3.8, -1.35, 0.12), (-3.68, -0.95, 0.5)),
    "Bench Right": ("Oak", (-1.92, -1.35, 0.12), (-1.8, -0.95, 0.5)),
    "Chimney": ("Brick", (-2.8, 3.0, 3.2), (-2.1, 3.7, 5.6)),
}
"""By name: paint, and the corners of least and greatest coordinates [m]."""

EYE, AIM = (-8.0, -13.0, 3.2), (-0.6, 0.2, 1.7)


def build() -> bpy.types.Scene:
    """Return a new scene with the house and a camera, lit by nothing yet."""
    scene = bpy.data.scenes.new(NAME)
    paints = {name: _paint(name, color) for name, color in PAINTS.items()}
    for name, (paint, low, high) in BOXES.items():
        _add(scene, name, _box(low, high), paints[paint])
    _add(scene, "Roof", _gable((-4.5, -0.6, 3.0), (2.7, 5.6, 5.2)), paints["Roof Tiles"])
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = EYE
    camera.rotation_euler = (Vector(AIM) - Vector(EYE)).to_track_quat("-Z", "Y").to_euler()
    camera.data.angle = math.radians(52)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def _paint(name: str, color: Sequence[float]) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    nodes.use(material)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    material.diffuse_color = (*color, 1.0)
    return material


def _add(
    scene: bpy.types.Scene,
    name: str,
    shape: Shape,
    paint: bpy.types.Material,
) -> None:
    mesh = bpy.data.meshes.new(name)
    places, faces = shape
    mesh.from_pydata(places, [], faces)
    mesh.materials.append(paint)
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def _box(low: Corner, high: Corner) -> Shape:
    x, y, z = zip(low, high, strict=True)
    places = [(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)]
    faces: list[tuple[int, ...]] = [
        (0, 2, 3, 1),
        (4, 5, 7, 6),
        (0, 1, 5, 4),
        (2, 6, 7, 3),
        (0, 4, 6, 2),
        (1, 3, 7, 5),
    ]
    return places, faces


def _gable(low: Corner, high: Corner) -> Shape:
    """A prism whose ridge runs along x over a box's middle."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    ridge = (y0 + y1) / 2.0
    places = [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)]
    places += [(x0, ridge, z1), (x1, ridge, z1)]
    return places, [(3, 2, 1, 0), (0, 1, 5, 4), (2, 3, 4, 5), (0, 4, 3), (1, 2, 5)]
