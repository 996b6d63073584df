"""The open scene with the light that goes round in it, of which meters read at any place.

Rays between surfaces are cast once; another light, or other places, cost what it takes to look.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress
from ...transport import rays
from ...transport.meter import Field
from ...transport.radiosity import Radiosity
from ..bake import patches, session
from ..bake.light import SceneLight
from ..bake.scene_key import scene_key

RAYS = 2048, 65536
"""From each meter at least and at most …"""

BUDGET = 3e7, 4e6
"""… and about so many from all of them, with and without `embreex`."""


@dataclass
class LitScene:
    """What stands in a scene: ``origin`` (3,), to which its geometry is relative; full names of its
    materials; the patches that light goes round between."""

    origin: NDArray[np.float64]
    materials: list[str]
    radiosity: Radiosity

    def reading(
        self, light: SceneLight, places: NDArray, normals: NDArray
    ) -> Generator[Progress, None, tuple[NDArray, NDArray, NDArray]]:
        """Return spectra (n, 81) of irradiance and of the radiance seen, and what part of rays tell
        anything (n,), at places (n, 3) that look along unit normals (n, 3).

        In units of the HDRI as the scene shows it, before any balancing.
        """
        # A meter stands where there is room: what is dark around it is a dark room.
        field, _ = yield from self.solved(light, leaks=False)
        at = np.asarray(places, float) - self.origin
        each = BUDGET[not rays.fast()] / max(len(at), 1)
        count = int(2 ** np.clip(np.round(np.log2(each)), *np.log2(RAYS)))
        irradiance, told = [], []
        done = 0
        for found in field.on_faces(at, normals, count):
            irradiance.append(np.pi * _spectra(light, found))
            told.append(found.told)
            done += len(found.told)
            yield Progress(0.5 + 0.45 * done / max(len(at), 1), f"{len(at):,} places")
        radiance = [_spectra(light, found) for found in field.in_spots(at, normals)]
        none = np.empty((0, 81))
        return (
            np.concatenate([*irradiance, none]) * light.strength,
            np.concatenate([*radiance, none]) * light.strength,
            np.concatenate([*told, np.empty(0)]),
        )

    def solved(
        self, light: SceneLight, leaks: bool = True
    ) -> Generator[Progress, None, tuple[Field, NDArray[np.float32]]]:
        """Return what meters read of a light that has gone round, and irradiance / π (r, 16) on the
        patches' sides but for what lamps send straight, NaN within something solid.

        Not ``leaks``: what is dark all around is a dark room.
        """
        radiosity = self.radiosity
        radiosity.take(light.matter(self.materials))
        at = Progress(0.5, patches.BETWEEN)
        going = patches.going_round(radiosity, light, self.origin, at, leaks)
        direct, table, tells = yield from going
        channels = light.channels.astype(np.float32)
        around = np.where(tells[radiosity.row][:, None] > 0.0, radiosity.E - direct, np.nan)
        lamps = light.lamps_from(self.origin)
        return Field(radiosity.space, table, tells, channels, lamps), around


def _spectra(light: SceneLight, found) -> NDArray[np.float64]:
    sources = light.sources
    return sources.restored(found.bands) + sources.seen(found.channels)


_last: list[tuple[int, LitScene]] = []


def casting(light: SceneLight) -> Generator[Progress, None, LitScene]:
    """Return the open scene with rays cast; those of a bake, or of before, where nothing moved."""
    bpy.context.view_layer.update()
    key = scene_key()
    if remembered := session.remembered(key):
        return LitScene(*remembered)
    if _last and _last[0][0] == key:
        return _last[0][1]
    _last.clear()
    found = yield from session.casting(light)
    _last.append((key, LitScene(*found)))
    return _last[0][1]
