"""Sockets that several groups have in common."""

from __future__ import annotations

from .tree import Socket

NORMAL = Socket(
    "Normal", "Vector", "Unit normal in world space. If not connected, the shading normal is used"
)
ROTATION = Socket(
    "Rotation", "Vector", "XYZ Euler angles in radians, as in the Mapping node of the World"
)
STRENGTH = Socket(
    "Strength", "Float", "Factor on the light, as in the Background node of the World", 1.0
)
SHADER = Socket("Shader", "Shader", "Shader for a Material Output whose target is All or Eevee")
CYCLES = Socket("Cycles", "Shader", "Shader for a Material Output whose target is Cycles")


def alpha(what: str) -> Socket:
    """The opacity of a surface."""
    return Socket("Alpha", "Float", f"Opacity of the {what}. At 0 only what is behind is seen", 1.0)
