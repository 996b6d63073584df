"""What the viewport shows: shading, RGB × RGB for comparison, and a neutral white."""

import contextlib
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene.materials import rgb_comparison, spectral_material
from spectral_skylight.addon.scene.output.render import render
from spectral_skylight.addon.scene.world import view_transform
from spectral_skylight.addon.ui import panels, split_view
from spectral_skylight.tests.ui.stage import drawn, material, matrix

pytestmark = pytest.mark.blender


def shadings():
    return [
        area.spaces.active.shading
        for area in bpy.context.window.screen.areas
        if area.type == "VIEW_3D"
    ]


def test_show_in_viewport(scene):
    (shading,) = shadings()
    shading.type = "SOLID"
    assert bpy.ops.skylight.show_in_viewport() == {"FINISHED"}
    assert shading.type == "RENDERED" and shading.use_scene_world_render
    scene.render.engine = "CYCLES"  # which takes its time: Eevee shows the same at once
    bpy.ops.skylight.show_in_viewport()
    assert shading.type == "MATERIAL"
    assert shading.use_scene_world and shading.use_scene_lights
    scene.world.skylight.occlusion = "traced"
    bpy.ops.skylight.show_in_viewport()
    assert shading.type == "RENDERED"  # which Cycles alone can show
    scene.world.skylight.occlusion = "auto"
    scene.render.engine = "BLENDER_WORKBENCH"
    with pytest.raises(RuntimeError, match="Workbench does not show shaders"):
        bpy.ops.skylight.show_in_viewport()


def inputs(name="Wall"):
    """Every vector and colour of our nodes in a material, by the node's role and the input."""
    return {
        (node[tags.NODE], socket.name): tuple(socket.default_value)
        for node in material(name).node_tree.nodes
        if tags.NODE in node
        for socket in node.inputs
        if socket.type in ("VECTOR", "RGBA")
    }


