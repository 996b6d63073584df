"""Bounds that hold for any material and any light.

Let R be the restoration, so that S R = I: the three numbers are kept. A light s leaves the residual
r = s - R S s, which has no numbers of its own, S r = 0. A material rho makes of it the error

    e_i = sum_k S_ik rho_k r_k = sum_k g_ik rho_k    with  g_ik = S_ik r_k  and  sum_k g_ik = 0.

*Range.* Any constant c may be taken from rho, for sum_k g_ik c = 0; with the middle of its range

    |e_i| <= (max rho - min rho) / 2  sum_k |g_ik|.

*Slope and variation.* Summed by parts with G_ik = g_i1 + ... + g_ik, whose last is 0,
e_i = - sum_k G_ik (rho_k+1 - rho_k), so

    |e_i| <= max_k |rho_k+1 - rho_k|  sum_k |G_ik|      and
    |e_i| <= sum_k |rho_k+1 - rho_k|  max_k |G_ik|.

Nothing in them is fitted. The first is reached by a reflectance (rho = 1 where g_i > 0, else 0).
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spectral_skylight.addon.spectra import bases
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.tests.stability.lights import (
    LEAVES,
    S,
    bright,
    daylight,
    skylight,
    source,
    true,
)

ROUNDING = 1e-12
"""Of sums of 81 float64 products of order 1 after a 3x3 solution of condition 26: 81 * 26 * 1e-16,
four times."""

PARTS = [bright(function) for function in bases.rayleigh()]
FOREIGN = [
    source("HPS"),
    source("LED-B1"),
    bright(daylight(40.0) * LEAVES),
    skylight(-5.0),
]
MAPPING = {name: transfer(name) for name in bases.BASES}

some = settings(max_examples=60, deadline=None)
unit = st.floats(0.0, 1.0)
rough = arrays(float, WAVELENGTHS.size, elements=unit)


@st.composite
def smooth(draw):
    """Straight lines between values every 50 nm."""
    knots = np.linspace(380.0, 780.0, 9)
    return np.interp(WAVELENGTHS, knots, draw(arrays(float, knots.size, elements=unit)))


physical = arrays(float, 3, elements=st.floats(0.0, 1.0)).filter(lambda share: share.sum() > 0.01)


def error(mapping, light, rho):
    return mapping.matrices(rho) @ (mapping.S_in @ light) - true(light, rho[None])[0, 0]


def residual_parts(mapping, light):
    """g and G of the text above, (3, 81)."""
    g = S * (light - mapping.restoration @ (mapping.S_in @ light))
    return g, np.cumsum(g, axis=1)


@given(physical, st.one_of(rough, smooth()))
@some
def test_physical_mixtures_are_exact(share, rho):
    """Sunlight, scattered once and twice, in any amounts, on any material at all."""
    light = share @ PARTS
    assert np.abs(error(MAPPING["rayleigh"], light, rho)).max() <= ROUNDING * share.sum()


@given(
    physical,
    st.sampled_from(range(len(FOREIGN))),
    st.floats(0.0, 1.0),
    st.one_of(rough, smooth()),
    st.sampled_from(list(MAPPING)),
)
@some
def test_any_light_on_any_material(share, foreign, part, rho, basis):
    """All three bounds, with any part of the light foreign."""
    light = (1.0 - part) * share @ PARTS + part * FOREIGN[foreign]
    mapping = MAPPING[basis]
    off = np.abs(error(mapping, light, rho))
    g, G = residual_parts(mapping, light)
    np.testing.assert_allclose(G[:, -1], 0.0, atol=ROUNDING)
    step = np.abs(np.diff(rho))
    for bound in (
        np.ptp(rho) / 2.0 * np.abs(g).sum(axis=1),
        step.max() * np.abs(G).sum(axis=1),
        step.sum() * np.abs(G).max(axis=1),
    ):
        assert (off <= bound + ROUNDING).all()


@given(physical, st.sampled_from(range(len(FOREIGN))), st.floats(0.0, 0.5), rough)
@some
def test_the_error_grows_as_the_foreign_part_does(share, foreign, part, rho):
    """With the paper's basis its own light leaves nothing: e = part * e(foreign light alone)."""
    own = (1.0 - part) * share @ PARTS
    mapping = MAPPING["rayleigh"]
    np.testing.assert_allclose(
        error(mapping, own + part * FOREIGN[foreign], rho),
        part * error(mapping, FOREIGN[foreign], rho),
        atol=4 * ROUNDING,
    )


@given(rough, st.sampled_from(list(MAPPING)))
@some
def test_no_entry_is_larger_than_said(rho, basis):
    mapping = MAPPING[basis]
    assert np.abs(mapping.matrices(rho)).max() <= mapping.largest + ROUNDING


@given(rough, arrays(float, 3, elements=st.floats(-0.05, 0.05)))
@some
def test_noise_grows_no_more_than_the_rows_allow(rho, noise):
    """|M dE|_i <= sum_j |M_ij| |dE_j| <= 3 largest max |dE|."""
    mapping = MAPPING["rayleigh"]
    E = S @ daylight(40.0)
    moved = np.abs(mapping.matrices(rho) @ (E * noise))
    assert (moved <= 3.0 * mapping.largest * np.abs(E * noise).max() + ROUNDING).all()


def test_the_bound_is_reached():
    """A bound that no material comes near would be worth little."""
    g, _ = residual_parts(MAPPING["rayleigh"], skylight(-5.0))
    for channel in range(3):
        worst = (g[channel] > 0).astype(float)
        off = error(MAPPING["rayleigh"], skylight(-5.0), worst)[channel]
        assert abs(off) == pytest.approx(np.abs(g[channel]).sum() / 2.0, abs=ROUNDING)


def test_what_the_bounds_are_worth(keep):
    """For any material there is, relative to the white diffuser's luminance of 1."""
    luminance = np.array([0.2126, 0.7152, 0.0722])
    lights = {
        "clear sky, sun at 40°": skylight(40.0),
        "sky, sun at -5°": skylight(-5.0),
        "light off leaves": FOREIGN[2],
        "sodium light": FOREIGN[0],
    }
    limits = {}
    for name, light in lights.items():
        r = light - MAPPING["rayleigh"].restoration @ (S @ light)
        g = (luminance @ S) * r
        limits[name] = np.abs(g).sum() / 2.0, 0.02 * np.abs(np.cumsum(g)).sum()
        keep(
            f"any material under {name}, `rayleigh`",
            f"its luminance is off by at most {100 * limits[name][0]:.2g} % of white's; by "
            f"{100 * limits[name][1]:.2g} % where reflectance changes by at most 0.02 in 5 nm",
            "nothing to do: derived, see test_bounds.py",
        )
    ordered = [limits[name][0] for name in lights]
    assert ordered == sorted(ordered)  # the further from the model, the less is promised
    assert ordered[0] < 0.02 and ordered[3] > 0.2
