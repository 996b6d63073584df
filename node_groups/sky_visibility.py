"""`Sky Visibility`: the sky's irradiance on vertices that know how much of that sky they see.

Precomputed radiance transfer (Sloan, Kautz & Snyder 2002, doi:10.1145/566654.566612): a bake leaves
in mesh attributes the harmonics of each corner's transfer, visibility times cosine / pi; a World's
sky lies here as the RGB coefficients of the same harmonics, and irradiance is their sum of
products. Another sky changes values alone. A turn of the sky about z turns the transfer:
harmonics of order m by m times the angle. All is in world space; attributes are found by name.

    skylight_0 … 3   16 harmonics of the sky (`PLACES`)
    skylight_4       share of what lies below the horizon; where baked, the `mark` of the object's
                     place, else 0; the sun's two bounces
    skylight_5 … 9   9 harmonics each of the sky's light by way of two kinds of neighbours; 1 where
                     those were baked
    skylight_exact   what the harmonics leave of one sky's irradiance; that sky's key
    skylight_back    1 and the part that a face seen from behind has of the open sky's RGB; the same
                     of what lies below the horizon, without the 1
"""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Mapping, Sequence
from functools import partial

import bpy

from . import tree as groups
from .sky_irradiance import ROTATE

KIND = "Sky Visibility"
VERSION = 3
EXACT = "skylight_exact"
BACK = "skylight_back"
SUN = "Exact for"  # the node with the turn of the sky for which the exact part was made
KEY = "Key"  # … and with its key
FADE = 0.9962  # cosine of 5 degrees: so far turned, the exact part is no longer right, and is gone

LANDMARK = (0.37, 0.61, 0.83)  # a point of each object, by whose place in the world it is told
ALONG = (1.618, 2.236, 2.646)  # … along this direction, modulo 1 unit
NEAR = 0.01  # how far the place may be off: float32 far from the origin

Key = tuple[int, int]
Place = tuple[int, int]


def attribute(number: int) -> str:
    """The name of a colour attribute on corners."""
    return f"skylight_{number}"


PLACES: dict[Key, Place] = {
    (1, 1): (0, 0), (2, 1): (0, 1), (3, 1): (0, 2), (0, 0): (0, 3),
    (1, -1): (1, 0), (2, -1): (1, 1), (3, -1): (1, 2), (1, 0): (1, 3),
    (2, 2): (2, 0), (3, 2): (2, 1), (3, 3): (2, 2), (2, 0): (2, 3),
    (2, -2): (3, 0), (3, -2): (3, 1), (3, -3): (3, 2), (3, 0): (3, 3),
}  # fmt: skip
"""Attribute and channel (RGBA: 0 to 3) that hold the transfer's harmonic (degree, order)."""

GROUND: Place = (4, 0)
BAKED: Place = (4, 1)
BOUNCED: Place = (9, 2)
BOUNCE_SUN: tuple[Place, Place] = ((4, 2), (4, 3))

BOUNCES: tuple[dict[Key, Place], dict[Key, Place]] = (
    {
        (1, 1): (5, 0), (2, 1): (5, 1), (2, 2): (5, 2), (0, 0): (5, 3),
        (1, -1): (6, 0), (2, -1): (6, 1), (2, -2): (6, 2), (1, 0): (6, 3), (2, 0): (9, 0),
    },
    {
        (1, 1): (7, 0), (2, 1): (7, 1), (2, 2): (7, 2), (0, 0): (7, 3),
        (1, -1): (8, 0), (2, -1): (8, 1), (2, -2): (8, 2), (1, 0): (8, 3), (2, 0): (9, 1),
    },
)  # fmt: skip
"""The same for light by way of the first and second kind of neighbours, degrees 0 to 2."""


def mark(to_world: Sequence[Sequence[float]]) -> float:
    """What the flag holds on objects with this matrix (4, 4) to the world: 1 to 2.

    Attributes are in world space. Another mark, as an instance or a moved object has it (but for
    one of fifty), is no flag.
    """
    place = [sum(m * p for m, p in zip(row, (*LANDMARK, 1.0), strict=True)) for row in to_world]
    return 1.0 + math.fmod(1.0 + math.fmod(sum(map(operator.mul, place, ALONG)), 1.0), 1.0)


