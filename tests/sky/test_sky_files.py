"""Skies as programs write them: layers, crops, primaries, corrections; read as they are meant."""

import struct

import numpy as np
import OpenEXR
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.exr_header import header_of
from spectral_skylight.addon.sky.exr_layers import find_colours
from spectral_skylight.addon.sky.exr_writer import write_exr
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.addon.spectra.working_spaces import primaries_to_rec709
from spectral_skylight.tests import exr
from spectral_skylight.tests.sky.test_panorama import as_float, hdr, noise, rgbe

REC2020 = (0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329)
ACESCG = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)


def planes(rgb, prefix="", letters="RGB"):
    return {prefix + letter: rgb[..., i].copy() for i, letter in enumerate(letters)}


def write(path, header, channels):
    OpenEXR.File(header, channels).write(str(path))
    return path


def with_attribute(path, name, kind, content):
    """Add an entry to an EXR's header; the table of its blocks moves with them."""
    whole = path.read_bytes()
    (part,) = header_of(path)
    entry = name + b"\0" + kind + b"\0" + struct.pack("<i", len(content)) + content
    table = np.frombuffer(whole, "<u8", part.blocks, part.table) + len(entry)
    rest = whole[part.table + 8 * part.blocks :]
    path.write_bytes(whole[:8] + entry + whole[8 : part.table] + table.tobytes() + rest)
    return path


@pytest.mark.parametrize(
    "entry",
    [
        (b"preview", b"preview", struct.pack("<2I", 2, 1) + bytes(8)),
        (b"owner", b"string", "café".encode("latin-1")),
        ("Größe".encode("latin-1"), b"string", b"x"),
        (b"unheard", b"of", b"\xff\xfe"),
    ],
    ids=["thumbnail", "text in Latin-1", "name in Latin-1", "unknown type"],
)
def test_unusual_headers_spoil_nothing(tmp_path, entry):
    path = with_attribute(write(tmp_path / "a.exr", {}, planes(noise())), *entry)
    sky = read_panorama(path)
    np.testing.assert_array_equal(sky.rgb, noise())
    assert sky.notes == ()
    if entry[0] == b"owner":
        assert sky.metadata["owner"] == "café"


@pytest.mark.parametrize(
    ("names", "chosen"),
    [
        (("AO", "Beauty"), "Beauty"),
        (("", "beauty"), ""),
        (("ViewLayer.Combined", "ViewLayer.DiffCol", "ViewLayer.Env"), "ViewLayer.Combined"),
        (("V.Combined_key", "V.Combined", "V.AO"), "V.Combined"),
        (("rgba", "albedo"), "rgba"),
        (("C_main", "Albedo"), "C_main"),
        (("normal", "sky"), "sky"),
        (("AO",), "AO"),
        (("specular", "exterior", "zenith"), "exterior"),
    ],
)
def test_the_beauty_is_read_and_named(tmp_path, names, chosen):
    channels = {}
    for name in names:
        factor = 1.0 if name == chosen else 7.0
        channels |= planes(factor * noise(), name + "." if name else "")
    sky = read_panorama(write(tmp_path / "a.exr", {}, channels))
    np.testing.assert_array_equal(sky.rgb, noise())
    assert sky.metadata["layer"] == chosen
    called = f"the layer {chosen or 'without a name'} is read"
    of = f", of {len(names)} layers" if len(names) > 1 else ""
    assert sky.notes == (called + of,)


def test_names_in_latin_1(tmp_path):
    path = write(tmp_path / "a.exr", {}, planes(noise(), "Beaute."))
    path.write_bytes(path.read_bytes().replace(b"Beaute", b"Beaut\xe9"))
    assert read_panorama(path).metadata["layer"] == "Beauté"


def test_no_beauty(tmp_path):
    several = planes(noise(), "AO.") | planes(noise(), "normal.")
    path = write(tmp_path / "a.exr", {}, several)
    with pytest.raises(
        InputError, match="holds the layers AO, normal and no beauty layer; save only"
    ):
        read_panorama(path)
    whole = {c: np.ones((8, 16), np.uint32) for c in "RGB"}
    with pytest.raises(InputError, match="holds integers: B, G, R; save it as RGB"):
        read_panorama(write(path, {}, whole))
    luma = {"Y": noise()[..., 0].copy(), "RY": noise()[..., 1].copy(), "BY": noise()[..., 2].copy()}
    with pytest.raises(InputError, match="no channels R, G, B but BY, RY, Y"):
        read_panorama(write(path, {}, luma))
    spectral = {f"w{nm}nm": noise()[..., 0].copy() for nm in range(400, 700, 50)}
    with pytest.raises(InputError, match="is spectral: .*; use the sky's RGB file"):
        read_panorama(write(path, {}, spectral))


