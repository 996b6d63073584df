"""Files of reflectances as their publishers write them, made here by what they publish."""

import json
import random
from pathlib import Path

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
from spectral_skylight.addon.spectra.table import NoSpectra

X = np.arange(350.0, 1001.0, 5.0)
RISING = 0.1 + 0.7 * (X - 350) / 650
FALLING = 0.9 - 0.7 * (X - 350) / 650


def on_grid(values):
    """Straight lines are brought to the grid as they are."""
    return np.interp(WAVELENGTHS, X, values)


def splib07(folder, values=RISING, name="Brick GDS350 Dkred  ASDFRa AREF", wavelengths=X):
    """A spectrum of the USGS in its chapter, and the wavelengths above it."""
    chapter = folder / "ASCIIdata_splib07a" / "ChapterA_ArtificialMaterials"
    chapter.mkdir(parents=True, exist_ok=True)
    for kind, nm in (("ASD_0.35-2.5_microns", wavelengths), ("BECK_Beckman_0.2-3.0", X * 2)):
        rows = [f"   {x / 1000:.6f}" for x in nm]
        title = f" splib07a Record=1: Wavelengths {kind}"
        (chapter.parent / f"splib07a_Wavelengths_{kind}.txt").write_text("\n".join([title, *rows]))
    path = chapter / "splib07a_Brick_GDS350_Dkred_ASDFRa_AREF.txt"
    path.write_text("\n".join([f" splib07a Record=12: {name}", *(f" {v:.7e}" for v in values)]))
    return path


def envi(folder, spectra, names=("one", "two"), kind=4, order=0, factor=1.0, more="", nm=False):
    """A spectral library, wavelengths in µm."""
    path = folder / "urban.sli"
    kinds = {2: "i2", 4: "f4", 5: "f8"}
    data = (np.array(spectra) * factor).round(0 if kind == 2 else 12)
    path.write_bytes(data.astype("<>"[order] + kinds[kind]).tobytes())
    nm = X if nm else X / 1000
    path.with_suffix(".hdr").write_text(
        f"ENVI\ndescription = {{\n  Made by a test, for = signs}}\nsamples = {X.size}\n"
        f"lines   = {len(spectra)}\nbands   = 1\nheader offset = 0\n"
        f"file type = ENVI Spectral Library\ndata type = {kind}\ninterleave = bsq\n"
        f"byte order = {order}\nwavelength units = {'Nanometers' if nm is X else 'Micrometers'}\n"
        + (f"reflectance scale factor = {factor}\n" if factor else "")
        + f"spectra names = {{\n {', '.join(names)}}}\n"
        + f"wavelength = {{\n {', '.join(f'{x:.6f}' for x in nm)}}}\n{more}"
    )
    return path


def ecostress(folder, values=RISING, y="Reflectance (percent)", scale=100.0):
    """A spectrum that descends from the infrared, as those of JHU do."""
    rows = [f"{x / 1000:.4f}\t{scale * v:.4f}" for x, v in zip(X[::-1], values[::-1], strict=True)]
    path = folder / "manmade.road.asphalt.solid.all.0095uuuasp.jhu.becknic.spectrum.txt"
    head = (
        "Name: Construction Asphalt\nType: manmade\nClass: Road\nSubclass: none\n"
        "Sample No.: 0095UUUASP\nOwner: JHU\nDescription: Dark: and tarry.\nOn two lines.\n"
        f"X Units: Wavelength (micrometers)\nY Units:{y}\nFirst X Value: 1.0\nLast X Value:  0.35\n"
        f"Number of X Values: {len(rows)}\nAdditional Information: none\n\n"
    )
    path.write_text(head + "\n".join(["14.0000\t 999.0", "2.0800\t 5.0", "2.0800\t 6.0", *rows]))
    return path


