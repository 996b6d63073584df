"""What glass does to daylight and to colors: EN 410's quantities and what must hold of them."""

import json

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer import glass

GREEN = 0.75 * np.exp(-(((WAVELENGTHS - 540.0) / 220.0) ** 2))


def test_grey_glass_dims_and_changes_no_color():
    _, rho = colorchecker()
    for part in (0.9, 0.3, 1e-4):
        tau = np.full(81, part)
        assert glass.light_transmittance(tau) == pytest.approx(part)
        assert glass.daylight_rendering(tau) == pytest.approx(100.0)
        np.testing.assert_allclose(glass.colour_shift(tau, rho), 0.0, atol=1e-6)


def test_colored_glass():
    _, rho = colorchecker()
    # By colour-science's D65 and V(λ) at every nanometre: 0.7209.
    assert glass.light_transmittance([GREEN, 0.5 * GREEN]) == pytest.approx([0.7209, 0.3605], 2e-4)
    assert 80.0 < glass.daylight_rendering(GREEN) < 99.0
    shift = glass.colour_shift(GREEN, rho)
    assert shift.shape == (24,) and shift.max() > 1.0
    # Twice the glass, in absorbance, shifts more and renders worse.
    assert glass.daylight_rendering(GREEN**2) < glass.daylight_rendering(GREEN)
    assert (glass.colour_shift(GREEN**2, rho) >= shift).mean() > 0.9
    # What reflects all light alike is seen as white, and grey, behind any glass.
    np.testing.assert_allclose(glass.colour_shift(GREEN, np.full((1, 81), 0.4)), 0.0, atol=1e-6)


def test_glass_that_is_black():
    assert glass.light_transmittance(np.zeros(81)) == 0.0
    assert np.isnan(glass.daylight_rendering(np.zeros(81)))
    assert np.isnan(glass.colour_shift(np.zeros(81), np.ones((2, 81)))).all()


def test_the_command(tmp_path, capsys):
    file = tmp_path / "pane.csv"
    rows = "".join(f"{nm:g},{tau:.6f}\n" for nm, tau in zip(WAVELENGTHS, GREEN, strict=True))
    file.write_text("wavelength_nm,green\n" + rows)
    assert cli.main(["glazing", str(file), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["light_transmittance"] == pytest.approx(glass.light_transmittance(GREEN), rel=1e-4)
    assert found["color_rendering_index"] == pytest.approx(
        glass.daylight_rendering(GREEN), abs=0.01
    )
    assert len(found["materials"]) == 24 and found["panes"] == ["green"]
    assert cli.main(["glazing", str(file), str(file), "--json"]) == 0
    double = json.loads(capsys.readouterr().out)
    # Light that goes to and fro between the panes comes on top of what passes both at once.
    assert double["light_transmittance"] > glass.light_transmittance(GREEN**2)
    assert cli.main(["glazing", str(file)]) == 0
    assert "Ra" in capsys.readouterr().out
    assert cli.main(["glazing", str(tmp_path / "none.csv")]) == 2
    assert "cannot be read" in capsys.readouterr().err
