"""What managed and unmanaged things give to one another, in Eevee and in Cycles.

A managed wall of one colour stands on strips of floor: a mirror, a matt white one, a managed one
and a managed glossy one. The World's own light is nearly none, so that all there is comes from the
wall.
"""

import math

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.output import render
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.node_groups import skylight_surface
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import exr, faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]

WALL = np.array([0.8, 0.4, 0.2])
FLOOR = np.array([0.2, 0.3, 0.5])
FAINT = 0.01
STRIPS = ("mirror", "white", "managed", "glossy")
SIZE = 64


def shader(name, kind, **values):
    """An unmanaged material of one shader."""
    material = bpy.data.materials.new(name)
    nodes.use(material)
    tree = material.node_tree
    tree.nodes.clear()
    node = groups.add(tree, f"ShaderNode{kind}")
    for key, value in values.items():
        node.inputs[key].default_value = value
    groups.add(tree, "ShaderNodeOutputMaterial", node.outputs[0])
    return material


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mixed")
    scene = faces.empty_scene()
    write_panorama(folder / "sky.exr", np.full((16, 32, 3), FAINT))
    world = worlds.set_sky(scene, folder / "sky.exr")
    world.probe_resolution = "128"  # even as it is
    white = (1.0, 1.0, 1.0, 1.0)
    made = {
        "wall": shader("wall", "BsdfDiffuse"),
        "mirror": shader("mirror", "BsdfGlossy", Color=white, Roughness=0.0),
        "white": shader("white", "BsdfDiffuse", Color=white),
        "managed": shader("managed", "BsdfDiffuse"),
        "glossy": shader("glossy", "BsdfPrincipled", Roughness=0.05),
    }
    spectral_material.apply(made["wall"], world, spectral_material.Surface(np.diag(WALL)))
    spectral_material.apply(made["managed"], world, spectral_material.Surface(np.diag(FLOOR)))
    black = spectral_material.Surface(np.zeros((3, 3)), gloss=True)
    spectral_material.apply(made["glossy"], world, black)
    light_group.set_coefficients(world, np.ones((1, 3)))  # not the HDRI's: what is managed emits
    for k, name in enumerate(STRIPS):
        bpy.ops.mesh.primitive_plane_add(size=1, location=(2 * k - 3, -1, 0))
        bpy.context.object.name = name
        bpy.context.object.scale = (2.0, 6.0, 1.0)
        bpy.context.object.data.materials.append(made[name])
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 2.25, 1.5))
    bpy.context.object.name = "wall"
    bpy.context.object.scale = (8.0, 0.5, 3.0)
    bpy.context.object.data.materials.append(made["wall"])
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location, camera.data.lens = (0.0, -9.0, 4.0), 32
    camera.rotation_euler = (math.radians(72), 0, 0)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.cycles.samples, scene.cycles.max_bounces = 96, 4
    scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = 3
    scene.eevee.taa_render_samples = 32
    return scene, folder


def looked_at(picture, scene, point):
    """The mean of 3 by 3 pixels where a point is seen."""
    seen = world_to_camera_view(scene, scene.camera, Vector(point))
    row, column = int((1 - seen.y) * SIZE), int(seen.x * SIZE)
    return picture[row - 1 : row + 2, column - 1 : column + 2].mean(axis=(0, 1)).astype(float)


def strips(scene, folder, engine):
    """What is seen of each strip one unit before the wall, and of the wall."""
    picture = faces.picture(scene, folder, engine)
    seen = {name: looked_at(picture, scene, (2 * k - 3, 0.8, 0)) for k, name in enumerate(STRIPS)}
    return {**seen, "wall": looked_at(picture, scene, (0, 2, 1.5))}