def test_before_and_after_swap_values_alone(scene, brick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    bpy.ops.skylight.apply(filepath=brick, column="moss", material="Roof")
    ours = {name: inputs(name) for name in ("Wall", "Roof")}
    links = [len(bpy.data.materials[name].node_tree.links) for name in ours]
    bpy.ops.skylight.before_after()
    rgb = matrix()
    assert rgb == pytest.approx(np.diag(np.diag(rgb)))  # RGB times RGB
    # A brick's RGB under D65, by colour-science itself.
    assert np.diag(rgb) == pytest.approx(
        rgb_of(brick, "brick"), abs=5e-3
    )  # steps of 10 nm, interpolated otherwise
    assert inputs("Wall")["surface", "Sun"] == pytest.approx(np.diag(rgb))
    assert "Renders show this too" in drawn(panels.SKYLIGHT_PT_main).text
    assert [len(bpy.data.materials[name].node_tree.links) for name in ours] == links
    before = inputs("Wall")
    bpy.ops.skylight.before_after(show="DIFFERENCE")
    assert "Difference" in str(drawn(panels.SKYLIGHT_PT_main))
    for key, value in inputs("Wall").items():
        times = np.array(before[key]) + 8 * np.subtract(ours["Wall"][key], before[key])
        assert value == pytest.approx(times, rel=1e-5, abs=1e-6), key
    bpy.ops.skylight.before_after(show="BEFORE")
    assert inputs("Wall") == {k: pytest.approx(v, rel=1e-5, abs=1e-6) for k, v in before.items()}
    bpy.ops.skylight.before_after(show="AFTER")
    assert {name: inputs(name) for name in ours} == ours
    assert "Renders show" not in drawn(panels.SKYLIGHT_PT_main).text
    # Whatever makes materials spectral shows ours again, and what leaves takes all along.
    bpy.ops.skylight.before_after(show="BEFORE")
    bpy.ops.skylight.before_after(show="BEFORE")  # twice is once
    assert matrix() == pytest.approx(rgb)
    bpy.ops.skylight.update()
    assert inputs() == ours["Wall"] and rgb_comparison.shown_now() == []
    bpy.ops.skylight.before_after()
    copy = material().copy()  # says so on its own
    assert copy in rgb_comparison.shown_now()
    bpy.ops.skylight.remove_all()
    assert not any(tags.COMPARISON in m or tags.SHOWS_RGB in m for m in bpy.data.materials)


def test_judging_colors_and_back_to_the_picture(scene):
    view = scene.view_settings
    view.view_transform, view.look = "AgX", "AgX - Punchy"
    bpy.ops.skylight.view_as()
    bpy.ops.skylight.view_as()  # twice is once
    assert (view.view_transform, view.look) == ("Standard", "None")
    bpy.ops.skylight.view_as(judge=False)
    assert (view.view_transform, view.look) == ("AgX", "AgX - Punchy")
    assert tags.PICTURE not in scene


def rgb_of(path, column):
    import colour

    data = np.genfromtxt(path, delimiter=",", names=True)
    sd = colour.SpectralDistribution(dict(zip(data["wavelength_nm"], data[column], strict=True)))
    shape = colour.SpectralShape(380, 780, 5)
    D65 = colour.SDS_ILLUMINANTS["D65"].copy().align(shape)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    XYZ = [
        colour.sd_to_XYZ(each, cmfs, D65, method="Integration")
        for each in (sd.align(shape), colour.sd_ones(shape))
    ]
    to_rgb = colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB
    return to_rgb @ XYZ[0] / (to_rgb @ XYZ[1])


def test_a_texture_metal_and_glass_are_compared_too(scene, brick, tmp_path):
    image = bpy.data.images.new("tiles", 2, 2)
    for name in ("Wall", "Roof"):
        tree = material(name).node_tree
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    bpy.ops.skylight.estimate(material="Wall")
    bpy.ops.skylight.apply(material="Roof", filepath=brick, column="moss", kind="GLASS")
    pane = lambda: inputs("Roof")["glass", "Transmittance"]  # noqa: E731
    ours = inputs("Wall"), pane()
    bpy.ops.skylight.before_after()
    now = inputs("Wall")
    red = [now["texture", f"Red Row {row}"] for row in "RGB"]
    assert red == pytest.approx(np.diag([1, 0, 0]), abs=0.02)  # the image's own red
    assert pane()[:3] == pytest.approx(
        rgb_of(brick, "moss"), abs=5e-3
    )  # steps of 10 nm, interpolated otherwise
    bpy.ops.skylight.before_after()
    assert (inputs("Wall"), pane()) == ours


def test_the_view_transform_is_explained(scene):
    known = scene.view_settings.bl_rna.properties["view_transform"]
    assert known is not None
    with pytest.raises(TypeError) as caught:
        scene.view_settings.view_transform = "None of them"
    names = str(caught.value).partition("not found in (")[2].rstrip(")").split(", ")
    assert {name.strip("'") for name in names} <= set(view_transform.TRANSFORMS)
    scene.view_settings.view_transform = "Standard"
    assert view_transform.transform_line(scene)[0]
    assert "Standard: shows colors as computed" in drawn(panels.SKYLIGHT_PT_advanced).text
    scene.view_settings.view_transform = "AgX"
    fit, line = view_transform.transform_line(scene)
    assert not fit and line.startswith("AgX: ")
    scene.view_settings.look = "AgX - Punchy"
    assert "AgX - Punchy" in view_transform.transform_line(scene)[1]


def test_a_neutral_white_is_no_second_one(scene, brick):
    settings = scene.view_settings
    with pytest.raises(RuntimeError, match="Make a material spectral first"):
        bpy.ops.skylight.neutral_white()
    settings.white_balance_temperature = 5200.0
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    bpy.ops.skylight.neutral_white()
    assert settings.use_white_balance and settings.white_balance_temperature != 5200.0
    found = settings.white_balance_temperature
    bpy.ops.skylight.neutral_white()  # twice is once
    assert settings.white_balance_temperature == found
    bpy.ops.skylight.neutral_white(on=False)
    assert (settings.use_white_balance, settings.white_balance_temperature) == (False, 5200.0)
    settings.use_white_balance = True
    with pytest.raises(RuntimeError, match="view already uses White Balance"):
        bpy.ops.skylight.neutral_white()
    settings.use_white_balance = False
    scene.world.skylight.white_balanced = True
    with pytest.raises(RuntimeError, match="HDRI is already white-balanced"):
        bpy.ops.skylight.neutral_white()
    scene.world.skylight.white_balanced = False
    bpy.ops.skylight.neutral_white()
    scene.world.skylight.white_balanced = True
    bpy.ops.skylight.update()  # what would be twice from now on is taken back
    assert not settings.use_white_balance and tags.VIEW not in scene
    scene.world.skylight.white_balanced = False
    bpy.ops.skylight.update()
    bpy.ops.skylight.neutral_white()
    bpy.ops.skylight.remove_all()  # as the last material leaves
    assert (settings.use_white_balance, settings.white_balance_temperature) == (False, 5200.0)


def test_light_beyond_the_white_balance_is_refused(scene, brick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    with pytest.raises(ValueError, match="outside the range of Blender's White Balance"):
        view_transform.neutral(scene, [0.1, 0.2, 5.0])
    assert not scene.view_settings.use_white_balance and tags.VIEW not in scene


@pytest.mark.slow
def test_white_is_neutral_in_the_picture_and_EXR_stays_exact(scene, tmp_path):
    """A level white plane in sun and sky: its PNG turns grey, its linear numbers do not change."""
    white = tmp_path / "white.csv"
    white.write_text("nm,white\n" + "".join(f"{nm},0.5\n" for nm in range(380, 781, 10)))
    mesh = bpy.data.objects["Wall"].data
    mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location.z = 3.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.view_settings.view_transform = "Standard"
    scene.eevee.taa_render_samples = 4
    bpy.ops.skylight.apply(filepath=str(white))
    found = []
    for on in (False, True):
        if on:
            bpy.ops.skylight.neutral_white()
        exr, png = render(scene, tmp_path / f"{on}.exr")
        found.append((pixels(exr), pixels(png)))
    (linear, tinted), (linear_again, neutral) = found
    assert (linear == linear_again).all()
    middle = (slice(8, 24), slice(8, 24))
    # Sky and sun together differ by a tenth between channels here.
    assert np.ptp(tinted[middle].mean(axis=(0, 1))) > 0.03
    # 8 bits of a picture; the white balance is a temperature and a tint, so not wholly exact.
    assert np.ptp(neutral[middle].mean(axis=(0, 1))) < 2.0 / 255.0
    bpy.ops.skylight.before_after()
    exr, _ = render(scene, tmp_path / "before.exr")
    # White by RGB times RGB is white by spectra: nothing but the matrix differs.
    assert pixels(exr)[middle] == pytest.approx(linear[middle], rel=2e-3)


def pixels(path):
    image = bpy.data.images.load(str(path))
    if path.suffix == ".png":
        image.colorspace_settings.name = "Non-Color"
    found = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(found)
    return found.reshape(image.size[1], image.size[0], image.channels)[..., :3]


class Picture:
    """An offscreen picture that notes what the materials show while the view is drawn into it."""

    def __init__(self, width, height, fails=False):
        self.width, self.height, self.fails, self.shown = width, height, fails, []

    def draw_view3d(self, *_, **__):
        self.shown.append([rgb_comparison.shown_by(m) for m in spectral_material.ours()])
        if self.fails:
            raise RuntimeError("no more memory")


@pytest.mark.parametrize("fails", [False, True])
def test_a_split_view_shows_rgb_while_its_picture_is_drawn_and_never_else(
    scene, monkeypatch, fails
):
    """Whatever becomes of the picture, the materials have the values that they had."""
    bpy.ops.skylight.make_spectral()
    before = inputs()
    (space,) = (a.spaces.active for a in bpy.context.window.screen.areas if a.type == "VIEW_3D")
    picture, region = Picture(640, 480, fails), SimpleNamespace(width=640, height=480)
    monkeypatch.setattr(split_view, "_split", split_view.Split(1, picture=picture))
    with pytest.raises(RuntimeError) if fails else contextlib.nullcontext():
        split_view._take(bpy.context, region, space)
    assert picture.shown[0] == [rgb_comparison.RGB] * 2
    assert rgb_comparison.shown_now() == [] and inputs() == before
    with pytest.raises(RuntimeError, match="in the sidebar of a 3D view"):
        bpy.ops.skylight.split_view()
