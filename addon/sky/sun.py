"""The sun's disc in a panorama: found, measured and taken out of the sky."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.sorting import median
from ..spectra.working_spaces import LUMINANCE
from .lat_long import solid_angles
from .spots import spots

_SUN = np.pi * np.radians(0.2666) ** 2
"""Solid angle of the sun from the earth [sr]."""
_LARGEST = np.radians(5.0)
"""Radius over which a bright spot is a cloud, a window or a lit wall, however clipped."""
_LOWEST = np.radians(-1.0)
"""A sun whose middle is lower has set; what shines there is its reflection."""
_HALF_MAX = 65504.0


@dataclass(frozen=True)
class Sun:
    """The sun as a sky shows it."""

    direction: NDArray[np.float64]
    """Unit vector towards it, (3,), Blender's world."""
    elevation: float
    """[deg] over the horizon."""
    azimuth: float
    """[deg] counter-clockwise from +x (east), -180 to 180."""
    angular_radius: float
    """[deg] of a circle with the area that is at least half as bright as its brightest pixel: what
    the picture shows, no finer than its pixels, and wider than 0.27 where glare or a veil is."""
    irradiance: NDArray[np.float64]
    """RGB irradiance / pi of a face that looks at it, without the sky's, (3,)."""
    share: float
    """Part of the luminance irradiance of a face that looks up that is the sun's, 0 to 1."""
    clipped: bool
    """Whether the picture could not hold its brightness, so that it was brighter than it is here.

    Seen by a flat top that is larger than the sun, by the largest half float, or by colours that
    differ over the disc, for channels clip one by one. A flat disc that someone drew too large
    looks the same; a veiled white sun that clipped in all channels within a pixel or two is missed.
    """


