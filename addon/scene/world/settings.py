"""What a World's HDRI means and what is asked of its light, kept with the World for later."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import tags
from ...choices import (
    ALL_LIGHT,
    AUTO,
    BAKED,
    BASIS,
    GROUNDS,
    OCCLUSIONS,
    OPEN,
    SIMPLEST,
    TRACED,
    default,
)
from ...sky.light import SkyLight
from ...spectra import sensitivities
from ...transfer.choice import Choice, choose_with
from ...transfer.known_light import KnownLight
from ...transfer.matrices import Transfer, transfer
from ..blend_data import kept, working_space
from . import light_group


@dataclass(frozen=True)
class Settings:
    """What is asked for a scene: what made the HDRI's numbers, and which light and how exact.

    The first four are options of `transfer`; ``basis`` may be `SIMPLEST` too. With a
    ``tolerance`` [CIEDE2000] each material gets the least model that keeps to it, and the sky the
    lowest degree.
    """

    basis: str = BASIS
    camera: str | None = None
    white: tuple[float, float, float] | None = None
    sun_elevation: float | None = None
    tolerance: float | None = None
    sun: bool = True
    """Whether the HDRI's sun shines on materials, by a lamp."""
    ground: str = default(GROUNDS)
    """The light from below: one of `transfer.ground.CHOICES`, or the modelled ground where geometry
    lies under the materials, else the HDRI's."""
    occlusion: str = default(OCCLUSIONS)
    least: str | None = None
    """What automatic occlusion with a tolerance came to: `OPEN` where that is enough for the whole
    picture; None: baked."""
    bounce: bool = False
    """Asked for every bounce between surfaces, which baked light holds anyway."""
    gloss: bool = False
    """Whether materials keep gloss and metal over their measured base."""

    def transfer(
        self, light: SkyLight | None = None, basis: str | None = None, space: str | None = None
    ) -> Transfer:
        """Return the map from reflectances to matrices of a working space, the open file's if None.

        ``light``: the sky, whose sun and color the basis may be chosen by. ``basis``: another one
        than the settings', which are `atmosphere` as long as the simplest is not found.
        """
        if basis is None:
            basis = "atmosphere" if self.basis == SIMPLEST else self.basis
        return transfer(
            basis,
            camera=self.camera,
            white=self.white,
            space=space or working_space.name(),
            sun_elevation=light.sun_elevation(self.sun_elevation) if light else self.sun_elevation,
            sky_rgb=None if light is None else light.faces,
            known=None if light is None or light.spectrum is None else light.spectrum.members,
        )

    @property
    def shadows(self) -> str:
        """The occlusion that materials show: all light is a bake, whoever keeps it new, but where
        less is enough."""
        if self.is_choosing and self.least is not None:
            return self.least
        if self.occlusion == TRACED:
            return OPEN
        return BAKED if self.occlusion in ALL_LIGHT else self.occlusion

    @property
    def traced(self) -> bool:
        """Whether Cycles traces the light itself."""
        return self.occlusion == TRACED

    @property
    def is_choosing(self) -> bool:
        """Whether the light follows from the tolerance."""
        return self.occlusion == AUTO and self.tolerance is not None

    @property
    def sensors(self) -> NDArray[np.float64]:
        """What made the HDRI's numbers as Blender has them, (3, 81), white balance and all."""
        if self.camera is None:
            S = sensitivities.observer(working_space.name())
        else:
            S = sensitivities.camera(self.camera)
        return S if self.white is None else S / np.array(self.white)[:, None]

    def choose(
        self,
        light: SkyLight,
        reflectances: NDArray[np.float64],
        *,
        white_is_doubtful: bool = False,
        space: str | None = None,
    ) -> Choice:
        """Return the models of reflectances (m, 81) under a sky, in a working space as `transfer`.

        ``white_is_doubtful``: a white balance is suspected that is not undone.
        """
        # A camera's World was developed by one basis already: its materials keep to that.
        basis = "atmosphere" if self.camera and self.basis == SIMPLEST else self.basis
        known = KnownLight.of(light, self.sun_elevation, white_is_doubtful=white_is_doubtful)
        return choose_with(
            lambda name: self.transfer(light, name, space),
            basis,
            reflectances,
            known,
            self.tolerance,
        )

    def plain(self) -> dict[str, Any]:
        """Return it as plain data that JSON holds; None is left out."""
        return {name: value for name, value in asdict(self).items() if value is not None}

    def to_json(self) -> str:
        """Return it as text."""
        return json.dumps(self.plain())

    @classmethod
    def from_json(cls, text: str) -> Settings:
        """Read what `to_json` wrote; what is not named there has its default, and what only a newer
        version knows is passed over. The same text is read once."""
        return _settings(text)

    @classmethod
    def from_plain(cls, found: Mapping[str, Any]) -> Settings:
        """Read what `plain` returned; what is of another kind has its default."""
        own = {name: found[name] for name, right in _RIGHT.items() if right(found.get(name))}
        if "white" in own:
            own["white"] = tuple(own["white"])
        return cls(**own)


@lru_cache(maxsize=64)
def _settings(text: str) -> Settings:
    return Settings.from_plain(kept.parsed(text, {}))


_RIGHT: dict[str, Callable[[Any], bool]] = {
    "basis": lambda value: isinstance(value, str),
    "camera": lambda value: isinstance(value, str),
    "white": lambda value: kept.are_numbers(value, 3) and min(value) > 0,
    "sun_elevation": kept.is_number,
    "tolerance": lambda value: kept.is_number(value) and value > 0,
    "sun": lambda value: isinstance(value, bool),
    "ground": lambda value: value in list(GROUNDS),
    "occlusion": lambda value: value in list(OCCLUSIONS),
    "least": lambda value: value == OPEN,
    "bounce": lambda value: isinstance(value, bool),
    "gloss": lambda value: isinstance(value, bool),
}
"""Whether a value is one that a setting can have."""


def stored(world: bpy.types.World | None) -> Settings | None:
    """The settings that a World's materials were made with, or are to be; None before any."""
    if world is None:
        return None
    if world.library is not None and tags.SETTINGS not in world:
        # What is written on a linked World is not saved: our group of it, in this file, is.
        record = light_group.record_of(world)
        return None if record is None else Settings.from_plain(record.settings)
    found = kept.text(world, tags.SETTINGS)
    return Settings.from_json(found) if found else None


def store(world: bpy.types.World, settings: Settings) -> None:
    """Keep settings with a World."""
    world[tags.SETTINGS] = settings.to_json()
