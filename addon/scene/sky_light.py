"""The light of one World's sky in its node groups: coefficients, and what follows the World.

Eevee's `World.sun_threshold`, which pulls a sun lamp out of the HDRI, is left alone: it
lights unmanaged objects only, for managed ones emit.
"""

from __future__ import annotations

import json
import math
from typing import Any

import bpy
import numpy as np

from ...node_groups import sky_irradiance, skylight_surface, spectral_matrix
from ...node_groups import tree as groups
from . import world as worlds

DESCRIPTION = "spectral_skylight_description"  # JSON, for custom properties hold no nested lists


def ensure(world: bpy.types.World) -> bpy.types.NodeTree:
    """The `Skylight Surface` group of a World, made or updated, following its turn and strength.

    It follows by drivers, so keyframes work in a file without the add-on. A renamed Mapping or
    Background node is followed again from the next call on. Raises InputError where
    `world.sky_of` does.
    """
    sky = worlds.sky_of(world)
    return skylight_surface.ensure(
        world,
        _value_path(world, sky.background, "Strength"),
        sky.mapping and _value_path(world, sky.mapping, "Rotation"),
        sky.inverse,
    )


def _value_path(world: bpy.types.World, node: str, socket: str) -> str:
    return "node_tree." + world.node_tree.nodes[node].inputs[socket].path_from_id("default_value")


def set_coefficients(world: bpy.types.World, coefficients: np.ndarray) -> None:
    """Give a World's sky the RGB coefficients of its irradiance polynomial.

    `coefficients`: ((d + 1)², 3) for a degree d of 0 to 6, in the order of
    `node_groups.sky_irradiance.exponents(d)`; higher terms become 0. Raises ValueError for another
    shape and InputError where `world.sky_of` does.
    """
    coefficients = np.asarray(coefficients, dtype=float)
    degree = math.isqrt(len(coefficients)) - 1
    terms = sky_irradiance.exponents(degree)
    if coefficients.shape != (len(terms), 3) or not 0 <= degree <= sky_irradiance.DEGREE:
        raise ValueError(f"coefficients of shape {coefficients.shape} fit no degree from 0 to 6")
    surface = ensure(world)
    values = dict.fromkeys(sky_irradiance.exponents(), (0.0, 0.0, 0.0))
    values.update(zip(terms, coefficients.tolist(), strict=True))
    sky_irradiance.set_coefficients(skylight_surface.sky_in(surface), values)


def coefficients_of(world: bpy.types.World) -> np.ndarray | None:
    """The (49, 3) coefficients that a World's sky holds, None before any were set."""
    surface = skylight_surface.find(world)
    if surface is None:
        return None
    return np.array(list(sky_irradiance.coefficients(skylight_surface.sky_in(surface)).values()))


def describe(world: bpy.types.World, description: dict[str, Any]) -> None:
    """Keep with a World's light what was found in its sky: anything that JSON can hold.

    Raises InputError where `world.sky_of` does.
    """
    ensure(world)[DESCRIPTION] = json.dumps(description)


def description_of(world: bpy.types.World) -> dict[str, Any] | None:
    """What `describe` kept, None before."""
    surface = skylight_surface.find(world)
    kept = None if surface is None else surface.get(DESCRIPTION)
    return None if kept is None else json.loads(kept)


def remove(surface: bpy.types.NodeTree) -> None:
    """Take a `Skylight Surface` group out of the file with what is inside and used nowhere else.

    Call it when the last material under that sky is released: one that still uses it turns black.
    """
    inside = (skylight_surface.sky_in(surface), *groups.of_kind(spectral_matrix.KIND))
    bpy.data.node_groups.remove(surface)
    for tree in inside:
        if tree.users == 0:
            bpy.data.node_groups.remove(tree)