def igsdb(folder, values=RISING):
    """A product with wavelengths in µm to the far infrared, and one null."""
    rows = [
        {"wavelength": x / 1000, "T": v, "Rf": 0.1, "Rb": 0.2}
        for x, v in zip(X, values, strict=True)
    ]
    rows += [{"wavelength": 55.556, "T": None, "Rf": 0.5, "Rb": 0.5}]
    path = folder / "product_1.json"
    product = {"name": "Green 60%T", "spectral_data": {"spectral_data": rows}}
    path.write_text(json.dumps(product), encoding="utf-8")
    return path


def matlab(folder, saved=None, **variables):
    from scipy.io import savemat

    path = folder / "sur_house.mat"
    savemat(path, variables, **(saved or {}))
    return path


def psychtoolbox(folder, values=RISING, labels=False, **saved):
    padded = np.zeros((X.size + 4, 2))
    padded[2:-2] = np.column_stack([values, FALLING])
    grid = np.array([[X[0] - 10, 5, X.size + 4]], dtype=np.uint16)
    more = {"labels_house": np.array(["roof", "Öl"], dtype=object)} if labels else {}
    return matlab(folder, saved, sur_house=padded, S_house=grid, note="text", **more)


def isetcam(folder, values=RISING):
    data = np.column_stack([values, FALLING])
    return matlab(folder, data=data, wavelength=X[:, None], comment="cloth")


def cgats(folder, field="SPECTRAL_NM_{:.0f}", scale=1.0, more="", values=RISING, name="wall.txt"):
    fields = " ".join(["SAMPLE_ID", "SAMPLE_NAME", "LAB_L", *(field.format(x) for x in X)])
    rows = [
        f'{k} "{title}" 50.0 ' + " ".join(f"{scale * v:.8f}" for v in curve)
        for k, (title, curve) in enumerate((("dark red", values), ("white", FALLING)), 1)
    ]
    path = folder / name
    path.write_text(
        f'CGATS.17\nORIGINATOR "a test"\n{more}NUMBER_OF_FIELDS {X.size + 3}\n'
        f"BEGIN_DATA_FORMAT\n{fields}\nEND_DATA_FORMAT\nNUMBER_OF_SETS 2\nBEGIN_DATA\n"
        + "\n".join(rows)
        + "\nEND_DATA\n"
    )
    return path


def cxf(folder, values=RISING, start="", head=""):
    numbers = " ".join(f"{v:.8f}" for v in values)
    path = folder / "wall.cxf"
    path.write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>{head}\n'
        '<cc:CxF xmlns:cc="http://colorexchangeformat.com/CxF3-core"><cc:Resources>'
        '<cc:ObjectCollection><cc:Object ObjectType="Standard" Name="Blå" Id="1"><cc:ColorValues>'
        f'<cc:ReflectanceSpectrum ColorSpecification="M1"{start}>{numbers}'
        "</cc:ReflectanceSpectrum></cc:ColorValues></cc:Object>"
        '<cc:Object ObjectType="Standard" Name="Lab" Id="2"><cc:ColorValues><cc:ColorCIELab>'
        "<cc:L>50</cc:L></cc:ColorCIELab></cc:ColorValues></cc:Object></cc:ObjectCollection>"
        '<cc:ColorSpecificationCollection><cc:ColorSpecification Id="M1"><cc:MeasurementSpec>'
        '<cc:WavelengthRange StartWL="350" Increment="5"/></cc:MeasurementSpec>'
        "</cc:ColorSpecification></cc:ColorSpecificationCollection></cc:Resources></cc:CxF>",
        encoding="utf-8",
    )
    return path


