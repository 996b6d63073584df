"""What a World's HDRI means and what is asked of its light, kept with the World for later."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...sky.light import SkyLight
from ...spectra import sensitivities
from ...transfer.choice import SIMPLEST, Choice, choose_with
from ...transfer.matrices import Transfer, transfer
from ...transfer.white import AUTO
from ..blend_data import working_space
from . import light_group

SETTINGS = "spectral_skylight_settings"

OPEN, BAKED, DOME = "open", "baked", "dome"
"""Shadows of the sky: none, precomputed, or of soft suns."""


@dataclass(frozen=True)
class Settings:
    """What made the HDRI's numbers, the model of skylight, and how exact it has to be.

    The first four are options of `transfer`; ``basis`` may be `SIMPLEST` too. With a
    ``tolerance`` [CIEDE2000] each material gets the least model that keeps to it, and the sky the
    lowest degree.
    """

    basis: str = "atmosphere"
    camera: str | None = None
    white: tuple[float, float, float] | None = None
    sun_elevation: float | None = None
    tolerance: float | None = None
    sun: bool = True
    """Whether the HDRI's sun shines on materials, by a lamp."""
    ground: str = AUTO
    """The light from below: one of `transfer.ground.CHOICES`, or the modelled ground where geometry
    lies under the materials, else the HDRI's."""
    occlusion: str = OPEN
    """Shadows of the sky: `OPEN` for none, `DOME`, or `BAKED`."""
    bounce: bool = False
    """Whether baked light holds what one bounce between materials brings."""
    gloss: bool = False
    """Whether materials keep gloss and metal over their measured base."""

    def transfer(self, light: SkyLight | None = None, basis: str | None = None) -> Transfer:
        """Return the map from reflectances to matrices of the open file's working space.

        ``light``: the sky, whose sun and colour the basis may be chosen by. ``basis``: another one
        than the settings', which are `atmosphere` as long as the simplest is not found.
        """
        if basis is None:
            basis = "atmosphere" if self.basis == SIMPLEST else self.basis
        return transfer(
            basis,
            camera=self.camera,
            white=self.white,
            space=working_space.name(),
            sun_elevation=light.sun_elevation(self.sun_elevation) if light else self.sun_elevation,
            sky_rgb=None if light is None else light.faces,
        )

    @property
    def sensors(self) -> NDArray[np.float64]:
        """What made the HDRI's numbers as Blender has them, (3, 81), white balance and all."""
        if self.camera is None:
            S = sensitivities.observer(working_space.name())
        else:
            S = sensitivities.camera(self.camera)
        return S if self.white is None else S / np.array(self.white)[:, None]

    def choose(
        self, light: SkyLight, reflectances: NDArray[np.float64], doubted: str = ""
    ) -> Choice:
        """Return the models of reflectances (m, 81) under a sky; ``doubted``: `choice.doubt`."""
        # A camera's World was developed by one basis already: its materials keep to that.
        basis = "atmosphere" if self.camera and self.basis == SIMPLEST else self.basis
        return choose_with(
            lambda name: self.transfer(light, name),
            basis,
            reflectances,
            light.faces,
            light.sun_elevation(self.sun_elevation),
            self.tolerance,
            light.outside.foreign,
            doubted,
        )


def stored(world: bpy.types.World | None) -> dict[str, Any]:
    """The settings that a World's materials were made with, or are to be; empty before any."""
    if world is not None and world.library is not None and SETTINGS not in world:
        # What is written on a linked World is not saved: our group of it, in this file, is.
        return (light_group.description_of(world) or {}).get("settings", {})
    return {} if world is None else json.loads(world.get(SETTINGS, "{}"))


def store(world: bpy.types.World, settings: dict[str, Any]) -> None:
    """Keep settings with a World: names, numbers and lists; None is left out."""
    given = {name: value for name, value in settings.items() if value is not None}
    world[SETTINGS] = json.dumps(given)
