"""A panorama of spectral radiance as the observer sees it, and its spectra in short."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..spectra.grid import STEP, WAVELENGTHS, band_average
from ..spectra.sensitivities import observer
from ..spectra.sorting import median
from .clear_sky import SCALE
from .known_spectrum import KnownSpectrum, cell_means
from .lat_long import directions, solid_angles
from .sun import Sun, separate_sun

LIMITS = 420.0, 680.0
"""[nm] that spectra must reach: beyond, the eye sees a thousandth."""

WIDEST = 50.0
"""[nm] between two samples. Farther apart they miss what ozone and air do to light."""

MOST = 1 << 31
"""Bytes of spectra at once: 2048 x 1024 pixels at 240 wavelengths."""

_AROUND = 3
"""Pixels around the sun's disc that tell the sky behind it."""


def check_wavelengths(wavelengths: NDArray[np.float64], place: object) -> None:
    """Raise `InputError` where ascending wavelengths (n,) [nm] leave out what the eye sees."""
    low, high = LIMITS
    if wavelengths[0] > low or wavelengths[-1] < high:
        raise InputError(
            place,
            f"its spectra reach from {wavelengths[0]:g} to {wavelengths[-1]:g} nm",
            f"save them from {low:g} to {high:g} nm at least",
        )
    gaps = np.diff(wavelengths)
    gaps[(wavelengths[1:] <= low) | (wavelengths[:-1] >= high)] = 0.0
    widest = int(np.argmax(gaps))
    if gaps[widest] > WIDEST:
        raise InputError(
            place,
            f"its spectra have nothing from {wavelengths[widest]:g} to "
            f"{wavelengths[widest + 1]:g} nm",
            f"save a wavelength every {WIDEST:g} nm at least",
        )


def check_amount(place: object, pixels: tuple[int, int], count: int) -> None:
    """Raise `InputError` for more spectra of ``count`` samples than are read at once."""
    width, height = pixels
    if 4 * count * width * height > MOST:
        raise InputError(
            place,
            f"holds {width} x {height} pixels at {count} wavelengths, too many to read at once",
            "make it smaller: spectra need fewer pixels than a background",
        )


def to_grid(wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix (81, n) from samples at ascending wavelengths (n,) [nm] to the grid.

    Straight lines between samples, the end values beyond; where these are finer than the grid,
    their means under its hats.
    """
    samples = np.eye(wavelengths.size)
    if median(np.diff(wavelengths)) < STEP / 2:
        return band_average(wavelengths, samples).T
    return np.array([np.interp(WAVELENGTHS, wavelengths, one) for one in samples]).T


def spectral_sky(
    radiance: NDArray[np.float32], onto: NDArray[np.float64], place: object
) -> tuple[NDArray[np.float32], KnownSpectrum]:
    """Return a panorama (h, 2 h, n) in Linear Rec.709, (h, 2 h, 3), and its spectra.

    ``onto`` (81, n): from its samples to radiance on the grid [W m^-2 sr^-1 nm^-1]; RGB 1 is then
    `clear_sky.WHITE_LUMINANCE`. The samples of the sun's disc are filled in place. Raises
    `InputError` for samples that are no numbers.
    """
    for k in range(radiance.shape[2]):
        finite = np.isfinite(radiance[..., k])
        if not finite.all():
            y, x = np.argwhere(~finite)[0]
            count = finite.size - int(finite.sum())
            raise InputError(
                place,
                f"{count} numbers of spectral channel {k + 1} are not finite, the first at x = {x},"
                f" y = {y} from the top left",
                "repair them in a picture editor",
            )
    seen = (observer() * SCALE @ onto).T.astype(np.float32)
    rgb = radiance @ seen
    sky, sun = separate_sun(rgb)
    found = None
    if sun is not None:
        found = _sun_spectrum(radiance, np.nonzero((sky != rgb).any(axis=2)), sun, onto * SCALE)
    cells = cell_means(radiance) @ (onto.T * SCALE)
    return rgb, KnownSpectrum(cells, found, None if sun is None else sun.direction)


def _sun_spectrum(
    radiance: NDArray[np.float32],
    disc: tuple[NDArray[np.intp], ...],
    sun: Sun,
    onto: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Take the sun out of its disc's pixels; return its irradiance / pi, (81,)."""
    height, width = radiance.shape[:2]
    rows, columns = disc
    inside = set(zip(rows.tolist(), columns.tolist(), strict=True))
    reach = range(-_AROUND, _AROUND + 1)
    around = {
        (min(max(row + down, 0), height - 1), (column + across) % width)
        for row, column in inside
        for down in reach
        for across in reach
    }
    y, x = np.array(sorted(around - inside)).T
    fill = np.median(radiance[y, x], axis=0)
    towards = directions(height, width)[rows, columns] @ sun.direction
    weight = np.maximum(towards, 0.0) * solid_angles(height, width)[rows] / np.pi
    excess = weight @ (radiance[rows, columns].astype(float) - fill)
    radiance[rows, columns] = fill
    return np.maximum(onto @ excess, 0.0)
