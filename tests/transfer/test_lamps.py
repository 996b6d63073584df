"""Lamps by name, temperature, file and colour, and what it costs to take them together."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, WEIGHTS
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.sensitivities import cmfs, observer
from spectral_skylight.addon.spectra.working_spaces import WORKING_SPACES
from spectral_skylight.addon.transfer.lamps import black_body, classes, lamp_spectrum
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.tests.stability.lights import source

RHO = colorchecker()[1]
S = observer()
Y = cmfs()[1] * WEIGHTS


def test_black_bodies_are_plancks():
    import colour

    for kelvin in (1000.0, 2856.0, 6500.0):
        theirs = colour.sd_blackbody(kelvin, colour.SpectralShape(380, 780, 5)).values
        ours = black_body(kelvin)
        # Its c2 is rounded to 1.4388e-2: 1.6e-5 of an exponent that is 38 at most.
        np.testing.assert_allclose(ours / ours[40], theirs / theirs[40], rtol=6e-4)


def test_names_temperatures_and_files(tmp_path):
    for name in ("A", "FL11", "HPS"):
        np.testing.assert_allclose(lamp_spectrum(name), source(name) / (Y @ source(name)))
    np.testing.assert_array_equal(lamp_spectrum("led-b3"), lamp_spectrum("LED-B3"))
    np.testing.assert_array_equal(lamp_spectrum("2700 K"), lamp_spectrum(2700))
    # CIE A is Planck's at 2848 K on the scale of 1931, 2855.5 K on today's, to its printed digits.
    np.testing.assert_allclose(lamp_spectrum(2855.5), lamp_spectrum("A"), rtol=1e-3)
    path = tmp_path / "lamps.csv"
    rows = np.stack([WAVELENGTHS, 40.0 * lamp_spectrum("FL2"), lamp_spectrum("HP1")], axis=1)
    np.savetxt(path, rows, delimiter=",", header="wavelength_nm,tube,street", comments="")
    np.testing.assert_allclose(lamp_spectrum(f"{path}:tube"), lamp_spectrum("FL2"), rtol=1e-8)
    for lamp, problem in (
        (f"{path}", "no column"),
        (f"{path}:bulb", "no column 'bulb'"),
        ("Moonshine", "not a file, a temperature or a known lamp"),
        (100.0, "100 K"),
        ((0.0, 0.0, 0.0), "is not a light"),
        ((1.0, 2.0), "is not a light"),
        ((1.0, np.nan, 1.0), "is not a light"),
    ):
        with pytest.raises(InputError, match=problem):
            lamp_spectrum(lamp)


@pytest.mark.parametrize("space", WORKING_SPACES)
def test_a_colour_is_met(space):
    for rgb in ((1.0, 1.0, 1.0), (5.0, 2.5, 0.5), (0.1, 0.2, 1.0), (1.0, 0.3, 0.9)):
        spectrum = lamp_spectrum(rgb, space)
        assert (spectrum > 0).all()
        np.testing.assert_allclose(observer(space) @ spectrum, rgb, atol=1e-8 * max(rgb))


def test_primaries_that_no_light_has_are_paled():
    """Rec.2020's are single wavelengths, ACEScg's green is none at all."""
    for space, least in (("Linear Rec.709", 1.0), ("Linear Rec.2020", 0.97), ("ACEScg", 0.9)):
        for rgb in np.eye(3):
            shown = observer(space) @ lamp_spectrum(rgb, space)
            assert shown @ rgb >= least - 1e-9 and shown.sum() == pytest.approx(1.0)


def test_colours_of_usual_lamps_give_their_light():
    white = lamp_spectrum((1.0, 1.0, 1.0))
    np.testing.assert_allclose(white, D65() / (Y @ D65()) * (Y @ white), rtol=2e-3)
    bulb = lamp_spectrum(S @ lamp_spectrum(2900))
    # Temperatures lie 5 mired apart: 20 K off at this one, and the colour is put right.
    np.testing.assert_allclose(bulb, lamp_spectrum(2900), rtol=0.01)


def test_lamps_of_one_light_are_one():
    same = [2.0 * lamp_spectrum(3000), lamp_spectrum(3000), lamp_spectrum(3001)]
    found = classes(same, [1.0, 5.0, 1.0], RHO)
    assert found.assignment.tolist() == [0, 0, 0] and found.line == ""
    assert found.cost.max() < 0.1
    np.testing.assert_allclose(found.spectra @ Y, 1.0)


def test_two_lamps_stay_two():
    found = classes([lamp_spectrum("A"), lamp_spectrum("FL11")], [1.0, 1.0], RHO)
    assert sorted(found.assignment) == [0, 1] and found.line == ""
    np.testing.assert_allclose(found.cost, 0.0, atol=1e-10)


def test_what_merging_costs_is_said():
    names = ["bulb", "street", "halogen"]
    lamps = [lamp_spectrum(lamp) for lamp in (2700, "HPS", 3000)]
    found = classes(lamps, [1.0, 1.0, 1.0], RHO, names=names)
    assert found.assignment[0] == found.assignment[2] != found.assignment[1]
    np.testing.assert_allclose(found.cost[1], 0.0, atol=1e-10)
    mean, worst = found.cost[[0, 2]].max(axis=0)
    assert found.line == (
        f"bulb, halogen share one spectrum: ΔE {mean:.1f} in the mean, {worst:.1f} at worst"
    )
    # A bulb beside a halogen lamp is a tint, a street lamp beside either another world.
    assert 1.0 < mean < 4.0
    one = classes(lamps, [1.0, 1.0, 1.0], RHO, most=1, names=names)
    assert one.cost[1, 0] > 10.0
    # The stronger lamp keeps the better part.
    strong = classes(lamps, [1.0, 20.0, 1.0], RHO, most=1)
    assert strong.cost[1, 0] < 0.3 * one.cost[1, 0]
    np.testing.assert_allclose(
        one.cost[1],
        [seen_as(one.spectra[0], lamps[1]).mean(), seen_as(one.spectra[0], lamps[1]).max()],
    )


def seen_as(one, other):
    """CIEDE2000 of materials, white among them, under one light for another."""
    rho = np.vstack([RHO, np.ones(81)])
    return delta_E((rho * one) @ S.T, (rho * other) @ S.T, S @ other)
