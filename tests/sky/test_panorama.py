"""Skies are read as the files hold them, and what is no sky is refused in one line."""

import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky import lat_long, panorama
from spectral_skylight.addon.sky.panorama import from_pixels, read_panorama, write_panorama
from spectral_skylight.tests import exr


def noise(height=8, low=0.1):
    """A panorama without any symmetry that could hide a flip."""
    return np.random.default_rng(1).uniform(low, 4.0, (height, 2 * height, 3)).astype(np.float32)


def rgbe(rgb):
    """Pixels as Radiance stores them, (h, w, 4) bytes."""
    exponent = np.frexp(rgb.max(axis=2))[1]
    mantissa = np.floor(np.ldexp(rgb, (8 - exponent)[..., None]))
    return np.concatenate([mantissa, exponent[..., None] + 128], axis=2).astype(np.uint8)


def packed(line):
    """One component of a scanline in the new run-length packing."""
    out, literal = bytearray(), bytearray()

    def flush():
        if literal:
            out.extend([len(literal), *literal])
            literal.clear()

    for value, run in itertools.groupby(line):
        count = len(list(run))
        while count > 2:
            flush()
            out.extend([128 + min(count, 127), value])
            count -= min(count, 127)
        for _ in range(count):
            if len(literal) == 128:
                flush()
            literal.append(value)
    flush()
    return bytes(out)


def hdr(pixels, header=b"", size=None, new=True):
    """A Radiance file's bytes from its RGBE pixels."""
    height, width = pixels.shape[:2]
    size = size or b"-Y %d +X %d" % (height, width)
    body = pixels.tobytes()
    if new:
        magic = bytes([2, 2, width >> 8, width & 255])
        body = b"".join(
            magic + b"".join(packed(line[:, channel].tolist()) for channel in range(4))
            for line in pixels
        )
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + header + b"\n" + size + b"\n" + body


def as_float(pixels):
    """What an RGBE pixel is worth, by the definition."""
    scale = np.ldexp(1.0, pixels[..., 3:].astype(int) - 136) * (pixels[..., 3:] > 0)
    return pixels[..., :3] * scale


