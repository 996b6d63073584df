"""What the gases of the air absorb in the visible.

Ozone follows Beer's law: its bands (Huggins under 380 nm, Chappuis around 600 nm) are smooth.
Water vapour and oxygen absorb in lines much narrower than the grid, so that their transmittance
falls with the square root of the column rather than exponentially; a band model stands for them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.grid import STEP, WAVELENGTHS, band_average

DOBSON = 2.6867e20
"""[molecules/m^2] in one Dobson unit."""

_OZONE_BINS = np.arange(360.0, 841.0, 10.0)
# fmt: off
_OZONE = 1e-28 * np.array([
    # 360 to 830 nm
    11.8, 2.182, 2.818, 6.636, 15.27, 27.63, 55.2, 84.51, 158.2, 231.6, 366.9, 492.4, 775.2,
    901.6, 1480.0, 1602.0, 2139.0, 2755.0, 3091.0, 3500.0, 4266.0, 4672.0, 4398.0, 4701.0, 5019.0,
    4305.0, 3740.0, 3215.0, 2662.0, 2238.0, 1852.0, 1473.0, 1209.0, 942.3, 745.5, 656.6, 510.5,
    415.0, 422.8, 323.7, 245.1, 280.1, 253.4, 162.4, 146.5, 207.8, 138.3, 71.05,
])
# fmt: on


@cache
def ozone_cross_section() -> NDArray[np.float64]:
    """Return the absorption cross-section of ozone at 233 K on the grid, (81,) [m^2].

    Serdyuchenko et al. 2014 (DOI 10.5194/amt-7-625-2014), means over 10 nm as E. Bruneton
    tabulates them ("Precomputed Atmospheric Scattering: a New Implementation", 2017). The curve
    between them is a spline through the running integral, which keeps those means.
    """
    integral = np.concatenate([[0.0], np.cumsum(_OZONE)])
    # A natural cubic spline of the integral; its slope is the cross-section.
    count = integral.size
    system = np.diag(np.full(count, 4.0)) + np.diag(np.ones(count - 1), 1)
    system += np.diag(np.ones(count - 1), -1)
    system[0, 0] = system[-1, -1] = 2.0
    rises = np.diff(integral)
    right = 3.0 * np.concatenate([rises[:1], rises[1:] + rises[:-1], rises[-1:]])
    slope = np.linalg.solve(system, right)
    fine = np.arange(_OZONE_BINS[0], _OZONE_BINS[-1], STEP / 10)
    k = ((fine - _OZONE_BINS[0]) / 10.0).astype(int)
    u = (fine - _OZONE_BINS[k]) / 10.0
    curve = slope[k] * (1 - u) * (1 - 3 * u) + slope[k + 1] * u * (3 * u - 2)
    curve += 6 * u * (1 - u) * rises[k]
    result = np.maximum(band_average(fine, curve), 0.0)
    result.flags.writeable = False
    return result


_WATER = (
    "505:.0118 510:.0036 525:.00209 530:.00807 535:.00318 545:.00683 550:.0042 555:.00245 "
    "560:.00639 565:.0156 570:.0233 575:.039 580:.0256 585:.0371 590:.23 595:.18 600:.0404 "
    "605:.00729 615:.00501 640:.0114 645:.0319 650:.0948 655:.0665 660:.0926 665:.0594 "
    "670:.00265 700:.286 705:.168 710:.0601 715:.512 720:3.59 725:3.1 730:2.15 735:.403 "
    "740:.0711 745:.00403"
)
_OXYGEN = (
    "475:.00366 480:.00339 570:.0056 575:.00937 580:.00615 620:.00768 625:.0358 630:.056 "
    "635:.0107 685:.118 690:.587 695:.137 755:.00391 760:5.83 765:5.34 770:.0806"
)


@cache
def band_absorption() -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return where on the grid water and oxygen absorb, (b,), and how strongly there, (2, b).

    The coefficients a of `band_transmittance` [1/cm of water], [1/atmosphere of oxygen]. Found
    from ASTM G173-03's direct and extraterrestrial spectra (SMARTS 2.9.2, air mass 1.5, 14.2 mm
    of water), averaged on the grid, after air, haze and ozone had been divided out. The pairs of
    oxygen molecules that absorb around 477 and 577 nm are counted with oxygen.
    """
    strengths = np.zeros((2, WAVELENGTHS.size))
    for row, text in zip(strengths, (_WATER, _OXYGEN), strict=True):
        for entry in text.split():
            wavelength, strength = entry.split(":")
            row[np.searchsorted(WAVELENGTHS, float(wavelength))] = float(strength)
    where = np.flatnonzero(strengths.any(axis=0))
    return where, strengths[:, where]


def band_depth(columns: ArrayLike) -> NDArray[np.float64]:
    """Return the optical depth of water and oxygen along a way, at `band_absorption`'s nodes.

    ``c a M / (1 + d a M)^0.45`` after Leckner, equations 2-8 and 2-11 of Bird and Riordan 1984,
    "Simple solar spectral model" (DOI 10.2172/5986936): linear in a thin, near the square root in
    a thick column. Not additive: ``columns`` (..., 2) [cm of water, atmospheres of oxygen] are
    those of the whole way from the sun to the eye. Returns (..., b).
    """
    columns = np.asarray(columns, dtype=float)
    depth = np.zeros((*columns.shape[:-1], band_absorption()[0].size))
    for kind, (at, c, d) in enumerate(_laws()):
        column = columns[..., kind, None]
        depth[..., at] += (c * column) * (1.0 + d * column) ** -0.45
    return depth


@cache
def _laws() -> list[tuple[NDArray, NDArray, NDArray]]:
    """Return for water and for oxygen where they absorb and what multiplies their columns there."""
    _, strengths = band_absorption()
    laws = ((0.2385, 20.07), (1.41, 118.3))
    at = [np.flatnonzero(strength) for strength in strengths]
    return [
        (at[k], c * strengths[k][at[k]], d * strengths[k][at[k]]) for k, (c, d) in enumerate(laws)
    ]