def ensure(tree: bpy.types.NodeTree | None = None, bounce: bool = False) -> bpy.types.NodeTree:
    """A `Sky Visibility` group: the given one, updated, its coefficients kept; or a new one, all 0.

    Inputs: Rotation (Euler XYZ [rad], of which z is followed) and Strength, as the World's Mapping
    and Background have them. Outputs: Irradiance, irradiance/pi in the HDRI's linear RGB, nowhere
    negative; Ground, the part (0 to 1) of a white face's view that is open below the horizon;
    Baked, 1 where these hold and 0 where a mesh was not baked or elsewhere, as an instance or a
    moved object, or where its face is seen from behind;
    Back and Back Ground, what a face seen from behind has of the light of open sky and ground,
    else 1; with `bounce` always 1, for a material has no more than 14 attributes;
    Bounce 1, Bounce 2 and Bounce 1 Sun, Bounce 2 Sun, light by way of neighbours, all 0 without
    `bounce`: another shader, with five more attributes.
    """
    kept, first = ({}, {}) if tree is None else (coefficients(tree), coefficients(tree, _FIRST))
    tree = groups.ensure(
        tree,
        KIND,
        VERSION,
        [("Rotation", "NodeSocketVector", None), ("Strength", "NodeSocketFloat", 1.0)],
        [
            ("Irradiance", "NodeSocketVector", None),
            ("Ground", "NodeSocketFloat", None),
            ("Baked", "NodeSocketFloat", None),
            ("Back", "NodeSocketVector", None),
            ("Back Ground", "NodeSocketFloat", None),
            ("Bounce 1", "NodeSocketVector", None),
            ("Bounce 1 Sun", "NodeSocketFloat", None),
            ("Bounce 2", "NodeSocketVector", None),
            ("Bounce 2 Sun", "NodeSocketFloat", None),
        ],
        partial(_build, bounce=bounce),
        variant="bounce" if bounce else "",
    )
    set_coefficients(tree, kept, first)
    return tree


_FIRST = " of bounce 1"
_SECOND = " of bounce 2"


def coefficients(tree: bpy.types.NodeTree, of: str = "") -> dict[Key, tuple[float, float, float]]:
    """The RGB coefficient of each harmonic (degree, order) of the sky that the group holds."""
    found = ((key, tree.nodes.get(_name(key) + of)) for key in PLACES)
    return {key: tuple(node.inputs[1].default_value) for key, node in found if node is not None}


def set_coefficients(
    tree: bpy.types.NodeTree,
    values: Mapping[Key, Iterable[float]],
    first: Mapping[Key, Iterable[float]] | None = None,
) -> None:
    """Write the sky's RGB coefficients of the given harmonics; the others keep theirs.

    `first`: those of a fit with 9 harmonics, for the bounces; left out where the group has none.
    """
    written = [(key, rgb, "") for key, rgb in values.items()]
    written += [(key, rgb, of) for key, rgb in (first or {}).items() for of in (_FIRST, _SECOND)]
    for key, rgb, of in written:
        node = tree.nodes.get(_name(key) + of)
        if node is not None:
            node.inputs[1].default_value = tuple(rgb)


def set_exact(tree: bpy.types.NodeTree, key: float, turn: tuple[float, float]) -> None:
    """Say for which sky the attribute `EXACT` holds: its key, -1 for none, and its turn.

    `turn`: (cos, sin) of the angle about z that the transfer was turned by.
    """
    tree.nodes[KEY].inputs[1].default_value = key
    tree.nodes[SUN].inputs[1].default_value = (*turn, 0.0)


def _name(key: Key) -> str:
    return "l{} m{}".format(*key)


