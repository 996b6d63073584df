"""Pictures are judged by their last byte: whole ones pass, and no other."""

import struct
import zlib

import numpy as np
import OpenEXR
import pytest

from spectral_skylight.addon.scene.output import image_file
from spectral_skylight.tests import exr

NOTE = "0123abcd"
NOTED = b"Note\x000123abcd"


def written(path, rgb, **header):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
    OpenEXR.File(header, {"RGB": rgb.astype(np.float32)}).write(str(path))
    return path.read_bytes()


def png(width, height, text=(NOTED,)):
    rows = b"".join(b"\0" + bytes(3 * width) for _ in range(height))
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))]
    chunks += [(b"tEXt", each) for each in text]
    chunks += [(b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


@pytest.fixture(params=[(16, 16), (5, 37), (33, 1)], ids=str)
def picture(request, tmp_path):
    """Width, height and an EXR by another writer, both of noise and of long runs."""
    width, height = request.param
    rgb = np.random.default_rng(0).normal(size=(height, width, 3))
    rgb[height // 2 :] = 0.25
    return width, height, written(tmp_path / "a.exr", rgb, Note=NOTE)


def test_whole_pictures_pass(picture):
    width, height, content = picture
    image_file.check(content, width, height, NOTE)
    image_file.check(png(width, height), width, height, NOTE)


def test_cut_or_changed_anywhere_they_do_not(picture):
    """Every length, and a flip of a bit in every byte of the pixels."""
    width, height, content = picture
    drawn = png(width, height)
    for good in (content, drawn):
        for length in range(len(good)):
            with pytest.raises(ValueError):
                image_file.check(good[:length], width, height)
    pixels = content.index(b"dataWindow") + 200
    missed = 0
    for place in range(pixels, len(content)):
        bad = bytearray(content)
        bad[place] ^= 0x40
        try:
            image_file.check(bytes(bad), width, height)
        except ValueError:
            continue
        missed += 1
    # Only blocks that could not be compressed have no checksum of their own.
    assert missed == 0 or width * height < 600
    for place in range(8, len(drawn)):
        bad = bytearray(drawn)
        bad[place] ^= 0x40
        with pytest.raises(ValueError):
            image_file.check(bytes(bad), width, height)


def test_others_are_named(picture, tmp_path):
    width, height, content = picture
    grey = np.ones((height, width, 3))
    with pytest.raises(ValueError, match="pixels"):
        image_file.check(content, width + 1, height)
    with pytest.raises(ValueError, match="other data"):
        image_file.check(content, width, height, "ffff")
    grey[-1, -1, 1] = np.nan
    with pytest.raises(ValueError, match="not finite"):
        image_file.check(written(tmp_path / "nan.exr", grey), width, height)
    with pytest.raises(ValueError, match="ZIP"):
        bare = written(tmp_path / "bare.exr", grey, compression=OpenEXR.NO_COMPRESSION)
        image_file.check(bare, width, height)
    with pytest.raises(ValueError, match="is not an OpenEXR file"):
        image_file.check(b"", width, height)


def test_what_cycles_notes_of_its_speed_is_taken_out(picture, tmp_path):
    """The same pixels and other entries remain, as another reader has them."""
    width, height, content = picture
    rgb = exr.picture(tmp_path / "a.exr")
    noted = {f"cycles.View.{name}": "00:01.25" for name in ("render_time", "total_time")}
    timed = written(tmp_path / "timed.exr", rgb, Note=NOTE, **noted)
    assert b"cycles." in timed
    (tmp_path / "clean.exr").write_bytes(image_file.without_times(timed))
    header = OpenEXR.File(str(tmp_path / "clean.exr"), header_only=True).header()
    assert not [name for name in header if name.startswith("cycles.")]
    assert header["Note"] == NOTE
    np.testing.assert_array_equal(exr.picture(tmp_path / "clean.exr"), rgb)
    assert image_file.without_times(content) == content
    timed = png(width, height, (b"cycles.View.render_time\x001", NOTED))
    assert image_file.without_times(timed) == png(width, height)
