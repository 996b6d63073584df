"""What lies over the spectral base of a surface: `Spectral Gloss`, `Spectral Metal` and both mixed.

Gloss, coat and metal come from Principled BSDFs without a diffuse part, so they look as Blender's
do; the base keeps what gloss and coat leave, (1 - gloss)(1 - coat) as seen from the view, as
Blender itself has it. Nothing here is diffuse, for what lamps say to a Diffuse is said to the base
alone. Three trees, for a second Principled costs its closures even where its weight is 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import bpy

from . import fresnel, normals
from . import tree as groups

GLOSS, METAL, MIXED = KINDS = ("Spectral Gloss", "Spectral Metal", "Spectral Gloss and Metal")
VERSION = 1
OUTPUTS = {"Shader": "Base", "Cycles": "Base Cycles"}
METAL_COLOURS = {"Metal Color": "Base Color", "Metal Edge": "Specular Tint"}

# Inputs that are the Principled BSDF's own, with its names and values.
SHARED: tuple[groups.Socket, ...] = (
    ("Roughness", "NodeSocketFloat", 0.5),
    ("IOR", "NodeSocketFloat", 1.5),
    ("Specular IOR Level", "NodeSocketFloat", 0.5),
    ("Specular Tint", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0)),
    ("Anisotropic", "NodeSocketFloat", 0.0),
    ("Anisotropic Rotation", "NodeSocketFloat", 0.0),
    ("Coat Weight", "NodeSocketFloat", 0.0),
    ("Coat Roughness", "NodeSocketFloat", 0.03),
    ("Coat IOR", "NodeSocketFloat", 1.5),
    ("Coat Tint", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0)),
    ("Emission Color", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0)),
    ("Emission Strength", "NodeSocketFloat", 0.0),
)


def ensure(kind: str) -> bpy.types.NodeTree:
    """The group of this file that is one of `KINDS`, made or updated.

    Inputs: Base and Base Cycles (the surface's shaders; metal alone shows none), those of the
    Principled BSDF (`SHARED`), Normal and Coat Normal (world space; unlinked: the shading normal)
    and Alpha, over all. Metals have Metal Color (reflected where faced) and Metal Edge (the tint
    at 82°, as Blender's F82 has it), the mix has Metallic, 0 to 1. Outputs: Shader, and Cycles
    with the other base.
    """
    inputs: list[groups.Socket] = []
    if kind != METAL:
        inputs += [(base, "NodeSocketShader", None) for base in OUTPUTS.values()]
    if kind == MIXED:
        inputs += [("Metallic", "NodeSocketFloat", 0.0)]
    if kind != GLOSS:
        inputs += [(name, "NodeSocketColor", (1.0, 1.0, 1.0, 1.0)) for name in METAL_COLOURS]
    return groups.ensure(
        groups.known(kind, VERSION),
        kind,
        VERSION,
        [
            *inputs,
            *SHARED,
            ("Normal", "NodeSocketVector", None),
            ("Coat Normal", "NodeSocketVector", None),
            ("Alpha", "NodeSocketFloat", 1.0),
        ],
        [(name, "NodeSocketShader", None) for name in OUTPUTS],
        partial(_build, kind=kind),
    )


def _build(tree: bpy.types.NodeTree, kind: str) -> None:
    add = partial(groups.add, tree)
    given = add("NodeGroupInput").outputs
    normal = normals.build(tree, given["Normal"])
    coat_normal = normals.build(tree, given["Coat Normal"])
    clear = add("ShaderNodeBsdfTransparent").outputs[0]

    def principled(colours: Mapping[str, str], metallic: float) -> bpy.types.NodeSocket:
        node = add("ShaderNodeBsdfPrincipled")
        node.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
        node.inputs["Metallic"].default_value = metallic
        shared = {name: name for name, _, _ in SHARED}
        for source, name in {**shared, **colours}.items():
            tree.links.new(given[source], node.inputs[name])
        tree.links.new(normal, node.inputs["Normal"])
        tree.links.new(coat_normal, node.inputs["Coat Normal"])
        return node.outputs[0]

    gloss = share = metal = None
    if kind != METAL:
        gloss = principled({}, 0.0)
        share = _share_left(tree, given, normal, coat_normal)
    if kind != GLOSS:
        metal = principled(METAL_COLOURS, 1.0)
    whole = []
    for base in OUTPUTS.values():
        shader = metal
        if gloss is not None:
            left = add("ShaderNodeMixShader", share, None, given[base]).outputs[0]
            shader = add("ShaderNodeAddShader", left, gloss).outputs[0]
            if metal is not None:
                mix = add("ShaderNodeMixShader", given["Metallic"], shader, metal)
                shader = mix.outputs[0]
        whole.append(add("ShaderNodeMixShader", given["Alpha"], clear, shader).outputs[0])
    add("NodeGroupOutput", *whole)
    groups.arrange(tree)


def _share_left(tree: bpy.types.NodeTree, given, normal, coat_normal) -> bpy.types.NodeSocket:
    """What gloss and coat leave of the base."""
    op = partial(fresnel.math, tree)
    gloss = fresnel.share_reflected(
        tree,
        fresnel.cosine(tree, normal),
        given["Roughness"],
        given["IOR"],
        given["Specular IOR Level"],
    )
    coat = fresnel.share_reflected(
        tree, fresnel.cosine(tree, coat_normal), given["Coat Roughness"], given["Coat IOR"]
    )
    below = op("SUBTRACT", 1.0, op("MULTIPLY", coat, given["Coat Weight"]))
    return op("MULTIPLY", below, op("SUBTRACT", 1.0, gloss))
