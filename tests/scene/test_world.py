"""Which HDRI a World shows, that its pixels are the file's, and why other Worlds are baked."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.blend_data import working_space
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.scene.world import panorama
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.node_groups import spectral_matrix
from spectral_skylight.tests import faces

pytestmark = pytest.mark.blender

RAW = np.array([[1.6, -0.4, 0.0], [-0.2, 1.3, -0.1], [0.0, -0.3, 1.5]])
"""A matrix such as develops a camera's raw."""

# Linear Rec.709 to the other working spaces, after colour-science (Bradford to ACES's white).
TO_REC2020 = [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
TO_ACESCG = [[0.6131, 0.3395, 0.0474], [0.0702, 0.9164, 0.0134], [0.0206, 0.1096, 0.8698]]


@pytest.fixture
def scene(tmp_path):
    scene = faces.empty_scene()
    faces.light(scene, tmp_path)
    return scene


def test_what_is_read_from_the_nodes(scene, tmp_path):
    nodes = scene.world.node_tree.nodes
    nodes["Mapping"].inputs["Rotation"].default_value = (0.1, 0.2, 0.3)
    nodes["Mapping"].vector_type = "TEXTURE"
    sky = worlds.sky_of(scene.world)
    np.testing.assert_allclose(sky.rotation, (0.1, 0.2, 0.3), atol=1e-7)
    assert (sky.inverse, sky.image.name, sky.name) == (True, "sky1.exr", "sky1.exr")
    assert sky.line == ""
    assert (sky.background, sky.texture, sky.mapping) == (
        "Background",
        "Environment Texture",
        "Mapping",
    )


@pytest.mark.parametrize("without", ["Mapping", "Texture Coordinate"])
def test_a_bare_texture_is_not_turned(scene, without):
    tree = scene.world.node_tree
    tree.nodes.remove(tree.nodes[without])
    if without == "Texture Coordinate":
        tree.nodes.remove(tree.nodes["Mapping"])
    sky = worlds.sky_of(scene.world)
    assert (sky.mapping, sky.rotation, sky.inverse) == (None, (0.0, 0.0, 0.0), False)


def test_reroutes_and_muted_nodes_are_seen_through(scene):
    tree = scene.world.node_tree
    texture, background = tree.nodes["Environment Texture"], tree.nodes["Background"]
    reroute, gamma = tree.nodes.new("NodeReroute"), tree.nodes.new("ShaderNodeGamma")
    tree.links.new(texture.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], gamma.inputs["Color"])
    tree.links.new(gamma.outputs[0], background.inputs["Color"])
    assert 'fed by "Gamma"' in worlds.sky_of(scene.world).why
    gamma.mute = True
    assert worlds.sky_of(scene.world).texture == "Environment Texture"


def no_texture(nodes):
    nodes.remove(nodes["Environment Texture"])


def no_image(nodes):
    nodes["Environment Texture"].image = None


def no_surface(nodes):
    nodes.remove(nodes["Background"])


def mirror_ball(nodes):
    nodes["Environment Texture"].projection = "MIRROR_BALL"


def linked_strength(nodes):
    value = nodes.new("ShaderNodeValue")
    nodes.id_data.links.new(value.outputs[0], nodes["Background"].inputs["Strength"])


def linked_rotation(nodes):
    value = nodes.new("ShaderNodeCombineXYZ")
    nodes.id_data.links.new(value.outputs[0], nodes["Mapping"].inputs["Rotation"])


def scaled(nodes):
    nodes["Mapping"].inputs["Scale"].default_value = (1, 1, -1)


def moved(nodes):
    nodes["Mapping"].inputs["Location"].default_value = (0, 0, 0.5)


def other_coordinates(nodes):
    links = nodes.id_data.links
    links.new(nodes["Texture Coordinate"].outputs["Camera"], nodes["Mapping"].inputs["Vector"])


def no_coordinates(nodes):
    nodes.remove(nodes["Texture Coordinate"])


STRENGTH, TURN = "Strength", "Strength and Rotation"


