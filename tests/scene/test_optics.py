"""Glass and metal: coloured for the sky, taken off without a trace, panes that lamps pass."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.lights import sun_lamp
from spectral_skylight.addon.scene.materials import (
    glass_and_metal,
    spectral_material,
)
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.transfer.metals import tints
from spectral_skylight.tests import faces
from spectral_skylight.tests.scene.test_look import material_with
from spectral_skylight.tests.scene.test_materials import dump

pytestmark = pytest.mark.blender

GREEN = 0.2 + 0.6 * np.exp(-(((WAVELENGTHS - 530) / 60.0) ** 2))
NK = np.interp(WAVELENGTHS, [380, 500, 600, 780], [1.2, 1.1, 0.3, 0.2]), 0.004 * WAVELENGTHS
PANE = Assignment("green", GREEN, faces=1)
SETTINGS = Settings(basis="rayleigh", tolerance=None)


@pytest.fixture
def scene(tmp_path):
    """A blue sky with a sun, and a square above another."""
    scene = faces.empty_scene()
    view = directions(128, 256)
    sky = np.array([0.3, 0.5, 1.0]) * (1.2 + view[..., 2:])
    sky[view @ np.array([0.6, 0.0, 0.8]) > 0.9996] = 30000.0
    write_panorama(tmp_path / "sky.exr", sky)
    use_cases.set_sky(scene, tmp_path / "sky.exr", SETTINGS)
    for name in ("Floor", "Pane"):
        square = faces.add_faces(scene, np.array([[0.0, 0.0, 1.0]]))
        square.name = name
        square.location.z = 2.0 * (name == "Pane")
    return scene


def test_glass_by_its_transmittance(scene):
    glass = material_with("BsdfGlass", Roughness=0.1)
    scene.objects["Pane"].data.materials[0] = glass
    wall = material_with("BsdfDiffuse")
    scene.objects["Floor"].data.materials[0] = wall
    glass.surface_render_method = "DITHERED"
    before = dump(glass)
    for _ in range(2):
        glass_and_metal.glaze(glass, PANE)
        given = {wall: Assignment("half", 0.5 * GREEN)}
        light = use_cases.make_spectral(scene, given, SETTINGS).light
    assert light.sun is not None
    node = glass_and_metal.pane_node(glass)
    tint = np.array(node.inputs["Transmittance"].default_value[:3])
    # Independent of how: the colour behind it is what the sky's matrix makes of it.
    mapping = SETTINGS.transfer(light)
    sky = light.faces.mean(axis=0)
    np.testing.assert_allclose(
        tint, mapping.matrices(GREEN) @ sky / (mapping.to_working @ sky), atol=1e-5
    )
    assert tint.argmax() == 1
    np.testing.assert_allclose(node.inputs["Roughness"].default_value, 0.1)
    assert glass.surface_render_method == "BLENDED"
    lamp = sun_lamp.find(scene, sun_lamp.SUN)
    held = lamp.light_linking.blocker_collection
    assert [obj.name for obj in held.objects] == ["Pane"]
    assert held.collection_objects[0].light_linking.link_state == "EXCLUDE"
    assert not spectral_material.is_managed(glass) and glass_and_metal.pane_node(wall) is None
    spectral_material.remove(glass)
    assert dump(glass) == before
    use_cases.update(scene, SETTINGS)
    assert lamp.light_linking.blocker_collection is None
    assert not any(tags.PANES in collection for collection in bpy.data.collections)


def test_a_frame_in_the_pane_is_told(scene):
    glass, frame = material_with("BsdfGlass"), material_with("BsdfDiffuse")
    window = scene.objects["Pane"].data.materials
    window[0] = glass
    window.append(frame)
    scene.objects["Floor"].data.materials[0] = frame
    glass_and_metal.glaze(glass, PANE)
    use_cases.make_spectral(scene, {frame: Assignment("half", 0.5 * GREEN)}, SETTINGS)
    assert glass_and_metal.pass_through(scene) == [
        "Pane: glass and frame in one object shade the sun; separate them by material"
    ]


def test_metal_by_its_n_and_k(scene):
    metal = material_with("BsdfPrincipled", Metallic=1.0, Roughness=0.2)
    scene.objects["Floor"].data.materials[0] = metal
    before = dump(metal)
    given = {metal: Assignment("copper", GREEN, metal=NK)}
    light = use_cases.make_spectral(scene, given, SETTINGS).light
    mapping = SETTINGS.transfer(light)
    sky = mapping.restoration @ light.faces.mean(axis=0)
    node = next(n for n in metal.node_tree.nodes if n.get(tags.NODE) == "gloss")
    for name, rgb in zip(("Metal Color", "Metal Edge"), tints(*NK, sky), strict=True):
        np.testing.assert_allclose(node.inputs[name].default_value[:3], rgb, atol=1e-5)
    node.inputs["Metal Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    use_cases.update(scene, SETTINGS)  # from what the file keeps
    assert node.inputs["Metal Color"].default_value[0] > 0.5
    spectral_material.remove(metal)
    assert dump(metal) == before and tags.METAL not in metal and tags.MATERIAL not in metal
