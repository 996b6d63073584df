"""Files of reflectances as their publishers write them, made here by what they publish."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra import formats
from spectral_skylight.addon.spectra.formats import mat_file
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.reflectance import (
    read_all,
    read_one,
    read_reflectances,
    split_assignment,
)
from spectral_skylight.tests.spectra.published import (
    FALLING,
    PUBLISHED,
    RISING,
    X,
    cgats,
    envi,
    igsdb,
    splib07,
)


def on_grid(values):
    """Straight lines are brought to the grid as they are."""
    return np.interp(WAVELENGTHS, X, values)


@pytest.mark.parametrize(("write", "name", "kind"), PUBLISHED.values(), ids=PUBLISHED.keys())
def test_published_formats(tmp_path, write, name, kind):
    read = read_reflectances(write(tmp_path))
    assert read.names[0] == name
    np.testing.assert_allclose(read.values[0], on_grid(RISING), atol=2e-6)
    if len(read.names) == 2:
        np.testing.assert_allclose(read.values[1], on_grid(FALLING), atol=2e-6)
    if kind is not None:
        assert read.classes[0] == kind


@pytest.mark.parametrize(
    ("write", "name"), [(w, n) for w, n, _ in PUBLISHED.values()], ids=PUBLISHED.keys()
)
def test_the_rules_are_those_of_csv(tmp_path, write, name):
    """A negative value, a fluorescent one, a gap, a range too short: each named, with its place."""
    for wrong, what in (
        (np.where(X == 500, -0.2, RISING), "is below 0"),
        (np.where(X == 500, 1.2, RISING), "1.05|percent or fraction"),
    ):
        path = write(tmp_path, values=wrong)
        with pytest.raises(InputError, match=what) as caught:
            read_reflectances(path, column=name)
        assert str(path) in str(caught.value) and f"'{name}'" in str(caught.value)
        assert "\n" not in str(caught.value)


ENVI = {
    "little endian": {},
    "big endian": {"order": 1},
    "doubles": {"kind": 5},
    "ten thousand": {"kind": 2, "factor": 10000.0},
    "nanometres": {"nm": True},
    "no factor": {"factor": None},
    "factor in the title": {
        "factor": None,
        "scale": 10000.0,
        "more": "z plot titles = {wavelength [!7l!3m]!N, reflectance [*10000]}\n",
    },
}


@pytest.mark.parametrize("options", ENVI.values(), ids=ENVI.keys())
def test_envi(tmp_path, options):
    options = dict(options)
    scale = options.pop("scale", 1.0)
    if options.get("factor", 1.0) is None:
        options |= {"factor": 0.0}
        path = envi(tmp_path, [RISING * scale, FALLING * scale], **{**options, "factor": 1.0})
        header = path.with_suffix(".hdr")
        text = header.read_text().replace("reflectance scale factor = 1.0\n", "")
        header.write_text(text)
    else:
        path = envi(tmp_path, [RISING, FALLING], **options)
    for given in (path, path.with_suffix(".hdr")):
        read = read_reflectances(given)
        assert read.names == ("one", "two")
        np.testing.assert_allclose(read.values, [on_grid(RISING), on_grid(FALLING)], atol=1e-4)


def test_envi_leaves_out_what_is_no_sample_and_what_was_deleted(tmp_path):
    deleted, far = RISING.copy(), np.full(X.size, -1.23e34)
    deleted[(X > 520) & (X < 530)] = -1.23e34  # a gap of 10 nm: nothing to say
    far[X > 900] = 0.5
    names = (
        "Wavelengths in microns",
        "Tile, red",
        "  error bars to preceding",
        "Mica NIC4",
        "Tile",
    )
    path = envi(
        tmp_path,
        [X / 1000, deleted, RISING / 100, far, FALLING],
        names,
        more="data ignore value = -1.23000002e+034\n",
    )
    header = path.with_suffix(".hdr")
    header.write_text(header.read_text().replace(", ".join(names), ",\n ".join(names)))
    read = read_all(path)
    assert read.names == ("Tile, red", "Tile") and read.measured[0] == 380
    np.testing.assert_allclose(read.values[0], on_grid(RISING), atol=1e-5)
    (problem,) = read.problems.values()
    assert "'Mica NIC4': covers no light" in str(problem)
    with pytest.raises(InputError, match="'Mica NIC4'"):
        read_reflectances(path, column="Mica NIC4")
    assert "1 of 3 spectra are left out" in " ".join(read_reflectances(path).notes)


def test_spectrometers_with_as_many_channels_are_told_apart(tmp_path):
    path = splib07(tmp_path)
    (path.parent / "copy.txt").write_text(path.read_text().replace("ASDFRa", "BECKa"))
    assert read_all(path).values[0][40] == pytest.approx(on_grid(RISING)[40], abs=1e-5)
    with pytest.raises(InputError, match="covers 700-"):  # its wavelengths are twice as long
        read_reflectances(path.parent / "copy.txt")


def test_matlab_variables_are_those_that_scipy_reads(tmp_path):
    from scipy.io import loadmat, savemat

    given = {
        "bytes": np.arange(6, dtype=np.uint8).reshape(2, 3),
        "single": np.float32([[1.5], [2.5]]),
        "whole": np.int64([[-3, 4]]),
        "text": "Grün",
        "cells": np.array(["a", "bc"], dtype=object),
        "record": {"label": "x", "nat": 2.0},
    }
    for k, options in enumerate(({}, {"do_compression": True})):
        path = tmp_path / f"{k}.mat"
        savemat(path, given, **options)
        ours, theirs = mat_file.variables(path.read_bytes()), loadmat(path)
        for name in ("bytes", "single", "whole"):
            np.testing.assert_array_equal(ours[name], theirs[name])
            assert ours[name].dtype.kind == theirs[name].dtype.kind
        assert (ours["text"], ours["cells"]) == ("Grün", ["a", "bc"])
        assert ours["record"]["label"] == ["x"] and ours["record"]["nat"][0] == 2.0


def test_names_of_columns_may_hold_colons_and_slashes(tmp_path):
    path = cgats(tmp_path)
    path.write_text(path.read_text().replace("dark red", "A: 1/2 red"))
    assert split_assignment(f"{path}:A: 1/2 red") == (path, "A: 1/2 red")
    assert read_one(f"{path}:A: 1/2 red").names == ("A: 1/2 red",)
    assert split_assignment(str(path)) == (path, None)


def test_checkers_of_colour_science_are_there_by_name():
    read = read_reflectances("colour:BabelColor Average")
    assert len(read.names) == 24 and read.values.shape == (24, 81)
    (name,) = read_one("colour:ColorChecker N Ohta:dark skin").names
    assert name == "dark skin"
    white = read_one("colour:ISO 17321-1:white 9.5 (.05 D)")
    assert white.values[0, 34] == pytest.approx(0.885, abs=2e-3)  # 550 nm


def test_glass_is_its_transmittance_where_nothing_else_is_asked_for(tmp_path):
    path = igsdb(tmp_path)
    with pytest.raises(InputError, match="holds 3 materials"):
        read_one(str(path))
    glass = read_one(str(path), quantity=formats.igsdb.TRANSMITTANCE)
    assert glass.names == ("Green 60%T transmittance",) and glass.unit == "fraction"
    back = read_one(f"{path}:Green 60%T back reflectance", quantity="transmittance")
    np.testing.assert_allclose(back.values, 0.2)


def test_slum_says_what_its_samples_are(tmp_path):
    path = tmp_path / "LUMA_SLUM_SW.csv"
    rows = [f"{x},{100 * a:.6f},{100 * b:.6f}" for x, a, b in zip(X, RISING, FALLING, strict=True)]
    path.write_text("\n".join(['"wavelength","B001","L001d"', *rows]))
    read = read_reflectances(path)
    assert read.classes == ("brick", "roofing, dark") and read.unit == "percent"
    np.testing.assert_allclose(read.values[0], on_grid(RISING), atol=1e-6)


def test_endings_are_those_of_all_formats():
    assert {".csv", ".txt", ".sli", ".json", ".mat", ".cxf", ".ti3"} <= set(formats.ENDINGS)
    assert len({module.NAME for module in formats.FORMATS}) == len(formats.FORMATS)


REAL = {
    "usgs_splib07_aviris95/s07_AV95_envi.sli": (1790, 0.392),
    "glazing_igsdb/igsdb_product_7406.json": (3, 0.259),
    "ptb_surfaces/sur_vrhel.mat": (170, 0.276),
}


@pytest.mark.parametrize(("name", "expected"), REAL.items())
def test_real_files(shared_data, name, expected):
    read = read_all(shared_data / "reflectance" / name)
    assert (len(read.names), read.values.mean()) == (
        expected[0],
        pytest.approx(expected[1], abs=1e-3),
    )
    assert len(set(read.names)) == len(read.names)


def test_a_real_matlab_file_says_what_its_csv_says(shared_data):
    folder = shared_data / "reflectance" / "ptb_surfaces"
    both = [read_reflectances(folder / f"sur_vrhel.{ending}") for ending in ("mat", "csv")]
    np.testing.assert_allclose(both[0].values, both[1].values, atol=1e-6)
