"""Where the pixels of a sky leave the model of skylight, and how much light comes from there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.daylight_locus import is_off_daylight_locus
from ..spectra.working_spaces import LUMINANCE
from .irradiance import exact_irradiance
from .lat_long import directions
from .sun import Sun

KINDS = ("sky", "sun", "ground", "foreign")
"""What a pixel can be: over the horizon with a colour that skylight has; the sun's disc; under the
horizon with such a colour; of any other colour: leaves, painted walls, lamps."""

SKY, SUN, GROUND, FOREIGN = range(len(KINDS))

_ROWS = 256
"""Finer skies are looked at in blocks: there a camera's noise is no longer a colour of its own."""

_SOME = 0.1
"""Foreign light that is worth a word. Light off leaves alone leaves a matrix 4 CIEDE2000 off in the
mean (see tests/stability), a tenth of it among skylight a quarter: more than the sky itself does.
"""


@dataclass(frozen=True)
class Outside:
    """A sky's pixels by kind.

    ``labels`` (h, 2 h) uint8: places in `KINDS`, of blocks of its pixels; ``shares`` (m, 4): what
    each kind has of a face's light (luminance), 0 to 1, all 0 in the dark.
    """

    labels: NDArray[np.uint8]
    shares: NDArray[np.float64]

    @property
    def verdict(self) -> str:
        """How far the model of skylight holds for this sky, in one line."""
        mean, worst = self.shares.mean(axis=0)[FOREIGN], self.shares[:, FOREIGN].max()
        if not self.shares.any():
            return "the sky is dark"
        if self.mostly:
            start = "mostly outside the model of skylight"
        elif not self.holds:
            start = "partly outside the model of skylight"
        else:
            return "its light has the colors of skylight"
        return (
            f"{start}: {100 * mean:.0f} % of the light on faces of a building, at most "
            f"{100 * worst:.0f} %, has colors that no sky has (leaves, walls, lamps, a tint)"
        )

    @property
    def holds(self) -> bool:
        """Whether no face gets foreign light that is worth a word."""
        return bool(self.shares[:, FOREIGN].max() <= _SOME)

    @property
    def foreign(self) -> float:
        """The part of the light, 0 to 1, that is foreign on the face that has most of it."""
        return float(self.shares[:, FOREIGN].max())

    @property
    def mostly(self) -> bool:
        """Whether most light on the faces together is foreign."""
        return bool(self.shares.mean(axis=0)[FOREIGN] > 0.5)


def classify(
    sky: ArrayLike, sun: Sun | None = None, S_in: NDArray[np.float64] | None = None
) -> NDArray[np.uint8]:
    """Return each pixel's place in `KINDS`, (h, 2 h), of a sky whose disc was taken out.

    ``sky`` (rows, 2 rows, 3), more than 256 rows in blocks; ``S_in`` as in `locus_distance`.
    Over the horizon skylight of any sun elevation counts, for cameras make a clear sky as blue as
    it is at twilight; under it what this sun's light is off a grey ground.
    """
    rgb = blocks(sky)
    height, width = rgb.shape[:2]
    labels = np.full((height, width), SKY, np.uint8)
    horizon = (height + 1) // 2
    labels[horizon:] = GROUND
    elevation = None if sun is None else sun.elevation
    over = is_off_daylight_locus(rgb[:horizon], S_in)
    under = is_off_daylight_locus(rgb[horizon:], S_in, elevation, direct_sun=sun is not None)
    labels[np.concatenate([over, under])] = FOREIGN
    if sun is not None:
        # A pixel's half diagonal more: the disc may lie between centres.
        radius = np.radians(sun.angular_radius) + 0.71 * np.pi / height
        labels[directions(height, width) @ sun.direction >= np.cos(radius)] = SUN
    return labels


def outside(
    sky: ArrayLike,
    sun: Sun | None,
    normals: ArrayLike,
    S_in: NDArray[np.float64] | None = None,
) -> Outside:
    """Return where a sky leaves the model, and what that is of the light on normals (m, 3).

    ``sky`` is the panorama without the disc, (rows, 2 rows, 3); ``S_in`` as in `locus_distance`.
    """
    normals = np.asarray(normals, dtype=float)
    rgb = blocks(sky)
    labels = classify(rgb, sun, S_in)
    luminance = rgb @ LUMINANCE
    # What fills the disc's place is sky; the disc itself comes from `sun`.
    groups = (np.isin(labels, (SKY, SUN)), labels == GROUND, labels == FOREIGN)
    masked = np.stack([luminance * group for group in groups], axis=-1)
    light = np.empty((len(normals), len(KINDS)))
    light[:, [SKY, GROUND, FOREIGN]] = exact_irradiance(masked, normals)
    direct = 0.0 if sun is None else float(sun.irradiance @ LUMINANCE)
    light[:, SUN] = 0.0 if sun is None else np.maximum(normals @ sun.direction, 0.0) * direct
    light = np.maximum(light, 0.0)
    total = light.sum(axis=1, keepdims=True)
    return Outside(labels, np.divide(light, total, out=np.zeros_like(light), where=total > 0))


def blocks(sky: ArrayLike) -> NDArray[np.float32]:
    """Return a sky's means over square blocks of pixels, about `_ROWS` rows of them."""
    rgb = np.asarray(sky)
    height = len(rgb)
    size = next(k for k in range(max(1, height // _ROWS), 0, -1) if height % k == 0)
    if size == 1:
        return rgb.astype(np.float32, copy=False)
    rows = height // size
    return rgb.reshape(rows, size, 2 * rows, size, 3).mean(axis=(1, 3), dtype=np.float32)