@pytest.mark.parametrize("letters", ["rgb", "RGB"])
def test_small_letters_and_kinds_side_by_side(tmp_path, letters):
    channels = planes(noise(), letters=letters)
    channels[letters[1]] = channels[letters[1]].astype(np.float16)
    expected = noise()
    expected[..., 1] = channels[letters[1]]
    sky = read_panorama(write(tmp_path / "a.exr", {}, channels))
    np.testing.assert_array_equal(sky.rgb, expected)
    words = dict(zip(("red", "green", "blue"), np.moveaxis(noise(), 2, 0).copy(), strict=True))
    sky = read_panorama(write(tmp_path / "b.exr", {}, words))
    np.testing.assert_array_equal(sky.rgb, noise())


def test_tristimulus_values_are_converted(tmp_path):
    """XYZ of D65 is white, and the matrix is IEC 61966-2-1's, of four digits."""
    XYZ = np.full((8, 16, 3), (0.9505, 1.0, 1.089), np.float32)
    XYZ[3] = 0.4, 0.5, 0.6
    sky = read_panorama(write(tmp_path / "a.exr", {}, planes(XYZ, letters="XYZ")))
    matrix = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
    np.testing.assert_allclose(sky.rgb, XYZ @ np.transpose(matrix), atol=1e-3)
    assert sky.notes == ("its channels are X, Y, Z: converted",)
    # Beside a picture they are normals or places.
    channels = planes(noise()) | planes(XYZ, "N.", "XYZ")
    np.testing.assert_array_equal(
        read_panorama(write(tmp_path / "b.exr", {}, channels)).rgb, noise()
    )


@pytest.mark.parametrize(
    ("header", "space"),
    [
        ({"colorInteropID": "lin_ap1_scene"}, ACESCG),
        ({"chromaticities": ACESCG}, ACESCG),
        ({"chromaticities": REC2020}, REC2020),
        ({"colorInteropID": "lin_rec2020_scene", "chromaticities": ACESCG}, REC2020),
        ({"colorInteropID": "lin_rec709_scene", "chromaticities": ACESCG}, None),
        ({"colorInteropID": "data", "chromaticities": ACESCG}, ACESCG),
        ({"colorInteropID": "unknown"}, None),
    ],
)
def test_primaries_are_converted(tmp_path, header, space):
    sky = read_panorama(write(tmp_path / "a.exr", header, planes(noise())))
    to_rec709 = np.eye(3) if space is None else primaries_to_rec709(space)
    expected = np.maximum(noise() @ to_rec709.T, 0.0)
    np.testing.assert_allclose(sky.rgb, expected, atol=2e-5)  # float32 of values up to 8
    assert len(sky.notes) == (space is not None)
    raw = read_panorama(tmp_path / "a.exr", raw=True)
    np.testing.assert_array_equal(raw.rgb, noise())
    assert raw.notes == ()


def test_encoded_numbers_are_refused_and_unknown_ones_told(tmp_path):
    path = write(tmp_path / "a.exr", {"colorInteropID": "g22_rec709_scene"}, planes(noise()))
    with pytest.raises(InputError, match="g22_rec709_scene, which is not linear light; save it"):
        read_panorama(path)
    write(path, {"colorInteropID": "lin_moon_scene"}, planes(noise()))
    assert "lin_moon_scene, which is unknown" in read_panorama(path).notes[0]


