"""Load Sky HDRI shows what a file means, and a World made by hand is told what its file says."""

import bpy
import numpy as np
import OpenEXR
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.scene.world import panorama, sky_image
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.declared_colours import SPACES
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.spectra.working_spaces import primaries_to_rec709
from spectral_skylight.tests import faces
from spectral_skylight.tests.sky.test_panorama import hdr, rgbe

pytestmark = pytest.mark.blender

ACESCG = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
COLORIST = (0.7, 0.3, 0.2, 0.75, 0.14, 0.05, 0.3127, 0.329)
"""Primaries that Blender has no name for."""


def sky():
    return faces.smooth_sky(3).astype(np.float32)


def planes(rgb, prefix="", letters="RGB"):
    return {prefix + letter: rgb[..., i].copy() for i, letter in enumerate(letters)}


def exr(header, channels):
    return lambda path: OpenEXR.File(header, channels).write(str(path))


def cropped(rgb):
    rows = len(rgb)
    ends = [np.array(p, np.int32) for p in ((0, 0), (2 * rows - 1, rows - 1))]
    return exr({"displayWindow": tuple(ends)}, planes(rgb[: rows * 3 // 4]))


def infinite(rgb):
    rgb = rgb.copy()
    rgb[2, 3] = np.inf
    return exr({}, planes(rgb))


KINDS = {
    "plain.exr": (exr({}, planes(sky())), "Linear Rec.709", ""),
    "id.exr": (exr({"colorInteropID": "lin_ap1_scene"}, planes(sky())), "ACEScg", "primaries"),
    "named.exr": (exr({"chromaticities": ACESCG}, planes(sky())), "ACEScg", "primaries"),
    "nameless.exr": (exr({"chromaticities": COLORIST}, planes(sky())), "", "primaries"),
    "xyz.exr": (exr({}, planes(sky(), letters="XYZ")), "Linear CIE-XYZ D65", "X, Y, Z"),
    "layers.exr": (
        exr({}, planes(0.7 + 0 * sky(), "AO.") | planes(sky(), "Beauty.")),
        "",
        "the layer Beauty",
    ),
    "cropped.exr": (cropped(sky()), "", "cropped: 25 %"),
    "infinite.exr": (infinite(sky()), "", "infinite"),
    "corrected.hdr": (
        lambda path: path.write_bytes(hdr(rgbe(sky()), b"COLORCORR=2 1 0.5\n")),
        "",
        "COLORCORR",
    ),
}
"""By name: what writes it, the colour space that is enough to show it, and a word of its note."""


@pytest.fixture
def scene():
    return faces.empty_scene()


@pytest.mark.parametrize("name", KINDS)
def test_a_scene_shows_and_knows_what_the_file_means(scene, tmp_path, name):
    """The World's image, its light, and the same after saving; told as on the command line."""
    write, space, word = KINDS[name]
    path = tmp_path / name
    write(path)
    truth = read_panorama(path)
    world = use_cases.set_sky(scene, path, Settings())
    image = worlds.sky_of(world).image
    # Blender's own conversion: 4.5 keeps tables of 16 bits.
    tolerance = 0.0 if not word or not space else 4e-4 * truth.rgb.max()
    shown = np.maximum(panorama.pixels_of(image), 0.0)
    np.testing.assert_allclose(shown, truth.rgb, atol=tolerance)
    assert (image.colorspace_settings.name, bool(image.packed_file)) == (
        space or "Linear Rec.709",
        not space,
    )
    notes = panorama.light_of(world, observer()).signs
    assert notes == truth.notes
    assert (word in notes[0]) if word else not notes
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    before = path.read_bytes()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    image = worlds.sky_of(bpy.context.scene.world).image
    np.testing.assert_array_equal(np.maximum(panorama.pixels_of(image), 0.0), shown)
    assert worlds.set_sky(bpy.context.scene, path) == bpy.context.scene.world  # kept
    if not space:  # unpacking must not write over the file that was read
        image.unpack(method="WRITE_LOCAL")
    assert path.read_bytes() == before


def test_a_changed_file_is_read_again(scene, tmp_path):
    KINDS["layers.exr"][0](tmp_path / "a.exr")
    first = worlds.set_sky(scene, tmp_path / "a.exr")
    exr({}, planes(sky(), "AO.") | planes(2 * sky(), "Beauty."))(tmp_path / "a.exr")
    second = worlds.set_sky(scene, tmp_path / "a.exr")
    assert second != first
    np.testing.assert_array_equal(panorama.pixels_of(worlds.sky_of(second).image), 2 * sky())


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("name", KINDS)
def test_a_world_made_by_hand_is_told(scene, tmp_path, name, packed):
    path = tmp_path / name
    KINDS[name][0](path)
    image = bpy.data.images.load(str(path))
    space = KINDS[name][1]
    if packed:
        image.pack()
        path.unlink()
    notes = sky_image.notes(image)
    if name == "cropped.exr":
        with pytest.raises(InputError, match="cropped, and Blender stretches it.*Load Sky HDRI"):
            panorama.pixels_of(image)
    elif name == "infinite.exr":
        assert notes == [] and np.isinf(panorama.pixels_of(image)).any()
    elif name == "plain.exr":
        assert notes == []
    elif name == "layers.exr":
        np.testing.assert_array_equal(panorama.pixels_of(image), sky())
        assert notes[0].startswith("the layer Beauty is read, of 2 layers; load it with")
    elif space and image.colorspace_settings.name == space:  # Blender 5 reads colorInteropID
        assert notes[0].endswith(": converted")
    elif space:
        assert notes[0].endswith(f"its Color Space is Linear Rec.709: set that to {space}")
        image.colorspace_settings.name = space
        assert sky_image.notes(image)[0].endswith(": converted")
        image.colorspace_settings.name = "Non-Color"  # a camera's raw numbers
        assert sky_image.notes(image) == []
    else:
        assert "load it with Load Sky HDRI" in notes[0] and len(notes) == 1


@pytest.mark.parametrize("name", KINDS)
def test_loading_what_a_world_shows_otherwise(scene, tmp_path, name):
    """Load Sky HDRI does what the panel says that it does, and keeps a World that is right."""
    KINDS[name][0](tmp_path / name)
    write_panorama(tmp_path / "b.exr", sky())
    world = worlds.set_sky(scene, tmp_path / "b.exr")
    image = bpy.data.images.load(str(tmp_path / name))
    world.node_tree.nodes[worlds.sky_of(world).texture].image = image
    right = name == "plain.exr" or image.colorspace_settings.name not in ("", "Linear Rec.709")
    found = worlds.set_sky(scene, tmp_path / name)
    assert (found == world) == right
    shown = np.maximum(panorama.pixels_of(worlds.sky_of(found).image), 0.0)
    truth = read_panorama(tmp_path / name).rgb
    np.testing.assert_allclose(shown, truth, atol=4e-4 * truth.max())  # Blender 4.5's tables
    assert worlds.set_sky(scene, tmp_path / name) == found
    if name == "plain.exr":  # of a file that says nothing a user's own color space stays
        image.colorspace_settings.name = "ACEScg"
        assert worlds.set_sky(scene, tmp_path / name) == world


def test_raw_skies_are_never_converted(scene, tmp_path):
    write_panorama(tmp_path / "a.exr", sky(), {"chromaticities": ACESCG})
    image = sky_image.load(tmp_path / "a.exr", raw=True)
    assert image.colorspace_settings.name == "Non-Color"
    np.testing.assert_array_equal(panorama.pixels_of(image), sky())
    assert read_panorama(tmp_path / "a.exr", raw=True).notes == ()
    KINDS["cropped.exr"][0](tmp_path / "b.exr")
    image = sky_image.load(tmp_path / "b.exr", raw=True)
    assert image.colorspace_settings.name == "Non-Color" and image.packed_file


@pytest.mark.parametrize("name", SPACES)
def test_spaces_are_blenders(scene, tmp_path, name):
    """Chromaticities of each colour space, by Blender's own conversion of pure colours."""
    rgb = np.full((4, 8, 3), 0.5, np.float32)
    rgb[0, :3] = np.eye(3)
    write_panorama(tmp_path / "a.exr", rgb)
    image = bpy.data.images.load(str(tmp_path / "a.exr"))
    try:
        image.colorspace_settings.name = name
    except TypeError:
        pytest.skip(f"Blender {bpy.app.version_string} has no {name}")
    pure = panorama.pixels_of(image)[0, :3].T
    # Blender 4.5 keeps tables of 16 bits; ACES's white is rounded differently.
    np.testing.assert_allclose(pure, primaries_to_rec709(SPACES[name]), atol=2e-3)


def test_no_image_is_left_where_a_file_is_refused(scene, tmp_path):
    path = tmp_path / "a.exr"
    exr({"colorInteropID": "srgb_rec709_scene"}, planes(sky()))(path)
    before = len(bpy.data.images), len(bpy.data.worlds)
    with pytest.raises(InputError, match="srgb_rec709_scene, which is not linear light"):
        use_cases.set_sky(scene, path, Settings())
    assert (len(bpy.data.images), len(bpy.data.worlds)) == before
