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

KIND = "Light Probe"
VERSION = 1
STRENGTH = 1e5  # the World and all other lamps count 1e-5 beside it
CYCLES_STRENGTH = 1e3  # Cycles drops a closure of less than 1e-5: even black reflects more
SUN, GREEN, BLUE = "Sun", "Sky in Green", "Sky in Blue"  # nodes that hold a colour of one World


def ensure(tree: bpy.types.NodeTree | None = None) -> bpy.types.NodeTree:
    """A `Light Probe` group: the given one, updated, its colours kept; or a new one.

    Inputs: Normal (world space; unlinked: the shading normal) and Strength, the World's. Outputs,
    as irradiance/π: Sun and Sky (RGB, the sky that a dome of lamps holds), Lamp 1 and Lamp 2; and
    Sun Color, what the sun gives a face that looks at it, which Cycles knows too.
    """
    kept = {} if tree is None else {name: colour(tree, name) for name in (SUN, GREEN, BLUE)}
    tree = groups.ensure(
        tree,
        KIND,
        VERSION,
        [("Normal", "NodeSocketVector", None), ("Strength", "NodeSocketFloat", 1.0)],
        [
            ("Sun", "NodeSocketVector", None),
            ("Lamp 1", "NodeSocketFloat", None),
            ("Lamp 2", "NodeSocketFloat", None),
            ("Sky", "NodeSocketVector", None),
            ("Sun Color", "NodeSocketVector", None),
        ],
        _build,
    )
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
    given = add("NodeGroupInput").outputs
    normal = normals.build(tree, given["Normal"])
    white = add("ShaderNodeBsdfDiffuse", (1.0, 1.0, 1.0, 1.0), 0.0)
    tree.links.new(normal, white.inputs["Normal"])
    seen = add("ShaderNodeShaderToRGB", white.outputs[0])
    red, green, blue = add("ShaderNodeSeparateColor", seen.outputs["Color"], mode="RGB").outputs

    def times(number, factor):
        return add("ShaderNodeMath", number, factor, operation="MULTIPLY").outputs[0]

    def lit(name, number):
        node = add("ShaderNodeVectorMath", operation="SCALE", name=name, label=name)
        tree.links.new(number, node.inputs["Scale"])
        return node.outputs[0]

    # The sun's lamp is of strength 1 and its colour an irradiance/π: 1/π of 1 is seen of it.
    sun_colour = lit(SUN, given["Strength"])
    sun = add("ShaderNodeVectorMath", sun_colour, operation="SCALE")
    tree.links.new(times(red, math.pi / STRENGTH), sun.inputs["Scale"])
    lamps = [times(channel, 1.0 / STRENGTH) for channel in (green, blue)]
    dome = [
        lit(name, times(number, given["Strength"]))
        for name, number in zip((GREEN, BLUE), lamps, strict=True)
    ]
    sky = add("ShaderNodeVectorMath", *dome, operation="ADD")
    add("NodeGroupOutput", sun.outputs[0], *lamps, sky.outputs[0], sun_colour)
    groups.arrange(tree)
