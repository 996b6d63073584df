"""What a managed material's settings were comes back."""

import bpy
import pytest

from spectral_skylight.addon.scene import owned

pytestmark = pytest.mark.blender


def test_owned_once_and_given_back():
    material = bpy.data.materials.new("Wall")
    material.cycles.emission_sampling = "FRONT"
    material.surface_render_method = "DITHERED"
    for _ in range(2):
        owned.own(material)
        owned.own(material, owned.GLASS)
    assert material.cycles.emission_sampling == "NONE"
    assert material.surface_render_method == "BLENDED"
    owned.give_back(material)
    assert material.cycles.emission_sampling == "FRONT"
    assert material.surface_render_method == "DITHERED" and owned.KEPT not in material
    owned.give_back(material)


def test_what_a_user_changed_meanwhile_stays():
    material = bpy.data.materials.new("Wall")
    owned.own(material)
    material.cycles.emission_sampling = "BACK"
    owned.give_back(material)
    assert material.cycles.emission_sampling == "BACK"
