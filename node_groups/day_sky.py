"""`Day Sky`: a clear sky for every height of the sun, between key skies that lie in one image.

A clear sky depends on how high the sun stands, and turns with it. So one image holds key skies, one
above the other, in a frame in which the sun stands over +x; two of them are looked up and mixed.
Each is the half on one side of the sun's meridian, of which the other is the mirror image, and is
stretched so that horizon, sun and zenith lie on the same rows in all: between two key skies the
brightness around the sun moves with it and is not seen twice. The lower half is the ground, of one
color; the sun's disc is drawn where the sun stands.

Only numbers change from frame to frame, so nothing is compiled, and however many key skies there
are, two are read.
"""

from __future__ import annotations

import math

import bpy

from . import tree as groups
from .tree import Socket
from .value import Value, inputs, vector_math
from .value import math as number

KIND = "Day Sky"
VERSION = 1
ROWS, COLUMNS = 128, 256
GUTTER = 8
"""Rows around a key sky that repeat its first and last: where coarser levels of the image are read,
as near the zenith, nothing of its neighbors shows."""

TILE = ROWS + 2 * GUTTER
LOW, HIGH = 5.0, 80.0
"""[degrees] between which the rows of a key sky are stretched by where the sun stands."""

SUN_RADIUS = math.radians(0.2665)
SOLID_ANGLE = 2.0 * math.pi * (1.0 - math.cos(SUN_RADIUS))
LOWER, UPPER, COUNT = "Lower Key", "Upper Key", "Key Skies"

INPUTS = (
    Socket("Vector", "Vector", "Direction in a frame in which the sun stands over +X"),
    Socket("Elevation", "Float", "Elevation of the sun in degrees"),
    Socket("Key", "Float", "Number of the key sky. Between whole numbers two are mixed"),
    Socket("Sun", "Vector", "RGB radiance of the sun's disc"),
    Socket("Ground", "Vector", "RGB radiance of the ground, which fills the lower half"),
)
OUTPUTS = (Socket("Color", "Color", "RGB radiance of the sky"),)


def ensure(tree: bpy.types.NodeTree | None = None) -> bpy.types.NodeTree:
    """A `Day Sky` group: the given one, updated, its image kept; or a new one, without an image."""
    kept = None if tree is None else (image_of(tree), count_of(tree))
    tree = groups.ensure(tree, KIND, VERSION, INPUTS, OUTPUTS, _build)
    if kept is not None and kept[0] is not None:
        set_image(tree, *kept)
    return tree


def image_of(tree: bpy.types.NodeTree) -> bpy.types.Image | None:
    """The image of a group's key skies, None without."""
    node = tree.nodes.get(LOWER)
    return None if node is None else node.image


def count_of(tree: bpy.types.NodeTree) -> int:
    """How many key skies a group's image holds."""
    node = tree.nodes.get(COUNT)
    return 1 if node is None else max(1, round(node.outputs[0].default_value))


def set_image(tree: bpy.types.NodeTree, image: bpy.types.Image, count: int) -> None:
    """Give a group the image of ``count`` key skies: the first at the bottom."""
    for name in (LOWER, UPPER):
        tree.nodes[name].image = image
    tree.nodes[COUNT].outputs[0].default_value = float(count)


def _build(tree: bpy.types.NodeTree) -> None:
    given = inputs(tree)

    def math_of(operation: str, *operands: Value | float) -> Value:
        return number(tree, operation, *operands)

    def vector(x: Value, y: Value | float, z: Value | float) -> Value:
        return Value(groups.add(tree, "ShaderNodeCombineXYZ", x, y, z).outputs[0])

    to_degrees = 180.0 / math.pi
    way = given["Vector"].normalize()
    x, y, z = way.xyz()
    height = math_of("ARCSINE", z) * to_degrees
    u = math_of("ARCTAN2", abs(y), x) * ((COLUMNS - 1) / (COLUMNS * math.pi))
    knot = given["Elevation"].maximum(LOW).minimum(HIGH)
    under = (height / knot).clamp()
    over = ((height - knot) / math_of("SUBTRACT", 90.0, knot)).clamp()
    row = (under + over) * (0.5 * (ROWS - 1))
    count = groups.add(tree, "ShaderNodeValue", name=COUNT, label=COUNT).outputs[0]
    count.default_value = 1.0
    part = given["Key"].fraction()
    rows = (given["Key"] - part) * TILE + row + (GUTTER + 0.5)
    total = Value(count) * TILE
    color = None
    for name, above in ((LOWER, 0.0), (UPPER, float(TILE))):
        at = vector(u + 0.5 / COLUMNS, (rows + above) / total, 0.0)
        texture = groups.add(
            tree, "ShaderNodeTexImage", at, name=name, label=name, extension="EXTEND"
        )
        found = Value(texture.outputs["Color"])
        if color is not None:
            found = vector_math(tree, "SUBTRACT", found, color) * part + color
        color = found
    assert color is not None
    angle = given["Elevation"] * (1.0 / to_degrees)
    sun = vector(math_of("COSINE", angle), 0.0, math_of("SINE", angle))
    inside = way.distance(sun).less_than(2.0 * math.sin(0.5 * SUN_RADIUS))
    sky = vector_math(tree, "ADD", given["Sun"] * inside, color)
    below = z.less_than(0.0)
    seen = groups.add(
        tree, "ShaderNodeMix", below, sky, given["Ground"], data_type="VECTOR", clamp_factor=True
    )
    groups.add(tree, "NodeGroupOutput", next(s for s in seen.outputs if s.enabled))
