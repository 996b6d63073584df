"""`Spectral Texture`: what a surface has of one texture: its matrix and vectors, at each pixel.

A texture's colour c weights three basis reflectances, so all that is linear in the reflectance is
the sum of three values, weighted by the channels of c. The values are sockets: one tree serves
every texture, and what nothing is linked to costs nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import bpy

from . import tree as groups

KIND = "Spectral Texture"
VERSION = 1
OUTPUTS = ("Row R", "Row G", "Row B", "Sun", "Ground", "Lamp 1", "Lamp 2")
CHANNELS = ("Red", "Green", "Blue")

Values = list[list[float]]


def ensure() -> bpy.types.NodeTree:
    """The `Spectral Texture` group of this file, made or updated.

    Inputs: Color [linear, the file's working space], and for each of `OUTPUTS` three vectors, as
    "Red Row R": what a colour has of it for each unit of its red. By default they show RGB times
    RGB. Outputs: `OUTPUTS`, to be linked to the inputs of a surface that have these names.
    """
    return groups.ensure(
        groups.known(KIND, VERSION),
        KIND,
        VERSION,
        [
            ("Color", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0)),
            *(
                (f"{channel} {name}", "NodeSocketVector", _default(name, k))
                for name in OUTPUTS
                for k, channel in enumerate(CHANNELS)
            ),
        ],
        [(name, "NodeSocketVector", None) for name in OUTPUTS],
        _build,
    )


def set_values(
    node: bpy.types.Node,
    values: Mapping[str, Iterable[Iterable[float]]],
    to_rec709: Iterable[Iterable[float]] | None = None,
) -> None:
    """Write the values of some of `OUTPUTS`; the others keep theirs.

    `values`: for each output three vectors, those of the three basis reflectances whose weights are
    linear Rec.709 red, green and blue. `to_rec709` (3, 3) takes colours of the working space to
    linear Rec.709 (None: that is the working space). Colours out of the Rec.709 gamut have
    negative weights, and are not clamped.
    """
    for name, basis in values.items():
        vectors = [list(vector) for vector in basis]
        if to_rec709 is not None:
            weights = [list(row) for row in to_rec709]
            vectors = [
                [sum(weights[j][k] * vectors[j][axis] for j in range(3)) for axis in range(3)]
                for k in range(3)
            ]
        for channel, vector in zip(CHANNELS, vectors, strict=True):
            node.inputs[f"{channel} {name}"].default_value = tuple(float(v) for v in vector)


def get_values(node: bpy.types.Node) -> dict[str, Values]:
    """The three vectors of each output, for the channels of the working space."""
    return {
        name: [list(node.inputs[f"{channel} {name}"].default_value) for channel in CHANNELS]
        for name in OUTPUTS
    }


def _default(name: str, channel: int) -> tuple[float, ...]:
    """RGB times RGB: a row has its own channel alone, at its place; a vector each channel."""
    if name.startswith("Row") and name[-1] != CHANNELS[channel][0]:
        return (0.0, 0.0, 0.0)
    return tuple(float(axis == channel) for axis in range(3))


def _build(tree: bpy.types.NodeTree) -> None:
    given = groups.add(tree, "NodeGroupInput").outputs
    weights = groups.add(tree, "ShaderNodeSeparateColor", given["Color"], mode="RGB").outputs
    sums = []
    for name in OUTPUTS:
        total = None
        for channel, weight in zip(CHANNELS, weights, strict=True):
            operation = "MULTIPLY" if total is None else "MULTIPLY_ADD"
            node = groups.add(
                tree,
                "ShaderNodeVectorMath",
                given[f"{channel} {name}"],
                weight,
                total,
                operation=operation,
            )
            total = node.outputs[0]
        sums.append(total)
    groups.add(tree, "NodeGroupOutput", *sums)
    groups.arrange(tree)
