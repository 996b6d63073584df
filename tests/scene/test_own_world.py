"""The user's World is kept while one of ours lights the scene, and given back; nothing is left."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import clear, use_cases
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.world import own_worlds
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import DATA

pytestmark = pytest.mark.blender

GREY = Assignment("grey", np.full(81, 0.5))


def sky(folder, seed):
    path = folder / f"sky{seed}.exr"
    write_panorama(path, faces.smooth_sky(seed))
    return path


@pytest.fixture
def scene():
    """A cube and a lamp under a World of the user's own, a colour and a turned strength."""
    scene = faces.empty_scene()
    world = bpy.data.worlds.new("Dusk")
    nodes.use(world)
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.1, 0.2, 0.4, 1.0)
    background.inputs["Strength"].default_value = 3.25
    scene.world = world
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.data.materials.append(bpy.data.materials.new("Paint"))
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.data.energy = 10.0
    scene.collection.objects.link(lamp)
    return scene


def keys():
    """Every custom property in the file, but those that hold Cycles' own settings."""
    owners = [each for name in (*DATA, "scenes") for each in getattr(bpy.data, name)]
    return {(o.name, key) for o in owners for key in o.keys() if key != "cycles"}  # noqa: SIM118


def whole():
    """What of a file has names, and what is on it."""
    return {name: {each.name for each in getattr(bpy.data, name)} for name in DATA}, keys()


def reload(folder):
    path = str(folder / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.context.scene


def test_the_world_comes_back_after_saving(scene, tmp_path):
    use_cases.load_sky(scene, sky(tmp_path, 1), Settings(occlusion="open"))
    assert scene.world.name == "sky1"
    scene = reload(tmp_path)
    assert "Dusk" in bpy.data.worlds
    use_cases.make_spectral(scene, {bpy.data.materials["Paint"]: GREY}, Settings(occlusion="open"))
    scene = reload(tmp_path)
    use_cases.remove_all()
    assert scene.world == bpy.data.worlds["Dusk"] and len(bpy.data.worlds) == 1
    background = scene.world.node_tree.nodes["Background"]
    assert background.inputs["Strength"].default_value == 3.25
    scene = reload(tmp_path)
    assert scene.world.name == "Dusk"


def test_skies_that_were_tried_leave_no_worlds(scene, tmp_path):
    given = {bpy.data.materials["Paint"]: GREY}
    use_cases.make_spectral(scene, given, Settings(occlusion="open"))
    for seed in (1, 2, 3):
        use_cases.load_sky(scene, sky(tmp_path, seed), Settings(occlusion="open"))
        assert own_worlds.behind(scene.world).name == "Dusk"
        assert len(bpy.data.worlds) == 2
    assert {image.name for image in bpy.data.images} == {"sky3.exr"}
    camera = Settings(occlusion="open", camera="Nikon 5100")
    bpy.data.images["sky3.exr"].colorspace_settings.name = "Non-Color"
    use_cases.make_spectral(scene, given, camera)  # shown through a matrix
    assert own_worlds.behind(scene.world).name == "Dusk" and len(bpy.data.worlds) == 2
    use_cases.remove_all()
    assert scene.world.name == "Dusk" and len(bpy.data.worlds) == 1


def test_a_world_that_is_developed_is_a_copy(scene, tmp_path):
    """The user's own HDRI, a camera's raw, is shown by a World of ours and stays as it is."""
    use_cases.set_sky(scene, sky(tmp_path, 1), Settings(camera="Nikon 5100"))
    own = scene.world
    for tag in (tags.OWN_WORLD, tags.WORLD_BEFORE):
        own.pop(tag, None)  # as if the user had made it
    tree = own.node_tree
    for node in [n for n in tree.nodes if n.type == "GROUP"]:
        texture = next(n for n in tree.nodes if n.type == "TEX_ENVIRONMENT")
        background = next(n for n in tree.nodes if n.type == "BACKGROUND")
        tree.nodes.remove(node)
        tree.links.new(texture.outputs[0], background.inputs["Color"])
    use_cases.develop(scene, Settings(camera="Nikon 5100"))
    assert scene.world != own and own_worlds.behind(scene.world) == own
    own_worlds.give_back()
    assert scene.world == own


def test_a_world_chosen_since_stays(scene, tmp_path):
    use_cases.load_sky(scene, sky(tmp_path, 1), Settings(occlusion="open"))
    scene.world = bpy.data.worlds.new("Noon")
    use_cases.remove_all()
    assert scene.world.name == "Noon" and "sky1" not in bpy.data.worlds


def test_a_scene_without_a_world_keeps_the_sky(scene, tmp_path):
    """Without it all would be black: it is the user's from then on, and nothing on it is ours."""
    scene.world = None
    bpy.data.worlds.remove(bpy.data.worlds["Dusk"])
    before = whole()[0]
    use_cases.load_sky(scene, sky(tmp_path, 1), Settings(occlusion="open"))
    use_cases.make_spectral(scene, {bpy.data.materials["Paint"]: GREY}, Settings(occlusion="open"))
    use_cases.remove_all()
    assert scene.world.name == "sky1"
    own = {"worlds": {"sky1"}, "images": {"sky1.exr"}}
    assert whole() == ({**before, **own}, set())
    assert not clear.is_anything_ours()


@pytest.mark.parametrize("occlusion", ["open", "dome", "baked"])
def test_remove_all_leaves_nothing(scene, tmp_path, occlusion):
    """Bakes, groups, lamps, Worlds, images and properties: the file is as it was."""
    before = whole()
    settings = Settings(occlusion=occlusion)
    use_cases.load_sky(scene, sky(tmp_path, 1), settings)
    run(use_cases.make_everything_spectral(scene, {}, settings))
    if occlusion == "baked":
        run(use_cases.bake(scene, settings, rays=32))
        use_cases.update(scene, settings)
    assert whole() != before and clear.is_anything_ours()
    use_cases.remove_all()
    assert whole() == before
    assert [modifier for obj in bpy.data.objects for modifier in obj.modifiers] == []
    assert scene.world.name == "Dusk"
    assert not clear.is_anything_ours()