@pytest.mark.parametrize(
    ("change", "why", "live"),
    [
        (no_texture, "Background is fed by no texture", STRENGTH),
        (no_image, "has no image", TURN),
        (no_surface, "output is fed by no texture", ""),
        (mirror_ball, "is a mirror ball", TURN),
        (linked_strength, "Strength is linked", ""),
        (linked_rotation, "Rotation is linked", STRENGTH),
        (scaled, "has a Scale", STRENGTH),
        (moved, "has a Location", STRENGTH),
        (other_coordinates, 'looked up by "Texture Coordinate", Camera', STRENGTH),
        (no_coordinates, "Mapping has no Vector", STRENGTH),
    ],
)
def test_why_a_world_is_baked_and_what_is_followed_live(scene, change, why, live):
    change(scene.world.node_tree.nodes)
    sky = worlds.sky_of(scene.world)
    assert why in sky.why and sky.image is None
    verb = "are" if live == TURN else "is"
    assert (f"; {live} {verb} updated live" in sky.line) == bool(live)
    assert "\n" not in sky.line


def test_no_world_and_a_plain_one(scene):
    with pytest.raises(InputError, match="has no World"):
        worlds.sky_of(None)
    assert worlds.sky_of(bpy.data.worlds.new("Plain")).image is None


def test_pixels_are_the_files_packed_external_and_linked(scene, tmp_path):
    image = worlds.sky_of(scene.world).image
    truth = read_panorama(tmp_path / "sky1.exr").rgb
    assert panorama.pixels_of(image).dtype == np.float32
    np.testing.assert_array_equal(panorama.pixels_of(image), truth)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "external.blend"))
    image.pack()
    (tmp_path / "sky1.exr").rename(tmp_path / "elsewhere.exr")
    np.testing.assert_array_equal(panorama.pixels_of(image), truth)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "packed.blend"), copy=True)
    (tmp_path / "elsewhere.exr").rename(tmp_path / "sky1.exr")
    for library in ("packed.blend", "external.blend"):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        with bpy.data.libraries.load(str(tmp_path / library), link=True) as (_, wanted):
            wanted.worlds = ["sky1"]
        linked = worlds.sky_of(bpy.data.worlds[0]).image
        assert linked.library is not None
        np.testing.assert_array_equal(panorama.pixels_of(linked), truth)


@pytest.mark.parametrize("name", ["Linear Rec.709", "Non-Color", "Linear Rec.2020", "ACEScg"])
def test_pixels_follow_the_images_colour_space(scene, tmp_path, name):
    """What an image in that space says, brought to Linear Rec.709; Non-Color is left as it is."""
    image = worlds.sky_of(scene.world).image
    image.colorspace_settings.name = name
    truth = read_panorama(tmp_path / "sky1.exr").rgb
    to_working = {
        "Linear Rec.2020": np.linalg.inv(TO_REC2020),
        "ACEScg": np.linalg.inv(TO_ACESCG),
    }.get(name, np.eye(3))
    # Matrices of four digits; Blender keeps float32.
    tolerance = 1e-3 if name in ("Linear Rec.2020", "ACEScg") else 0.0
    np.testing.assert_allclose(panorama.pixels_of(image), truth @ to_working.T, atol=tolerance)


@pytest.mark.skipif(bpy.app.version < (5, 0, 0), reason="one working space before 5.0")
@pytest.mark.parametrize(("name", "to"), [("Linear Rec.2020", TO_REC2020), ("ACEScg", TO_ACESCG)])
def test_pixels_are_in_the_files_working_space(scene, tmp_path, name, to):
    assert working_space.name() == "Linear Rec.709"
    bpy.ops.wm.set_working_color_space(working_space=name, convert_colors=False)
    assert working_space.name() == name
    image = bpy.data.images.load(str(tmp_path / "sky1.exr"))
    assert image.colorspace_settings.name == "Linear Rec.709"  # what Blender takes an EXR for
    truth = read_panorama(tmp_path / "sky1.exr").rgb
    np.testing.assert_allclose(panorama.pixels_of(image), truth @ np.transpose(to), atol=1e-3)


def test_working_space_before_any_choice():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert working_space.name() == "Linear Rec.709"


