"""Conditioning: bases that are nearly collinear, and short numbers."""

from dataclasses import replace

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra import bases
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.tests.stability.lights import CHECKER, S, daylight, errors, skylight

LIGHTS = np.array([skylight(40.0), daylight(40.0)])


def with_basis(B):
    return replace(transfer(), restoration=bases.restoration(B, S))


def test_lambda0_moves_nothing(keep):
    """λ0 scales the functions; the matrix depends on their span. It may be anything in float64."""
    M = transfer().matrices(CHECKER)
    worst = 0.0
    for reference in (1.0, 100.0, 550.0, 5000.0):
        B = bases.extraterrestrial_sunlight() * (reference / WAVELENGTHS) ** (
            4.0 * np.arange(3)[:, None]
        )
        worst = max(worst, np.abs(with_basis(B).matrices(CHECKER) - M).max())
    # Rows are brought to one length first: rounding is 1e-16 times a condition of 26.
    assert worst < 1e-13
    keep("λ0 moved from 550 to 1, 100 or 5000 nm", f"entries move by {worst:.0e}", "nothing to do")


@pytest.mark.parametrize("near", [1e-1, 1e-3, 1e-5])
def test_collinear_functions_of_one_span_are_no_harm(near):
    """Leaning the functions on one another costs digits, not light: condition times 1e-16."""
    B = bases.rayleigh() / np.linalg.norm(bases.rayleigh(), axis=1, keepdims=True)
    B = B.sum(axis=0) + near * B
    # The condition of A grows as 1 / near, and once more in the solution's residual.
    np.testing.assert_allclose(
        with_basis(B).matrices(CHECKER), transfer().matrices(CHECKER), atol=1e-13 / near**2
    )


def test_a_measured_basis_of_one_sky_is_refused(tmp_path, keep):
    """Spectra that hardly differ leave their noise alone for the second and third function.

    A reflectance takes light away: with functions that are light, no entry of any matrix passes 1
    by more than a few hundredths (`Transfer.largest`). Noise is no light: there channels are
    differences of large numbers, and whatever the sky's numbers are off by is multiplied.
    """
    for name in bases.BASES:
        assert transfer(name).largest < 1.1
    rng = np.random.default_rng(5)
    sky = bases.rayleigh()[0] + bases.rayleigh()[1]
    spectra = np.array([sky * (1.0 + 0.003 * rng.normal(size=sky.size)) for _ in range(6)])
    path = tmp_path / "one_sky.csv"
    rows = np.column_stack([WAVELENGTHS, *spectra])
    lines = ["nm," + ",".join("abcdef"), *(",".join(map(repr, map(float, row))) for row in rows)]
    path.write_text("\n".join(lines))
    mapping = with_basis(bases.measured(path))
    off = errors(LIGHTS, mapping).mean()
    assert off > 1.0 and mapping.largest > 2.0
    with pytest.raises(InputError, match="differ too little"):
        transfer(f"measured {path}")
    keep(
        "a measured basis of six spectra of one sky with 0.3 % of noise",
        f"ΔE {off:.1f}; entries up to {mapping.largest:.0f} where 1 is right",
        "refuses a basis whose matrices may pass 2",
    )


def test_float32_rows(keep):
    """Sockets hold float32, and Blender adds in float32: three products a row.

    Each of the six numbers of a row is off by at most u = 2^-24 of itself, as is each product and
    each of two sums: |error| <= 6 u sum |M_ij| E_j, to first order.
    """
    worst, bound = 0.0, 0.0
    for light in LIGHTS @ S.T:
        M = transfer().matrices(CHECKER)
        short = np.zeros(M.shape[:2], np.float32)
        for j in range(3):
            short += M[..., j].astype(np.float32) * np.float32(light[j])
        error = np.abs(short - M @ light)
        allowed = 6 * 2.0**-24 * np.abs(M) @ light
        assert (error <= allowed).all()
        colours = np.linalg.norm(M @ light, axis=-1, keepdims=True)
        worst = max(worst, (error / colours).max())
        bound = max(bound, (allowed / colours).max())
    keep(
        "rows of M in float32 sockets instead of float64",
        f"{worst:.0e} of the colour, at most {bound:.0e} by rounding's own bound",
        "nothing to do",
    )
