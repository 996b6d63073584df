"""`Sky Irradiance`, `Ground Irradiance`: the light of one World's sky, and of the ground in its
HDRI, as polynomials of the world normal.

E(n) = P(x, y) + z Q(x, y), with P of degree 6 and Q of degree 5: as z² = 1 - x² - y² on the sphere,
these 49 terms span exactly the spherical harmonics up to degree 6 (Ramamoorthi & Hanrahan 2001,
doi:10.1145/383259.383317, stop at degree 2). Horner's scheme takes one Multiply Add a coefficient.
A lower degree leaves the higher coefficients 0, so another degree or sky changes values, never
the tree, and compiles nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial

import bpy

from . import normals
from . import tree as groups
from .sockets import NORMAL, ROTATION, STRENGTH
from .tree import Socket
from .value import Value, inputs, vector_math

KIND = "Sky Irradiance"
GROUND = "Ground Irradiance"
VERSION = 1
DEGREE = 6
GROUND_DEGREE = 3  # an even lower half is of degree 1
ROTATE = "Rotate"  # the node that turns the normal as the World's Mapping node turns its texture

INPUTS = (NORMAL, ROTATION, STRENGTH)
OUTPUTS = (
    Socket("Irradiance", "Vector", "Irradiance divided by π, in the linear RGB of the HDRI"),
)

Exponent = tuple[int, int, int]


def exponents(degree: int = DEGREE) -> list[Exponent]:
    """The (a, b, c) of the terms x^a y^b z^c, in the order in which coefficients are stored.

    All c = 0 with a + b <= degree, then all c = 1 with a + b <= degree - 1, each by (a + b, a):
    (degree + 1)² terms.
    """
    return [
        (a, total - a, c)
        for c in (0, 1)
        for total in range(degree + 1 - c)
        for a in range(total + 1)
    ]


def ensure(
    tree: bpy.types.NodeTree | None = None, kind: str = KIND, degree: int = DEGREE
) -> bpy.types.NodeTree:
    """A group of this kind: the given one, updated, its coefficients kept; or a new one, all 0."""
    kept = {} if tree is None else coefficients(tree)
    build = partial(_build, degree=degree)
    tree = groups.ensure(tree, kind, VERSION, INPUTS, OUTPUTS, build)
    set_coefficients(tree, kept)
    return tree


def coefficients(tree: bpy.types.NodeTree) -> dict[Exponent, tuple[float, float, float]]:
    """The RGB coefficient of each term that the group holds."""
    return {key: tuple(vector) for key in exponents() if (vector := _vector(tree, key)) is not None}


def set_coefficients(tree: bpy.types.NodeTree, values: Mapping[Exponent, Iterable[float]]) -> None:
    """Write the RGB coefficients of the given terms; the others keep theirs.

    What is there already is not written: Blender looks at all materials that use the group after
    each. Raises KeyError for a term that is over the group's degree.
    """
    for key, rgb in values.items():
        vector, wanted = _vector(tree, key), tuple(rgb)
        if vector is None:
            raise KeyError(key)
        if tuple(vector) != wanted:
            vector[:] = wanted


def _name(key: Exponent) -> str:
    return "x{} y{} z{}".format(*key)


def _row_name(b: int, c: int) -> str:
    return f"row y{b} z{c}"


def _vector(tree: bpy.types.NodeTree, key: Exponent):
    """The three numbers of one coefficient, which the Multiply Add node of its name adds.

    The highest power in a row of Horner's scheme has nothing that it could be added to: it is what
    the first node of that row multiplies, and lies there.
    """
    node = tree.nodes.get(_name(key))
    if node is not None:
        return node.inputs[2].default_value
    a, b, c = key
    node = tree.nodes.get(_name((a - 1, b, c)) if a else _row_name(b - 1, c))
    return None if node is None else node.inputs[0].default_value


def _build(tree: bpy.types.NodeTree, degree: int) -> None:
    given = inputs(tree)
    normal = normals.build(tree, given["Normal"])
    turned = groups.add(
        tree,
        "ShaderNodeVectorRotate",
        rotation_type="EULER_XYZ",
        name=ROTATE,
        into={"Vector": normal, "Rotation": given["Rotation"]},
    )
    x, y, z = Value(turned.outputs[0]).xyz()

    def multiply_add(a: Value | None, b: Value, c: Value | None, name: str) -> Value:
        """a b + c, where None is the coefficient that the node of this name holds itself."""
        return vector_math(tree, "MULTIPLY_ADD", a, b, c, name=name)

    def horner(degree: int, c: int) -> Value | None:
        total = None
        for b in range(degree, -1, -1):
            row = None
            for a in range(degree - b - 1, -1, -1):
                row = multiply_add(row, x, None, _name((a, b, c)))
            if b < degree:
                total = multiply_add(total, y, row, _row_name(b, c))
        return total

    irradiance = multiply_add(horner(degree - 1, 1), z, horner(degree, 0), "P + z Q")
    groups.add(tree, "NodeGroupOutput", irradiance * given["Strength"])
