"""The shading normal, also where nothing is linked to a group's Normal input."""

from __future__ import annotations

import bpy

from . import tree as groups

# Turns a given normal by less than float32 can tell, while its square still is a normal float32.
EPSILON = 1e-7


def build(tree: bpy.types.NodeTree, normal: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """A unit vector: the given normal, or the shading normal where that input is unlinked.

    An unlinked Normal input of a group reads (0, 0, 0) in both engines, and a Bump node passes that
    on in Eevee 5.2. So a trace of the shading normal is added: alone, it is all that normalizing
    sees; beside a given normal it drowns.
    """
    shading = groups.add(tree, "ShaderNodeNewGeometry").outputs["Normal"]
    trace = groups.add(
        tree, "ShaderNodeVectorMath", shading, (EPSILON,) * 3, normal, operation="MULTIPLY_ADD"
    )
    unit = groups.add(tree, "ShaderNodeVectorMath", trace.outputs[0], operation="NORMALIZE")
    return unit.outputs[0]
