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
from typing import Any

import bpy

from . import tree as groups
from .sky_irradiance import ROTATE
from .sockets import ROTATION, STRENGTH
from .tree import Socket
from .value import Value, combine_xyz, inputs, outputs, vector_math

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

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)

Key = tuple[int, int]
Place = tuple[int, int]
Angles = tuple[Value, Value, Value]


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


INPUTS = (ROTATION, STRENGTH)
OUTPUTS = (
    Socket("Irradiance", "Vector", "Irradiance divided by π, in the linear RGB of the HDRI"),
    Socket("Ground", "Float", "Cosine-weighted share of the view that is open below the horizon"),
    Socket(
        "Baked",
        "Float",
        "1 where the bake holds. 0 on faces that have the open sky: not baked, moved or seen from "
        "behind",
    ),
    Socket(
        "Back",
        "Vector",
        "Share of the open sky's RGB on a face seen from behind. 1 where no back is baked",
    ),
    Socket(
        "Back Ground",
        "Float",
        "Share of the light from below on a face seen from behind. 1 where no back is baked",
    ),
    Socket("Bounce 1", "Vector", "Skylight reflected by the first kind of neighbors"),
    Socket("Bounce 1 Sun", "Float", "Sunlight reflected by the first kind of neighbors"),
    Socket("Bounce 2", "Vector", "Skylight reflected by all other neighbors"),
    Socket("Bounce 2 Sun", "Float", "Sunlight reflected by all other neighbors"),
)


def ensure(tree: bpy.types.NodeTree | None = None, bounce: bool = False) -> bpy.types.NodeTree:
    """A `Sky Visibility` group: the given one, updated, its coefficients kept; or a new one, all 0.

    `bounce`: whether neighbours' light is in it, which is another shader with five more attributes.
    With it Back and Back Ground are always 1, for a material has no more than 14 attributes;
    without it the bounces are 0.
    """
    kept, first = ({}, {}) if tree is None else (coefficients(tree), coefficients(tree, _FIRST))
    tree = groups.ensure(
        tree,
        KIND,
        VERSION,
        INPUTS,
        OUTPUTS,
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
    given = inputs(tree)
    arrow = add(
        "ShaderNodeVectorRotate",
        rotation_type="EULER_XYZ",
        name=ROTATE,
        into={"Vector": (1.0, 0.0, 0.0), "Rotation": given["Rotation"]},
    )
    level = (Value(arrow.outputs[0]) * (1.0, 1.0, 0.0)).normalize()
    c, s, _ = level.xyz()
    c2 = (c * 2.0).multiply_add(c, -1.0)
    s2 = c * 2.0 * s
    c3 = c2 * c - s2 * s
    s3 = s2.multiply_add(c, c2 * s)

    def read(name: str) -> tuple[Value, Value]:
        """The first three numbers of an attribute, and the fourth."""
        attribute = add("ShaderNodeAttribute", attribute_name=name, attribute_type="GEOMETRY")
        parts = outputs(attribute)
        return parts["Vector"], parts["Alpha"]

    def turn(even: Value, odd: Value, cosines: Angles, sines: Angles) -> list[Value]:
        """The harmonics of orders m and -m after the turn, six numbers."""
        cosine, sine = combine_xyz(*cosines), combine_xyz(*sines)
        turned = (even * cosine - odd * sine, even.multiply_add(sine, odd * cosine))
        return [number for vector in turned for number in vector.xyz()]

    def total(harmonics: Mapping[Key, Value], of: str = "") -> Value:
        """The sum over harmonics of transfer times the sky's coefficient, which lies here."""
        light: Any = BLACK
        for key, transfer in harmonics.items():
            operands = (transfer, BLACK, light)
            light = vector_math(tree, "MULTIPLY_ADD", *operands, name=_name(key) + of)
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
    same = key.near(-1.0, 0.25, name=KEY)
    along = level.dot((1.0, 0.0, 0.0), name=SUN)
    near = Value(add("ShaderNodeMapRange", along, FADE, 1.0, 0.0, 1.0).outputs[0])
    light = (light + left * (same * near)).maximum(BLACK)

    other, sun_2 = read(attribute(4))
    ground, flag, sun_1 = other.xyz()
    behind = Value(add("ShaderNodeNewGeometry").outputs["Backfacing"])
    here = add(
        "ShaderNodeVectorTransform",
        LANDMARK,
        vector_type="POINT",
        convert_from="OBJECT",
        convert_to="WORLD",
    )
    place = Value(here.outputs[0]).dot(ALONG)
    off = (flag - place + 0.5).fraction()
    same = off.near(0.5, NEAR) * flag.greater_than(0.5)
    baked = same * (1.0 - behind)
    results: list[Any] = [light * given["Strength"], ground, baked]
    if bounce:
        results += [WHITE, 1.0]
    else:
        # Of another place the flag of the front tells, and without it 1 is missing too.
        part, below = read(BACK)
        known = part.xyz()[0].greater_than(0.5) * (same * behind)
        thrice = combine_xyz(known, known, known)
        part = (part - WHITE).maximum(BLACK)
        results += [
            (part - WHITE).multiply_add(thrice, WHITE),
            (below - 1.0).multiply_add(known, 1.0),
        ]
    if bounce:
        # A missing attribute reads 0 with alpha 1, which would be a constant harmonic.
        spare = read(attribute(9))[0].xyz()
        there = spare[2] * baked
        strength = given["Strength"] * there
        orders = [(1, 1), (2, 1), (2, 2), (1, -1), (2, -1), (2, -2)]
        for way, of, sun in ((0, _FIRST, sun_1), (1, _SECOND, sun_2)):
            (even, z0), (odd, z1) = read(attribute(5 + 2 * way)), read(attribute(6 + 2 * way))
            turned = turn(even, odd, (c, c, c2), (s, s, s2))
            harmonics = dict(zip(orders, turned, strict=True))
            harmonics |= {(0, 0): z0, (1, 0): z1, (2, 0): spare[way]}
            light = total(harmonics, of).maximum(BLACK)
            results += [light * strength, sun * there]
    add("NodeGroupOutput", *results)
