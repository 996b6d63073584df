"""What repeats geometry has that geometry's light, or hides the light of others at least."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress
from spectral_skylight.addon.scene.bake import instance_proxies, scene_bake
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import box, ground, material, shown, sky_share

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def collected(*objects):
    """A collection of objects that the scene itself does not show."""
    found = bpy.data.collections.new("Collected")
    for obj in objects:
        found.objects.link(obj)
        bpy.context.scene.collection.objects.unlink(obj)
    return found


def test_an_instance_has_the_light_of_the_same_thing_made_real():
    """Beside a wall, turned and scaled; the only difference is in which order rays are cast."""
    found = {}
    for real in (True, False):
        faces.empty_scene()
        made_of = material()
        ground(8, made_of)
        box("Wall", (2.5, 0, 2), (1, 6, 4), made_of)
        thing = box("Thing", (0, 0, 0.5), (1, 1, 1), made_of)
        place = ((0.6, 0.3, 0.01), (0.0, 0.0, 0.4), (1.0, 1.5, 2.0))
        if real:
            obj = thing
        else:
            obj = bpy.data.objects.new("Empty", None)
            obj.instance_type, obj.instance_collection = "COLLECTION", collected(thing)
            bpy.context.scene.collection.objects.link(obj)
        obj.location, obj.rotation_euler, obj.scale = place
        bpy.context.view_layer.update()
        assert progress.run(scene_bake.bake(rays=1024)) == ["3 object(s) baked"]
        shows = obj if real else instance_proxies.stand_ins(obj)[0]
        found[real], _ = sky_share(shows)
    assert len(found[True]) > 100
    assert found[True].min() < 0.5 < found[True].max()
    np.testing.assert_allclose(found[False], found[True], atol=0.01)


@pytest.mark.parametrize("kind", ["META", "VERTS", "FACES", "PARTICLES"])
def test_what_cannot_be_baked_hides_the_sky_and_is_named(kind):
    """A metaball, or a roof that vertices, faces or particles instance, over the floor's middle."""
    faces.empty_scene()
    made_of = material()
    floor = ground(14, made_of)
    if kind == "META":
        data = bpy.data.metaballs.new("Ball")
        data.elements.new().radius = 4.0
        data.resolution = data.render_resolution = 0.5
        data.materials.append(made_of)
        obj = bpy.data.objects.new("Ball", data)
        obj.location.z, obj.scale.z = 2.0, 0.3
        bpy.context.scene.collection.objects.link(obj)
    else:
        roof = box("Roof", (0, 0, 0), (5, 5, 0.2), made_of)
        square = [(-1, -1, 1.5), (1, -1, 1.5), (1, 1, 1.5), (-1, 1, 1.5)]
        obj = shown("Carrier", square, [(0, 1, 2, 3)], made_of)
        if kind == "PARTICLES":
            system = obj.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
            system.type, system.count, system.render_type = "HAIR", 4, "OBJECT"
            system.instance_object, system.particle_size = roof, 1.0
            system.use_rotation_instance = False
        else:
            roof.parent, obj.instance_type = obj, kind
    bpy.context.view_layer.update()
    lines = progress.run(scene_bake.bake([floor], rays=64))
    assert any(obj.name in line for line in lines), lines
    share, _ = sky_share(floor)
    assert share.min() < 0.5
    assert share.max() > 0.9
