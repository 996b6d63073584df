"""A dozen awkward scenes: one click makes of each what can be, says the rest, and takes it back."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import scene_bake, sky_exposure
from spectral_skylight.addon.scene.lights import light_linking
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.ui import everything
from spectral_skylight.node_groups import baked_light
from spectral_skylight.tests import buildings, faces
from spectral_skylight.tests.buildings import DATA
from spectral_skylight.tests.lanes import newest
from spectral_skylight.tests.scene.awkward_scenes import (
    SCENES,
    excluded,
    glass_house,
    hamlet,
    linked_collection,
    odd_geometry,
    paint,
    set_by_nodes,
    village,
)

pytestmark = pytest.mark.blender


@pytest.fixture
def scene(tmp_path):
    scene = faces.empty_scene()
    faces.light(scene, tmp_path)
    for tag in (tags.OWN_WORLD, tags.WORLD_BEFORE):
        scene.world.pop(tag, None)  # the user's own
    return scene


def links():
    """What feeds each material's outputs."""
    return {
        material.name_full: sorted(
            (link.from_node.name, link.to_node.name, link.to_socket.name)
            for link in material.node_tree.links
        )
        for material in bpy.data.materials
        if material.node_tree is not None and (bpy.app.version >= (5, 0, 0) or material.use_nodes)
    }


def whole():
    """What of a file has names, and all that the add-on writes on it."""
    names = {name: sorted(each.name_full for each in getattr(bpy.data, name)) for name in DATA}
    owners = [each for name in (*DATA, "scenes") for each in getattr(bpy.data, name)]
    keys = {(o.name_full, k) for o in owners for k in o.keys() if k.startswith("spectral")}  # noqa: SIM118
    modifiers = sorted((o.name, m.name) for o in bpy.data.objects for m in o.modifiers)
    instances = sorted(
        (o.name, o.instance_collection.name) for o in bpy.data.objects if o.instance_collection
    )
    return names, keys, modifiers, instances, links()


@pytest.mark.parametrize("build", SCENES, ids=lambda build: build.__name__)
def test_one_click_and_back(scene, tmp_path, build):
    managed, left = build(tmp_path)
    bpy.context.view_layer.update()
    assert everything.SKYLIGHT_OT_make_spectral.disabled_reason(bpy.context) == ""
    before = whole()
    done = run(use_cases.make_everything_spectral(scene, {}, Settings(occlusion="open")))
    assert {result.material for result in done.results} == managed
    assert {name for name, _ in done.left} == left and all(why for _, why in done.left)
    assert {m.name for m in bpy.data.materials if spectral_material.is_managed(m)} == managed
    found = run(use_cases.make_everything_spectral(scene, {}, Settings(occlusion="open")))
    assert [r.line for r in found.results] == [r.line for r in done.results]  # twice is once
    use_cases.remove_all()
    assert whole() == before


@newest
@pytest.mark.slow
@pytest.mark.parametrize(
    "build",
    [glass_house, hamlet, set_by_nodes, odd_geometry, linked_collection, excluded],
    ids=lambda build: build.__name__,
)
def test_all_light_and_back(scene, tmp_path, build):
    """The same with all light baked: what is baked is no longer called missing."""
    build(tmp_path)
    bpy.context.view_layer.update()
    before = whole()
    settings = Settings(occlusion="baked")
    run(use_cases.make_everything_spectral(scene, {}, settings))
    lines = run(use_cases.bake(scene, settings, rays=32))
    assert scene_bake.baked() and len(lines) == len(set(lines)) < 6
    assert scene_bake.stale() == []
    use_cases.remove_all()
    assert whole() == before


def test_without_materials_the_button_says_so(scene):
    assert "No object has a material" in everything.SKYLIGHT_OT_make_spectral.disabled_reason(
        bpy.context
    )
    box = buildings.box("Box", (0, 0, 1), (2, 2, 2), None)
    box.data.materials.clear()
    before = whole()
    assert "No object has a material" in everything.SKYLIGHT_OT_make_spectral.disabled_reason(
        bpy.context
    )
    done = run(use_cases.make_everything_spectral(scene, {}, Settings(occlusion="open")))
    assert (done.results, done.left) == ([], [])
    use_cases.remove_all()
    assert whole() == before


def test_updates_reach_what_nodes_set_and_instances_show(scene, tmp_path):
    """Another sky reaches materials that no object of the scene has in a slot."""
    village(tmp_path)
    set_by_nodes(tmp_path)
    bpy.context.view_layer.update()
    run(use_cases.make_everything_spectral(scene, {}, Settings(occlusion="open")))
    names = {material.name for material in use_cases.in_scene(scene)}
    assert names == {"Wall", "Roof", "Set by nodes"}
    found = use_cases.update(scene, Settings(occlusion="open"))
    assert {result.material for result in found.results} == names
    lit = {obj.name for obj in light_linking.ensure(scene).objects}
    assert "Box" in lit and sum(name.startswith("Instance") for name in lit) == 20


def test_what_is_excluded_hides_no_sky(scene, tmp_path):
    excluded(tmp_path)
    bpy.context.view_layer.update()
    floor = bpy.data.materials["Floor"]
    assert sky_exposure.hidden_share(scene, [floor]) == 0.0
    bpy.context.view_layer.layer_collection.children["Roof"].exclude = False
    bpy.context.view_layer.update()
    assert sky_exposure.hidden_share(scene, [floor]) > 0.8


def test_a_sky_whose_picture_is_gone_is_one_line(scene, tmp_path):
    from spectral_skylight.addon.errors import InputError

    glass_house(tmp_path)
    image = next(n.image for n in scene.world.node_tree.nodes if n.type == "TEX_ENVIRONMENT")
    image.filepath = str(tmp_path / "gone.exr")
    image.reload()
    before = whole()
    with pytest.raises(InputError, match=r"gone\.exr.*restore or pack the file"):
        run(use_cases.make_everything_spectral(scene, {}, Settings(occlusion="open")))
    assert whole() == before


def test_what_casts_no_shadow_is_lit_as_what_it_is(scene):
    """Alone in a scene and beside something: by its own reflectance, not as if it had none."""
    white, floor = paint("White"), paint("Floor")
    sheet = buildings.ground(2, white)
    sheet.visible_shadow = False
    settings = Settings(occlusion="baked", ground="none")
    given = {m: Assignment("white", np.ones(81)) for m in (white, floor)}
    for beside in (False, True):
        if beside:
            buildings.box("Far", (500, 0, 1), (2, 2, 2), floor)
        bpy.context.view_layer.update()
        light = use_cases.make_spectral(scene, given, settings).light
        run(use_cases.bake(scene, settings, rays=1024))
        shown = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        seen = buildings.colours(shown, baked_light.LIGHT)[:, :3].mean(axis=0)
        # A polynomial leaves 1 % at a horizon as dark below, and 1,024 rays less.
        expected = Settings().transfer(light).to_working @ light.faces[0]
        np.testing.assert_allclose(seen, expected, rtol=0.03)
