"""What lies under the mouse in the 3D view."""

from __future__ import annotations

import bpy
from bpy_extras import view3d_utils


def under_mouse(
    context: bpy.types.Context, x: float, y: float
) -> tuple[bpy.types.Object, int] | None:
    """Return the object at a place in the view's region [pixels], and the slot of its material.

    None where nothing is, or where there is no view.
    """
    region, view = context.region, context.region_data
    if region is None or view is None:
        return None
    origin = view3d_utils.region_2d_to_origin_3d(region, view, (x, y))
    direction = view3d_utils.region_2d_to_vector_3d(region, view, (x, y))
    return along(context, origin, direction)


def along(context: bpy.types.Context, origin, direction) -> tuple[bpy.types.Object, int] | None:
    """Return the first object on a ray, and the slot of the material there; None without."""
    depsgraph = context.evaluated_depsgraph_get()
    hit, _, _, face, found, _ = context.scene.ray_cast(depsgraph, origin, direction)
    if not hit or found is None:
        return None
    shown = found.evaluated_get(depsgraph).data
    faces = getattr(shown, "polygons", ())  # a curve has none: its first slot is meant
    slot = faces[face].material_index if 0 <= face < len(faces) else 0
    return found.original, min(slot, max(len(found.material_slots) - 1, 0))


def material_in(obj: bpy.types.Object, slot: int, name: str) -> bpy.types.Material:
    """Return the material in an object's slot; where there is none, a new one of this name."""
    if slot < len(obj.material_slots) and obj.material_slots[slot].material is not None:
        return obj.material_slots[slot].material
    made = bpy.data.materials.new(name)
    if slot < len(obj.material_slots):
        obj.material_slots[slot].material = made
    else:
        obj.data.materials.append(made)
    return made
