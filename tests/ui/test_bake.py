"""The bake's buttons, as a script calls them."""

import bpy
import pytest

from spectral_skylight.addon.scene.bake import scene_bake
from spectral_skylight.node_groups import skylight_surface

pytestmark = pytest.mark.blender


def faces(name):
    """Give the stage's empty mesh one upright and one level face."""
    mesh = bpy.data.objects[name].data
    places = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)]
    mesh.from_pydata(places, [], [(0, 1, 2, 3), (0, 1, 5, 4)])


def test_bake_shows_and_remove_takes_away(scene, brick):
    faces("Wall")
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    before = len(bpy.data.objects)
    assert not bpy.ops.skylight.remove_bakes.poll()
    assert bpy.ops.skylight.bake(rays=64) == {"FINISHED"}
    assert scene_bake.baked() == [bpy.data.objects["Wall"]]
    assert scene_bake.stale() == []
    assert scene.world.skylight.occlusion == "auto"  # which asks for a bake by itself
    surface = skylight_surface.find(scene.world)
    assert skylight_surface.features_of(surface).sky == "baked"
    assert bpy.ops.skylight.remove_bakes() == {"FINISHED"}
    assert scene_bake.baked() == []
    assert len(bpy.data.objects) == before


def test_a_bake_is_shown_where_the_open_sky_was(scene, brick):
    faces("Wall")
    scene.world.skylight.occlusion = "open"
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    assert bpy.ops.skylight.bake(rays=64) == {"FINISHED"}
    assert scene.world.skylight.occlusion == "baked"


def test_only_what_is_selected(scene, brick):
    for name in ("Wall", "Roof"):
        faces(name)
        bpy.ops.skylight.apply(filepath=brick, column="brick", material=name)
    bpy.context.view_layer.objects["Wall"].select_set(True)
    bpy.context.view_layer.objects["Roof"].select_set(False)
    bpy.ops.skylight.bake(rays=64, selected=True)
    assert scene_bake.baked() == [bpy.data.objects["Wall"]]
    assert scene_bake.stale() == [bpy.data.objects["Roof"]]
