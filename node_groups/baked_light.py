"""`Baked Light`: what all light, but sun and lamps as they shine, makes of a vertex's material.

A bake has multiplied spectra out on the processor and left a colour on each corner of a mesh: sky
and ground where they are seen, and whatever has bounced. It is read here, of the side that is seen.
Another light, or another place, changes the bake; until then the last one stays.

    skylight_light         RGB for a World of strength 1, and 2 where there is a bake
    skylight_light_behind  the same of the backs of faces, on meshes that have any
"""

from __future__ import annotations

from functools import partial

import bpy

from . import tree as groups
from .sockets import STRENGTH
from .tree import Socket
from .value import Value, inputs, outputs

KIND = "Baked Light"
VERSION = 1
LIGHT = "skylight_light"
BEHIND = "skylight_light_behind"
FLAG = 2.0
"""What alpha holds where there is a bake: a missing attribute reads 0 with alpha 1."""

INPUTS = (STRENGTH,)
OUTPUTS = (
    Socket("Light", "Vector", "RGB that all light but sun and lamps makes of the material"),
    Socket("Baked", "Float", "1 where the light is baked on the side that is seen, else 0"),
)


def ensure(tree: bpy.types.NodeTree | None = None) -> bpy.types.NodeTree:
    """A `Baked Light` group: the given one, updated, or a new one."""
    return groups.ensure(tree, KIND, VERSION, INPUTS, OUTPUTS, _build)


def _build(tree: bpy.types.NodeTree) -> None:
    add = partial(groups.add, tree)
    given = inputs(tree)
    behind = Value(add("ShaderNodeNewGeometry").outputs["Backfacing"])

    def read(name: str) -> tuple[Value, Value]:
        attribute = add("ShaderNodeAttribute", attribute_name=name, attribute_type="GEOMETRY")
        parts = outputs(attribute)
        return parts["Vector"], parts["Alpha"].greater_than(1.5)

    def choice(kind: str, front: Value, back: Value) -> Value:
        node = add("ShaderNodeMix", behind, front, back, data_type=kind, clamp_factor=True)
        return Value(next(socket for socket in node.outputs if socket.enabled))

    (front, there), (back, there_behind) = read(LIGHT), read(BEHIND)
    light = choice("VECTOR", front, back) * given["Strength"]
    add("NodeGroupOutput", light, choice("FLOAT", there, there_behind))
