"""The light of Worlds that are no plain HDRI: baked, and the file as it was.

Baked light is compared with what Cycles puts on a white diffuse face, or with numbers of our own.
"""

import math

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.world import capture, panorama, sky_texture
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.scene.world.settings import stored
from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.light import FACES
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.sky.polynomial import evaluate_polynomial
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.tests import exr, faces
from spectral_skylight.tests.lanes import newest

pytestmark = pytest.mark.blender


OBSERVER = observer("Linear Rec.709")
NORMALS = np.concatenate([FACES[:5], [[0.36, 0.48, 0.8]]])
"""Faces that a camera above sees: up and at 45°."""


@pytest.fixture
def scene(tmp_path):
    scene = faces.empty_scene()
    faces.light(scene, tmp_path)
    return scene


def world_of(scene, *kinds):
    """A World of its own for the scene, and new nodes of these kinds in it."""
    scene.world = bpy.data.worlds.new("Mine")
    nodes.use(scene.world)
    tree = scene.world.node_tree
    return tree, tree.nodes["Background"], *(tree.nodes.new(f"ShaderNode{k}") for k in kinds)


def baked(scene):
    pixels, _ = capture.bake(scene.world, worlds.sky_of(scene.world))
    return pixels


def light_on(pixels, normals=NORMALS):
    return exact_irradiance(pixels, normals)


def in_cycles(scene, folder, samples):
    """What a white diffuse face of each of the `NORMALS` shows: irradiance/π as Cycles finds it."""
    obj = faces.add_faces(scene, NORMALS)
    material = bpy.data.materials.new("White")
    nodes.use(material)
    tree = material.node_tree
    tree.nodes.clear()
    shader, output = (tree.nodes.new(f"ShaderNode{k}") for k in ("BsdfDiffuse", "OutputMaterial"))
    shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    tree.links.new(shader.outputs[0], output.inputs[0])
    obj.data.materials[0] = material
    scene.cycles.samples, scene.cycles.pixel_filter_type = samples, "BOX"
    obj.visible_diffuse = obj.visible_shadow = False  # each sees all of the sky
    shown = faces.picture(scene, folder, "cycles")[..., :3]
    side = len(shown) // faces.PIXELS
    blocks = shown.reshape(side, faces.PIXELS, side, faces.PIXELS, 3).mean(axis=(1, 3))
    for left in (obj, scene.camera):
        bpy.data.objects.remove(left)
    return blocks.reshape(-1, 3)[: len(NORMALS)]


def everything():
    """All datablocks with their users, and where the person stands."""
    blocks = {
        name: [(block.name_full, block.users) for block in getattr(bpy.data, name)]
        for name in dir(bpy.data)
        if isinstance(getattr(bpy.data, name), bpy.types.bpy_prop_collection)
    }
    scene = bpy.context.scene
    return blocks, scene.name, scene.frame_current, scene.render.engine, scene.render.filepath


def rendered(scene, folder):
    """The picture that the person rendered last."""
    scene.render.image_settings.file_format = "OPEN_EXR"
    bpy.data.images["Render Result"].save_render(str(folder / "shown.exr"), scene=scene)
    return exr.picture(folder / "shown.exr")


@pytest.mark.slow
def test_a_bake_is_what_falls_on_diffuse_faces_and_leaves_no_trace(scene, tmp_path):
    """A backdrop for cameras alone, a turned and scaled texture, hue and gamma, a linked strength,
    in a group within a group."""
    image = worlds.sky_of(scene.world).image
    tree, background, texture, mapping, where, hue, gamma, rays, mix, other, half = world_of(
        scene,
        "TexEnvironment",
        "Mapping",
        "TexCoord",
        "HueSaturation",
        "Gamma",
        "LightPath",
        "MixShader",
        "Background",
        "Value",
    )
    texture.image, half.outputs[0].default_value = image, 0.5
    mapping.inputs["Rotation"].default_value = (0.3, 0.4, 2.0)
    mapping.inputs["Scale"].default_value = (1.0, 1.3, -1.0)
    hue.inputs["Saturation"].default_value, gamma.inputs["Gamma"].default_value = 1.3, 1.5
    for source, target in (
        (where.outputs["Generated"], mapping.inputs["Vector"]),
        (mapping.outputs[0], texture.inputs["Vector"]),
        (texture.outputs[0], hue.inputs["Color"]),
        (hue.outputs[0], gamma.inputs["Color"]),
        (gamma.outputs[0], background.inputs["Color"]),
        (half.outputs[0], background.inputs["Strength"]),
        (background.outputs[0], mix.inputs[1]),
        (other.outputs[0], mix.inputs[2]),
        (mix.outputs[0], tree.nodes["World Output"].inputs["Surface"]),
    ):
        tree.links.new(source, target)
    other.inputs["Color"].default_value = (9.0, 0.0, 0.0, 1.0)
    for _ in range(2):
        inner = bpy.data.node_groups.new("Rays", "ShaderNodeTree")
        inner.interface.new_socket("Camera", in_out="OUTPUT", socket_type="NodeSocketFloat")
        out = inner.nodes.new("NodeGroupOutput")
        if rays.id_data == tree:
            tree.nodes.remove(rays)
            rays = inner.nodes.new("ShaderNodeLightPath")
        else:
            group, rays = rays.id_data, inner.nodes.new("ShaderNodeGroup")
            rays.node_tree = group
        inner.links.new(rays.outputs[0], out.inputs[0])
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = inner
    tree.links.new(outer.outputs[0], mix.inputs[0])

    seen = in_cycles(scene, tmp_path, 4096)
    shown = rendered(scene, tmp_path)
    ran = []
    bpy.app.handlers.render_pre.append(ran.append)
    before = everything()
    try:
        np.testing.assert_allclose(light_on(baked(scene)), seen, rtol=0.03)
    finally:
        bpy.app.handlers.render_pre.remove(ran.append)
    assert everything() == before
    assert ran == []
    np.testing.assert_array_equal(rendered(scene, tmp_path), shown)
    bpy.data.images.remove(bpy.data.images["Render Result"])
    mapping.inputs["Scale"].default_value = (1.0, 1.0, 1.0)
    before = everything()
    baked(scene)
    assert everything() == before
    assert "output is fed by" in worlds.sky_of(scene.world).why


