"""How much a dielectric surface reflects, as nodes: what is left of the light for its base."""

from __future__ import annotations

from functools import partial
from typing import Any

from bpy.types import NodeSocket as Socket
from bpy.types import NodeTree

from . import tree as groups


def math(tree: NodeTree, operation: str, *sources: Any, **settings: Any) -> Socket:
    """The output of a new Math node."""
    return groups.add(tree, "ShaderNodeMath", *sources, operation=operation, **settings).outputs[0]


def cosine(tree: NodeTree, normal: Socket) -> Socket:
    """The cosine between the view and a unit normal, 0 to 1; the same on both sides of a face."""
    view = groups.add(tree, "ShaderNodeNewGeometry").outputs["Incoming"]
    dot = groups.add(tree, "ShaderNodeVectorMath", view, normal, operation="DOT_PRODUCT")
    return math(tree, "ABSOLUTE", dot.outputs["Value"])


def share_reflected(
    tree: NodeTree, cos: Socket, roughness: Socket, ior: Socket, level: Any = 0.5
) -> Socket:
    """What a rough dielectric reflects of an even light, as the Principled BSDF does it.

    Schlick's curve, its peak lower and broader with roughness: F0 (1 - 0.55 r²)
    + (1 - F0) min(1, 7.4 √F0) exp(-4.4 r^1.45) (1 - cos)^(4.95 - 4.15 r), with F0 twice `level`
    times ((ior - 1)/(ior + 1))². Fitted to renders of a black Principled under a white World at
    IOR 1.1 to 2.5, in both engines, which differ from one another by 0.007 on average and 0.04 at
    worst (IOR 1.5): the fit is off by 0.008 and 0.05.
    """
    op = partial(math, tree)
    root = op("ABSOLUTE", op("DIVIDE", op("SUBTRACT", ior, 1.0), op("ADD", ior, 1.0)))
    if level != 0.5:
        root = op("MULTIPLY", root, op("SQRT", op("MULTIPLY", level, 2.0)))
    F0 = op("MULTIPLY", root, root)
    grazing = op("MULTIPLY", op("SUBTRACT", 1.0, F0), op("MINIMUM", op("MULTIPLY", root, 7.4), 1.0))
    dimmed = op("EXPONENT", op("MULTIPLY", op("POWER", roughness, 1.45), -4.4))
    slope = op("POWER", op("SUBTRACT", 1.0, cos), op("MULTIPLY_ADD", roughness, -4.15, 4.95))
    peak = op("MULTIPLY", op("MULTIPLY", grazing, dimmed), slope)
    facing = op("MULTIPLY_ADD", op("MULTIPLY", roughness, roughness), -0.55, 1.0)
    return op("MULTIPLY_ADD", F0, facing, peak, use_clamp=True)


def smooth(tree: NodeTree, cos: Socket, ior: Socket) -> tuple[Socket, Socket]:
    """The exact reflectance of a smooth dielectric for unpolarized light, and cos of refraction.

    From outside the dielectric only, whichever side is seen: Blender's Fresnel node takes a
    pane's back for the inside of a block.
    """
    op = partial(math, tree)
    square = op("MULTIPLY_ADD", cos, cos, -1.0)  # -sin²
    g = op("SQRT", op("MULTIPLY_ADD", ior, ior, square))  # n cos of refraction
    inside = op("DIVIDE", g, ior)
    s = op("DIVIDE", op("SUBTRACT", cos, g), op("ADD", cos, g))
    n_cos = op("MULTIPLY", ior, cos)
    p = op("DIVIDE", op("SUBTRACT", n_cos, inside), op("ADD", n_cos, inside))
    both = op("MULTIPLY_ADD", s, s, op("MULTIPLY", p, p))
    return op("MULTIPLY", both, 0.5), inside
