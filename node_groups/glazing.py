"""`Spectral Glazing`: a pane or a block of glass, tinted by what it lets through.

Its colour is that of daylight through it, which the caller computes from a measured transmittance.
The glass reflects all colours alike, by Fresnel's equations. What is left is tinted by Beer's law
in each channel: the longer the path through the glass, the deeper the tint. Nothing is refracted,
for a flat pane only shifts what is behind it.
"""

from __future__ import annotations

from functools import partial

import bpy

from . import fresnel, normals
from . import tree as groups
from .sockets import NORMAL, alpha
from .tree import Socket
from .value import combine_rgb, inputs

KIND = "Spectral Glazing"
VERSION = 1
LEAST = 1e-4  # of a transmittance: no power of 0

INPUTS = (
    Socket(
        "Transmittance",
        "Color",
        "Light that passes at normal incidence, as measured: all faces and reflections included",
        (0.9, 0.9, 0.9, 1.0),
    ),
    Socket("IOR", "Float", "Index of refraction of the glass", 1.52),
    Socket(
        "Faces",
        "Float",
        "1 where each face is a whole pane, 2 where two faces of a closed block make one pane",
        1.0,
    ),
    Socket("Roughness", "Float", "Roughness of the reflection", 0.0),
    NORMAL,
    alpha("glass"),
)
OUTPUTS = (Socket("Shader", "Shader", "Shader for both engines"),)


def ensure() -> bpy.types.NodeTree:
    """The `Spectral Glazing` group of this file, made or updated."""
    return groups.ensure(groups.known(KIND, VERSION), KIND, VERSION, INPUTS, OUTPUTS, _build)


def _build(tree: bpy.types.NodeTree) -> None:
    add = partial(groups.add, tree)
    given = inputs(tree)
    ior, faces = given["IOR"], given["Faces"]
    normal = normals.build(tree, given["Normal"])
    cos = fresnel.cosine(tree, normal)
    one_face, inside = fresnel.smooth(cos, ior)

    # (1 - F)/(1 + F) of a clear pane, which is all that its measured transmittance lacks there.
    passing = ior * 2.0 / ior.multiply_add(ior, 1.0)
    path = 1.0 / inside / faces
    tint = combine_rgb(
        *((channel / passing).maximum(LEAST) ** path for channel in given["Transmittance"].rgb())
    )

    # Both faces of a pane in one, 2F/(1 + F), or F for one face of a block.
    other = 2.0 - faces
    mirrored = one_face * (other + 1.0) / one_face.multiply_add(other, 1.0)
    through = add("ShaderNodeBsdfTransparent", tint).outputs[0]
    white = (1.0, 1.0, 1.0, 1.0)
    glossy = add("ShaderNodeBsdfGlossy", white, given["Roughness"], into={"Normal": normal})
    glass = add("ShaderNodeMixShader", mirrored, through, glossy.outputs[0])
    clear = add("ShaderNodeBsdfTransparent").outputs[0]
    shown = add("ShaderNodeMixShader", given["Alpha"], clear, glass.outputs[0])
    add("NodeGroupOutput", shown.outputs[0])
