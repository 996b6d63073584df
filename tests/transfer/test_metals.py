"""Metals: Fresnel's limits, published colours, and the shader's curve."""

import numpy as np
import pytest

from spectral_skylight.addon.spectra.grid import WAVELENGTHS, resample
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.refraction import read_nk
from spectral_skylight.addon.transfer.metals import EDGE, conductor, tints
from spectral_skylight.addon.transfer.prefilter import prefiltered


def schlick_82(F0, tint, cosine):
    """Return the curve that shaders draw between F0 and an edge tint, (..., c), for colours (c,).

    Schlick's, less what makes it ``tint`` times its own value at 82°: Blender's F82 Tint.
    C. Kutz, M. Hašan and J. Edmondson 2021, "Novel aspects of the Adobe Standard Material", after
    N. Hoffman. Linear in F0, and in the product of tint and its value at 82°.
    """
    cosine = np.asarray(cosine, dtype=float)[..., None]
    F0 = np.asarray(F0, dtype=float)
    plain = F0 + (1.0 - F0) * (1.0 - cosine) ** 5
    at_edge = (F0 + (1.0 - F0) * (1.0 - EDGE) ** 5) * (1.0 - np.asarray(tint, dtype=float))
    return plain - at_edge * cosine * (1.0 - cosine) ** 6 / (EDGE * (1.0 - EDGE) ** 6)


def edge_tint(n, k):
    """Return the tint of `schlick_82` by wavelength, (81,): Fresnel over Schlick at 82°."""
    F0 = conductor(n, k)
    return conductor(n, k, EDGE) / (F0 + (1.0 - F0) * (1.0 - EDGE) ** 5)


# Johnson and Christy 1972 (DOI 10.1103/PhysRevB.6.4370), copper: photon energy [eV], n, k.
_COPPER = np.array(
    [
        (1.51, 0.26, 5.18), (1.64, 0.22, 4.67), (1.76, 0.21, 4.205), (1.88, 0.22, 3.747),
        (2.01, 0.30, 3.205), (2.14, 0.70, 2.704), (2.26, 1.02, 2.577), (2.38, 1.18, 2.608),
        (2.50, 1.22, 2.564), (2.63, 1.25, 2.483), (2.75, 1.24, 2.397), (2.88, 1.25, 2.305),
        (3.00, 1.28, 2.207), (3.12, 1.32, 2.116), (3.25, 1.33, 2.045), (3.37, 1.36, 1.975),
    ]
)  # fmt: skip
COPPER = resample(1239.84 / _COPPER[::-1, 0], _COPPER[::-1, 1:])
ANGLES = np.cos(np.radians(np.linspace(0.0, 89.0, 90)))


def test_at_normal_incidence_it_is_the_textbooks_quotient():
    n, k = COPPER
    expected = ((n - 1.0) ** 2 + k**2) / ((n + 1.0) ** 2 + k**2)
    np.testing.assert_allclose(conductor(n, k), expected, rtol=1e-12)


def test_a_dielectric_mirrors_as_glass_does():
    np.testing.assert_allclose(conductor(np.full(81, 1.5), 0.0), 0.04, rtol=1e-12)
    np.testing.assert_allclose(conductor(1.5, 0.0, 0.0), 1.0)
    # At Brewster's angle one polarisation goes in whole; the other's half is ((n²-1)/(n²+1))² / 2.
    brewster = np.cos(np.arctan(1.5))
    half = 0.5 * ((1.5**2 - 1) / (1.5**2 + 1)) ** 2
    np.testing.assert_allclose(conductor(1.5, 0.0, brewster), half, rtol=1e-12)


def test_all_is_mirrored_in_the_end():
    mirrored = conductor(*COPPER, ANGLES)
    assert mirrored.shape == (90, 81) and mirrored.min() > 0.0 and mirrored.max() < 1.0
    np.testing.assert_allclose(conductor(*COPPER, 0.0), 1.0)


def test_copper_has_its_published_colour():
    """N. Hoffman's table in "Real-Time Rendering", 4th edition (2018), table 9.2: linear Rec.709.

    Samples differ: other tables of n and k are up to 0.09 away in red.
    """
    F0, _ = tints(*COPPER, D65())
    np.testing.assert_allclose(F0, [0.955, 0.638, 0.538], atol=0.025)


@pytest.mark.parametrize(
    ("record", "published", "within"),
    [
        ("Cr_nk_Johnson", (0.549, 0.556, 0.554), 0.002),
        ("Al_nk_Rakic", (0.913, 0.922, 0.924), 0.007),
        # Films of other years and makers.
        ("Ni_nk_Johnson", (0.660, 0.609, 0.526), 0.04),
        ("Au_nk_Johnson", (1.000, 0.782, 0.344), 0.06),
        ("Ag_nk_Johnson", (0.972, 0.960, 0.915), 0.07),
    ],
)
def test_metals_have_their_published_colours(shared_data, record, published, within):
    folder = shared_data / "reflectance" / "refractiveindex_info" / "original_yml"
    F0, tint = tints(*read_nk(folder / f"main_{record}.yml"), D65())
    np.testing.assert_allclose(F0, published, atol=within)
    assert (tint > 0.7).all() and (tint < 1.01).all()


def test_the_shaders_curve_is_fresnels_at_both_angles_and_near_it_between():
    exact = conductor(*COPPER, ANGLES)
    curve = schlick_82(conductor(*COPPER), edge_tint(*COPPER), ANGLES)
    np.testing.assert_allclose(curve[0], exact[0], rtol=1e-12)
    at_edge = schlick_82(conductor(*COPPER), edge_tint(*COPPER), EDGE)
    np.testing.assert_allclose(at_edge, conductor(*COPPER, EDGE), rtol=1e-12)
    # Between them copper is off by 0.04 in the blue, where it mirrors like a dielectric.
    assert np.abs(curve - exact).max() < 0.05
    in_colour = schlick_82(*tints(*COPPER, D65()), ANGLES)
    seen = prefiltered(exact, D65())
    assert np.abs(in_colour - seen).max() < 0.015
    # Without the tint it is Schlick's curve, three times as far off.
    assert np.abs(schlick_82(tints(*COPPER, D65())[0], 1.0, ANGLES) - seen).max() > 0.035


def test_tints_are_of_their_light():
    warm = np.where(WAVELENGTHS > 550.0, 1.0, 0.3)
    assert not np.allclose(tints(*COPPER, warm)[0], tints(*COPPER, D65())[0], atol=0.01)
    np.testing.assert_allclose(tints(*COPPER, D65())[0], prefiltered(conductor(*COPPER), D65()))
