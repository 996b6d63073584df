"""The menu that Blender's search goes through holds all that the panels' buttons do."""

import bpy
import pytest

from spectral_skylight.addon import registration
from spectral_skylight.addon.ui import menu
from spectral_skylight.tests.ui import stage

pytestmark = pytest.mark.blender

ELSEWHERE = {
    "skylight.drop_reflectance",  # what is dropped on the 3D view
    "skylight.add_folder",  # the preferences'
    "skylight.remove_folder",
}


def test_the_menu_hangs_in_blenders_own_and_leaves_with_the_add_on():
    import spectral_skylight

    def hung():
        return [f for f in bpy.types.VIEW3D_MT_object._dyn_ui_initialize() if f is menu._draw]

    assert hung() == []
    spectral_skylight.register()
    assert hung() == [menu._draw]
    spectral_skylight.unregister()
    assert hung() == []


def test_every_operator_is_in_the_menu(addon):
    drawn = stage.drawn(menu.SKYLIGHT_MT_object).operators
    all_of_them = {
        cls.bl_idname for cls in registration.CLASSES if issubclass(cls, bpy.types.Operator)
    }
    assert len(drawn) == len({*drawn})
    assert {*drawn} == all_of_them - ELSEWHERE
