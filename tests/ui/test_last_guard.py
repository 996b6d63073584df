"""What nobody foresaw is one line: in a button, in a panel, in what asks whether it can run."""

from types import SimpleNamespace

import bpy
import pytest

from spectral_skylight.addon.ui import last_guard
from spectral_skylight.tests.ui import stage

pytestmark = pytest.mark.blender


class SKYLIGHT_OT_broken(bpy.types.Operator):
    """Fails"""

    bl_idname = "skylight.broken"
    bl_label = "Broken"

    @classmethod
    def poll(cls, context):
        return context.scene.name != "never" or 1 / 0

    def execute(self, context):
        raise KeyError("what\nnobody foresaw")


class SKYLIGHT_PT_broken(bpy.types.Panel):
    bl_label = "Broken"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    def draw(self, context):
        self.layout.label(text="before")
        raise ZeroDivisionError


@pytest.fixture
def broken():
    classes = [last_guard.guarded(cls) for cls in (SKYLIGHT_OT_broken, SKYLIGHT_PT_broken)]
    for cls in classes:
        bpy.utils.register_class(cls)
    yield
    for cls in classes:
        bpy.utils.unregister_class(cls)


def test_a_button_says_it_in_a_line(broken, capsys):
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.skylight.broken()
    line = str(caught.value).strip()
    assert "\n" not in line and line.startswith("Error: a fault of this program, KeyError")
    assert "test_last_guard.py, line" in line and "please report this" in line
    assert "Traceback" in capsys.readouterr().err  # for whoever is asked for it


def test_what_cannot_be_asked_cannot_run(broken):
    name = bpy.context.scene.name
    bpy.context.scene.name = "never"
    assert not bpy.ops.skylight.broken.poll()
    bpy.context.scene.name = name
    assert bpy.ops.skylight.broken.poll()


def test_a_panel_says_it_below_what_it_drew(broken, capsys):
    for _ in range(2):
        drawn = stage.drawn(SKYLIGHT_PT_broken)
        assert drawn.text.startswith("before a fault of this program, ZeroDivisionError")
    assert capsys.readouterr().err.count("Traceback") <= 1  # not at each redraw


def test_every_button_and_panel_is_guarded_when_it_is_registered(addon):
    from spectral_skylight.addon.registration import CLASSES

    for cls in CLASSES:
        for name in ("execute", "invoke", "modal", "draw", "poll"):
            method = getattr(cls, name, None)
            known = method is None or hasattr(method, "__wrapped__")
            # A gizmo's methods have other parameters.
            apart = issubclass(cls, bpy.types.PropertyGroup | bpy.types.Gizmo)
            assert known or apart, (cls, name)


def test_a_handler_that_fails_is_told_once(capsys):
    quiet = last_guard.handler(lambda: SimpleNamespace().nothing)
    quiet(), quiet()
    assert capsys.readouterr().err.count("Traceback") == 1
