"""Files made to hurt: what a reader takes is a small multiple of what it is given."""

import json
import os
import random
import struct
import tracemalloc
import zlib

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra import library
from spectral_skylight.addon.spectra.reflectance import read_all
from spectral_skylight.addon.spectra.refraction import read_nk
from spectral_skylight.tests.spectra import fuzz, kind_files


def test_damage_of_any_kind_is_one_line(tmp_path):
    """Four hundred inputs over all readers, always the same; a million by hand, see `fuzz`."""
    before = fuzz.largest_mb()
    assert list(fuzz.faults(400, 1, tmp_path)) == []
    assert not fuzz.largest_mb() - before > 500.0  # also where it is not known


def test_mutations_differ_and_are_always_the_same():
    found = [
        [
            fuzz.mutated(b"nm,red\n400,0.5\n" * 9, b"other", random.Random(seed))
            for seed in range(99)
        ]
        for _ in range(2)
    ]
    assert found[0] == found[1] and len(set(found[0])) > 90


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)


def variable(flags, shape, *parts, name=b"sur_a"):
    head = element(6, struct.pack("<II", flags, 0)) + element(5, struct.pack("<2i", *shape))
    return element(14, head + element(1, name) + b"".join(parts))


def matlab(*variables):
    return b"MATLAB 5.0".ljust(124) + struct.pack("<H", 0x100) + b"IM" + b"".join(variables)


def bomb():
    packed = zlib.compress(variable(6, (2048, 2048), element(9, bytes(1 << 25))), 9)
    return struct.pack("<II", 15, len(packed)) + packed


def spectra_of_their_own(count):
    """Products each at wavelengths of their own: a table of them all would be count² numbers."""
    return [
        {"spectral_data": [{"wavelength": 0.3 + k / 1e5 + d, "T": 0.5} for d in (0.0, 0.6)]}
        for k in range(count)
    ]


def objects_of_their_own(count):
    form = (
        '<Object Name="a"><ColorValues><ReflectanceSpectrum StartWL="{}" Increment="900">'
        "0.1 0.1</ReflectanceSpectrum></ColorValues></Object>"
    )
    return "<CxF>" + "".join(form.format(300 + k / 100) for k in range(count)) + "</CxF>"


ENVI = "ENVI\nfile type = ENVI spectral library\n"
FORMAT = "CGATS.17\nBEGIN_DATA_FORMAT\n{}\nEND_DATA_FORMAT\n"
HOSTILE = {
    "records without fields": (
        "a.mat",
        matlab(variable(2, (1 << 14, 1 << 14), element(5, b"\x20\0\0\0"), element(1, b""))),
    ),
    "cells that are not there": ("a.mat", matlab(variable(1, (1 << 14, 1 << 14)))),
    "rows of nothing": (
        "a.mat",
        matlab(
            variable(6, (2**31 - 1, 0), element(9, b"")),
            variable(6, (1, 3), element(9, struct.pack("<3d", 380, 1, 2**31 - 1)), name=b"S_a"),
        ),
    ),
    "packed zeros": ("a.mat", matlab(*[bomb()] * 20)),
    "objects at wavelengths of their own": ("a.cxf", objects_of_their_own(6000)),
    "products at wavelengths of their own": ("a.json", json.dumps(spectra_of_their_own(6000))),
    "endless digits": (
        "a.json",
        '[{"spectral_data": [{"wavelength": %s, "T": 1}]}]' % ("9" * 300000),
    ),
    "deep lists": ("a.json", "[" * 100000),
    "open braces": ("a.hdr", ENVI + "a = {\n" * 60000),
    "a library that is not there": (
        "a.hdr",
        f"{ENVI}samples = 9\nlines = 99999999\ndata type = 4\nwavelength = {{1,2,3,4,5,6,7,8,9}}\n",
    ),
    "many tables under many fields": (
        "a.ti3",
        FORMAT.format(" ".join(f"SPEC_{380 + k / 1000:.3f}" for k in range(20000)))
        + "BEGIN_DATA\nEND_DATA\n" * 8000,
    ),
    "samples at wavelengths of their own": (
        "a.ti3",
        FORMAT.format("SPECTRAL_NM SPECTRAL_DEC")
        + "BEGIN_DATA\n"
        + "".join(f"{400 + k / 100} 0.5\n" for k in range(20000))
        + "END_DATA\n",
    ),
    "an endless quotation": ("a.csv", '"' + "a," * 100000 + '"\n400,"0.5\n' * 1000),
    "quotation marks": ("a.csv", '"\n' * 100000),
    "a difference a million times": (
        "a.jdx",
        "##JCAMP-DX=4\n" + "##FIRSTX=400\n##LASTX=700\n##XYDATA=(X++(Y..Y))\n400@s99999\n" * 99,
    ),
    "tables of n and k": ("a.nk", "1 2\n1 2 3\n" * 40000),
    "blanks in n and k": ("a.nk", " " * 300000 + "1," + " ," * 100000),
}


@pytest.mark.parametrize(("name", "content"), HOSTILE.values(), ids=HOSTILE.keys())
def test_small_files_take_little(tmp_path, name, content):
    """At most a hundred times the file's bytes, or what numbers of one variable may take."""
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as caught:
            (read_nk if path.suffix == ".nk" else read_all)(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(str(caught.value).splitlines()) == 1 and len(str(caught.value)) < 1000
    assert peak < max(100 * path.stat().st_size, 1 << 26)


def test_pipes_and_devices_are_not_opened(tmp_path):
    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes in a folder on this system")
    (tmp_path / "good.csv").write_bytes(kind_files.text("nm,red", kind_files.rows(kind_files.RED)))
    for name in ("pipe.csv", "pipe.hdr", "splib07a_Wavelengths.txt"):
        os.mkfifo(tmp_path / name)
    (tmp_path / "pipe.sli").write_bytes(b"1234")
    (tmp_path / "splib07a_x.txt").write_text(" splib07a Record=1: Brick ASDFRa AREF\n0.5\n0.5\n")
    (tmp_path / "null.csv").symlink_to(os.devnull)
    for name in ("pipe.csv", "null.csv", "pipe.sli"):
        with pytest.raises(InputError, match="is not a regular file"):
            read_all(tmp_path / name)
    with pytest.raises(InputError, match="is not a regular file"):
        read_nk(tmp_path / "pipe.csv")
    found = library.whole([tmp_path])
    assert found.names == ("red",)
    # One line each: both pipes, the device, and the two spectra that lean on pipes.
    assert len(found.problems) == 5
    assert all("not a regular file" in problem for problem in found.problems)


def test_names_that_nothing_can_show_are_shown_otherwise(tmp_path, capsysbinary):
    product = {"name": "a\ud800\nb\x1b[31m", "spectral_data": []}
    product["spectral_data"] = [
        {"wavelength": nm / 1000, "T": 0.5} for nm in np.arange(380.0, 790.0, 10.0)
    ]
    (tmp_path / "a.json").write_text(json.dumps(product))
    (name,) = read_all(tmp_path / "a.json").names
    assert name.isprintable() and name.encode().decode() == name
    assert cli.main(["library", str(tmp_path)]) == 0
    assert b"1 of 1 spectra" in capsysbinary.readouterr().err
