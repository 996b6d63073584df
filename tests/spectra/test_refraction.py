"""Tables of n and k in the forms that people publish."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.refraction import read_nk

NM = np.arange(350.0, 851.0, 25.0)
N, K = 1.0 + NM / 1000.0, 4.0 - NM / 500.0


def lines(*columns, separator=","):
    return "\n".join(separator.join(f"{v:.6g}" for v in row) for row in zip(*columns, strict=True))


FORMS = {
    "one table": "wavelength_nm,n,k\n" + lines(NM, N, K),
    "micrometres": "wl um, n, k\n" + lines(NM / 1000.0, N, K),
    "two tables": f"wl,n\n{lines(NM / 1000.0, N)}\n\nwl,k\n{lines(NM / 1000.0, K)}\n",
    "spaces": "# comment of 3 words\n" + lines(NM, N, K, separator="  "),
    "a database's record": (
        "REFERENCES: 1972\nDATA:\n  - type: tabulated nk\n    data: |\n        "
        + lines(NM / 1000.0, N, K, separator=" ").replace("\n", "\n        ")
    ),
    "decimal commas": "nm;n;k\n" + lines(NM, N, K, separator=";").replace(".", ","),
    "unsorted": lines(NM[::-1], N[::-1], K[::-1]),
    "far infrared beside it": lines(
        [*NM / 1000.0, *range(2, 300)], [*N, *[-5.0] * 298], [*K, *[1] * 298]
    ),
}


@pytest.mark.parametrize("form", FORMS)
def test_forms(tmp_path, form):
    path = tmp_path / "metal.csv"
    path.write_text(FORMS[form], encoding="utf-8")
    n, k = read_nk(path)
    # Straight lines stay straight between samples.
    np.testing.assert_allclose(n, 1.0 + WAVELENGTHS / 1000.0, atol=1e-5)
    np.testing.assert_allclose(k, 4.0 - WAVELENGTHS / 500.0, atol=1e-5)


def test_a_dielectric_has_no_k(tmp_path):
    path = tmp_path / "glass.csv"
    path.write_text(
        "wl,n\n0.3,1.5\n0.4,1.5\n0.5,1.5\n0.6,1.5\n0.7,1.5\n0.8,1.5\n", encoding="utf-8"
    )
    n, k = read_nk(path)
    np.testing.assert_allclose(n, 1.5)
    assert not k.any()


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("wavelength,n,k\n", "no table"),
        ("wavelength,n,k\n500,1.5,0\n", "no table"),
        (lines([450.0, 700.0], [1, 1], [1, 1]), "does not cover 400-700 nm"),
        (lines([400.0, 700.0], [1, 1], [1, 1]), "a gap of 300 nm"),
        (lines([400.0, 500, 500, 600, 700], [1] * 5, [1] * 5), "500 nm occurs twice"),
        (lines([400.0, 500, 600, 700], [1, 0, 1, 1], [1] * 4), "n is 0;"),
        (lines([400.0, 500, 600, 700], [1] * 4, [1, -2, 1, 1]), "k is -2;"),
        (lines([400.0, 500, 600, 700], [1] * 4, [1, np.nan, 1, 1]), "values that are not finite"),
        ("DATA:\n  - type: formula 5\n    coefficients: 1.5 0.003 2\n", "as a formula"),
    ],
)
def test_what_is_no_table_is_said(tmp_path, text, problem):
    path = tmp_path / "metal.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=problem):
        read_nk(path)


def test_no_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_nk(tmp_path / "none.csv")


def test_published_records_are_read(shared_data):
    """As refractiveindex.info stores them, against their table on 5 nm, which is straight lines."""
    folder = shared_data / "reflectance" / "refractiveindex_info"
    names = (folder / "n.csv").read_text().splitlines()[0].split(",")
    table = np.genfromtxt(folder / "n.csv", delimiter=",", skip_header=1)
    for metal in ("Cu_Johnson", "Al_Rakic", "Au_Johnson"):
        element, source = metal.split("_")
        n, _ = read_nk(folder / "original_yml" / f"main_{element}_nk_{source}.yml")
        theirs = np.interp(WAVELENGTHS, table[:, 0], table[:, names.index(metal)])
        # A cubic beside a line between samples 30 nm apart, where copper's n falls by 0.4.
        np.testing.assert_allclose(n, theirs, atol=0.05)