def separate_sun(rgb: ArrayLike) -> tuple[NDArray[np.float32], Sun | None]:
    """Return the sky with the sun's disc filled by what surrounds it, (h, w, 3), and the sun.

    The brightest spots over the horizon are looked at. One is the sun when it is small (radius up
    to 5°, and round when over 1°), ten times as bright as an even sky of the same light would be,
    by far the strongest of its kind, and gives a face that looks at it at least 1 % of what the
    panorama gives a face that looks up. A weaker sun is not worth a lamp and stays in the sky, as
    does every aureole. Without a sun the sky comes back as it was (not copied).

    Sky and sun together give each face that sees all of the disc what the panorama did. A lone lamp
    as small and strong as the sun, or a skylight in an evenly lit dark vault, is taken for it.
    """
    rgb = np.asarray(rgb, np.float32)
    height, width = rgb.shape[:2]
    luminance = rgb[: int((0.5 - _LOWEST / np.pi) * height) + 1] @ LUMINANCE.astype(np.float32)
    # sin d(sin) = d(sin^2 / 2): what each row gives a face that looks up.
    edges = np.sin((0.5 - np.arange(height // 2 + 1) / height) * np.pi) ** 2 / width
    upward = -np.diff(edges) @ luminance[: height // 2].sum(axis=1, dtype=np.float64)
    for _ in range(3):  # a dead pixel or a lamp may outshine the sun
        spot = _brightest_spot(luminance, solid_angles(height, width))
        if spot is None:
            break
        sun, rows, columns, fill = _measure(rgb, luminance, spot, float(upward))
        if sun is not None:
            sky = rgb.copy()
            sky[rows, columns] = fill
            return sky, sun
        seen = rows < len(luminance)
        luminance[rows[seen], columns[seen]] = 0.0
    return rgb, None


_Pixels = tuple[NDArray[np.intp], NDArray[np.intp]]


def _brightest_spot(
    luminance: NDArray[np.float32], solid_angle: NDArray[np.float64]
) -> _Pixels | None:
    """Return the connected pixels at least half as bright as the brightest, with most light in all.

    None when there is no light, when as bright pixels cover more than the largest spot does, or
    when those away from the spot hold half as much light: there is only one sun.
    """
    bright = luminance >= 0.5 * luminance.max()
    area = bright.sum(axis=1) @ solid_angle[: len(bright)]
    if not 0.0 < area <= np.pi * _LARGEST**2:
        return None
    rows, columns = np.nonzero(bright)
    spot = spots(bright)
    light = luminance[rows, columns] * solid_angle[rows]
    chosen = spot == np.argmax(np.bincount(spot, light))
    towards = _towards(rows, columns, len(solid_angle))
    middle = _unit(light[chosen] @ towards[chosen])
    away = towards @ middle < np.cos(2.0 * _LARGEST)
    if light[away].sum() > 0.5 * light[chosen].sum():
        return None
    return rows[chosen], columns[chosen]


def _measure(
    rgb: NDArray[np.float32], luminance: NDArray[np.float32], spot: _Pixels, upward: float
) -> tuple[Sun | None, NDArray[np.intp], NDArray[np.intp], NDArray[np.float32]]:
    """Return the sun at this spot, or None, the rows and columns of its disc, and what fills them.

    `upward` is the luminance irradiance / pi that the whole panorama gives a face that looks up.
    """
    height, width = rgb.shape[:2]
    pitch = np.pi / height
    solid_angle = solid_angles(height, width)
    towards = _towards(*spot, height)
    light = luminance[spot] * solid_angle[spot[0]]
    middle = _unit(light @ towards)
    area = solid_angle[spot[0]].sum()
    distance = _angle(towards, middle)
    # Resampling and lens spread the disc's edge over the next pixels.
    disc = distance.max() + max(2.0 * pitch, np.radians(0.1))
    ring = disc + max(3.0 * pitch, np.radians(0.5))

    rows, columns = _window(middle, ring, height)
    away = _angle(_towards(rows, columns, height), middle)
    surroundings = rgb[rows[away > disc], columns[away > disc]]
    fill = median(surroundings)
    rows, columns = rows[away <= disc], columns[away <= disc]
    pixels = rgb[rows, columns].astype(np.float64)
    excess = (pixels - fill) * solid_angle[rows, None]
    towards = _towards(rows, columns, height)
    direction = _unit((excess @ LUMINANCE) @ towards)
    irradiance = np.maximum((towards @ direction) @ excess, 0.0) / np.pi
    strength = float(irradiance @ LUMINANCE)
    share = strength * max(float(direction[2]), 0.0) / upward if upward > 0.0 else 0.0

    radius = np.sqrt(area / np.pi)
    glaring = luminance[spot].max() >= 10.0 * upward and strength >= 0.01 * upward
    # Glare makes a clipped sun large, but leaves it round and in a bright part of the sky (above
    # it, when it sets), where a window is in a dark wall.
    # A circle's mean squared distance from its middle is area / 2 pi, a square's 5 % more, that of
    # a rectangle of 2:1 a third more.
    spread = np.mean(distance**2) + pitch**2 / 6.0
    round_in_sky = (
        2.0 * np.pi * spread <= 1.2 * area
        and np.quantile(surroundings @ LUMINANCE, 0.75) >= 0.5 * (1.0 - share) * upward
    )
    if (
        not glaring
        or area < 0.1 * _SUN
        or direction[2] < np.sin(_LOWEST)
        or (radius > np.radians(1.0) and not round_in_sky)
    ):
        return None, rows, columns, fill
    sun = Sun(
        direction=direction,
        elevation=float(np.degrees(np.arcsin(direction[2]))),
        azimuth=float(np.degrees(np.arctan2(direction[1], direction[0]))),
        angular_radius=float(np.degrees(radius)),
        irradiance=irradiance,
        share=share,
        clipped=_is_clipped(pixels, fill, solid_angle[rows], pitch),
    )
    return sun, rows, columns, fill


def _is_clipped(
    pixels: NDArray[np.float64],
    fill: NDArray[np.float32],
    solid_angle: NDArray[np.float64],
    pitch: float,
) -> bool:
    """Judge a disc's pixels, (k, 3), by the signs that `Sun.clipped` names."""
    brightest = pixels.max(axis=1)
    flat = solid_angle[brightest >= 0.8 * brightest.max()].sum()
    largest = np.pi * (np.radians(0.2666) + pitch / 2.0) ** 2  # the sun, spread over whole pixels
    strong = pixels.max(axis=0) > 10.0 * fill  # a channel that the surroundings do not colour
    core = pixels[brightest >= 0.5 * brightest.max()][:, strong]
    ratio = core.min(axis=1, initial=np.inf) / core.max(axis=1, initial=1e-30)
    # A low sun's lower limb is redder too, but by less than 2.
    drifts = strong.any() and ratio.max() > 2.0 * ratio.min()
    return bool(flat > 1.2 * largest or brightest.max() == _HALF_MAX or drifts)


def _window(middle: NDArray[np.float64], radius: float, height: int) -> _Pixels:
    """Return the pixels whose centres lie within `radius` [rad] of a direction, seam or zenith."""
    width = 2 * height
    pitch = np.pi / height
    elevation = np.arcsin(np.clip(middle[2], -1.0, 1.0))
    row = (np.pi / 2.0 - elevation) / pitch
    column = (np.pi - np.arctan2(middle[1], middle[0])) / pitch
    reach = radius / pitch + 1.0
    lowest = abs(elevation) + reach * pitch
    across = min(reach / np.cos(lowest), height) if lowest < 1.5 else height
    rows = np.arange(max(0, int(row - reach)), min(height, int(row + reach) + 1))
    columns = np.arange(
        int(column - across), int(column - across) + min(int(2 * across) + 2, width)
    )
    y, x = (index.ravel() for index in np.meshgrid(rows, columns % width, indexing="ij"))
    near = _angle(_towards(y, x, height), middle) <= radius
    return y[near], x[near]


def _towards(rows: NDArray[np.intp], columns: NDArray[np.intp], height: int) -> NDArray[np.float64]:
    """Return where some pixels look, (k, 3), as `lat_long.directions` does for all."""
    elevation = (0.5 - (rows + 0.5) / height) * np.pi
    azimuth = (0.5 - (columns + 0.5) / (2 * height)) * 2.0 * np.pi
    level = np.cos(elevation)
    return np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=1)


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    return vector / np.linalg.norm(vector)


def _angle(towards: NDArray[np.float64], middle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles to one direction [rad]; by the chord, which small angles survive."""
    return 2.0 * np.arcsin(np.minimum(np.linalg.norm(towards - middle, axis=1) / 2.0, 1.0))
