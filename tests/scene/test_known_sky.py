"""Skies that hold their own spectra: what a scene's materials are made by, also once saved."""

import bpy
import numpy as np
import OpenEXR
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.explain import explain
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world import light_group, panorama, settings
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.clear_sky import SCALE, header_of, picture
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.tests import faces
from spectral_skylight.tests.sky.spectral_files import (
    radiance,
    stokes,
    write_fichet,
    write_hsr,
)
from spectral_skylight.tests.sky.test_known_spectrum import COARSE

pytestmark = pytest.mark.blender

OPEN = Settings(occlusion="open")


def ours(path):
    sky = simulate(25.0, quality=COARSE)
    rgb = picture(sky, 128, 180.0, True, observer() * SCALE)
    write_panorama(path, rgb, header_of(sky, 180.0, True))


def hsr(path):
    write_hsr(path, radiance(np.arange(390.0, 771.0, 20.0)))


def piz(path):
    """Thirty-one channels that Blender unpacks three at a time."""
    nodes = np.arange(400.0, 701.0, 10.0)
    write_fichet(path, stokes(radiance(nodes), nodes), compression=OpenEXR.PIZ_COMPRESSION)


KINDS = {"ours.exr": ours, "genssky.hsr": hsr, "piz.exr": piz}


@pytest.mark.parametrize("name", KINDS)
def test_matrices_are_from_its_own_spectrum(tmp_path, name):
    scene = faces.empty_scene()
    path = tmp_path / name
    KINDS[name](path)
    outside = analyse(read_panorama(path))  # unpacked by OpenEXR
    use_cases.set_sky(scene, path, OPEN)
    faces.add_faces(scene, np.array([[0.0, 0.0, 1.0]]))
    material = bpy.data.materials.new("Paint")
    scene.objects[0].data.materials.append(material)
    rho = colorchecker()[1][14]
    found = use_cases.make_spectral(scene, {material: Assignment("red", rho)}, OPEN)
    expected = transfer(
        "atmosphere",
        sun_elevation=outside.sun_elevation(),
        sky_rgb=outside.faces,
        known=outside.spectrum.members,
    ).matrices(rho)

    def check():
        shown = np.array(spectral_material.managed(bpy.data.materials["Paint"]).matrix)
        np.testing.assert_allclose(shown, expected, atol=1e-4)  # twelve components, 24 bits
        record = light_group.record_of(bpy.context.scene.world)
        assert "from this sky's own spectrum" in record.model
        steps = explain(bpy.context.scene, bpy.data.materials["Paint"]).steps
        assert any("from this sky's own spectrum" in step.text for step in steps)

    check()
    assert found.results[0].matrix_delta_E < 0.1
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    if name != "ours.exr":
        path.unlink()  # it is packed, for Blender cannot show it
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    scene = bpy.context.scene
    use_cases.update(scene, settings.stored(scene.world))
    check()
    assert panorama.light_of(scene.world, observer()).spectrum is not None


@pytest.mark.parametrize("name", ["piz.exr", "genssky.hsr"])
def test_a_world_made_by_hand_of_a_file_of_spectra_says_what_it_lacks(tmp_path, name):
    scene = faces.empty_scene()
    KINDS[name](tmp_path / name)
    world = scene.world = bpy.data.worlds.new("By Hand")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    nodes = world.node_tree.nodes
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(str(tmp_path / name))
    shown = next(node for node in nodes if node.type == "BACKGROUND")
    world.node_tree.links.new(texture.outputs[0], shown.inputs[0])
    material = bpy.data.materials.new("Paint")
    faces.add_faces(scene, np.array([[0.0, 0.0, 1.0]]))
    scene.objects[0].data.materials.append(material)
    given = {material: Assignment("red", colorchecker()[1][14])}
    said = "its file holds spectra, which Blender does not show"
    if name.endswith(".hsr"):  # which Blender loads nothing of
        with pytest.raises(InputError, match=f"{said}; load it with Load Sky HDRI$"):
            use_cases.make_spectral(scene, given, OPEN)
        return
    use_cases.make_spectral(scene, given, OPEN)
    (note,) = [each for each in light_group.record_of(world).notes if said in each]
    assert note.endswith("load it with Load Sky HDRI, which uses them")
    use_cases.load_sky(scene, tmp_path / name, OPEN)
    assert not any(said in each for each in light_group.record_of(scene.world).notes)


def test_a_basis_that_is_chosen_is_kept(tmp_path):
    scene = faces.empty_scene()
    hsr(tmp_path / "sky.hsr")
    world = use_cases.set_sky(scene, tmp_path / "sky.hsr", OPEN)
    light = panorama.light_of(world, observer())
    assert OPEN.transfer(light).basis == "own spectrum"
    assert Settings(basis="rayleigh").transfer(light).basis == "rayleigh"
