"""`Spectral Texture`: what a surface has of one texture: its matrix and vectors, at each pixel.

A texture's colour c weights three basis reflectances, so all that is linear in the reflectance is
the sum of three values, weighted by the channels of c. The values are sockets: one tree serves
every texture, and what nothing is linked to costs nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import bpy

from . import tree as groups
from .tree import Socket
from .value import inputs, vector_math

KIND = "Spectral Texture"
VERSION = 2
LIGHTS = {
    "Sun": "sunlight",
    "Ground": "light from the ground",
    "Lamp 1": "light of the first kind of lamps",
    "Lamp 2": "light of the second kind of lamps",
}
ROWS = {"Row R": "First", "Row G": "Second", "Row B": "Third"}
TINT = "Tint"
OUTPUTS = (*ROWS, *LIGHTS, TINT)
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
            Socket(
                "Color",
                "Color",
                "Color of the texture, linear and in the working space of the file",
                (1.0, 1.0, 1.0, 1.0),
            ),
            *(
                Socket(
                    f"{channel} {name}",
                    "Vector",
                    f"{_meaning(name)}, for each unit of the color's {channel.lower()}",
                    _default(name, k),
                )
                for name in OUTPUTS
                for k, channel in enumerate(CHANNELS)
            ),
        ],
        [Socket(name, "Vector", f"{_meaning(name)} at this point") for name in OUTPUTS],
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


def _meaning(name: str) -> str:
    if name == TINT:
        return "RGB that baked light is multiplied by"
    if name in ROWS:
        return f"{ROWS[name]} row of the matrix for skylight"
    return f"RGB reflected of {LIGHTS[name]}"


def _default(name: str, channel: int) -> tuple[float, ...]:
    """RGB times RGB: a row has its own channel alone, at its place; a vector each channel."""
    if name in ROWS and name[-1] != CHANNELS[channel][0]:
        return (0.0, 0.0, 0.0)
    return tuple(float(axis == channel) for axis in range(3))


def _build(tree: bpy.types.NodeTree) -> None:
    given = inputs(tree)
    weights = dict(zip(CHANNELS, given["Color"].rgb(), strict=True))
    sums = []
    for name in OUTPUTS:
        red, green, blue = (given[f"{channel} {name}"] for channel in CHANNELS)
        total = vector_math(tree, "MULTIPLY", red, weights["Red"])
        total = green.multiply_add(weights["Green"], total)
        sums.append(blue.multiply_add(weights["Blue"], total))
    groups.add(tree, "NodeGroupOutput", *sums)
