"""Materials that are hard to hold."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.transfer.known_light import KnownLight
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E, relative_error
from spectral_skylight.addon.transfer.prediction import predict
from spectral_skylight.tests.stability.lights import (
    CHECKER,
    NAMES,
    S,
    daylight,
    errors,
    skylight,
    source,
    true,
)

LIGHTS = np.stack([skylight(40.0), daylight(40.0), daylight(10.0)])
BLUE = skylight(40.0)


def band(middle, width):
    """A reflectance of 0.9 in one band and 0.02 elsewhere, with edges as steep as the grid."""
    return np.where(np.abs(WAVELENGTHS - middle) <= width / 2, 0.9, 0.02)


def step(edge, up):
    return np.where((edge < WAVELENGTHS) == up, 0.9, 0.02)


def test_narrow_bands_and_steps(keep):
    """The sharper a reflectance, the less the eye's three curves tell of the light in it."""
    bands = np.array([band(middle, 20.0) for middle in range(420, 681, 20)])
    steps = np.array([step(edge, up) for edge in range(440, 661, 20) for up in (True, False)])
    for rho, what, under in ((bands, "bands of 20 nm", 0.7), (steps, "steps", 0.4)):
        ours, today = errors(LIGHTS, rho=rho), errors(LIGHTS, "rgb", rho=rho)
        # Still far better than today's way, though some times worse than on paints.
        assert ours.mean() < under and ours.mean() < today.mean() / 3.0
        assert ours.mean() > 1.2 * errors(LIGHTS).mean()
        expected = [
            predict(transfer(), each, KnownLight(LIGHTS @ S.T)).matrix.mean()
            for each in (rho, CHECKER)
        ]
        assert expected[0] > 1.2 * expected[1]
        keep(
            f"reflectances of {what}, 420 to 680 nm",
            f"ΔE {ours.mean():.2f}, at most {ours.max():.1f}; RGB × RGB "
            f"{today.mean():.1f}, at most {today.max():.0f}",
            f"predicts each material's own error: {expected[0]:.2f}, for paints {expected[1]:.2f}",
        )


def test_near_black(keep):
    """M is linear in the reflectance: relative errors stay, ΔE fades.

    In its toe L* falls as Y does: from Y = 0.2 to a hundredth of it, an error's part in it shrinks
    thirteen times, that of darker paints less.
    """
    mapping = transfer()
    light = S @ BLUE
    for dark in (0.1, 0.01):
        rho = dark * CHECKER
        estimate, right = mapping.matrices(rho) @ light, true(BLUE, rho)[0]
        bright_error = relative_error(mapping.matrices(CHECKER) @ light, true(BLUE)[0])
        np.testing.assert_allclose(relative_error(estimate, right), bright_error, rtol=1e-9)
    off = errors(BLUE, rho=rho).mean()
    assert off < 0.25 * errors(BLUE).mean()
    keep("near black: a hundredth of the ColorChecker", f"ΔE {off:.3f}", "nothing to do")


def test_black_is_black():
    mapping = transfer()
    assert not mapping.matrices(np.zeros(81)).any()


def test_saturated_colours_leave_the_gamut(keep):
    """Cyan's red is negative in Rec.709; the matrix keeps it, Blender's emission clamps it."""
    cyan, orange = NAMES.index("cyan"), NAMES.index("orange")
    mapping = transfer()
    colours = mapping.matrices(CHECKER) @ (S @ BLUE)
    assert colours[cyan, 0] < 0.0
    found = predict(mapping, CHECKER, KnownLight(S @ BLUE))
    assert found.out_of_gamut[cyan] and not found.out_of_gamut[orange]
    clamped = delta_E(np.maximum(colours, 0.0), true(BLUE)[0], S @ BLUE)
    wide = transfer(space="Linear Rec.2020")
    assert (wide.matrices(CHECKER) @ (wide.S_in @ BLUE)).min() > 0.0
    own = errors(BLUE)[0]
    for patch in (cyan, orange):
        assert own[patch] < 0.5 < errors(BLUE, "rgb")[0, patch]
    assert clamped[cyan] > own[cyan]
    keep(
        "saturated cyan under blue sky",
        f"red of {colours[cyan, 0] / colours[cyan].max():.2f} of the largest channel; ΔE "
        f"{own[cyan]:.2f}, clamped {clamped[cyan]:.1f}",
        "says `out of gamut`; Linear Rec.2020 holds it",
    )
    keep(
        "saturated orange under blue sky",
        f"ΔE {own[orange]:.2f}, RGB × RGB {errors(BLUE, 'rgb')[0, orange]:.1f}",
        "nothing to do",
    )


def metamer(rho, seed):
    """Another reflectance of the same colour under D65: plus a metameric black, 0 to 1 kept."""
    seen = (S * source("D65")).T
    rough = np.random.default_rng(seed).normal(size=rho.size)
    smooth = np.convolve(rough, np.hanning(15), mode="same")
    black = smooth - seen @ np.linalg.lstsq(seen, smooth, rcond=None)[0]
    room = np.where(black > 0, 1.0 - rho, rho) / np.maximum(np.abs(black), 1e-12)
    return rho + 0.95 * room.min() * black


def test_metamers_part_under_blue_sky(keep):
    """Equal under D65, so RGB × RGB never parts them; under blue sky they must."""
    mapping = transfer()
    apart, off, today = [], [], []
    for seed in range(20):
        rho = CHECKER[NAMES.index("neutral 5 (.70 D)")]
        pair = np.stack([rho, metamer(rho, seed)])
        assert pair.min() >= 0.0 and pair.max() <= 1.0
        right, white = true(BLUE, pair)[0], S @ BLUE
        # Equal under D65 by construction, to rounding.
        np.testing.assert_allclose(*true(source("D65"), pair)[0], rtol=1e-9)
        one, other = mapping.matrices(pair) @ white
        apart.append(delta_E(*right, white))
        off.append(abs(delta_E(one, other, white) - apart[-1]))
        today.append(errors(BLUE, "rgb", rho=pair)[0, 1])
    apart, off = np.array(apart), np.array(off)
    # Curves with wiggles 25 nm wide are hard too: what is left is the errors of bands above.
    assert apart.mean() > 2.0 and off.mean() < 0.05 * apart.mean() and off.max() < 0.5
    keep(
        "metamers, equal under D65, under blue sky",
        f"part by ΔE {apart.mean():.1f}, at most {apart.max():.1f}; ours parts them so to within "
        f"{off.max():.2f}, RGB × RGB not at all",
        "nothing to do",
    )


def test_fluorescence_is_refused(keep, tmp_path):
    """More light out than in at a wavelength: no diagonal of a spectrum is that."""
    path = tmp_path / "paints.csv"
    rows = [f"{nm},{0.9 if nm < 500 else 1.3}" for nm in range(400, 701, 20)]
    path.write_text("\n".join(["wavelength_nm,day-glow orange [fraction]", *rows]))
    with pytest.raises(InputError, match="1.3 is over 1.05.*fluorescent"):
        read_reflectances(path)
    keep(
        "fluorescent paint, 1.3 at its peak", "no figure", "refuses the file, line and column named"
    )
