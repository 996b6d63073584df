"""Drivers that work in a file without the add-on: one value of another datablock, on a line."""

from __future__ import annotations

import bpy


def drive(
    owner: bpy.types.bpy_struct,
    path: str,
    source: bpy.types.ID,
    source_path: str,
    axis: int = -1,
    factor: float = 1.0,
    offset: float = 0.0,
) -> None:
    """Let a property, or one axis of it, be the offset plus the factor times a source's value."""
    owner.driver_remove(path, axis)
    curve = owner.driver_add(path, axis)
    curve.driver.type = "AVERAGE"  # of one value: no expression that Blender might refuse to run
    target = curve.driver.variables.new().targets[0]
    target.id_type = source.id_type
    target.id = source
    target.data_path = source_path
    if (factor, offset) == (1.0, 0.0):
        return
    for modifier in list(curve.modifiers):
        curve.modifiers.remove(modifier)
    line = curve.modifiers.new("GENERATOR")
    line.poly_order = 1
    line.coefficients = (offset, factor)
