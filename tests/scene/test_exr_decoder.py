"""Blender unpacks OpenEXR files to the same numbers as OpenEXR, whatever they are packed in."""

import struct
import subprocess
import sys

import bpy
import numpy as np
import OpenEXR
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.files import exr_decoder
from spectral_skylight.addon.sky.exr_file import decode_by_openexr, read_exr
from spectral_skylight.tests import exr

pytestmark = pytest.mark.blender

HEIGHT = 70  # no multiple of any block or tile
NEWEST = ("HTJ2K256", "HTJ2K32")
"""What Blender before 5.0 cannot unpack."""
KNOWN = ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB", *NEWEST)


def light(kind=np.float32):
    """Smooth with noise, and with all that floats can be but NaN."""
    rng = np.random.default_rng(3)
    rgb = rng.uniform(0.1, 4.0, (HEIGHT, 2 * HEIGHT, 3)).astype(np.float32)
    rgb[3, 4] = -1.0, 1e-7, 6e4
    rgb[5, 5] = np.inf, 0.0, -0.0
    return rgb.astype(kind)


def planes(rgb, prefix="", letters="RGB"):
    return {prefix + letter: rgb[..., i].copy() for i, letter in enumerate(letters)}


def both(path):
    """What Blender reads of a file, having made sure that OpenEXR reads the same."""
    size = path.stat().st_size
    blender, header = read_exr(path, size, exr_decoder.decode_by_blender)
    other, also = read_exr(path, size, decode_by_openexr)
    np.testing.assert_array_equal(blender, other)
    assert header == also
    return blender


def write(path, header, channels):
    OpenEXR.File(header, channels).write(str(path))
    return path


def test_inside_blender_it_is_blender():
    assert exr_decoder.decoder() is exr_decoder.decode_by_blender


@pytest.mark.parametrize("kind", [np.float16, np.float32], ids=["half", "float"])
@pytest.mark.parametrize("packing", KNOWN)
def test_every_compression(tmp_path, packing, kind):
    """Lines and tiles, of one level and of many, alone and beside another layer."""
    compression = getattr(OpenEXR, f"{packing}_COMPRESSION", None)
    if compression is None:
        pytest.skip(f"OpenEXR's module here cannot write {packing}")
    tiles = OpenEXR.TileDescription()
    tiles.xSize, tiles.ySize = 32, 16
    for number, tile in enumerate((None, tiles)):
        header = {"compression": compression}
        if tile is not None:
            header |= {"type": OpenEXR.tiledimage, "tiles": tile}
        depth = {"Top.Depth.Z": light()[..., 0].copy()}
        for name, channels in {
            "RGB": planes(light(kind)),
            "with alpha RGB": planes(light(kind)) | {"A": np.zeros((HEIGHT, 2 * HEIGHT), kind)},
            "rgb": planes(light(kind), letters="rgb"),
            "Top.Combined.RGB": planes(light(kind), "Top.Combined.") | depth,
        }.items():
            path = write(tmp_path / f"{name}{number}.exr", header, channels)
            try:
                found = both(path)
            except InputError as error:
                assert packing in NEWEST and bpy.app.version < (5, 0, 0)
                assert f"{packing}: Blender" in str(error)
                assert str(error).endswith("or save it with ZIP compression")
                continue
            truth = exr.planes(path)
            names = [name[:-3].rpartition(" ")[2] + letter for letter in name[-3:]]
            truth = np.stack([truth[each].astype(np.float32) for each in names], axis=2)
            np.testing.assert_array_equal(found, truth)


