"""Damaged and hostile sky files: read, or refused in one line; never more memory than they claim.

SKYLIGHT_FUZZ sets how many mutations of each file are tried; 40 where it is not set.
"""

import os
import struct
import time
import tracemalloc

import numpy as np
import OpenEXR
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.file_claims import SMALL
from spectral_skylight.addon.sky.known_spectrum import ATTRIBUTE
from spectral_skylight.addon.sky.panorama import read_panorama
from spectral_skylight.addon.sky.spectral_panorama import spectral_sky, to_grid
from spectral_skylight.tests.sky.spectral_files import radiance, stokes, write_fichet, write_hsr
from spectral_skylight.tests.sky.test_panorama import hdr, noise, rgbe

COUNT = int(os.environ.get("SKYLIGHT_FUZZ", "40"))
EXTREMES = [
    struct.pack("<i", value) for value in (-1, 0, 1, 255, 1 << 16, 1 << 24, 1 << 30, -(1 << 31))
]


def exr_bytes(path, header, channels):
    OpenEXR.File(header, channels).write(str(path))
    return path.read_bytes()


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Bytes of skies of every kind, by a name that is a file's."""
    path = tmp_path_factory.mktemp("seeds") / "a.exr"
    rgb = np.round(noise(16), 1)
    planes = {c: rgb[..., i].copy() for i, c in enumerate("RGB")}
    found = {
        f"{packing}.exr": exr_bytes(
            path,
            {
                "compression": getattr(OpenEXR, f"{packing}_COMPRESSION"),
                "owner": "someone",
                "chromaticities": (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.3217, 0.3377),
            },
            planes,
        )
        for packing in ("NO", "RLE", "ZIP", "PIZ", "PXR24", "B44", "DWAA")
    }
    tiled = {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    found["tiles.exr"] = exr_bytes(path, tiled, planes)
    layers = {f"{layer}.{c}": plane for layer in ("AO", "Beauty") for c, plane in planes.items()}
    found["layers.exr"] = exr_bytes(path, {}, layers)
    parts = [OpenEXR.Part({"name": name}, dict(planes)) for name in ("left", "right")]
    OpenEXR.File(parts).write(str(path))
    found["parts.exr"] = path.read_bytes()
    header = b"PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\nCOLORCORR=2 1 0.5\n"
    found["new.hdr"] = hdr(rgbe(rgb), header)
    found["old.hdr"] = hdr(rgbe(rgb), header, new=False)
    nodes = np.arange(400.0, 741.0, 34.0)
    values = 10.0 * radiance(nodes, rows=16)
    found["spectra.hsr"] = write_hsr(path, values).read_bytes()
    for packing in ("ZIP", "PIZ"):
        compression = getattr(OpenEXR, f"{packing}_COMPRESSION")
        write_fichet(path, stokes(values, nodes), compression=compression)
        found[f"spectra {packing}.exr"] = path.read_bytes()
    known = {ATTRIBUTE: spectral_sky(values.astype(np.float32), to_grid(nodes), path)[1].to_text()}
    found["known.exr"] = exr_bytes(path, known, planes)
    return found


def mutated(whole, rng):
    """Change a file somewhere, more often in its header than elsewhere."""
    content = bytearray(whole)
    for _ in range(rng.integers(1, 4)):
        end = len(content) if rng.random() < 0.4 else min(500, len(content))
        place, what = int(rng.integers(end)), rng.integers(6)
        if what == 0:
            content[place] ^= 1 << rng.integers(8)
        elif what == 1:
            content[place : place + 4] = EXTREMES[rng.integers(len(EXTREMES))]
        elif what == 2:
            content[place:place] = content[place : place + int(rng.integers(1, 64))]
        elif what == 3:
            del content[place : place + int(rng.integers(1, 64))]
        elif what == 4:
            content[place] = rng.integers(256)
        else:
            del content[place:]
        if not content:
            content += b"\0"
    return bytes(content)


def outcome(path):
    """What comes of a file: its largest value, or the error, which is one line; and its memory."""
    tracemalloc.start()
    try:
        sky = read_panorama(path)
    except InputError as error:
        assert "\n" not in str(error)
        found = str(error)
    else:
        assert np.isfinite(sky.rgb).all() and sky.rgb.min() >= 0.0
        found = float(sky.rgb.max())
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return found, peak


def test_mutations(files, tmp_path, capfd):
    rng, most, longest, refused = np.random.default_rng(16), 0, 0.0, 0
    for name, whole in files.items():
        path = tmp_path / name
        path.write_bytes(whole)
        assert read_panorama(path).rgb.max() > 1.0  # and imports what takes memory of its own
        for _ in range(COUNT):
            path.write_bytes(mutated(whole, rng))
            start = time.perf_counter()
            found, peak = outcome(path)
            longest = max(longest, time.perf_counter() - start)
            most = max(most, peak)
            refused += isinstance(found, str)
    assert refused > COUNT  # the mutations do change something
    assert most < 3 * SMALL
    printed = capfd.readouterr()
    assert printed == ("", "")
    print(
        f"{COUNT * len(files)} inputs, {refused} refused: {most >> 20} MiB, {longest:.2f} s at most"
    )


@pytest.mark.parametrize("name", ["new.hdr", "old.hdr"])
def test_hdr_cut_at_each_of_its_first_bytes(files, tmp_path, name):
    whole, path = files[name], tmp_path / name
    for length in range(whole.index(b"+X") + 60):
        path.write_bytes(whole[:length])
        assert isinstance(outcome(path)[0], str)


@pytest.mark.parametrize("pixels", [(999998, 499999), (999999, 999999), (2, 1), (32768, 16384)])
def test_hdr_that_claims_more_than_it_holds(tmp_path, pixels):
    path = tmp_path / "a.hdr"
    path.write_bytes(b"#?RADIANCE\n\n-Y %d +X %d\n" % (pixels[1], pixels[0]))
    found, peak = outcome(path)
    assert isinstance(found, str) and peak < 1 << 20


def test_exr_that_claims_more_than_it_holds(files, tmp_path):
    """Windows, blocks that lie upon one another, tiles of one pixel, attributes without end."""
    whole, path = files["ZIP.exr"], tmp_path / "a.exr"
    old = struct.pack("<4i", 0, 0, 31, 15)
    for width, height in ((1 << 23, 1 << 22), (1 << 24, 1 << 23), (65536, 32768)):
        window = struct.pack("<4i", 0, 0, width - 1, height - 1)
        path.write_bytes(whole.replace(old, window))
        found, peak = outcome(path)
        assert isinstance(found, str) and peak < 1 << 20
        # A small data window in a large picture would be filled up with black.
        path.write_bytes(window.join(whole.rsplit(old, 1)))
        found, peak = outcome(path)
        assert "claims" in found and peak < 1 << 20
    rows = files["NO.exr"]
    table = rows.index(struct.pack("<Q", len(rows) - 15 * (8 + 32 * 12) - 8 - 32 * 12))
    place = rows[table : table + 8]
    path.write_bytes(rows[:table] + 16 * place + rows[table + 128 :])
    assert isinstance(outcome(path)[0], str)
    tiles = files["tiles.exr"]
    place = tiles.index(b"tiledesc") + 9 + 4
    for mode in (0x20, 0xF1, 0xF2, 3):  # of levels and rounding that there are none
        path.write_bytes(tiles[: place + 8] + bytes([mode]) + tiles[place + 9 :])
        assert "header" in outcome(path)[0]
    for side in (1 << 15, 1 << 24, (1 << 32) - 1):  # a reader would make room for such a tile
        path.write_bytes(tiles[:place] + 2 * struct.pack("<I", side) + tiles[place + 8 :])
        found, peak = outcome(path)
        assert "claims" in found and peak < 1 << 20
    path.write_bytes(whole[:8] + b"a\0string\0" + struct.pack("<i", 1 << 30))
    assert "header" in outcome(path)[0]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_what_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "a.hdr")
    assert "not a regular file" in outcome(tmp_path / "a.hdr")[0]
    assert "no such file" in outcome(tmp_path / "b.hdr" / "c")[0]
    assert "cannot be opened" in outcome(tmp_path)[0]
