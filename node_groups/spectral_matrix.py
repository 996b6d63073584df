"""`Spectral Matrix`: a colour times a 3x3 matrix, as three dot products."""

from __future__ import annotations

import bpy

from . import tree as groups

KIND = "Spectral Matrix"
VERSION = 1
ROWS = ("Row R", "Row G", "Row B")


def ensure() -> bpy.types.NodeTree:
    """The `Spectral Matrix` group of this file, made or updated.

    Inputs: Color, and the matrix's rows as the vectors Row R, Row G, Row B (identity by default;
    negative entries are fine). Output: Color, unclamped.
    """
    return groups.ensure(
        groups.known(KIND, VERSION),
        KIND,
        VERSION,
        [("Color", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0)), *row_sockets()],
        [("Color", "NodeSocketColor", None)],
        _build,
    )


def row_sockets() -> list[groups.Socket]:
    """The three row inputs, identity by default, as every group with a matrix has them."""
    identity = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    return [(name, "NodeSocketVector", row) for name, row in zip(ROWS, identity, strict=True)]


def set_matrix(node: bpy.types.Node, matrix) -> None:
    """Write a (3, 3) row-major matrix into the row inputs of a group node."""
    for name, row in zip(ROWS, matrix, strict=True):
        node.inputs[name].default_value = tuple(float(entry) for entry in row)


def get_matrix(node: bpy.types.Node) -> list[list[float]]:
    """The (3, 3) row-major matrix in the row inputs of a group node."""
    return [list(node.inputs[name].default_value) for name in ROWS]


def _build(tree: bpy.types.NodeTree) -> None:
    given = groups.add(tree, "NodeGroupInput").outputs
    dots = [
        groups.add(
            tree, "ShaderNodeVectorMath", given["Color"], given[row], operation="DOT_PRODUCT"
        ).outputs["Value"]
        for row in ROWS
    ]
    colour = groups.add(tree, "ShaderNodeCombineColor", *dots, mode="RGB")
    groups.add(tree, "NodeGroupOutput", colour.outputs[0])
    groups.arrange(tree)
