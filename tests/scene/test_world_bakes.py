"""When the light of a World is baked again, of which frame it is, and where it cannot be."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.world import capture, panorama
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests import faces
from spectral_skylight.tests.lanes import newest
from spectral_skylight.tests.scene.test_any_world import OBSERVER, baked, everything, world_of

pytestmark = pytest.mark.blender


@pytest.fixture
def scene(tmp_path):
    scene = faces.empty_scene()
    faces.light(scene, tmp_path)
    return scene


def test_what_has_not_changed_is_not_baked_again(scene, tmp_path, monkeypatch):
    tree, background, sky, ramp = world_of(scene, "TexSky", "ValToRGB")
    tree.links.new(sky.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], background.inputs["Color"])
    renders = []
    blank = np.ones((256, 512, 3), np.float32)
    monkeypatch.setattr(capture, "_render", lambda *given: (renders.append(given), blank)[1])

    def again():
        before = len(renders)
        baked(scene)
        return len(renders) > before

    assert again() and not again()
    background.inputs["Strength"].default_value = 0.3
    sky.location = (100.0, 50.0)
    sky.name = "Renamed"
    assert not again()
    ramp.color_ramp.elements[0].color = (0.1, 0.0, 0.0, 1.0)
    assert again()
    sky.sun_elevation += 0.1
    assert again()
    tree.links.remove(background.inputs["Color"].links[0])
    assert again() and not again()
    image = bpy.data.images.new("Painted", 8, 4, float_buffer=True)
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image, texture.projection = image, "MIRROR_BALL"
    tree.links.new(texture.outputs[0], background.inputs["Color"])
    assert again() and not again()
    image.pixels[0] = 0.7
    assert again()
    image.colorspace_settings.name = "Non-Color"
    assert again()
    background.inputs["Strength"].keyframe_insert("default_value", frame=1)
    assert again() and not again()
    scene.frame_set(7)
    assert again()


@newest
def test_a_sequence_is_that_of_the_frame_and_bytes_are_told(scene, tmp_path):
    texture = scene.world.node_tree.nodes["Environment Texture"]
    for frame in (1, 2):
        write_panorama(tmp_path / f"day{frame}.exr", np.full((4, 8, 3), 0.25 * frame, np.float32))
    texture.image = bpy.data.images.load(str(tmp_path / "day1.exr"))
    texture.image.source = "SEQUENCE"
    texture.image_user.frame_duration, texture.image_user.use_auto_refresh = 2, True
    scene.frame_set(2)
    light = panorama.light_of(scene.world, OBSERVER)
    np.testing.assert_allclose(light.faces, 0.5, rtol=1e-3)
    assert any("its light is that of frame 2" in note for note in light.notes)
    texture.image = bpy.data.images.new("Bytes", 8, 4)
    texture.image.generated_color = (1.0, 1.0, 1.0, 1.0)
    light = panorama.light_of(scene.world, OBSERVER)
    np.testing.assert_allclose(light.faces, 1.0, rtol=1e-3)
    assert any("8 bits per channel" in note for note in light.notes)


@newest
def test_without_cycles_it_is_told(scene):
    _, background, _ = world_of(scene, "Value")
    background.inputs["Color"].default_value = (0.3, 0.1, 0.8, 1.0)
    before = everything()
    bpy.ops.preferences.addon_disable(module="cycles")
    try:
        with pytest.raises(InputError, match="baked by Cycles alone; enable that add-on"):
            baked(scene)
    finally:
        bpy.ops.preferences.addon_enable(module="cycles")
    assert everything() == before


def test_missing_images_are_named(scene, tmp_path):
    texture = scene.world.node_tree.nodes["Environment Texture"]
    texture.projection = "MIRROR_BALL"
    texture.image.filepath = str(tmp_path / "gone.exr")
    with pytest.raises(InputError, match=r'"sky1.exr" cannot be read from .*gone.exr'):
        baked(scene)
    texture.image = None
    with pytest.raises(InputError, match='"Environment Texture" has no image; open'):
        baked(scene)
