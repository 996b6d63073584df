"""Reflectance files as the world writes them, and the one line that each broken one gets."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.reflectance import (
    read_assigned,
    read_one,
    read_reflectances,
    split_assignment,
)

X = np.arange(380, 781, 10)


def rows(values, separator=",", form="{:g}"):
    return [f"{x}{separator}{form.format(v)}" for x, v in zip(X, values, strict=True)]


FRACTIONS = np.linspace(0.1, 0.9, X.size)
PLAIN = ["wavelength_nm,brick", *rows(FRACTIONS)]


@pytest.fixture
def write(tmp_path):
    def write(lines, name="brick.csv", **options):
        path = tmp_path / name
        path.write_text("\n".join(lines) + "\n", **{"encoding": "utf-8", **options})
        return path

    return write


@pytest.fixture
def expected(write):
    return read_reflectances(write(PLAIN, "plain.csv")).values


def test_plain(write):
    read = read_reflectances(write(PLAIN))
    assert read.names == ("brick",) and read.unit == "fraction"
    # Monotone cubics reproduce a straight line.
    np.testing.assert_allclose(read.values[0], np.interp(WAVELENGTHS, X, FRACTIONS), atol=1e-12)


AWKWARD = {
    "percent by size": ["wavelength,brick", *rows(FRACTIONS * 100)],
    "percent in the header": ["wavelength,brick (%)", *rows(FRACTIONS * 100)],
    "decimal commas, semicolons": ["Wellenlänge [nm];brick"]
    + [row.replace(".", ",") for row in rows(FRACTIONS, ";")],
    "decimal commas, tabs": ["nm\tbrick"] + [r.replace(".", ",") for r in rows(FRACTIONS, "\t")],
    "tabs": ["lambda\tbrick", *rows(FRACTIONS, "\t")],
    "byte-order mark": ["\ufeffwavelength_nm,brick", *rows(FRACTIONS)],
    "comments and empty lines": [
        "# measured with care",
        "",
        PLAIN[0],
        "# from here",
        *rows(FRACTIONS),
        "",
        "  # end",
    ],
    "unsorted": [PLAIN[0], *reversed(rows(FRACTIONS))],
    "shouted header": ["WAVELENGTH (NM),brick", *rows(FRACTIONS)],
    "Greek header": ["λ,brick", *rows(FRACTIONS)],
    "quoted cells": ['"Wavelength","brick"', *rows(FRACTIONS)],
    "trailing separators": [line + "," for line in PLAIN],
    "no header": rows(FRACTIONS),
    "carriage returns": [line + "\r" for line in PLAIN],
    "scientific notation": [PLAIN[0], *rows(FRACTIONS, form="{:.6e}")],
    "micrometres in the header": ["wavelength (µm),brick"]
    + [f"{x / 1000:g},{v:g}" for x, v in zip(X, FRACTIONS, strict=True)],
    "spaces": [line.replace(",", " , ") for line in PLAIN],
}


@pytest.mark.parametrize("lines", AWKWARD.values(), ids=AWKWARD.keys())
def test_awkward_but_right(write, expected, lines):
    np.testing.assert_allclose(read_reflectances(write(lines)).values, expected, atol=1e-6)


def test_utf16_with_byte_order_mark(write, expected):
    read = read_reflectances(write(PLAIN, encoding="utf-16"))
    np.testing.assert_allclose(read.values, expected, atol=1e-12)


def test_latin_1(write):
    assert read_reflectances(
        write(["Wellenlänge,Öl", *rows(FRACTIONS)], encoding="latin-1")
    ).names == ("Öl",)


def test_unit_option_wins(write):
    read = read_reflectances(write(["nm,dark (fraction)", *rows(FRACTIONS)]), unit="percent")
    assert read.values.max() == pytest.approx(0.009) and read.unit == "percent"


def test_each_column_has_the_unit_of_its_header(write):
    lines = ["nm,a (%),b (fraction)"] + [
        f"{x},{100 * v},{v}" for x, v in zip(X, FRACTIONS, strict=True)
    ]
    read = read_reflectances(write(lines))
    np.testing.assert_allclose(read.values[0], read.values[1], atol=1e-12)
    assert read.unit == "mixed"


def test_slightly_over_one_is_clipped_and_said(write):
    read = read_reflectances(write(["nm,snow", *rows(FRACTIONS + 0.14)]))
    assert read.values.max() == 1.0
    assert any("over 1" in note for note in read.notes)


def test_range_is_held_and_said(write):
    inside = [row for row in rows(FRACTIONS) if 400 <= int(row.split(",")[0]) <= 700]
    read = read_reflectances(write(["nm,a", *inside]))
    assert read.values[0, 0] == read.values[0, 4] and "400 to 700" in read.notes[-1]


def test_what_lies_outside_the_visible_cannot_hurt(write, expected):
    lines = [*PLAIN, "800,0.9", "1400,nan", "1410,-1.23e34", "2500,7"]
    read = read_reflectances(write(lines))
    np.testing.assert_allclose(read.values, expected, atol=1e-12)


def replaced(wavelength, row):
    return [row if line.startswith(f"{wavelength},") else line for line in PLAIN]


BROKEN = {
    "empty file": ([], None, ["holds no data"]),
    "only a header": (PLAIN[:1], None, ["no row of numbers"]),
    "text for numbers": (replaced(500, "500,high"), None, [":14", "'brick'", "'high'"]),
    "no reflectance column": (["wavelength", "400", "410"], None, [":1", "no other"]),
    "first column is no wavelength": (["sample,brick", *rows(FRACTIONS)], None, ["'sample'"]),
    "duplicate wavelengths": ([*PLAIN, "500,0.3"], None, [":43", "line 14"]),
    "micrometres": (
        ["wavelength,brick"] + [f"{x / 1000},{v}" for x, v in zip(X, FRACTIONS, strict=True)],
        None,
        ["micrometres"],
    ),
    "below 0": (replaced(500, "500,-0.01"), None, [":14", "'brick'", "below 0"]),
    "over 1.05": (replaced(500, "500,1.3"), "fraction", [":14", "'brick'", "1.05"]),
    "over 105 percent": (replaced(500, "500,140"), None, [":14", "'brick'", "1.05"]),
    "between fraction and percent": (
        replaced(500, "500,1.5"),
        None,
        [":14", "'brick'", "give unit"],
    ),
    "NaN": (replaced(500, "500,nan"), None, [":14", "'brick'", "not a number"]),
    "empty cell": (replaced(500, "500,"), None, [":14", "'brick'", "not a number"]),
    "infinity": (replaced(500, "500,inf"), "fraction", [":14", "'brick'", "not a number"]),
    "gap": (
        [line for line in PLAIN if not line.startswith(("500", "510"))],
        None,
        ["490 to 520 nm", ":14"],
    ),
    "range too narrow": (PLAIN[:1] + PLAIN[6:], None, ["430-780 nm", "420-700"]),
    "ragged row": (replaced(500, "500,0.3,0.4"), None, [":14", "3 columns"]),
    "decimal commas between commas": (replaced(500, "500,0,3"), None, [":14", "semicolons"]),
}


@pytest.mark.parametrize(("lines", "unit", "parts"), BROKEN.values(), ids=BROKEN.keys())
def test_broken_files_get_one_line_with_place_and_cure(write, lines, unit, parts):
    path = write(lines)
    with pytest.raises(InputError) as caught:
        read_reflectances(path, unit)
    message = str(caught.value)
    assert str(path) in message and "\n" not in message and "; " in message
    for part in parts:
        assert part in message


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match=r"none\.csv.*check the path"):
        read_reflectances(tmp_path / "none.csv")


def test_binary_file(tmp_path):
    path = tmp_path / "brick.csv"
    path.write_bytes(b"\x76\x2f\x31\x01\x00\x00" * 100)
    with pytest.raises(InputError, match="binary"):
        read_reflectances(path)


@pytest.mark.slow
def test_line_of_a_gigabyte_is_refused_without_reading_it(tmp_path):
    import tracemalloc

    path = tmp_path / "long.csv"
    with path.open("wb") as handle:
        handle.write(b"wavelength,brick\n400,0.")
        handle.seek(1 << 30)
        handle.write(b"1\n")
    # A sparse file reads as NUL bytes; a real one would hold digits. Both are one endless line.
    tracemalloc.start()
    with pytest.raises(InputError, match="binary|longer than"):
        read_reflectances(path)
    digits = tmp_path / "digits.csv"
    with digits.open("wb") as handle:
        handle.write(b"wavelength,brick\n400,0.")
        for _ in range(1 << 10):
            handle.write(b"1" * (1 << 20))
    with pytest.raises(InputError, match=":2: the line is longer than 4 MiB"):
        read_reflectances(digits)
    # A few copies of the longest line that is looked at, not of the file.
    assert tracemalloc.get_traced_memory()[1] < 64 << 20
    tracemalloc.stop()
    digits.unlink()


def test_assignment_names_a_column(write):
    path = write(["nm,a,b"] + [f"{x},{v},0.5" for x, v in zip(X, FRACTIONS, strict=True)])
    name, values = read_assigned(f"{path}:b")
    assert name == "b" and np.all(values == 0.5)
    with pytest.raises(InputError, match="no column 'c'.*'a', 'b'"):
        read_assigned(f"{path}:c")
    with pytest.raises(InputError, match="holds 2 materials"):
        read_assigned(str(path))


def test_what_was_measured_is_told_from_what_is_held(tmp_path):
    path = tmp_path / "short.csv"
    path.write_text("nm,a\n" + "".join(f"{nm},0.{nm}\n" for nm in range(400, 701, 10)))
    read = read_one(f"{path}:a")
    assert read.measured == (400.0, 700.0)
    beyond = (WAVELENGTHS < 400) | (WAVELENGTHS > 700)
    assert set(read.values[0][beyond].round(12)) == {0.4, 0.7}


def test_assignment_leaves_drive_letters_alone():
    path, column = split_assignment(r"C:\data\brick.csv")
    assert str(path) == r"C:\data\brick.csv" and column is None
    path, column = split_assignment(r"C:\data\brick.csv:red, dark")
    assert str(path) == r"C:\data\brick.csv" and column == "red, dark"


def test_errors_in_other_columns_do_not_matter(write):
    path = write(["nm,a,b"] + [f"{x},{v},nan" for x, v in zip(X, FRACTIONS, strict=True)])
    assert read_assigned(f"{path}:a")[0] == "a"
    with pytest.raises(InputError, match="column 'b'"):
        read_reflectances(path)


LIBRARIES = {
    "slum_sample/slum_sample_15.csv": {},
    "astroray_usgs_ecostress/profiles.csv": {},
    "ptb_surfaces/sur_vrhel.csv": {},
    "colour_science_checkers/BabelColor_Average.csv": {},
    # The file holds a lawn of 1.21: its unit must be told, and a column is read for itself.
    "usgs_splib07_aviris95/usgs_splib07_aviris95_from_artificial_on_365_1000.csv": {
        "unit": "fraction",
        "column": "2454 Aluminum brushed 293K        ASDFRa AREF",
    },
}


@pytest.mark.parametrize(("name", "options"), LIBRARIES.items())
def test_real_libraries_are_read(shared_data, name, options):
    """Units, ranges and spacings of five publishers differ; all are plausible after."""
    read = read_reflectances(shared_data / "reflectance" / name, **options)
    assert read.unit == "fraction" and read.values.shape == (len(read.names), 81)
    assert 0.02 < read.values.mean() < 0.9
