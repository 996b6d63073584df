"""The shading normal, also where nothing is linked to a group's Normal input."""

from __future__ import annotations

import bpy

from . import tree as groups
from .value import Value

# Turns a given normal by less than float32 can tell, while its square still is a normal float32.
EPSILON = 1e-7


def build(tree: bpy.types.NodeTree, normal: Value) -> Value:
    """A unit vector: the given normal, or the shading normal where that input is unlinked.

    An unlinked Normal input of a group reads (0, 0, 0) in both engines, and a Bump node passes that
    on in Eevee 5.2. So a trace of the shading normal is added: alone, it is all that normalizing
    sees; beside a given normal it drowns.
    """
    shading = Value(groups.add(tree, "ShaderNodeNewGeometry").outputs["Normal"])
    return shading.multiply_add((EPSILON,) * 3, normal).normalize()