@pytest.mark.parametrize("mode", [1, 2], ids=["mip maps", "rip maps"])
@pytest.mark.parametrize("up", [False, True])
def test_tiles_of_many_levels(tmp_path, mode, up):
    """The finest level is the picture; the others are counted, by both ways of rounding."""
    rgb, side = light(), 32

    def sizes(length):
        found = [length]
        while found[-1] > 1:
            found.append(max(1, (found[-1] + up) // 2))
        return list(enumerate(found))

    levels = [(x, y) for x in sizes(2 * HEIGHT) for y in sizes(HEIGHT)]
    if mode == 1:
        pairs = dict(sizes(HEIGHT))
        levels = [((i, w), (i, pairs.get(i, 1))) for i, w in sizes(2 * HEIGHT)]
    chunks = []
    for (across, width), (down, height) in levels:
        picture = rgb if (across, down) == (0, 0) else np.zeros((height, width, 3), np.float32)
        for ty in range(-(-height // side)):
            for tx in range(-(-width // side)):
                tile = picture[ty * side : (ty + 1) * side, tx * side : (tx + 1) * side, ::-1]
                data = np.ascontiguousarray(tile.transpose(0, 2, 1)).tobytes()  # B, G, R of a row
                chunks.append(struct.pack("<5i", tx, ty, across, down, len(data)) + data)
    windows = struct.pack("<4i", 0, 0, 2 * HEIGHT - 1, HEIGHT - 1)
    channels = b"".join(c + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for c in (b"B", b"G", b"R"))
    head = b"\x76\x2f\x31\x01\x02\x02\0\0"
    for name, kind, content in (
        (b"channels", b"chlist", channels + b"\0"),
        (b"compression", b"compression", b"\0"),
        (b"dataWindow", b"box2i", windows),
        (b"displayWindow", b"box2i", windows),
        (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1.0)),
        (b"screenWindowCenter", b"v2f", bytes(8)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1.0)),
        (b"tiles", b"tiledesc", struct.pack("<2IB", side, side, mode | up << 4)),
    ):
        head += name + b"\0" + kind + b"\0" + struct.pack("<i", len(content)) + content
    head += b"\0"
    places = np.cumsum([len(head) + 8 * len(chunks), *map(len, chunks[:-1])])
    path = tmp_path / "a.exr"
    path.write_bytes(head + places.astype("<u8").tobytes() + b"".join(chunks))
    np.testing.assert_array_equal(both(path), rgb)


@pytest.mark.parametrize("packing", ["DWAA", "DWAB"])
def test_layers_whose_names_decide_how_they_are_packed(tmp_path, packing):
    """They keep their names, and Blender takes them apart itself."""
    header = {"compression": getattr(OpenEXR, f"{packing}_COMPRESSION")}
    depth = light()[..., 0].copy()
    for layer, other, z in (("V.Combined.", "V.DiffCol.", "V.Depth.Z"), ("beauty.", "AO.", "Z")):
        channels = planes(light(), layer) | planes(2 * light(), other) | {z: depth}
        path = write(tmp_path / f"{layer}exr", header, channels)
        held = exr.planes(path)
        truth = np.stack([held[layer + letter] for letter in "RGB"], axis=2)
        np.testing.assert_array_equal(both(path), truth)


def test_windows(tmp_path):
    """Data windows that start anywhere, smaller and larger than the picture."""
    rgb = light()
    for left, top in ((0, 0), (17, 5), (-31, -4), (-100, 300)):
        window = [np.array(p, np.int32) for p in ((left, top), (left + 139, top + 69))]
        shown = [np.array(p, np.int32) for p in ((0, 0), (139, 69))]
        header = {"dataWindow": tuple(window), "displayWindow": tuple(shown)}
        path = write(tmp_path / "a.exr", header, planes(rgb))
        expected = np.zeros_like(rgb)
        for y in range(HEIGHT):
            for x in range(2 * HEIGHT):
                if 0 <= y - top < HEIGHT and 0 <= x - left < 2 * HEIGHT:
                    expected[y, x] = rgb[y - top, x - left]
        np.testing.assert_array_equal(both(path), expected)


@pytest.mark.parametrize("tiled", [False, True])
def test_parts(tmp_path, tiled):
    """The beauty of several parts, wherever it stands, in lines or tiles."""
    rgb = light()
    header = {"compression": OpenEXR.ZIP_COMPRESSION}
    if tiled:
        header |= {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    for order in (("AO", "beauty", "depth"), ("beauty", "AO", "depth"), ("depth", "AO", "beauty")):
        parts = [
            OpenEXR.Part(
                {**header, "name": name},
                planes(rgb if name == "beauty" else 9.0 * rgb)
                if name != "depth"
                else {"Z": rgb[..., 0].copy()},
            )
            for name in order
        ]
        OpenEXR.File(parts).write(str(tmp_path / "a.exr"))
        np.testing.assert_array_equal(both(tmp_path / "a.exr"), rgb)


def test_half_beside_float_and_many_channels(tmp_path):
    rgb = light()
    channels = planes(rgb)
    channels["G"] = channels["G"].astype(np.float16)
    expected = rgb.copy()
    expected[..., 1] = channels["G"]
    path = write(tmp_path / "mixed.exr", {}, channels)
    np.testing.assert_array_equal(both(path), expected)
    many = {f"S0.{nm},000000nm": rgb[..., 0].copy() for nm in range(380, 785, 5)}
    path = write(tmp_path / "many.exr", {}, planes(rgb) | many)
    np.testing.assert_array_equal(both(path), rgb)
    path = write(tmp_path / "spectral.exr", {}, many)
    with pytest.raises(InputError, match="of spectral channel 1 are not finite"):
        exr_decoder.read_sky(path)


@pytest.mark.parametrize("packing", ["ZIP", "PIZ", "DWAA"])
def test_grey_and_tristimulus(tmp_path, packing):
    """A lone Y, plain or in a layer, with alpha or depth beside it; and X, Y, Z."""
    grey, header = light()[..., :1], {"compression": getattr(OpenEXR, f"{packing}_COMPRESSION")}
    alone = {"Y": grey[..., 0].copy()}
    for number, channels in enumerate(
        (alone, alone | {"A": np.zeros_like(alone["Y"])}, {"L.Y": alone["Y"], "L.Z": alone["Y"]})
    ):
        path = write(tmp_path / f"{number}.exr", header, dict(channels))
        held = exr.planes(path)
        truth = next(plane for name, plane in held.items() if name.endswith("Y"))
        np.testing.assert_array_equal(both(path), np.repeat(truth[..., None], 3, axis=2))
    path = write(tmp_path / "xyz.exr", header, planes(light(), letters="XYZ"))
    held = exr.planes(path)
    np.testing.assert_array_equal(both(path), np.stack([held[c] for c in "XYZ"], axis=2))


def test_damage_is_one_line(tmp_path, capfd):
    """Whatever is changed among the pixels: read, or refused in one line, and nothing printed."""
    path = write(tmp_path / "a.exr", {}, planes(np.round(light())))  # ZIP, which has checksums
    whole, rng = path.read_bytes(), np.random.default_rng(4)
    refused = 0
    for _ in range(60):
        bad = bytearray(whole)
        for place in rng.integers(400, len(whole), 40):
            bad[place] = rng.integers(256)
        path.write_bytes(bad)
        try:
            read_exr(path, len(bad), exr_decoder.decode_by_blender)
        except InputError as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused > 20
    assert capfd.readouterr() == ("", "")


def test_skies_without_openexr(tmp_path):
    """In a Blender whose Python has no OpenEXR: written, read and lit by, by the same numbers."""
    code = (
        "import sys, bpy\n"
        "sys.modules['OpenEXR'] = None\n"
        "import numpy as np\n"
        "from spectral_skylight.addon import cli\n"
        "from spectral_skylight.addon.sky.panorama import write_panorama, write_spectral\n"
        "rgb = np.random.default_rng(1).uniform(0.1, 4.0, (32, 64, 3)).astype(np.float32)\n"
        "write_panorama('sky.exr', rgb, {'whiteLuminance': 1e4})\n"
        "write_spectral('spectral.exr', rgb, [400.0, 500.0, 600.0])\n"
        "code = cli.main(['irradiance', 'sky.exr', '--out', 'e.exr', '--json'])\n"
        "sys.stdout.flush()\n"
        "import os; os._exit(code)"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert '"coefficients"' in run.stdout
    rgb = np.random.default_rng(1).uniform(0.1, 4.0, (32, 64, 3)).astype(np.float32)
    np.testing.assert_array_equal(exr.picture(tmp_path / "sky.exr"), rgb)
    assert exr.picture(tmp_path / "e.exr").shape == (32, 64, 3)
