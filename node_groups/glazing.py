"""`Spectral Glazing`: a pane or a block of glass, tinted by what it lets through.

Its colour is that of daylight through it, which the caller computes from a measured transmittance.
The glass itself reflects neutrally, by Fresnel's equations; what is left is tinted, at a slant as
deeply as the way through it is longer (Beer's law for each channel). Nothing is refracted: a flat
pane only shifts what is behind it.
"""

from __future__ import annotations

from functools import partial

import bpy

from . import fresnel, normals
from . import tree as groups

KIND = "Spectral Glazing"
VERSION = 1
LEAST = 1e-4  # of a transmittance: no power of 0


def ensure() -> bpy.types.NodeTree:
    """The `Spectral Glazing` group of this file, made or updated.

    Inputs: Transmittance (RGB at normal incidence, all faces and reflections included, as it is
    measured), IOR, Faces (1: a face is the whole pane; 2: a closed block, each face half of it),
    Roughness of what is mirrored, Normal (world space; unlinked: the shading normal), Alpha (0: no
    glass at all). Output: Shader.
    """
    return groups.ensure(
        groups.known(KIND, VERSION),
        KIND,
        VERSION,
        [
            ("Transmittance", "NodeSocketColor", (0.9, 0.9, 0.9, 1.0)),
            ("IOR", "NodeSocketFloat", 1.52),
            ("Faces", "NodeSocketFloat", 1.0),
            ("Roughness", "NodeSocketFloat", 0.0),
            ("Normal", "NodeSocketVector", None),
            ("Alpha", "NodeSocketFloat", 1.0),
        ],
        [("Shader", "NodeSocketShader", None)],
        _build,
    )


def _build(tree: bpy.types.NodeTree) -> None:
    add, op = partial(groups.add, tree), partial(fresnel.math, tree)
    given = add("NodeGroupInput").outputs
    normal = normals.build(tree, given["Normal"])
    cos = fresnel.cosine(tree, normal)
    one_face, inside = fresnel.smooth(tree, cos, given["IOR"])

    # (1 - F)/(1 + F) of a clear pane, which is all that its measured transmittance lacks there.
    passing = op(
        "DIVIDE",
        op("MULTIPLY", given["IOR"], 2.0),
        op("MULTIPLY_ADD", given["IOR"], given["IOR"], 1.0),
    )
    way = op("DIVIDE", op("DIVIDE", 1.0, inside), given["Faces"])
    tints = []
    for channel in add("ShaderNodeSeparateColor", given["Transmittance"], mode="RGB").outputs:
        glass = op("MAXIMUM", op("DIVIDE", channel, passing), LEAST)
        tints.append(op("POWER", glass, way))
    tint = add("ShaderNodeCombineColor", *tints, mode="RGB").outputs[0]

    # Both faces of a pane in one, 2F/(1 + F), or F for one face of a block.
    other = op("SUBTRACT", 2.0, given["Faces"])
    mirrored = op(
        "DIVIDE",
        op("MULTIPLY", one_face, op("ADD", other, 1.0)),
        op("MULTIPLY_ADD", one_face, other, 1.0),
    )
    through = add("ShaderNodeBsdfTransparent", tint).outputs[0]
    glossy = add("ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0, 1.0), given["Roughness"])
    tree.links.new(normal, glossy.inputs["Normal"])
    glass = add("ShaderNodeMixShader", mirrored, through, glossy.outputs[0])
    clear = add("ShaderNodeBsdfTransparent").outputs[0]
    shown = add("ShaderNodeMixShader", given["Alpha"], clear, glass.outputs[0])
    add("NodeGroupOutput", shown.outputs[0])
    groups.arrange(tree)