PUBLISHED = {
    "USGS ASCII": (splib07, "Brick GDS350 Dkred ASDFRa AREF", "Artificial Materials"),
    "ECOSTRESS": (ecostress, "Construction Asphalt 0095UUUASP", "manmade, Road"),
    "IGSDB": (igsdb, "Green 60%T transmittance", "glazing, transmittance"),
    "Psychtoolbox": (psychtoolbox, "house 1", None),
    "Psychtoolbox, packed, with labels": (
        lambda f, **o: psychtoolbox(f, labels=True, do_compression=True, **o),
        "roof",
        None,
    ),
    "Psychtoolbox, version 4": (lambda f, **o: psychtoolbox(f, format="4", **o), "house 1", None),
    "ISETCam": (isetcam, "sur_house 1", None),
    "CGATS": (cgats, "dark red", None),
    "CGATS of i1Profiler": (lambda f, **o: cgats(f, "nm{:.0f}", **o), "dark red", None),
    "CGATS of Argyll": (
        lambda f, **o: cgats(f, "SPEC_{:.0f}", 100.0, 'SPECTRAL_NORM "100.000"\n', **o),
        "dark red",
        None,
    ),
    "CxF3": (cxf, "Blå", "Standard"),
    "CxF3, range at the spectrum": (
        lambda f, **o: cxf(f, start=' StartWL="350"', **o),
        "Blå",
        None,
    ),
}


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


def two(folder):
    return envi(folder, [RISING, FALLING])


def broken(write, change):
    def make(folder):
        path = write(folder)
        change(path)
        return path

    return make


def text(old, new, suffix=None):
    def change(path):
        target = path.with_suffix(suffix) if suffix else path
        content = target.read_bytes()
        assert old in content
        target.write_bytes(content.replace(old, new, 1))

    return change


def unlink_wavelengths(path):
    for file in path.parents[1].glob("*Wavelengths*"):
        file.unlink()


BROKEN = {
    "USGS, text": (broken(splib07, text(b" 1.2692308e-01", b" high")), ":7: 'high'"),
    "USGS, no wavelengths": (
        broken(splib07, unlink_wavelengths),
        "no file with that many wavelengths",
    ),
    "ECOSTRESS, text": (
        broken(ecostress, text(b"0.9000\t", b"0.9000\tx")),
        ":.*is not a measurement",
    ),
    "ECOSTRESS, wavenumbers": (
        broken(ecostress, text(b"(micrometers)", b"(cm-1)")),
        "wavelengths in 'cm-1'",
    ),
    "ENVI, no header": (
        broken(two, lambda path: path.with_suffix(".hdr").unlink()),
        "urban.hdr: is missing",
    ),
    "ENVI, cut": (broken(two, lambda path: path.write_bytes(b"1234")), "has 4 bytes of"),
    "ENVI, data type": (broken(two, text(b"type = 4", b"type = 6", ".hdr")), "data type = 6"),
    "ENVI, wavelengths": (
        broken(two, text(b"0.350000, ", b"", ".hdr")),
        "names 130 wavelengths for 131",
    ),
    "ENVI, units": (broken(two, text(b"Micrometers", b"Wavenumber", ".hdr")), "'Wavenumber'"),
    "ENVI, huge": (broken(two, text(b"lines   = 2", b"lines   = 99999999", ".hdr")), "split"),
    "ENVI, no number": (broken(two, text(b"samples = ", b"samples = x", ".hdr")), "samples = x131"),
    "IGSDB, cut": (broken(igsdb, text(b'"Rb": 0.2}', b"")), "is broken JSON"),
    "IGSDB, text": (broken(igsdb, text(b'"Rb": 0.2', b'"Rb": "much"')), "back reflectance holds"),
    "MATLAB, cut": (
        broken(psychtoolbox, lambda path: path.write_bytes(path.read_bytes()[:400])),
        "is a broken MATLAB file",
    ),
    "MATLAB, no grid": (lambda f: matlab(f, sur_a=np.ones((9, 2))), r"S_a: is not \[start"),
    "MATLAB, misfit": (
        lambda f: matlab(f, sur_a=np.ones((9, 2)), S_a=[400, 10, 31]),
        "9 rows for 31 wavelengths",
    ),
    "MATLAB, huge": (
        lambda f: matlab(f, sur_a=np.ones((9, 2)), S_a=[400, 10, 1e300]),
        "9 rows for 1e.300",
    ),
    "MATLAB 7.3": (
        broken(psychtoolbox, lambda path: path.write_bytes(b"M" * 512 + b"\x89HDF\r\n")),
        "save it with -v7",
    ),
    "CGATS, short row": (broken(cgats, text(b'"white" 50.0', b'"white"')), ":10: 133 values for"),
    "CGATS, text": (broken(cgats, text(b"0.10000000", b"none")), ":9: could not convert"),
    "CxF3, cut": (broken(cxf, text(b"</cc:CxF>", b"")), "is broken XML"),
    "CxF3, entities": (
        lambda f: cxf(f, head='<!DOCTYPE x [<!ENTITY a "0.5 0.5">]>'),
        "declares a document type",
    ),
    "CxF3, text": (broken(cxf, text(b"0.10000000", b"none")), "object 'Blå': could not convert"),
    "CxF3, no start": (broken(cxf, text(b'Id="M1"', b'Id="M2"')), "has no first wavelength"),
    "checker": (lambda f: "colour:Macbeth", "there are 'colour:BabelColor Average'"),
}


