"""`Light Probe`: how much of the sun, of lamps or of a dome of lamps reaches a point in Eevee.

A white Diffuse through Shader to RGB returns all light that Eevee has for a point, shadows and all:
the World's too, and every lamp's. Lamps of `STRENGTH` times the strength, which light nothing but
managed objects (light linking), drown the rest. Its three channels are three probes that know
nothing of one another: red is the sun, green and blue are two kinds of lamps, or the two numbers
that a live dome of lamps holds of the sky. Light of a known spectrum needs no more than one number:
what a material makes of it is computed before. Black in Cycles, which knows no Shader to RGB.
"""

from __future__ import annotations

import math
from functools import partial

import bpy

from . import normals
from . import tree as groups
from .sockets import NORMAL
from .sockets import STRENGTH as WORLD_STRENGTH
from .tree import Socket
from .value import Value, inputs, vector_math

KIND = "Light Probe"
VERSION = 1
STRENGTH = 1e5  # the World and all other lamps count 1e-5 beside it
CYCLES_STRENGTH = 1e3  # Cycles drops a closure of less than 1e-5: even black reflects more
SUN, GREEN, BLUE = "Sun", "Sky in Green", "Sky in Blue"  # nodes that hold a colour of one World

INPUTS = (NORMAL, WORLD_STRENGTH)
OUTPUTS = (
    Socket("Sun", "Vector", "Sunlight that arrives: RGB irradiance divided by π"),
    Socket("Lamp 1", "Float", "Light of the first kind of lamps, in units of their spectrum"),
    Socket("Lamp 2", "Float", "Light of the second kind of lamps, in units of their spectrum"),
    Socket("Sky", "Vector", "Skylight of a dome of lamps: RGB irradiance divided by π"),
    Socket("Sun Color", "Vector", "Sunlight on a face that looks at the sun, without shadows"),
)


def ensure(tree: bpy.types.NodeTree | None = None) -> bpy.types.NodeTree:
    """A `Light Probe` group: the given one, updated, its colours kept; or a new one."""
    kept = {} if tree is None else {name: colour(tree, name) for name in (SUN, GREEN, BLUE)}
    tree = groups.ensure(tree, KIND, VERSION, INPUTS, OUTPUTS, _build)
    for name, rgb in kept.items():
        set_colour(tree, name, rgb)
    return tree


def colour(tree: bpy.types.NodeTree, name: str) -> tuple[float, float, float]:
    """The RGB that `SUN` gives a face that looks at it [irradiance/π], or of the dome's numbers."""
    return tuple(tree.nodes[name].inputs[0].default_value)


def set_colour(tree: bpy.types.NodeTree, name: str, rgb) -> None:
    """Write the RGB of `SUN`, `GREEN` or `BLUE`."""
    tree.nodes[name].inputs[0].default_value = tuple(float(part) for part in rgb)


def _build(tree: bpy.types.NodeTree) -> None:
    add = partial(groups.add, tree)
    given = inputs(tree)
    normal = normals.build(tree, given["Normal"])
    white = add("ShaderNodeBsdfDiffuse", (1.0, 1.0, 1.0, 1.0), 0.0, into={"Normal": normal})
    seen = Value(add("ShaderNodeShaderToRGB", white.outputs[0]).outputs["Color"])
    red, green, blue = seen.rgb()

    def lit(name: str, number: Value) -> Value:
        """The colour that lies here, times a number."""
        return vector_math(tree, "SCALE", None, number, name=name, label=name)

    # The sun's lamp is of strength 1 and its colour an irradiance/π: 1/π of 1 is seen of it.
    sun_colour = lit(SUN, given["Strength"])
    sun = sun_colour * (red * (math.pi / STRENGTH))
    lamps = [channel * (1.0 / STRENGTH) for channel in (green, blue)]
    in_green, in_blue = (
        lit(name, lamp * given["Strength"]) for name, lamp in zip((GREEN, BLUE), lamps, strict=True)
    )
    add("NodeGroupOutput", sun, *lamps, in_green + in_blue, sun_colour)