def test_the_mirror_ball_is_that_of_a_chrome_ball_seen_along_y(scene, tmp_path):
    """A ball of radius 1 looked at along +y from afar mirrors d at n = (d - y) / |d - y|."""
    size = 512
    across = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    x, z = np.meshgrid(across, -across)
    inside = x**2 + z**2 < 1.0
    n = np.stack([x, -np.sqrt(np.where(inside, 1.0 - x**2 - z**2, 0.0)), z], axis=-1)
    eye = np.array([0.0, 1.0, 0.0])
    d = eye - 2.0 * (n @ eye)[..., None] * n

    def sky(towards):
        shape = np.array([[0.3, 0.1, 0.2], [0.1, 0.3, 0.1], [0.2, 0.2, 0.5]])
        return np.array([0.5, 0.7, 1.0]) + towards @ shape

    ball = np.where(inside[..., None], sky(d), 0.0).astype(np.float32)
    image = bpy.data.images.new("Ball", size, size, float_buffer=True, is_data=True)
    rgba = np.concatenate([ball, np.ones_like(ball[..., :1])], axis=2)[::-1]
    image.pixels.foreach_set(np.ascontiguousarray(rgba).ravel())
    texture = scene.world.node_tree.nodes["Environment Texture"]
    texture.image, texture.projection = image, "MIRROR_BALL"
    scene.world.node_tree.nodes["Mapping"].inputs["Rotation"].default_value = (0.2, 0.5, 1.0)
    found = worlds.sky_of(scene.world)
    assert "mirror ball" in found.why and found.rotation != (0, 0, 0)  # turned live all the same
    same = sky(directions(64, 128))
    np.testing.assert_allclose(light_on(baked(scene)), light_on(same), rtol=0.01)


@pytest.mark.parametrize("kind", ["Mix", "MixShader", "AddShader"])
def test_light_of_two_skies_is_added(scene, tmp_path, kind):
    skies = [faces.smooth_sky(seed, 64) for seed in (1, 2)]
    tree, background, mix, *textures, other = world_of(
        scene, kind, "TexEnvironment", "TexEnvironment", "Background"
    )
    for k, texture in enumerate(textures):
        write_panorama(tmp_path / f"part{k}.exr", skies[k])
        texture.image = bpy.data.images.load(str(tmp_path / f"part{k}.exr"))
    output = tree.nodes["World Output"].inputs["Surface"]
    if kind == "Mix":
        mix.data_type, mix.inputs["Factor"].default_value = "RGBA", 0.5
        taken = [s for s in mix.inputs if s.enabled and s.type == "RGBA"]
        sources = [texture.outputs[0] for texture in textures]
        made = next(s for s in mix.outputs if s.enabled)
        tree.links.new(made, background.inputs["Color"])
    else:
        taken = list(mix.inputs)[-2:]
        tree.links.new(textures[0].outputs[0], background.inputs["Color"])
        tree.links.new(textures[1].outputs[0], other.inputs["Color"])
        sources = [background.outputs[0], other.outputs[0]]
        background.inputs["Strength"].default_value = other.inputs["Strength"].default_value = 1.0
        tree.links.new(mix.outputs[0], output)
    for source, target in zip(sources, taken, strict=True):
        tree.links.new(source, target)
    background.inputs["Strength"].default_value = 3.0 if kind == "Mix" else 1.0  # followed live
    expected = sum(light_on(sky) for sky in skies) * (1.0 if kind == "AddShader" else 0.5)
    np.testing.assert_allclose(light_on(baked(scene)), expected, rtol=2e-3)


