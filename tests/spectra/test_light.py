"""Measured light as files have it: any grid and unit gives the same spectrum, or one clear line."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.light import read_light

BETWEEN = 0.004
"""Of a smooth spectrum's largest value: what a grid of up to 20 nm leaves unknown between."""


def smooth(nm):
    return 0.3 + np.exp(-(((np.asarray(nm, float) - 500.0) / 150.0) ** 2))


def text(nm, *columns, head="wavelength,sky", separator=",", scale=1.0):
    rows = np.column_stack([np.asarray(nm) * scale, *columns])
    return "\n".join([head, *(separator.join(f"{v:.10g}" for v in row) for row in rows)])


COARSE = np.arange(380, 781, 10)
SHORT = np.arange(400, 701, 5)
UNEVEN = np.r_[395.0, 400.0 + np.cumsum(np.tile([3.3, 17.0, 0.7, 9.1], 12))[:41], 715.0]
FINE = np.arange(360, 831, 1)


@pytest.mark.parametrize(
    "written",
    [
        text(COARSE, smooth(COARSE)),
        text(SHORT, smooth(SHORT)),
        text(UNEVEN, smooth(UNEVEN)),
        text(FINE, 1e-4 * smooth(FINE)),
        text(COARSE, smooth(COARSE), head="wavelength_um,sky", scale=1e-3),
        text(COARSE, smooth(COARSE), head="Wellenlänge [nm];E", separator=";").replace(".", ","),
        "# noon, a clear sky\n# 12 June\n" + text(SHORT, smooth(SHORT)),
        text(COARSE, COARSE * smooth(COARSE), head="nm,Photon flux [µmol/m²/s/nm]"),
    ],
    ids=["10 nm", "5 nm", "uneven", "1 nm", "um", "decimal commas", "comments", "photons"],
)
def test_any_grid_and_unit_gives_the_same_spectrum(tmp_path, written):
    path = tmp_path / "light.csv"
    path.write_text(written, encoding="utf-8")
    (values,) = read_light(path).values
    inside = (WAVELENGTHS >= 400) & (WAVELENGTHS <= 700)
    values, true = values[inside], smooth(WAVELENGTHS[inside])
    scale = values @ true / (true @ true)
    np.testing.assert_allclose(values / scale, true, atol=BETWEEN * true.max())


def test_decimal_commas_between_commas_are_no_columns(tmp_path):
    path = tmp_path / "light.csv"
    path.write_text(text(COARSE, smooth(COARSE), head="nm,E").replace(".", ","))
    with pytest.raises(InputError, match="'unnamed': has no heading; .*semicolons"):
        read_light(path)


def test_each_column_is_a_spectrum(tmp_path):
    path = tmp_path / "light.csv"
    path.write_text(text(SHORT, smooth(SHORT), SHORT / 500.0, head="nm,noon,dusk"))
    light = read_light(path)
    assert light.names == ("noon", "dusk")
    assert not np.allclose(*light.values, rtol=0.05)


def test_it_must_cover_what_the_eye_sees(tmp_path):
    path = tmp_path / "light.csv"
    path.write_text(text(np.arange(380, 626, 5), np.ones(50)))
    with pytest.raises(InputError, match="covers 380-625 nm"):
        read_light(path)
    gap = np.r_[WAVELENGTHS[:20], WAVELENGTHS[26:]]
    path.write_text(text(gap, np.ones(gap.size)))
    with pytest.raises(InputError, match="a gap from 475 to 510 nm"):
        read_light(path)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_noise_of_a_dark_sky_is_light_and_a_difference_is_none(tmp_path, sign):
    path = tmp_path / "light.csv"
    noise = np.random.default_rng(2).normal(0.0, 0.02, WAVELENGTHS.size)
    path.write_text(text(WAVELENGTHS, smooth(WAVELENGTHS) * (WAVELENGTHS < 700) + sign * noise))
    assert read_light(path).values.min() < 0
    # D. B. Judd 1964: the second component of daylight, which turns its sign (CIE 15).
    path.write_text(text(WAVELENGTHS, D65() - D65()[::-1] + 0.2 * D65()))
    with pytest.raises(InputError, match="is negative"):
        read_light(path)


@pytest.mark.parametrize(
    ("head", "quantity"),
    [
        ("nm,Reflectance (%)", "reflectance"),
        ("nm,Transmission [%]", "transmittance"),
        ("nm,Absorbance", "absorbance"),
        ("nm,StdDev", "deviations"),
    ],
)
def test_what_is_said_to_be_no_light_is_refused(tmp_path, head, quantity):
    path = tmp_path / "light.csv"
    path.write_text(text(SHORT, smooth(SHORT), head=head))
    with pytest.raises(InputError, match=f"holds {quantity}, not light"):
        read_light(path)
    path.write_text(text(SHORT, smooth(SHORT), head="nm,Counts"))
    assert len(read_light(path).values) == 1
