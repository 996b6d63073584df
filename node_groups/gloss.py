"""What lies over the spectral base of a surface: `Spectral Gloss`, `Spectral Metal` and both mixed.

Gloss, coat and metal come from Principled BSDFs without a diffuse part, so they look as Blender's
do, but in Eevee gloss has Fresnel's reflectance in place of Schlick's. The base keeps what gloss
and coat leave, (1 - gloss)(1 - coat) as seen from the view, as Blender itself has it. Nothing here
is diffuse, for what lamps say to a Diffuse is said to the base alone. Three trees, for a second
Principled costs its closures even where its weight is 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import bpy

from . import fresnel, normals
from . import tree as groups
from .sockets import CYCLES, NORMAL, SHADER, alpha
from .tree import Socket
from .value import Value, inputs

GLOSS, METAL, MIXED = KINDS = ("Spectral Gloss", "Spectral Metal", "Spectral Gloss and Metal")
VERSION = 2
OUTPUTS = {"Shader": "Base", "Cycles": "Base Cycles"}
METAL_COLOURS = {"Metal Color": "Base Color", "Metal Edge": "Specular Tint"}
WHITE = (1.0, 1.0, 1.0, 1.0)

BASES = (
    Socket("Base", "Shader", "Spectral surface below, for Eevee"),
    Socket("Base Cycles", "Shader", "Spectral surface below, for Cycles"),
)
METALLIC = Socket("Metallic", "Float", "Share of the surface that is metal", 0.0)
COLORED = (
    Socket("Metal Color", "Color", "Color of the metal's reflection seen from the front", WHITE),
    Socket("Metal Edge", "Color", "Tint of the metal's reflection at 82° from the normal", WHITE),
)
# Inputs that are the Principled BSDF's own, with its names and values.
PRINCIPLED = (
    Socket("Roughness", "Float", "Roughness of the reflection", 0.5),
    Socket("IOR", "Float", "Index of refraction of the gloss", 1.5),
    Socket("Specular IOR Level", "Float", "Amount of gloss. 0.5 leaves what the IOR gives", 0.5),
    Socket("Specular Tint", "Color", "Tint of the gloss when seen from the front", WHITE),
    Socket("Anisotropic", "Float", "Stretch of highlights along the tangent", 0.0),
    Socket("Anisotropic Rotation", "Float", "Turn of that stretch. 1 is a full turn", 0.0),
    Socket("Coat Weight", "Float", "Share of the surface under a clear coat", 0.0),
    Socket("Coat Roughness", "Float", "Roughness of the coat", 0.03),
    Socket("Coat IOR", "Float", "Index of refraction of the coat", 1.5),
    Socket("Coat Tint", "Color", "Color that the coat gives to what is below it", WHITE),
    Socket("Emission Color", "Color", "Color of the light that the surface emits", WHITE),
    Socket("Emission Strength", "Float", "Strength of the light that the surface emits", 0.0),
)
COAT_NORMAL = Socket(
    "Coat Normal",
    "Vector",
    "Unit normal of the coat in world space. If not connected, the shading normal is used",
)


def ensure(kind: str) -> bpy.types.NodeTree:
    """The group of this file that is one of `KINDS`, made or updated.

    Its inputs are those that the kind has of `BASES`, `METALLIC` and `COLORED`, then
    `PRINCIPLED`, Normal, Coat Normal and Alpha.
    """
    own: list[Socket] = []
    if kind != METAL:
        own += BASES
    if kind == MIXED:
        own += [METALLIC]
    if kind != GLOSS:
        own += COLORED
    return groups.ensure(
        groups.known(kind, VERSION),
        kind,
        VERSION,
        [*own, *PRINCIPLED, NORMAL, COAT_NORMAL, alpha("surface")],
        (SHADER, CYCLES),
        partial(_build, kind=kind),
    )


def _build(tree: bpy.types.NodeTree, kind: str) -> None:
    add = partial(groups.add, tree)
    given = inputs(tree)
    normal = normals.build(tree, given["Normal"])
    coat_normal = normals.build(tree, given["Coat Normal"])
    clear = add("ShaderNodeBsdfTransparent").outputs[0]

    def principled(
        metallic: float, colours: Mapping[str, str], **other: Value
    ) -> bpy.types.NodeSocket:
        shared = {socket.name: socket.name for socket in PRINCIPLED}
        fed = {name: given[source] for source, name in {**shared, **colours}.items()}
        fed |= {"Normal": normal, "Coat Normal": coat_normal, **other}
        black = (0.0, 0.0, 0.0, 1.0)
        return add("ShaderNodeBsdfPrincipled", black, metallic, into=fed).outputs[0]

    share = metal = None
    glosses: dict[str, bpy.types.NodeSocket] = {}
    if kind != METAL:
        level = given["Specular IOR Level"]
        cos = fresnel.cosine(tree, normal)
        exact = fresnel.over_schlick(cos, given["IOR"], level)
        eevee = {"Specular IOR Level": level * exact}
        glosses = {"Base": principled(0.0, {}, **eevee), "Base Cycles": principled(0.0, {})}
        share = _share_left(tree, given, normal, coat_normal)
    if kind != GLOSS:
        metal = principled(1.0, METAL_COLOURS)
    whole = []
    for base in OUTPUTS.values():
        shader = metal
        if glosses:
            left = add("ShaderNodeMixShader", share, None, given[base]).outputs[0]
            shader = add("ShaderNodeAddShader", left, glosses[base]).outputs[0]
            if metal is not None:
                mix = add("ShaderNodeMixShader", given["Metallic"], shader, metal)
                shader = mix.outputs[0]
        whole.append(add("ShaderNodeMixShader", given["Alpha"], clear, shader).outputs[0])
    add("NodeGroupOutput", *whole)


def _share_left(
    tree: bpy.types.NodeTree, given: Mapping[str, Value], normal: Value, coat_normal: Value
) -> Value:
    """What gloss and coat leave of the base."""
    gloss = fresnel.share_reflected(
        fresnel.cosine(tree, normal), given["Roughness"], given["IOR"], given["Specular IOR Level"]
    )
    coat = fresnel.share_reflected(
        fresnel.cosine(tree, coat_normal), given["Coat Roughness"], given["Coat IOR"]
    )
    return (1.0 - coat * given["Coat Weight"]) * (1.0 - gloss)