@pytest.mark.parametrize(("make", "said"), BROKEN.values(), ids=BROKEN.keys())
def test_broken_files_get_one_line_with_place_and_cure(tmp_path, make, said):
    path = make(tmp_path)
    with pytest.raises(InputError, match=said) as caught:
        read_all(path)
    message = str(caught.value)
    assert "\n" not in message and "; " in message
    assert Path(path).stem in message


OTHERS = {
    "an image": (two, text(b"ENVI Spectral Library", b"ENVI Standard", ".hdr")),
    "emissivity": (ecostress, text(b"Reflectance (percent)", b"Emissivity")),
    "wavelengths": (splib07, text(b"Brick", b"Bandpass")),
    "other JSON": (igsdb, text(b"spectral_data", b"thermal_data")),
    "colours": (cxf, lambda path: path.write_text("<CxF><Object Name='a'/></CxF>")),
    "densities": (cgats, lambda path: path.write_text("CGATS.17\nBEGIN_DATA\n1 2\nEND_DATA\n")),
    "matrices": (lambda f: matlab(f, T_xyz=np.ones((3, 3))), lambda path: None),
}


@pytest.mark.parametrize(("write", "change"), OTHERS.values(), ids=OTHERS.keys())
def test_whole_files_about_something_else_are_told_apart(tmp_path, write, change):
    with pytest.raises(NoSpectra):
        read_all(broken(write, change)(tmp_path))


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


@pytest.mark.parametrize(
    "write", [*(w for w, _, _ in PUBLISHED.values()), two], ids=[*PUBLISHED, "ENVI"]
)
def test_damage_of_any_kind_is_one_line(tmp_path, write):
    """Bytes cut off, changed, taken out and put in, by chance: nothing but `InputError` comes."""
    chance = random.Random(1)
    path = write(tmp_path)
    files = [path, path.with_suffix(".hdr")] if path.suffix == ".sli" else [path]
    for _ in range(40):
        target = chance.choice(files)
        whole = target.read_bytes()
        data = bytearray(whole)
        at = chance.randrange(len(data))
        how = chance.randrange(4)
        if how == 0:
            del data[at:]
        elif how == 1:
            del data[at : at + chance.randrange(200)]
        elif how == 2:
            data[at:at] = chance.choice(
                [b"nan", b"1e999", b"\0\0\0", b"{", b'"', b"9" * 30, b"<", b"\n"]
            )
        else:
            for _ in range(chance.randrange(1, 20)):
                data[chance.randrange(len(data))] = chance.randrange(256)
        target.write_bytes(data)
        try:
            values = read_all(path).values
            assert ((values >= 0) & (values <= 1)).all()
        except InputError as error:
            assert "\n" not in str(error)
        target.write_bytes(whole)


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