@pytest.mark.parametrize("kind", [np.float16, np.float32])
@pytest.mark.parametrize("tiled", [False, True])
@pytest.mark.parametrize("alpha", [False, True])
def test_exr_reads_as_written(tmp_path, kind, tiled, alpha):
    rgb = noise().astype(kind)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "comment": "a sky", "exposure": 2.5}
    if tiled:
        header |= {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    pixels = np.concatenate([rgb, rgb[..., :1]], axis=2) if alpha else rgb
    OpenEXR.File(header, {"RGBA" if alpha else "RGB": pixels}).write(str(tmp_path / "a.exr"))
    sky = read_panorama(tmp_path / "a.exr")
    assert sky.rgb.dtype == np.float32
    np.testing.assert_array_equal(sky.rgb, rgb.astype(np.float32))
    assert sky.metadata["comment"] == "a sky"
    assert sky.metadata["exposure"] == 2.5


def test_exr_layers_and_grey(tmp_path):
    rgb, path = noise(), tmp_path / "a.exr"
    planes = {
        f"{layer}.{c}": rgb[..., i].copy()
        for layer in ("B.Combined", "A.Depth")
        for i, c in enumerate("RGB")
    }
    planes["A.Depth.R"] *= 9
    OpenEXR.File({}, planes).write(str(path))
    sky = read_panorama(path)
    np.testing.assert_array_equal(sky.rgb, rgb)
    assert sky.metadata["layer"] == "B.Combined"
    OpenEXR.File({}, {"Y": rgb[..., 0].copy()}).write(str(path))
    np.testing.assert_array_equal(read_panorama(path).rgb, np.repeat(rgb[..., :1], 3, axis=2))
    OpenEXR.File({}, {"w400nm": rgb[..., 0].copy()}).write(str(path))
    with pytest.raises(InputError, match="no channels R, G, B but w400nm"):
        read_panorama(path)


@given(st.data())
def test_hdr_packings_agree(tmp_path_factory, data):
    """Long runs, lone bytes and bytes that look like the start of a line, in all three packings."""
    height = data.draw(st.integers(4, 9))
    count = height * height * 8
    values = data.draw(st.lists(st.integers(0, 255), min_size=1, max_size=40))
    rng = np.random.default_rng(data.draw(st.integers(0, 99)))
    runs = np.repeat(rng.choice([2, 0, 2 * height, *values], count), rng.integers(1, 9, count))
    pixels = runs[:count].astype(np.uint8).reshape(height, 2 * height, 4)
    pixels[..., :3][(pixels[..., :3] == 1).all(axis=2)] = 3  # would be a repeat in the old packing
    pixels[0, 0, :3] = 77  # would announce the new packing
    pixels[..., 3] = pixels[..., 3] // 4 + 100  # exponents of sane, finite light
    path = tmp_path_factory.mktemp("hdr") / "a.hdr"
    for new in (True, False):
        path.write_bytes(hdr(pixels, new=new))
        np.testing.assert_array_equal(read_panorama(path).rgb, as_float(pixels))


def test_hdr_old_repeats(tmp_path):
    """(1, 1, 1, n) repeats the last pixel n times; a second one in a row counts 256 each."""
    width = 600
    line = [[10, 20, 30, 128], [1, 1, 1, 44], [1, 1, 1, 2], [40, 50, 60, 129], [1, 1, 1, 42]]
    entries = np.array(line * (width // 2), np.uint8)
    body = hdr(entries[None], size=b"-Y 300 +X 600", new=False)
    (tmp_path / "a.hdr").write_bytes(body)
    rgb = read_panorama(tmp_path / "a.hdr").rgb
    first = 1 + 44 + (2 << 8)
    np.testing.assert_array_equal(
        rgb[:, :first], np.broadcast_to([10, 20, 30], (300, first, 3)) / 256
    )
    rest = (300, width - first, 3)
    np.testing.assert_array_equal(rgb[:, first:], np.broadcast_to([40, 50, 60], rest) / 128)


@pytest.mark.parametrize("new", [True, False])
def test_hdr_orientation_and_header(tmp_path, new):
    pixels, path = rgbe(noise()), tmp_path / "a.hdr"
    path.write_bytes(hdr(pixels, b"EXPOSURE=2.0\n# EXPOSURE=3\n", new=new))
    upright = read_panorama(path)
    assert upright.metadata["EXPOSURE"] == "2.0"
    # Stored values, whatever EXPOSURE says: what Blender shows.
    np.testing.assert_array_equal(upright.rgb, as_float(pixels))
    path.write_bytes(hdr(pixels[::-1, ::-1], size=b"+Y 8 -X 16", new=new))
    np.testing.assert_array_equal(read_panorama(path).rgb, upright.rgb)
    path.write_bytes(hdr(pixels, size=b"+X 16 -Y 8", new=new))
    with pytest.raises(InputError, match="is stored rotated or mirrored"):
        read_panorama(path)


@pytest.mark.blender
def test_hdr_as_blender_reads_it(shared_data):
    bpy = pytest.importorskip("bpy")
    path = shared_data / "hdri/polyhaven/venice_sunset_1k.hdr"
    image = bpy.data.images.load(str(path))
    pixels = np.empty(512 * 1024 * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    blender = pixels.reshape(512, 1024, 4)[::-1, :, :3]
    np.testing.assert_array_equal(read_panorama(path).rgb, blender)


def test_negatives_of_blenders_studio_skies_are_counted(shared_data):
    counts = {
        name: read_panorama(shared_data / f"hdri/blender_studiolights/{name}.exr").negatives
        for name in ("city", "courtyard", "forest", "sunrise", "sunset")
    }
    # From the provenance note beside the files.
    assert counts == {"city": 0, "courtyard": 12, "forest": 826, "sunrise": 358, "sunset": 4}


def test_negatives_become_zero():
    rgb = noise()
    rgb[2, 3, 1] = rgb[5, 6, 0] = -0.5
    sky = from_pixels(rgb.copy(), "a")
    assert sky.negatives == 2
    np.testing.assert_array_equal(sky.rgb, np.maximum(rgb, 0))


@pytest.mark.parametrize("ending", ["exr", "hdr"])
def test_cut_short_anywhere(tmp_path, capfd, ending):
    """Every length short of the whole is refused, in one line, and nothing else is printed."""
    path = tmp_path / f"a.{ending}"
    write_panorama(path, noise(64)) if ending == "exr" else path.write_bytes(hdr(rgbe(noise(64))))
    whole = path.read_bytes()
    for length in np.unique(np.linspace(0, len(whole) - 1, 97, dtype=int)):
        path.write_bytes(whole[:length])
        with pytest.raises(InputError) as caught:
            read_panorama(path)
        assert str(path) in str(caught.value)
        assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_damaged_hdr_names_the_scanline(tmp_path):
    whole = bytearray(hdr(rgbe(noise(64))))
    whole[whole.rindex(bytes([2, 2, 0, 128])) + 4] = 0  # the last line's first count
    (tmp_path / "a.hdr").write_bytes(whole)
    with pytest.raises(InputError, match="scanline 64 of 64 is cut short or damaged"):
        read_panorama(tmp_path / "a.hdr")


@pytest.mark.parametrize(
    ("size", "says"),
    [
        ((6, 1), "6 x 1, a cube map"),
        ((1, 6), "cube map"),
        ((8, 6), "cube map"),
        ((6, 8), "cube map"),
        ((9, 4), "not 2:1"),
        ((8, 8), "not 2:1"),
        ((0, 0), "not 2:1"),
    ],
)
def test_wrong_shapes(size, says):
    width, height = size
    with pytest.raises(InputError, match=f"^sky.hdr: is .*{says}.*; .*2:1"):
        from_pixels(np.ones((height, width, 3), np.float32), "sky.hdr")


def test_black_and_not_finite():
    with pytest.raises(InputError, match=r"^sky: is completely black; "):
        from_pixels(np.zeros((4, 8, 3)), "sky")
    rgb = noise(600)
    rgb[400, 17, 2], rgb[599, 3, 0] = np.nan, np.nan
    with pytest.raises(InputError, match="2 pixels are NaN, the first at x = 17, y = 400"):
        from_pixels(rgb, "sky")


def test_infinite_light_is_clipped_and_told():
    """To the largest half float, or to what else is brightest; endless darkness is none."""
    rgb = noise()
    rgb[1, 2], rgb[5, 6, 0] = np.inf, -np.inf
    sky = from_pixels(rgb.copy(), "sky")
    np.testing.assert_array_equal(sky.rgb[1, 2], 65504.0)
    assert sky.rgb[5, 6, 0] == 0.0 and sky.negatives == 1
    assert sky.notes[0].startswith("3 infinite value(s)") and len(sky.notes) == 1
    rgb[3, 3, 1] = 1e6
    np.testing.assert_array_equal(from_pixels(rgb.copy(), "sky").rgb[1, 2], np.float32(1e6))
    assert from_pixels(noise(), "sky").notes == ()


def test_other_kinds_of_file(tmp_path):
    from PIL import Image

    path = tmp_path / "a.hdr"  # the content decides, not the ending
    for kind in ("PNG", "JPEG", "BMP", "WebP"):
        Image.new("RGB", (8, 4), "skyblue").save(path, format=kind)
        with pytest.raises(InputError, match=f"is a {kind}: .*clipped.*; use .* .exr or .hdr"):
            read_panorama(path)
    path.write_text("solar")
    with pytest.raises(InputError, match="neither OpenEXR nor Radiance"):
        read_panorama(path)
    path.write_bytes(b"")
    with pytest.raises(InputError, match="is empty"):
        read_panorama(path)
    with pytest.raises(InputError, match="there is no such file"):
        read_panorama(tmp_path / "b.hdr")
    with pytest.raises(InputError, match="cannot be opened"):
        read_panorama(tmp_path)


def test_writing_is_whole_or_not_at_all(tmp_path):
    path = tmp_path / "a.exr"
    rgb = noise()
    write_panorama(path, rgb, {"comment": "ours"})
    sky = read_panorama(path)
    np.testing.assert_array_equal(sky.rgb, rgb)
    assert sky.metadata["comment"] == "ours"
    before = path.read_bytes()
    with pytest.raises(Exception):  # noqa: B017 - whatever OpenEXR makes of such a header
        write_panorama(path, 2 * rgb, {"compression": object()})
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.exr"]
    with pytest.raises(InputError, match="cannot be written"):
        write_panorama(tmp_path / "no" / "a.exr", rgb)


def test_spectral_layout(tmp_path):
    radiance = np.random.default_rng(2).random((4, 8, 3)).astype(np.float32)
    panorama.write_spectral(tmp_path / "s.exr", radiance, [380.0, 385.0, 1000.5])
    with OpenEXR.File(str(tmp_path / "s.exr"), separate_channels=True) as file:
        assert file.header()["spectralLayoutVersion"] == "1.0"
        assert file.header()["emissiveUnits"] == "W.m^-2.sr^-1"
    planes = exr.planes(tmp_path / "s.exr")
    names = ["S0.380,000000nm", "S0.385,000000nm", "S0.1000,500000nm"]
    assert sorted(planes) == sorted(names)
    np.testing.assert_array_equal(np.stack([planes[name] for name in names], axis=2), radiance)


def test_directions_and_solid_angles():
    height, width = 32, 64
    to = lat_long.directions(height, width)
    solid = lat_long.solid_angles(height, width)
    # Rounding only: both are closed forms.
    assert solid.sum() * width == pytest.approx(4 * np.pi, rel=1e-14)
    np.testing.assert_allclose(np.linalg.norm(to, axis=2), 1, rtol=1e-14)
    assert to[0, :, 2].min() > 0.99
    assert to[16, 31, 0] > 0.99  # the middle looks east,
    assert to[16, 15, 1] > 0.99  # a quarter left of it north
    assert to[16, 0, 0] < -0.99


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["exr", "hdr"])
def test_memory_while_reading(tmp_path, ending, record_property):
    """4k: the peak over what the interpreter holds anyway stays under twice the decoded size."""
    path = tmp_path / f"a.{ending}"
    rgb = np.tile(noise(64), (1, 32, 1))  # one 32nd of the height, repeated below
    if ending == "exr":
        write_panorama(path, np.tile(rgb, (32, 1, 1)))
    else:
        head, line, body = hdr(rgbe(rgb), size=b"-Y 2048 +X 4096").partition(b"+X 4096\n")
        path.write_bytes(head + line + body * 32)
    if not Path("/proc/self/status").exists():
        pytest.skip("peak memory is read from /proc")
    code = (
        "import re, sys, OpenEXR\n"
        "from spectral_skylight.addon.sky.panorama import read_panorama\n"
        "def peak():\n"
        "    return int(re.search(r'VmHWM:\\s*(\\d+)', open('/proc/self/status').read())[1])\n"
        "before = peak(); sky = read_panorama(sys.argv[1])\n"
        "print((peak() - before) * 1024 / sky.rgb.nbytes)"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True
    )
    ratio = float(run.stdout)
    print(f"{ending}: {ratio:.2f} times the decoded size")
    record_property("memory ratio", ratio)
    assert 1.0 < ratio < 2.0