def _build(tree: bpy.types.NodeTree, bounce: bool) -> None:
    add = partial(groups.add, tree)

    def maths(operation, *sources, **settings):
        return add("ShaderNodeMath", *sources, operation=operation, **settings).outputs[0]

    def vectors(operation, *sources, **settings):
        return add("ShaderNodeVectorMath", *sources, operation=operation, **settings).outputs[0]

    def read(name):
        node = add("ShaderNodeAttribute", attribute_name=name, attribute_type="GEOMETRY")
        return node.outputs["Vector"], node.outputs["Alpha"]

    given = add("NodeGroupInput").outputs
    arrow = add("ShaderNodeVectorRotate", rotation_type="EULER_XYZ", name=ROTATE)
    arrow.inputs["Vector"].default_value = (1.0, 0.0, 0.0)
    tree.links.new(given["Rotation"], arrow.inputs["Rotation"])
    level = vectors("NORMALIZE", vectors("MULTIPLY", arrow.outputs[0], (1.0, 1.0, 0.0)))
    c, s, _ = add("ShaderNodeSeparateXYZ", level).outputs
    c2 = maths("MULTIPLY_ADD", maths("MULTIPLY", c, 2.0), c, -1.0)
    s2 = maths("MULTIPLY", maths("MULTIPLY", c, 2.0), s)
    c3 = maths("SUBTRACT", maths("MULTIPLY", c2, c), maths("MULTIPLY", s2, s))
    s3 = maths("MULTIPLY_ADD", s2, c, maths("MULTIPLY", c2, s))

    def turn(even, odd, cosines, sines):
        """The harmonics of orders m and -m after the turn, six numbers."""
        cosine = add("ShaderNodeCombineXYZ", *cosines).outputs[0]
        sine = add("ShaderNodeCombineXYZ", *sines).outputs[0]
        turned = (
            vectors("SUBTRACT", vectors("MULTIPLY", even, cosine), vectors("MULTIPLY", odd, sine)),
            vectors("MULTIPLY_ADD", even, sine, vectors("MULTIPLY", odd, cosine)),
        )
        return [n for v in turned for n in add("ShaderNodeSeparateXYZ", v).outputs]

    def total(harmonics, of=""):
        """The sum over harmonics of transfer times the sky's coefficient, which lies here."""
        light = None
        for key, value in harmonics.items():
            sources = (value, (0.0,) * 3, (0.0,) * 3 if light is None else light)
            light = vectors("MULTIPLY_ADD", *sources, name=_name(key) + of)
        return light

    (one, z0), (minus_one, z1), (more, z2), (minus_more, z3) = (
        read(attribute(k)) for k in range(4)
    )
    keys = [(1, 1), (2, 1), (3, 1), (1, -1), (2, -1), (3, -1)]
    keys += [(2, 2), (3, 2), (3, 3), (2, -2), (3, -2), (3, -3)]
    values = turn(one, minus_one, (c, c, c), (s, s, s))
    values += turn(more, minus_more, (c2, c2, c3), (s2, s2, s3))
    harmonics = dict(zip(keys, values, strict=True))
    harmonics |= {(0, 0): z0, (1, 0): z1, (2, 0): z2, (3, 0): z3}
    light = total(harmonics)

    left, key = read(EXACT)
    same = maths("COMPARE", key, -1.0, 0.25, name=KEY)
    along = add("ShaderNodeVectorMath", level, (1.0, 0.0, 0.0), operation="DOT_PRODUCT", name=SUN)
    near = add("ShaderNodeMapRange", along.outputs["Value"], FADE, 1.0, 0.0, 1.0).outputs[0]
    left = add("ShaderNodeVectorMath", left, operation="SCALE")
    tree.links.new(maths("MULTIPLY", same, near), left.inputs["Scale"])
    light = vectors("MAXIMUM", vectors("ADD", light, left.outputs[0]), (0.0,) * 3)

    def lit(light, by=given["Strength"]):
        scaled = add("ShaderNodeVectorMath", light, operation="SCALE")
        tree.links.new(by, scaled.inputs["Scale"])
        return scaled.outputs[0]

    other, sun_2 = read(attribute(4))
    ground, flag, sun_1 = add("ShaderNodeSeparateXYZ", other).outputs
    behind = add("ShaderNodeNewGeometry").outputs["Backfacing"]
    here = add(
        "ShaderNodeVectorTransform",
        LANDMARK,
        vector_type="POINT",
        convert_from="OBJECT",
        convert_to="WORLD",
    ).outputs[0]
    place = add("ShaderNodeVectorMath", here, ALONG, operation="DOT_PRODUCT").outputs["Value"]
    off = maths("FRACT", maths("ADD", maths("SUBTRACT", flag, place), 0.5))
    same = maths("MULTIPLY", maths("COMPARE", off, 0.5, NEAR), maths("GREATER_THAN", flag, 0.5))
    baked = maths("MULTIPLY", same, maths("SUBTRACT", 1.0, behind))
    results = [lit(light), ground, baked]
    if bounce:
        results += [(1.0, 1.0, 1.0), 1.0]
    else:
        # Of another place the flag of the front tells, and without it 1 is missing too.
        part, below = read(BACK)
        known = add("ShaderNodeSeparateXYZ", part).outputs[0]
        known = maths(
            "MULTIPLY", maths("GREATER_THAN", known, 0.5), maths("MULTIPLY", same, behind)
        )
        thrice = add("ShaderNodeCombineXYZ", known, known, known).outputs[0]
        part = vectors("MAXIMUM", vectors("SUBTRACT", part, (1.0,) * 3), (0.0,) * 3)
        results += [
            vectors("MULTIPLY_ADD", vectors("SUBTRACT", part, (1.0,) * 3), thrice, (1.0,) * 3),
            maths("MULTIPLY_ADD", maths("SUBTRACT", below, 1.0), known, 1.0),
        ]
    if bounce:
        # A missing attribute reads 0 with alpha 1, which would be a constant harmonic.
        spare = add("ShaderNodeSeparateXYZ", read(attribute(9))[0]).outputs
        there = maths("MULTIPLY", spare[2], baked)
        strength = maths("MULTIPLY", given["Strength"], there)
        orders = [(1, 1), (2, 1), (2, 2), (1, -1), (2, -1), (2, -2)]
        for way, of, sun in ((0, _FIRST, sun_1), (1, _SECOND, sun_2)):
            (even, z0), (odd, z1) = read(attribute(5 + 2 * way)), read(attribute(6 + 2 * way))
            turned = turn(even, odd, (c, c, c2), (s, s, s2))
            harmonics = dict(zip(orders, turned, strict=True))
            harmonics |= {(0, 0): z0, (1, 0): z1, (2, 0): spare[way]}
            light = vectors("MAXIMUM", total(harmonics, of), (0.0,) * 3)
            results += [lit(light, strength), maths("MULTIPLY", sun, there)]
    add("NodeGroupOutput", *results)
    groups.arrange(tree)
