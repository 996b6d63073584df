"""`Spectral Matrix`: a colour times a 3x3 matrix, as three dot products."""

from __future__ import annotations

import bpy

from . import tree as groups
from .tree import Socket
from .value import combine_rgb, inputs

KIND = "Spectral Matrix"
VERSION = 1
ROWS = ("Row R", "Row G", "Row B")

ROW_SOCKETS = tuple(
    Socket(
        name,
        "Vector",
        f"{number} row of the matrix: reflected {channel} for each unit of red, green and blue",
        row,
    )
    for name, number, channel, row in zip(
        ROWS,
        ("First", "Second", "Third"),
        ("red", "green", "blue"),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        strict=True,
    )
)
"""The rows of a matrix, identity by default, as every group with a matrix has them."""

INPUTS = (
    Socket("Color", "Color", "Light to multiply by the matrix", (1.0, 1.0, 1.0, 1.0)),
    *ROW_SOCKETS,
)
OUTPUTS = (Socket("Color", "Color", "The matrix times the color, not clamped"),)


def ensure() -> bpy.types.NodeTree:
    """The `Spectral Matrix` group of this file, made or updated."""
    return groups.ensure(groups.known(KIND, VERSION), KIND, VERSION, INPUTS, OUTPUTS, _build)


def set_matrix(node: bpy.types.Node, matrix) -> None:
    """Write a (3, 3) row-major matrix into the row inputs of a group node."""
    for name, row in zip(ROWS, matrix, strict=True):
        node.inputs[name].default_value = tuple(float(entry) for entry in row)


def is_whole(node: bpy.types.Node) -> bool:
    """Whether a group node has all inputs of a matrix; not where its group was removed by hand."""
    return all(name in node.inputs for name in ROWS)


def get_matrix(node: bpy.types.Node) -> list[list[float]]:
    """The (3, 3) row-major matrix in the row inputs of a group node."""
    return [list(node.inputs[name].default_value) for name in ROWS]


def _build(tree: bpy.types.NodeTree) -> None:
    given = inputs(tree)
    groups.add(tree, "NodeGroupOutput", combine_rgb(*(given["Color"].dot(given[r]) for r in ROWS)))
