"""How much a dielectric surface reflects, as nodes: what is left of the light for its base."""

from __future__ import annotations

from bpy.types import NodeTree

from . import tree as groups
from .value import Value


def cosine(tree: NodeTree, normal: Value) -> Value:
    """The cosine between the view and a unit normal, 0 to 1; the same on both sides of a face."""
    view = Value(groups.add(tree, "ShaderNodeNewGeometry").outputs["Incoming"])
    return abs(view.dot(normal))


def share_reflected(cos: Value, roughness: Value, ior: Value, level: Value | None = None) -> Value:
    """What a rough dielectric reflects of an even light, as the Principled BSDF does it.

    Schlick's curve, its peak lower and broader with roughness: F0 (1 - 0.55 r²)
    + (1 - F0) min(1, 7.4 √F0) exp(-4.4 r^1.45) (1 - cos)^(4.95 - 4.15 r), with F0 twice `level`
    (None: 0.5) times ((ior - 1)/(ior + 1))². Fitted to renders of a black Principled under a white
    World at IOR 1.1 to 2.5, in both engines, which differ from one another by 0.007 on average and
    0.04 at worst (IOR 1.5): the fit is off by 0.008 and 0.05.
    """
    root = abs((ior - 1.0) / (ior + 1.0))
    if level is not None:
        root = root * (level * 2.0).sqrt()
    F0 = root * root
    grazing = (1.0 - F0) * (root * 7.4).minimum(1.0)
    dimmed = (roughness**1.45 * -4.4).exp()
    slope = (1.0 - cos) ** roughness.multiply_add(-4.15, 4.95)
    peak = grazing * dimmed * slope
    facing = (roughness * roughness).multiply_add(-0.55, 1.0)
    return F0.multiply_add(facing, peak).clamp()


def over_schlick(cos: Value, ior: Value, level: Value) -> Value:
    """By what a reflectance at normal incidence must grow for Schlick's curve to give Fresnel's.

    F0' = (F - (1 - cos)^5) / (1 - (1 - cos)^5), by F0; 1 to 2. Schlick's curve, which Eevee has,
    lacks a quarter of what glass reflects at 55 degrees; what it has too much beyond 75 degrees is
    less than roughness takes there. F is that of the index which `level` gives.
    """
    root = ((ior - 1.0) / (ior + 1.0) * (level * 2.0).sqrt()).maximum(1e-3).minimum(0.9)
    grazing = (1.0 - cos) ** 5.0
    exact, _ = smooth(cos, (root + 1.0) / (1.0 - root))
    needed = (exact - grazing) / (1.0 - grazing).maximum(1e-3)
    return (needed / (root * root)).maximum(1.0).minimum(2.0)


def smooth(cos: Value, ior: Value) -> tuple[Value, Value]:
    """The exact reflectance of a smooth dielectric for unpolarized light, and cos of refraction.

    From outside the dielectric only, whichever side is seen: Blender's Fresnel node takes a
    pane's back for the inside of a block.
    """
    g = ior.multiply_add(ior, cos.multiply_add(cos, -1.0)).sqrt()  # n cos of refraction: n² - sin²
    inside = g / ior
    s = (cos - g) / (cos + g)
    n_cos = ior * cos
    p = (n_cos - inside) / (n_cos + inside)
    return s.multiply_add(s, p * p) * 0.5, inside
