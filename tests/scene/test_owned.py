"""What a managed material's settings were comes back."""

import bpy
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene.materials import saved_settings

pytestmark = pytest.mark.blender


def test_owned_once_and_given_back():
    material = bpy.data.materials.new("Wall")
    material.cycles.emission_sampling = "FRONT"
    material.surface_render_method = "DITHERED"
    for _ in range(2):
        saved_settings.own(material)
        saved_settings.own(material, saved_settings.GLASS)
    assert material.cycles.emission_sampling == "NONE"
    assert material.surface_render_method == "BLENDED"
    saved_settings.give_back(material)
    assert material.cycles.emission_sampling == "FRONT"
    assert material.surface_render_method == "DITHERED" and tags.MATERIAL_SETTINGS not in material
    saved_settings.give_back(material)


def test_what_a_user_changed_meanwhile_stays():
    material = bpy.data.materials.new("Wall")
    saved_settings.own(material)
    material.cycles.emission_sampling = "BACK"
    saved_settings.give_back(material)
    assert material.cycles.emission_sampling == "BACK"