@pytest.mark.parametrize(
    ("lines", "matrix", "words"),
    [
        (b"PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\n", REC2020, ["primaries"]),
        (b"PRIMARIES=0 0 0 0 0 0 0 0\nGAMMA=1\nEXPOSURE=1.0\n", None, []),
        (b"PRIMARIES=0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3\n", None, ["impossible primaries"]),
        (b"COLORCORR=2 1 0.5\n", (0.5, 1.0, 2.0), ["multiplied by 2, 1, 0.5"]),
        (b"COLORCORR=2 1 0.5\nCOLORCORR= 2 4 1\n", (0.25, 0.25, 2.0), ["by 4, 4, 0.5"]),
        (b"COLORCORR=0 1 2\n", None, ["impossible COLORCORR"]),
        (b"EXPOSURE=2\nEXPOSURE=4\n", None, ["by 8 (EXPOSURE)"]),
        (b"GAMMA=2.2\n", None, ["GAMMA 2.2"]),
        (b"OWNER=caf\xe9\n", None, []),
    ],
)
def test_what_radiance_says_is_undone_or_told(tmp_path, lines, matrix, words):
    pixels, path = rgbe(noise()), tmp_path / "a.hdr"
    path.write_bytes(hdr(pixels, lines))
    sky = read_panorama(path)
    matrix = np.ones(3) if matrix is None else np.array(matrix)
    matrix = np.diag(matrix) if len(matrix) == 3 else primaries_to_rec709(matrix)
    expected = np.maximum(as_float(pixels) @ matrix.T, 0.0)
    np.testing.assert_allclose(sky.rgb, expected, atol=2e-5)  # float32 of values up to 8
    assert len(sky.notes) == len(words)
    assert all(word in note for word, note in zip(words, sky.notes, strict=True))


def test_crops_are_filled_with_black(tmp_path):
    rgb = noise(32)
    ends = [np.array(p, np.int32) for p in ((0, 0), (63, 31))]
    header = {"displayWindow": tuple(ends)}
    sky = read_panorama(write(tmp_path / "a.exr", header, planes(rgb[:26])))
    np.testing.assert_array_equal(sky.rgb[:26], rgb[:26])
    assert not sky.rgb[26:].any()
    assert sky.notes == ("the file is cropped: 19 % of the panorama is black",)
    # A display window that is none, as some programs leave it: all that there is.
    header = {"displayWindow": (np.array([0, 0], np.int32), np.array([0, 0], np.int32))}
    np.testing.assert_array_equal(
        read_panorama(write(tmp_path / "b.exr", header, planes(rgb))).rgb, rgb
    )
    header = {"displayWindow": (np.array([100, 0], np.int32), np.array([163, 31], np.int32))}
    with pytest.raises(InputError, match="is completely black"):
        read_panorama(write(tmp_path / "c.exr", header, planes(rgb)))


def test_header_says_what_openexr_says(tmp_path):
    header = {"compression": OpenEXR.PIZ_COMPRESSION, "comment": "a sky", "xDensity": 72.5}
    path = write(tmp_path / "a.exr", header | {"chromaticities": ACESCG}, planes(noise(), "a.b."))
    (part,) = header_of(path)
    with OpenEXR.File(str(path)) as file:
        theirs = dict(file.header())
    for name in ("comment", "xDensity", "chromaticities"):
        assert part.attributes[name] == theirs[name]
    assert part.compression == 4
    assert [channel.name for channel in part.channels] == ["a.b.B", "a.b.G", "a.b.R"]
    assert find_colours([part], path).layer == "a.b"


@pytest.mark.parametrize("shape", [(1, 2), (16, 32), (37, 74), (300, 600)])
def test_what_is_written_is_read_by_openexr(tmp_path, shape):
    """Noise, which does not pack, and runs, which do, of any height; channels by their names."""
    rng = np.random.default_rng(5)
    rgb = rng.normal(size=(*shape, 3)).astype(np.float32)
    rgb[shape[0] // 2 :] = 0.25
    write_panorama(tmp_path / "a.exr", rgb, {"whiteLuminance": 1e4, "comments": "für uns", "n": 3})
    np.testing.assert_array_equal(exr.picture(tmp_path / "a.exr"), rgb)
    with OpenEXR.File(str(tmp_path / "a.exr")) as file:
        header = dict(file.header())
    assert (header["whiteLuminance"], header["comments"], header["n"]) == (1e4, "für uns", 3)
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    named = {f"S0.{k}": rgb[..., k] for k in (2, 0, 1)}
    write_exr(tmp_path / "b.exr", named, {})
    for name, plane in exr.planes(tmp_path / "b.exr").items():
        np.testing.assert_array_equal(plane, named[name])
    with pytest.raises(TypeError, match="neither text nor number"):
        write_exr(tmp_path / "b.exr", named, {"x": [1]})
