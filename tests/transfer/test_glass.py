"""Glazing against published panes and the identities of light that goes to and fro."""

import json

import numpy as np
import pytest

from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, WEIGHTS, resample
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.sensitivities import cmfs, observer
from spectral_skylight.addon.transfer.glass import Glazing, panes, uncoated
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.tests.stability.lights import daylight

VISIBLE = cmfs()[1] * WEIGHTS * D65()
VISIBLE = VISIBLE / VISIBLE.sum()
CLEAR = np.full(81, 0.899)
"""3 mm of clear float glass, NFRC: visible transmittance 0.899, reflectance 0.083."""

GREEN = 0.9 * np.exp(-((WAVELENGTHS - 520.0) ** 2) / 2.0 / 120.0**2)


def test_a_pane_keeps_its_measurement():
    for tau in (CLEAR, GREEN, 0.05 * CLEAR):
        found = uncoated(tau)
        np.testing.assert_allclose(found.transmittance, tau, rtol=1e-12)
        assert (tau + found.front <= 1.0).all()


def test_clear_glass_mirrors_as_published():
    # Both surfaces of an index of 1.52, less what the glass swallows.
    assert uncoated(CLEAR).front @ VISIBLE == pytest.approx(0.083, abs=0.004)
    double = panes(uncoated(CLEAR), uncoated(CLEAR))
    # WINDOW's own clear double glazing of 3 mm: 0.814 and 0.150.
    assert double.transmittance @ VISIBLE == pytest.approx(0.814, abs=0.002)
    assert double.front @ VISIBLE == pytest.approx(0.150, abs=0.007)


def test_panes_that_swallow_nothing_lose_nothing():
    for angle in (0.0, 40.0, 80.0):
        clear = uncoated(np.ones(81), np.cos(np.radians(angle)))
        for many in (clear, panes(clear, clear), panes(*[clear] * 5)):
            np.testing.assert_allclose(many.transmittance + many.front, 1.0, rtol=1e-9)


def test_the_order_does_not_count_for_what_passes():
    one, two, three = uncoated(CLEAR), uncoated(GREEN), uncoated(0.5 * CLEAR)
    np.testing.assert_allclose(
        panes(one, two, three).transmittance, panes(three, two, one).transmittance, rtol=1e-12
    )
    np.testing.assert_allclose(panes(one, two).front, panes(two, one).back, rtol=1e-12)
    assert panes(one) is one


def test_light_to_and_fro_is_a_geometric_series():
    rng = np.random.default_rng(2)
    a, b = (Glazing(*rng.uniform(0.0, 0.45, (3, 81))) for _ in range(2))
    passed, returned = np.zeros(81), a.front.copy()
    between = a.transmittance
    for _ in range(60):  # 0.45^120 is left
        passed += between * b.transmittance
        back = between * b.front
        returned += back * a.transmittance
        between = back * a.back
    both = a + b
    np.testing.assert_allclose(both.transmittance, passed, rtol=1e-12)
    np.testing.assert_allclose(both.front, returned, rtol=1e-12)


def test_grazing_light_stays_outside():
    passed = uncoated(CLEAR, np.cos(np.radians([0.0, 30.0, 60.0, 75.0, 89.9]))).transmittance[:, 0]
    # 0 to 60°: clear float glass passes 0.90, 0.90 and 0.82 (ASHRAE Fundamentals 2017, chapter 15).
    np.testing.assert_allclose(passed[:3], [0.90, 0.90, 0.82], atol=0.01)
    assert (np.diff(passed) < 0).all() and passed[-1] < 0.01
    assert uncoated(GREEN, 0.5).transmittance.shape == (81,)


def test_a_published_glazing_has_its_published_transmittance(shared_data):
    """An electrochromic laminate of the IGSDB: its spectrum against NFRC's own integrals."""
    path = shared_data / "reflectance" / "glazing_igsdb" / "igsdb_product_7406.json"
    record = json.loads(path.read_text())
    rows = record["spectral_data"]["spectral_data"]
    nm = 1000.0 * np.array([row["wavelength"] for row in rows])
    found = (resample(nm, [row[name] for row in rows]) @ VISIBLE for name in ("T", "Rf", "Rb"))
    published = record["integrated_results_summary"][0]
    expected = [published[name] for name in ("tfvis", "rfvis", "rbvis")]
    np.testing.assert_allclose(list(found), expected, rtol=1e-4)


def test_behind_glass_the_product_has_its_matrix():
    """As light that was reflected twice: matrices in turn are off, RGB times RGB far off."""
    S, rho, light = observer(), colorchecker()[1], daylight(40.0)
    white, rgb = S @ light, S @ light
    true = (rho * GREEN * light) @ S.T
    mapping = transfer()
    ways = {
        "product": mapping.matrices(rho * GREEN) @ rgb,
        "in turn": mapping.matrices(rho) @ (mapping.matrices(GREEN) @ rgb),
        "RGB": rgb_albedo(rho) * rgb_albedo(GREEN) * white,
    }
    off = {name: delta_E(each, true, white).mean() for name, each in ways.items()}
    assert off["product"] < 0.15
    assert off["in turn"] > 3.0 * off["product"] and off["RGB"] > 3.0 * off["product"]
