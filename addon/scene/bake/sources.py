"""What shines in a scene, in bands: sky and ground, the sun, and lamps."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Euler
from numpy.typing import NDArray

from ....node_groups import skylight_surface
from ...progress import Progress, aside
from ...spectra.grid import WEIGHTS
from ...spectra.sensitivities import cmfs
from ...transfer.ground import split
from ...transfer.matrices import Transfer
from ...transport import directions
from ...transport.bands import Bands, spline
from ...transport.lamps import Direct
from ..lights.lighting import Lights
from ..lights.user_lamps import Lamps, luminance
from ..world import hdri as worlds


@dataclass
class Sources:
    """What shines: ``rgb`` (SKY, 3), the sky's cells in the HDRI's numbers, black below; ``ground``
    (SKY,), how many times each cell below has the spectrum ``below`` (81,) [before balancing];
    ``lamps``, the sun first where it shines, which ``sunny`` says."""

    transfer: Transfer
    bands: Bands
    rgb: NDArray[np.float64]
    ground: NDArray[np.float64]
    below: NDArray[np.float64]
    lamps: list[Direct]
    sunny: bool = False

    def restored(self, bands: NDArray) -> NDArray[np.float64]:
        """The spectrum (..., 81) of light in bands (..., 16)."""
        return np.asarray(bands, dtype=float) @ spline().T * self.bands.shape

    def seen(self, channels: NDArray) -> NDArray[np.float64]:
        """The spectrum (..., 81) of light in `channels` (..., 4), before any balancing."""
        sky = self.transfer.unbalanced(channels[..., :3]) @ self.transfer.restoration.T
        return sky + channels[..., 3:] * self.below

    @property
    def sky(self) -> NDArray[np.float32]:
        """The radiance of the sphere's cells in bands, (SKY, 16)."""
        transfer = self.transfer
        restored = self.bands.light(transfer.restoration.T)
        light = transfer.unbalanced(self.rgb) @ restored
        return (light + self.ground[:, None] * self.bands.light(self.below)).astype(np.float32)

    @property
    def channels(self) -> NDArray[np.float64]:
        """Each cell's light, (SKY, 4): RGB of the sky, and how many times that of the ground."""
        return np.concatenate([self.rgb, self.ground[:, None]], axis=1)

    def mix(self, rho: NDArray[np.float64]) -> NDArray[np.float64]:
        """What a reflectance (81,) makes of `channels`, (3, 4), by every wavelength."""
        transfer = self.transfer
        below = transfer.S_out @ (rho * self.below) / transfer.neutral
        return np.concatenate([transfer.matrices(rho), below[:, None]], axis=1)

    def matrix(self, rho: NDArray[np.float64]) -> NDArray[np.float64]:
        """From light in bands to the colour that a reflectance (81,) makes of it, (3, 16)."""
        return self.bands.colours(rho, self.transfer.S_out) / self.transfer.neutral[:, None]


def finding(
    world: bpy.types.World, lights: Lights, scene: bpy.types.Scene
) -> Generator[Progress, None, Sources]:
    """Find what shines on a scene by a World and its lamps.

    Raises InputError as `hdri.sky_of` does.
    """
    sky, light, transfer = worlds.sky_of(world), lights.light, lights.transfer
    turn = np.array(Euler(sky.rotation, "XYZ").to_matrix())
    to_panorama = turn.T if sky.inverse else turn
    day = transfer.restoration @ transfer.unbalanced(light.faces[0])
    if lights.sun is not None:
        day = day + lights.sun.spectrum
    bands = Bands(np.maximum(day, 0.01 * day.mean()) if day.any() else np.ones(81))
    lamps = []
    sunny = lights.sun is not None and light.sun is not None
    if lights.sun is not None and light.sun is not None:
        towards = worlds.in_world(sky, light.sun.direction)
        lamps.append(Direct(None, towards, bands.light(lights.sun.spectrum).astype(np.float32)))
    if lights.lamps is not None:
        lamps += _lamps(lights.lamps, bands, transfer, strength_of(world))
    step = Progress(0.0, "the sky")
    rgb, ground, below = yield from aside(step, _sky, lights, to_panorama)
    return Sources(transfer, bands, rgb, ground, below, lamps, sunny)


def _sky(
    lights: Lights, to_panorama: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The sky's cells and the ground, as `Sources` has them."""
    transfer = lights.transfer
    upper, lower = split(lights.light.sky)
    both = directions.sphere(np.concatenate([upper, lower], axis=2), to_panorama)
    rgb, under = both[:, :3].astype(float), both[:, 3:].astype(float)
    ground, below = np.zeros(len(rgb)), np.zeros(81)
    if lights.ground is None:
        rgb = rgb + under
    else:
        below = lights.ground.spectrum
        if lights.ground.choice == "modelled":
            ground[directions.SKY // 2 :] = 1.0
        elif lights.ground.choice == "hdri":
            seen = under @ _luminance(transfer)
            ways, solid = directions.centres()
            shape = np.maximum(-ways[:, 2], 0.0) * solid / np.pi
            ground = seen / max(float(seen @ shape), 1e-30)
    return rgb, ground, below


def strength_of(world: bpy.types.World) -> float:
    """What a bake is multiplied by now: a World's strength, and never nothing."""
    return max(worlds.strength(world), skylight_surface.LEAST)


def _luminance(transfer: Transfer) -> NDArray[np.float64]:
    """What the HDRI's numbers count for luminance, (3,)."""
    Y = cmfs()[1] * WEIGHTS
    weight = Y @ transfer.restoration * (1.0 if transfer.white is None else transfer.white)
    return np.maximum(weight, 0.0)


def _lamps(lamps: Lamps, bands, transfer, strength) -> list[Direct]:
    """The scene's own lamps, as Blender has their light (irradiance of power P at distance r:
    P / (4 pi r²); a sun's energy is irradiance)."""
    found = []
    sizes = luminance(lamps.colours, transfer) / strength
    for one, kind, size in zip(
        lamps.shining, lamps.classes.assignment.tolist(), sizes.tolist(), strict=True
    ):
        data, place = one.lamp.data, one.matrix
        axis = -place[:3, 2] / max(np.linalg.norm(place[:3, 2]), 1e-12)
        spectrum = bands.light(lamps.classes.spectra[kind]) * size * data.energy
        if data.type == "SUN":
            found.append(Direct(None, -axis, (spectrum / math.pi).astype(np.float32)))
            continue
        at, cone, area = place[:3, 3], (-1.0, -1.0), None
        scale = 1.0 / (4.0 * math.pi**2)
        if data.type == "SPOT":
            end = math.cos(data.spot_size / 2.0)
            cone = end, end + (1.0 - end) * max(data.spot_blend, 1e-3)
        elif data.type == "AREA":
            height = data.size_y if data.shape in ("RECTANGLE", "ELLIPSE") else data.size
            # A disc's light as that of the square of its area.
            round_ = data.shape in ("DISK", "ELLIPSE")
            half = 0.5 * (math.sqrt(math.pi) / 2.0 if round_ else 1.0)
            area = np.stack([place[:3, 0] * data.size, place[:3, 1] * height]) * half
            scale = 1.0 / math.pi**2
        found.append(
            Direct(
                at,
                axis,
                (spectrum * scale).astype(np.float32),
                cone,
                area,
                getattr(data, "shadow_soft_size", 0.0),
            )
        )
    return found
