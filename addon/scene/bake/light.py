"""What lights a bake: what shines, and what materials make of it."""

from __future__ import annotations

import pickle
from collections.abc import Generator, Sequence
from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress
from ...spectra.grid import WAVELENGTHS, WEIGHTS
from ...spectra.sensitivities import cmfs, observer
from ...spectra.working_spaces import DEFAULT_SPACE
from ...transfer.matrices import Transfer, transfer
from ...transport import directions
from ...transport.bands import COUNT
from ...transport.cells import Matter
from ...transport.lamps import Direct
from ..lights.lighting import Lights
from . import matter, sources


class Light:
    """An even sky of radiance 1 on white faces that send nothing on: how open a place is."""

    lamps: Sequence[Direct] = ()

    @property
    def sky(self) -> NDArray[np.float32]:
        """Radiance of the sphere's cells in bands, (SKY, 16)."""
        return np.repeat(_upper()[:, None], COUNT, axis=1).astype(np.float32)

    def lamps_from(self, origin: NDArray[np.float64]) -> list[Direct]:
        """The lamps with places relative to an origin (3,)."""
        return [lamp.seen_from(origin) for lamp in self.lamps]

    def matter(self, names: Sequence[str]) -> Matter:
        """What the materials of these full names do."""
        found, _ = matter.matter(names, _EVEN, self._transfer)
        found.reflectance[:] = 0.0
        found.emission[:] = 0.0
        found.transmittance[:] = 1.0
        found.mirrored[:] = 0.0
        return found

    @property
    def channels(self) -> NDArray[np.float64]:
        """What the sphere's cells have of each channel, (SKY, k), k up to 4."""
        return _upper()[:, None]

    def mix(self, name: str) -> NDArray[np.float64]:
        """The colour (3, k) that a material has in the light of each channel."""
        return np.ones((3, 1))

    def matrix(self, name: str) -> NDArray[np.float64]:
        """From light in bands to a material's colour, (3, 16)."""
        return np.full((3, COUNT), 1.0 / COUNT)

    def key(self, names: Sequence[str]) -> bytes:
        """What tells this light on materials of these full names from another."""
        does = self.matter(names)
        mixes = [self.mix(name) for name in names]
        return pickle.dumps((self.sky, self.channels, list(self.lamps), does, mixes))

    @property
    def _transfer(self) -> Transfer:
        return transfer()


class SceneLight(Light):
    """The light of a World and of the lamps in a scene, and the World's ``strength``."""

    def __init__(self, found: sources.Sources, strength: float, emits: bool = True) -> None:
        self.sources, self.strength, self.emits = found, strength, emits
        self.lamps = self.sources.lamps
        self._known: dict[str, matter.Optics] = {}

    @property
    def sky(self) -> NDArray[np.float32]:
        """As a `Light`'s."""
        return self.sources.sky

    def matter(self, names: Sequence[str]) -> Matter:
        """As a `Light`'s."""
        found, optics = matter.matter(names, self.sources.bands, self._transfer, self.strength)
        self._known = dict(zip(names, optics, strict=True))
        if not self.emits:
            found.emission[:] = 0.0
        return found

    @property
    def of_sky(self) -> SceneLight:
        """What of it grows with the World's strength: no lamps, and nothing shines by itself."""
        found = self.sources
        sun = found.lamps[: int(found.sunny)]
        return SceneLight(replace(found, lamps=sun), self.strength, emits=False)

    @property
    def of_lamps(self) -> SceneLight:
        """The rest of it."""
        found = self.sources
        dark = np.zeros_like(found.rgb), np.zeros_like(found.ground)
        own = found.lamps[int(found.sunny) :]
        found = replace(found, rgb=dark[0], ground=dark[1], lamps=own, sunny=False)
        return SceneLight(found, self.strength)

    @property
    def channels(self) -> NDArray[np.float64]:
        """As a `Light`'s."""
        return self.sources.channels

    def mix(self, name: str) -> NDArray[np.float64]:
        """As a `Light`'s."""
        return self.sources.mix(self._known[name].reflectance)

    def matrix(self, name: str) -> NDArray[np.float64]:
        """As a `Light`'s."""
        return self.sources.matrix(self._known[name].reflectance)

    @property
    def to_XYZ(self) -> NDArray[np.float64]:
        """From light in bands to XYZ, (3, 16)."""
        bands = self.sources.bands
        return bands.colours(np.ones(WAVELENGTHS.size), cmfs() * WEIGHTS)

    def reflectance(self, name: str) -> NDArray[np.float64]:
        """The reflectance (81,) of a material among those that `matter` was asked for."""
        return self._known[name].reflectance

    @property
    def _transfer(self) -> Transfer:
        return self.sources.transfer


def shining_of(
    world: bpy.types.World, lights: Lights, scene: bpy.types.Scene
) -> Generator[Progress, None, SceneLight]:
    """Return the light of a World and its lamps; raises InputError as `sources.finding` does."""
    found = yield from sources.finding(world, lights, scene)
    return SceneLight(found, sources.strength_of(world))


def _upper() -> NDArray[np.float64]:
    return (np.arange(directions.SKY) < directions.SKY // 2).astype(float)


_EVEN = sources.Bands(np.ones(observer(DEFAULT_SPACE).shape[1]))
