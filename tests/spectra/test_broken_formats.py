"""Published formats that are broken, damaged or about something else: one clear line each."""

import random
from pathlib import Path

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.reflectance import (
    read_all,
)
from spectral_skylight.addon.spectra.table import NoSpectra
from spectral_skylight.tests.spectra.published import (
    PUBLISHED,
    cgats,
    cxf,
    ecostress,
    igsdb,
    matlab,
    psychtoolbox,
    splib07,
    two,
)


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
