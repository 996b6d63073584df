"""The lights of a World beside its sky: which there are, and their lamps in the scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from ...node_groups import light_probe
from ...node_groups.skylight_surface import Features
from ..sky.direct_sun import SunLight, restored_sun
from ..sky.light import SkyLight
from ..transfer.matrices import Transfer
from ..transfer.prefilter import balanced_rgb, prefiltered
from . import receivers, sky_light, sun_lamp


@dataclass(frozen=True)
class Lights:
    """What shines on a World's materials, found before anything changes.

    ``spectra``: of each of `skylight_surface.LIGHTS` that there is, (81,).
    """

    light: SkyLight
    transfer: Transfer
    sun: SunLight | None = None
    spectra: dict[str, NDArray[np.float64]] = field(default_factory=dict)

    @property
    def features(self) -> Features:
        """What the World's shader has to hold."""
        return Features(probe=self.sun is not None)

    @property
    def lines(self) -> list[str]:
        """What is put beside the sky, a sentence each."""
        return [] if self.sun is None else [self.sun.line]

    @property
    def caption(self) -> str:
        """What a picture must say as long as not all light is in it."""
        return (
            self.light.caption
            if self.sun is None
            else "open sky and sun: the sky casts no shadows yet"
        )

    def reflected(self, rho: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Return what reflectances (m, 81) make of each light, (m, 3)."""
        space = self.transfer.space
        return {name: prefiltered(rho, light, space) for name, light in self.spectra.items()}


def find(light: SkyLight, transfer: Transfer, with_sun: bool) -> Lights:
    """Return the lights of a sky; ``with_sun``: its sun too, where the HDRI has one."""
    if light.sun is None or not with_sun:
        return Lights(light, transfer)
    sun = restored_sun(light.sun, light, transfer.S_in, transfer.white)
    return Lights(light, transfer, sun, {"Sun": sun.spectrum})


def install(world: bpy.types.World, lights: Lights) -> None:
    """Put lights into the World's group and its lamps into all scenes that it lights."""
    sky_light.ensure(world, lights.features)
    sky_light.set_coefficients(world, lights.light.fit.coefficients)
    if lights.sun is None:
        remove(world)
        return
    rgb = balanced_rgb(lights.sun.spectrum, lights.transfer)
    sky_light.set_probe(world, light_probe.SUN, rgb)
    for scene in _scenes(world):
        assert lights.light.sun is not None
        direction, brightest = lights.light.sun.direction, float(lights.light.sky.max())
        sun_lamp.place(scene, direction, rgb, brightest)


def refresh(world: bpy.types.World) -> list[str]:
    """Let the lamps shine on all objects that now have managed materials; return warnings."""
    lines = []
    for scene in _scenes(world):
        if receivers.find(scene) is None:
            continue
        receivers.ensure(scene)
        if names := [f'"{obj.name}"' for obj in receivers.mixed(scene)]:
            lines.append(
                f"no sun on {', '.join(names[:5])}{' …' if names[5:] else ''}: beside spectral "
                "materials it has others, which the sun's lamp would burn out"
            )
    return lines


def remove(world: bpy.types.World) -> None:
    """Take our lamps out of all scenes of a World."""
    for scene in _scenes(world):
        sun_lamp.remove(scene)
    sun_lamp.release_threshold(world)


def _scenes(world: bpy.types.World) -> Iterable[bpy.types.Scene]:
    return [scene for scene in bpy.data.scenes if scene.world == world]
