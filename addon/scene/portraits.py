"""What pictures show of materials, out of the blend file alone."""

from __future__ import annotations

import math
from collections.abc import Hashable

import bpy

from ...node_groups import skylight_surface
from .. import tags
from ..pictures.portrait import Portrait, plain
from ..transfer.assignment import ESTIMATED
from .materials import rgb_comparison, spectral_material
from .world import hdri as worlds
from .world import light_group


def portrait(material: bpy.types.Material) -> Portrait | None:
    """The numbers of a material, None if it is not managed.

    Files of earlier versions hold neither the sky's spectrum nor what RGB times RGB has, before an
    update.
    """
    managed = spectral_material.managed(material)
    if managed is None or not managed.details.values:
        return None
    sky = light_group.record_of(managed.world)
    matrix, today = rgb_comparison.matrices(material, managed.matrix)
    return Portrait(
        name=managed.record.reflectance,
        reflectance=plain(managed.details.values),
        matrix=plain(matrix),
        spectrum=plain(sky.spectrum or None if sky else None),
        measured=plain(managed.details.measured),
        estimated=managed.record.reflectance == ESTIMATED,
        today=plain(today),
    )


def sky_key(world: bpy.types.World) -> tuple[Hashable, ...] | None:
    """All that the map of a World's sky depends on; an HDRI by its name and size.

    None for a World that must be baked and lights nothing yet: nobody has asked for that work.
    """
    sky = worlds.sky_of(world)
    surface = skylight_surface.find(world)
    described = None if surface is None else surface.get(tags.LIGHT)
    if sky.image is None and described is None:
        return None
    file = () if sky.image is None else (sky.image.filepath, tuple(sky.image.size))
    return world.session_uid, sky.name, file, world.get(tags.SETTINGS), described


def expected() -> list[tuple[str, float, float]]:
    """Of each managed material of the file its name and the expected CIEDE2000, the worst first.

    Of RGB × RGB and of its own model; NaN where nothing can be predicted.
    """
    found = ((m.name, spectral_material.managed(m)) for m in spectral_material.ours())
    rows = [
        (name, managed.details.result.rgb_delta_E, managed.details.result.matrix_delta_E)
        for name, managed in found
        if managed is not None and managed.details.result is not None
    ]
    return sorted(rows, key=lambda row: math.inf if math.isnan(row[1]) else -row[1])


def unsure() -> tuple[str, float] | None:
    """The managed material that a measurement is expected to change most, and its CIEDE2000.

    None where nothing is estimated, or nothing can be predicted.
    """
    found = ((m.name, spectral_material.managed(m)) for m in spectral_material.ours())
    rows = ((name, managed.details.result) for name, managed in found if managed is not None)
    known = [(row.measuring, name) for name, row in rows if row and row.measuring is not None]
    change, name = max(known, default=(0.0, ""))
    return (name, change) if known else None