def test_images_that_are_no_hdri(scene, tmp_path):
    image = bpy.data.images.new("Byte", 8, 4)
    with pytest.raises(InputError, match='image "Byte": has 8 bits'):
        panorama.pixels_of(image)
    image = bpy.data.images.load(str(tmp_path / "sky1.exr"))
    image.filepath = str(tmp_path / "gone.exr")
    with pytest.raises(InputError, match=r"cannot be read from .*gone.exr"):
        panorama.pixels_of(image)


def test_set_sky_keeps_a_world_that_has_it_and_edits_no_other(scene, tmp_path):
    world = scene.world
    world.node_tree.nodes["Mapping"].inputs["Rotation"].default_value = (0, 0, 1)
    assert worlds.set_sky(scene, tmp_path / "sky1.exr") == world
    write_panorama(tmp_path / "other.exr", faces.smooth_sky(2))
    new = worlds.set_sky(scene, tmp_path / "other.exr")
    assert scene.world == new != world
    assert worlds.sky_of(world).image.name == "sky1.exr"
    assert Path(bpy.path.abspath(worlds.sky_of(new).image.filepath)) == tmp_path / "other.exr"
    with pytest.raises(InputError, match=r"none.exr: there is no such file"):
        worlds.set_sky(scene, tmp_path / "none.exr")
    assert scene.world == new


def test_a_raw_sky_gets_its_matrix_in_a_world_of_its_own(scene, tmp_path):
    user = scene.world
    world = worlds.develop(scene, RAW)
    assert world != user and scene.world == world
    assert worlds.sky_of(world).image == worlds.sky_of(user).image
    assert "Spectral Matrix" not in user.node_tree.nodes
    assert worlds.develop(scene, 2 * RAW) == world  # updated in place
    held = spectral_matrix.get_matrix(world.node_tree.nodes["Spectral Matrix"])
    np.testing.assert_allclose(held, 2 * RAW, atol=1e-6)
    assert worlds.develop(scene, np.eye(3)) == world  # not raw after all
    held = spectral_matrix.get_matrix(world.node_tree.nodes["Spectral Matrix"])
    np.testing.assert_array_equal(held, np.eye(3))


def test_an_identity_needs_no_world_of_its_own(scene):
    assert worlds.develop(scene, np.eye(3)) == scene.world
    assert "Spectral Matrix" not in scene.world.node_tree.nodes


def test_raw_numbers_must_not_be_converted(scene, tmp_path):
    image = worlds.sky_of(scene.world).image
    linked_strength(scene.world.node_tree.nodes)
    with pytest.raises(
        InputError, match="does not show raw camera RGB: its Background's Strength is"
    ):
        worlds.develop(scene, RAW)
    scene.world.node_tree.nodes.remove(scene.world.node_tree.nodes["Value"])
    image.colorspace_settings.name = "ACEScg"
    with pytest.raises(
        InputError, match="with the Color Space ACEScg; set its Color Space to Non-Color"
    ):
        worlds.develop(scene, RAW)
    image.colorspace_settings.name = "Non-Color"
    worlds.develop(scene, RAW)
    write_panorama(tmp_path / "raw.exr", faces.smooth_sky(3))
    loaded = worlds.sky_of(worlds.set_sky(scene, tmp_path / "raw.exr", raw=True)).image
    assert loaded.colorspace_settings.name == "Non-Color"


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_a_raw_sky_is_seen_developed(scene, tmp_path, engine):
    write_panorama(tmp_path / "even.exr", np.full((4, 8, 3), (0.5, 0.7, 0.6), np.float32))
    worlds.set_sky(scene, tmp_path / "even.exr", raw=True)
    worlds.develop(scene, RAW)
    faces.watch(scene, (0.0, 0.0), 1.0)
    scene.render.resolution_x = scene.render.resolution_y = 4
    pixels = faces.picture(scene, tmp_path, engine)[..., :3]
    expected = RAW @ [0.5, 0.7, 0.6]
    np.testing.assert_allclose(pixels[2, 2], expected, rtol=0.002)  # half floats in Eevee
