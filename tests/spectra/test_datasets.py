"""What ships of colour-science's tables is what it has: in every lane, to the last bit."""

import importlib.util
import zipfile
from pathlib import Path

import colour
import numpy as np
import pytest
from colour.plotting.datasets.astm_g_173 import SD_ASTMG173_ETR

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra import datasets
from spectral_skylight.addon.spectra.formats import checkers

pytestmark = pytest.mark.blender  # each lane has its own numpy to read it

WRITE = Path(__file__).resolve().parents[2] / ".ci" / "datasets" / "write.py"

SPECTRA = {
    datasets.SUNLIGHT: {"ASTM G173 ETR": SD_ASTMG173_ETR},
    datasets.DAYLIGHT: colour.colorimetry.SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES,
    datasets.ILLUMINANTS: colour.SDS_ILLUMINANTS,
    datasets.LIGHT_SOURCES: colour.SDS_LIGHT_SOURCES,
    datasets.CAMERAS: colour.MSDS_CAMERA_SENSITIVITIES,
}
"""Kinds of which all that colour-science has is there."""


@pytest.mark.parametrize("kind", SPECTRA)
def test_every_table_of_a_kind_is_colour_science_s(kind):
    assert datasets.names(kind) == tuple(SPECTRA[kind])
    for name, theirs in SPECTRA[kind].items():
        ours = datasets.dataset(kind, name)
        np.testing.assert_array_equal(ours.wavelengths, theirs.wavelengths)
        np.testing.assert_array_equal(ours.values, theirs.values.reshape(ours.values.shape))
        assert len(ours.columns) == ours.values.shape[1]


@pytest.mark.parametrize(
    "kind, name, theirs, labels",
    [
        (
            datasets.CMFS,
            "CIE 1931 2 Degree Standard Observer",
            colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"],
            ("x", "y", "z"),
        ),
        (
            datasets.BASIS_REFLECTANCES,
            "Mallett 2019",
            colour.recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019,
            ("red", "green", "blue"),
        ),
    ],
)
def test_functions_of_three_are_colour_science_s(kind, name, theirs, labels):
    ours = datasets.dataset(kind, name)
    np.testing.assert_array_equal(ours.wavelengths, theirs.wavelengths)
    np.testing.assert_array_equal(ours.values, theirs.values)
    assert ours.columns == labels and datasets.names(kind) == (name,)


def test_cameras_have_red_green_and_blue():
    for name, theirs in colour.MSDS_CAMERA_SENSITIVITIES.items():
        columns = datasets.dataset(datasets.CAMERAS, name).columns
        assert [c.casefold()[0] for c in theirs.labels] == [c.casefold() for c in columns]


def test_every_patch_is_colour_science_s():
    theirs = colour.SDS_COLOURCHECKERS
    assert datasets.names(datasets.CHECKERS) == checkers.CHECKERS
    # Those under a second name are the same ones.
    assert {id(v) for v in theirs.values()} == {id(theirs[n]) for n in checkers.CHECKERS}
    for name in checkers.CHECKERS:
        ours = datasets.dataset(datasets.CHECKERS, name)
        assert ours.columns == tuple(theirs[name])
        for column, patch in zip(ours.values.T, theirs[name].values(), strict=True):
            np.testing.assert_array_equal(column, patch.values)
            np.testing.assert_array_equal(ours.wavelengths, patch.wavelengths)


def test_the_file_is_what_its_script_writes_and_says_where_from():
    spec = importlib.util.spec_from_file_location("write_datasets", WRITE)
    write = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(write)
    with np.load(datasets.FILE) as file:
        assert set(file.files) == set(write.members())
        for name, array in write.members().items():
            np.testing.assert_array_equal(file[name], array)
    about = datasets.about()
    assert about["library"] == "colour-science" and about["version"] == colour.__version__
    assert about["license"].startswith("BSD-3-Clause\n\nCopyright 2013 Colour Developers")
    assert set(about["sources"]) == set(about["columns"])


def test_the_file_is_small_and_whole():
    assert datasets.FILE.stat().st_size < 200_000
    assert zipfile.ZipFile(datasets.FILE).testzip() is None


WHOLE = datasets.FILE.read_bytes()


@pytest.mark.parametrize(
    "damaged",
    [
        None,
        b"",
        b"PK\x03\x04 and no more",
        WHOLE[:-100],
        WHOLE[:40_000] + bytes(9) + WHOLE[40_009:],
    ],
    ids=["missing", "empty", "no zip", "cut", "other bytes"],
)
def test_a_missing_or_damaged_file_is_one_line(tmp_path, monkeypatch, damaged):
    monkeypatch.setattr(datasets, "FILE", tmp_path / "datasets.npz")
    if damaged is not None:
        datasets.FILE.write_bytes(damaged)
    for cached in (datasets._file, datasets.about):
        cached.cache_clear()
    try:
        with pytest.raises(InputError, match=r"datasets\.npz: cannot be read .*; install"):
            for kind in datasets.about()["columns"]:
                for name in datasets.names(kind):
                    datasets.dataset(kind, name)
    finally:
        for cached in (datasets._file, datasets.about):
            cached.cache_clear()