def test_what_each_receives(scene, capsys):
    """Cycles: all. Eevee: mirrors what is on the screen, by ray tracing; without it the World."""
    scene, folder = scene
    scene.eevee.use_raytracing = False
    seen = {"Cycles": strips(scene, folder, "cycles"), "Eevee": strips(scene, folder, "eevee")}
    scene.eevee.use_raytracing = True
    seen["ray traced"] = strips(scene, folder, "eevee")
    scene.eevee.use_raytracing = False
    probe = bpy.data.objects.new("Volume", bpy.data.lightprobes.new("Volume", "VOLUME"))
    scene.collection.objects.link(probe)
    probe.location, probe.scale = (0, 0, 2), (6, 6, 3)
    probe.data.resolution_x = probe.data.resolution_y = probe.data.resolution_z = 6
    probe.data.bake_samples, probe.data.surfel_density = 128, 4
    bpy.context.view_layer.objects.active = probe
    probe.select_set(True)
    if bpy.ops.object.lightprobe_cache_bake(subset="ALL") == {"FINISHED"}:
        seen["volume"] = strips(scene, folder, "eevee")
    bpy.data.objects.remove(probe)
    with capsys.disabled():
        for how, parts in seen.items():
            print(f"\n{how:11s}", *(f"{name} {np.round(rgb, 3)}" for name, rgb in parts.items()))
    for how, parts in seen.items():
        # Managed things are what the sky makes of them, whatever stands beside them.
        np.testing.assert_allclose(parts["wall"], WALL, rtol=0.002, err_msg=how)
        np.testing.assert_allclose(parts["managed"], FLOOR, rtol=0.002, err_msg=how)
    cycles, eevee, traced = seen["Cycles"], seen["Eevee"], seen["ray traced"]
    np.testing.assert_allclose(cycles["mirror"], WALL, rtol=0.002)
    np.testing.assert_allclose(traced["mirror"], WALL, rtol=0.15)  # the screen's pixels, filtered
    assert np.all(eevee["mirror"] < 2 * FAINT)
    for name in ("white", "glossy"):
        assert np.all(cycles[name] > 0.02) and np.all(eevee[name] < 2 * FAINT)
        ratio = cycles[name] / cycles[name].sum() * WALL.sum() / WALL
        np.testing.assert_allclose(ratio, 1.0, atol=0.1)  # its colour; the World's is a tenth
        assert np.all(traced[name] > 2 * eevee[name])
    # Of a gloss Eevee finds what is on the screen; of the wall's light on a matt floor its horizon
    # scan has 0.6 (Blender 5.2) to 1.5 (4.5) of Cycles', a baked volume 1.2 to 2.2.
    np.testing.assert_allclose(traced["glossy"], cycles["glossy"], rtol=0.35)
    assert np.all(np.abs(np.log2(traced["white"] / cycles["white"])) < 1.0)
    if "volume" in seen:  # managed surfaces are baked into it as lamps are
        assert np.all(np.abs(np.log2(seen["volume"]["white"] / cycles["white"])) < 1.5)


def test_catchers_and_holdouts(scene):
    scene, folder = scene
    wall, floor = scene.objects["wall"], scene.objects["white"]
    scene.render.film_transparent = True
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "SUN"))
    lamp.rotation_euler.x = -1.0  # behind the wall
    scene.collection.objects.link(lamp)
    floor.is_shadow_catcher = True
    managed = strips(scene, folder, "cycles")["white"]
    wall.data.materials[0] = shader("plain", "BsdfDiffuse")
    plain = strips(scene, folder, "cycles")["white"]
    # It casts its shadow as what is not managed does; its own light, a third of the lamp's, makes
    # the shadow a little lighter.
    assert plain[3] > 0.9 and plain[3] - 0.15 < managed[3] < plain[3] - 0.03
    wall.data.materials[0] = bpy.data.materials["wall"]
    bpy.data.objects.remove(lamp)
    floor.is_shadow_catcher = False
    wall.is_shadow_catcher = True  # nothing lights it as Cycles sees it: it shows nothing
    assert not strips(scene, folder, "cycles")["wall"].any()
    wall.is_shadow_catcher, wall.is_holdout = False, True
    for engine in ("cycles", "eevee"):
        assert np.all(strips(scene, folder, engine)["wall"] == 0.0)
    wall.is_holdout = scene.render.film_transparent = False


def test_managed_surfaces_are_no_lamps_to_cycles(scene):
    """The same light in less time with less noise: the World's rays are not spent on them."""
    scene, folder = scene
    wall = bpy.data.materials["wall"]
    assert wall.cycles.emission_sampling == "NONE"
    means = {}
    for sampling in ("NONE", "AUTO"):
        wall.cycles.emission_sampling = sampling
        means[sampling] = strips(scene, folder, "cycles")["white"]
    wall.cycles.emission_sampling = "NONE"
    # 9 pixels of 256 samples each.
    np.testing.assert_allclose(means["NONE"], means["AUTO"], rtol=0.05)


@pytest.mark.parametrize("engine", ["cycles", "eevee"])
def test_passes(scene, engine):
    """Irradiance and reflectance where a view layer asks for them; albedo is empty."""
    scene, folder = scene
    layer = scene.view_layers[0]
    names = (skylight_surface.IRRADIANCE, skylight_surface.REFLECTANCE)
    for name in names:
        layer.aovs.add().name = name
    layer.use_pass_diffuse_color = layer.use_pass_emit = True
    scene.render.engine = render.engine_id(engine)
    scene.cycles.samples = scene.eevee.taa_render_samples = 4
    image = scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format, image.color_depth = "OPEN_EXR_MULTILAYER", "32"
    scene.render.filepath = str(folder / f"{engine}.exr")
    bpy.ops.render.render(write_still=True)
    found = exr.planes(scene.render.filepath)

    def seen(*names):
        """The wall in the pass that this Blender calls one of these names."""
        name = next(name for name in names if f"ViewLayer.{name}.R" in found)
        picture = np.stack([found[f"ViewLayer.{name}.{c}"] for c in "RGB"], axis=-1)
        return looked_at(picture, scene, (0, 2, 1.5))

    np.testing.assert_allclose(seen(names[0]), 1.0, rtol=0.002)
    np.testing.assert_allclose(seen(names[1]), WALL, rtol=0.002)
    np.testing.assert_allclose(seen("Emission", "Emit"), WALL, rtol=0.002)
    assert not seen("Diffuse Color", "DiffCol").any()
    while layer.aovs:
        layer.aovs.remove(layer.aovs[0])
    if hasattr(image, "media_type"):
        image.media_type = "IMAGE"
