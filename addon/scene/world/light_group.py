"""The light of one World in its node groups: its values, and what follows the World."""

from __future__ import annotations

import math

import bpy
import numpy as np

from ....node_groups import light_probe, sky_irradiance, skylight_surface
from ... import tags
from ...errors import InputError
from ..blend_data import kept
from . import hdri as worlds
from .light_record import LightRecord


def ensure(
    world: bpy.types.World, features: skylight_surface.Features | None = None
) -> bpy.types.NodeTree:
    """The `Skylight Surface` group of a World, made or updated, following its turn and strength.

    ``features``: what its light is made of from now on; None: as before.

    It follows by drivers, so keyframes work in a file without the add-on. A renamed Mapping or
    Background node is followed again from the next call on. Raises InputError where
    `hdri.sky_of` does, and where a newer version of the add-on has made the groups.
    """
    sky = worlds.sky_of(world)
    if skylight_surface.is_newer(world):
        raise InputError(
            f'World "{world.name}"',
            "has light by a newer version of this add-on",
            "update the add-on",
        )
    return skylight_surface.ensure(
        world,
        worlds.value_path(world, sky.background, "Strength"),
        worlds.value_path(world, sky.mapping, "Rotation"),
        sky.inverse,
        features,
        # Bakes that move know the strength themselves: not all of their light grows with it.
        {skylight_surface.BAKED} if tags.BAKED_KEY in world else (),
    )


def set_coefficients(world: bpy.types.World, coefficients: np.ndarray) -> None:
    """Give a World's sky the RGB coefficients of its irradiance polynomial.

    `coefficients`: ((d + 1)², 3) for a degree d of 0 to 6, in the order of
    `node_groups.sky_irradiance.exponents(d)`; higher terms become 0. Raises ValueError for another
    shape and InputError where `hdri.sky_of` does.
    """
    _set(skylight_surface.sky_in(ensure(world)), coefficients, sky_irradiance.DEGREE)


def set_ground(world: bpy.types.World, coefficients: np.ndarray) -> None:
    """Give a World's ground the RGB coefficients of its irradiance, of a degree of 0 to 3.

    As `set_coefficients`; the World's `Features` have ground.
    """
    ground = skylight_surface.part(ensure(world), skylight_surface.GROUND)
    _set(ground, coefficients, sky_irradiance.GROUND_DEGREE)


def trace(world: bpy.types.World, on: bool) -> None:
    """Let Cycles trace a World's light itself, or show what its groups hold of it."""
    skylight_surface.trace(ensure(world), on)


def set_probe(world: bpy.types.World, name: str, rgb: np.ndarray) -> None:
    """Give a World's light probe the RGB of its `light_probe.SUN`, `GREEN` or `BLUE`."""
    light_probe.set_colour(skylight_surface.part(ensure(world), skylight_surface.PROBE), name, rgb)


def _set(tree: bpy.types.NodeTree, coefficients: np.ndarray, highest: int) -> None:
    coefficients = np.asarray(coefficients, dtype=float)
    degree = math.isqrt(len(coefficients)) - 1
    terms = sky_irradiance.exponents(degree)
    if coefficients.shape != (len(terms), 3) or not 0 <= degree <= highest:
        shape = coefficients.shape
        raise ValueError(f"coefficients of shape {shape} fit no degree from 0 to {highest}")
    values = dict.fromkeys(sky_irradiance.exponents(highest), (0.0, 0.0, 0.0))
    values.update(zip(terms, coefficients.tolist(), strict=True))
    sky_irradiance.set_coefficients(tree, values)


def coefficients_of(world: bpy.types.World) -> np.ndarray | None:
    """The (49, 3) coefficients that a World's sky holds, None before any were set."""
    surface = skylight_surface.find(world)
    if surface is None:
        return None
    return np.array(list(sky_irradiance.coefficients(skylight_surface.sky_in(surface)).values()))


def keep_record(world: bpy.types.World, record: LightRecord) -> None:
    """Keep with a World's light what was found in its sky; raises InputError as `hdri.sky_of`."""
    ensure(world)[tags.LIGHT] = record.to_json()


def record_of(world: bpy.types.World | None) -> LightRecord | None:
    """What `keep_record` kept, None before and without a World."""
    surface = None if world is None else skylight_surface.find(world)
    found = "" if surface is None else kept.text(surface, tags.LIGHT)
    return LightRecord.from_json(found) if found else None


def remove(surface: bpy.types.NodeTree) -> None:
    """Take a `Skylight Surface` group out of the file; what was inside is then unused.

    Call it when the last material under that sky is released: one that still uses it turns black.
    """
    bpy.data.node_groups.remove(surface)
