"""The sun shines on instances too, whatever makes them, in both engines."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.lights import light_linking
from spectral_skylight.addon.scene.output import render as renders
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.tests import exr
from spectral_skylight.tests.scene.test_sun import sky_with_sun

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def test_instances_are_lit_as_the_object_is(tmp_path):
    sky_with_sun(tmp_path / "sky.exr")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    link = scene.collection.objects.link
    use_cases.set_sky(scene, tmp_path / "sky.exr", Settings())
    material = bpy.data.materials.new("Paint")
    quad = bpy.data.meshes.new("Quad")
    quad.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
    quad.materials.append(material)
    itself = bpy.data.objects.new("Itself", quad)
    itself.location.x = -3
    library = bpy.data.collections.new("Library")
    library.objects.link(bpy.data.objects.new("In the library", quad))
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", library
    point = bpy.data.meshes.new("Point")
    point.from_pydata([(3, 0, 0)], [], [])
    places = bpy.data.objects.new("Places", point)
    places.instance_type = "VERTS"
    child = bpy.data.objects.new("Child", quad)
    child.parent = places
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 10, (0, 0, 5)
    for obj in (itself, instance, places, child, camera):
        link(obj)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = 40, 12
    scene.eevee.taa_render_samples, scene.cycles.samples = 4, 64
    bpy.context.view_layer.update()
    given = {material: Assignment("test", np.full(81, 0.5))}
    use_cases.make_spectral(scene, given, Settings())
    names = {obj.name for obj in light_linking.find(scene).objects}
    assert names == {"Itself", "Instance", "Places", "Child"}
    assert not light_linking.mixed(scene)
    for engine in ("eevee", "cycles"):
        path, _ = renders.render(scene, tmp_path / f"{engine}.exr", engine=engine)
        pixels = exr.picture(path)[6, :, :3]
        # Sun and sky together; the sky alone is a third of it. Cycles has its noise.
        np.testing.assert_allclose(pixels[[20, 32]], pixels[[8, 8]], rtol=0.02)
        assert pixels[8, 0] > 0.5