def sky_types():
    found = bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items.keys()
    return found if bpy.app.version[:2] != (5, 0) else found[1:2]  # 5.0 has those of 5.2


@pytest.mark.slow
@pytest.mark.parametrize("kind", sky_types())
def test_sky_textures_light_as_cycles_has_them(scene, tmp_path, kind):
    """The sun's disc, half a pixel of the bake, holds its light within 1 %."""
    tree, background, sky = world_of(scene, "TexSky")
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    sky.sky_type = kind
    sky.sun_direction = (0.4, -0.5, 0.6)
    sky.sun_elevation, sky.sun_rotation = math.radians(38.0), math.radians(130.0)
    found = panorama.light_of(scene.world, OBSERVER)
    total = light_on(found.sky)
    if kind in sky_texture.WITH_DISC:
        assert found.sun.elevation == pytest.approx(38.0, abs=0.35)
        assert found.known_elevation == pytest.approx(38.0, abs=1e-3)
        towards = found.sun.direction
        np.testing.assert_allclose(towards, sky_texture.direction(sky), atol=0.006)
        total = total + np.maximum(NORMALS @ towards, 0.0)[:, None] * found.sun.irradiance
    else:
        assert found.sun is None
        height = math.degrees(math.atan2(0.6, math.hypot(0.4, 0.5)))
        assert found.known_elevation == pytest.approx(height, abs=1e-3)
    np.testing.assert_allclose(total, in_cycles(scene, tmp_path, 4096), rtol=0.02)


def test_plain_colours_and_worlds_without_nodes(scene):
    _, background, _ = world_of(scene, "Value")
    background.inputs["Color"].default_value = (0.2, 0.4, 0.8, 1.0)
    pixels = baked(scene)
    np.testing.assert_allclose(pixels, np.broadcast_to([0.2, 0.4, 0.8], pixels.shape), rtol=1e-5)
    if bpy.app.version < (5, 0, 0):
        scene.world = bpy.data.worlds.new("Bare")
        scene.world.color = (0.1, 0.2, 0.3)
        np.testing.assert_allclose(baked(scene)[5, 5], (0.1, 0.2, 0.3), rtol=1e-5)
    else:  # numbers are those of the file's working space
        bpy.ops.wm.set_working_color_space(working_space="ACEScg", convert_colors=False)
        np.testing.assert_allclose(baked(scene), pixels, rtol=1e-5)
    background.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scene.world = bpy.data.worlds["Mine"]
    with pytest.raises(InputError, match='World "Mine": is completely black'):
        panorama.light_of(scene.world, OBSERVER)


@newest
@pytest.mark.slow
def test_a_file_with_a_sky_texture_from_the_command_line(scene, tmp_path):
    """What reflects all shows what falls on it: sky by the baked group, sun by its lamp."""
    from spectral_skylight.addon import cli

    tree, background, sky = world_of(scene, "TexSky")
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    sky.sun_elevation, sky.sun_rotation = math.radians(38.0), math.radians(130.0)
    background.inputs["Strength"].default_value = 0.5
    obj = faces.add_faces(scene, NORMALS)
    obj.data.materials[0] = bpy.data.materials.new("White")
    nodes.use(obj.data.materials[0])
    obj.visible_shadow = False
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "in.blend"))
    (tmp_path / "white.csv").write_text(
        "nm,white\n" + "".join(f"{n},1\n" for n in range(380, 785, 5))
    )
    out = str(tmp_path / "out.blend")
    given = ["apply", str(tmp_path / "in.blend"), "--assign", f"White={tmp_path}/white.csv"]
    assert cli.main([*given, "--ground", "hdri", "--out", out]) == 0
    bpy.ops.wm.open_mainfile(filepath=out)
    scene = bpy.context.scene
    found = panorama.light_of(scene.world, OBSERVER)
    sun = np.maximum(NORMALS @ found.sun.direction, 0.0)[:, None] * found.sun.irradiance
    expected = evaluate_polynomial(found.fit.coefficients, NORMALS) + sun
    background = scene.world.node_tree.nodes["Background"]
    scene.cycles.samples = 256  # of the sun's disc, which grazes some faces
    for strength in (0.5, 2.0):
        background.inputs["Strength"].default_value = strength
        seen = faces.seen(scene, tmp_path, len(NORMALS), "cycles")
        np.testing.assert_allclose(seen, strength * expected, rtol=0.02)
    value = scene.world.node_tree.nodes.new("ShaderNodeValue")
    value.outputs[0].default_value = 0.25
    scene.world.node_tree.links.new(value.outputs[0], background.inputs["Strength"])
    settings = stored(scene.world)
    use_cases.update(scene, settings)  # all of it is in the bake now
    background.inputs["Strength"].default_value = 7.0
    seen = faces.seen(scene, tmp_path, len(NORMALS), "cycles")
    np.testing.assert_allclose(seen, 0.25 * expected, rtol=0.02)
