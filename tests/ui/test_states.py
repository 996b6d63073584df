"""What the panel says in each state of a scene, from no sky to a file that is opened again.

A table: what leads to a state, and which words are there and which are not. All is true at every
moment, so each state is reached from the one before it.
"""

import bpy
import pytest

from spectral_skylight.addon import registration
from spectral_skylight.addon.ui import panels, staleness_handlers
from spectral_skylight.tests.ui import room
from spectral_skylight.tests.ui.stage import drawn, write_sky

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def no_sky(folder):
    bpy.context.scene.world = None


def sky(folder):
    bpy.ops.skylight.load_sky(filepath=str(write_sky(folder / "day.exr")))


def applied_without_light(folder):
    bpy.context.scene.world.skylight.occlusion = "open"
    bpy.ops.skylight.make_spectral()


def baked(folder):
    bpy.ops.skylight.bake(rays=32)


def moved(folder):
    bpy.data.objects["Wall"].location.x += 1.0


def found_old(folder):
    bpy.ops.skylight.update()


def baked_again(folder):
    bpy.ops.skylight.bake(rays=32)


def live(folder):
    bpy.context.scene.world.skylight.occlusion = "dome"
    bpy.ops.skylight.update()


def other_sky(folder):
    image = bpy.context.scene.world.node_tree.nodes["Environment Texture"].image
    bpy.context.scene.world.node_tree.nodes["Environment Texture"].image = image.copy()


def updated(folder):
    bpy.ops.skylight.update()


def opened_again(folder):
    path = str(folder / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)


def shows_rgb(folder):
    bpy.ops.skylight.before_after(show="BEFORE")


def removed(folder):
    bpy.ops.skylight.remove_all()


STATES = [
    (no_sky, ["No material is spectral yet"], ["Sky: ", "spectral: "]),
    (sky, ["Sky: day.exr", "Day, sun at", "No light is baked yet"], ["Old light"]),
    (
        applied_without_light,
        ["2 of 2", "Open sky", "Day, sun at", "RGB is"],
        ["baked", "Old light"],
    ),
    (baked, ["All light is baked"], ["Old light", "Open sky"]),
    (moved, ["Objects changed"], ["Old light"]),
    (found_old, ["Old light: "], ["Objects changed"]),
    (baked_again, ["All light is baked"], ["Old light", "Objects changed"]),
    (live, ["The sky's shadows are live"], ["Old light", "Objects changed", "baked"]),
    (other_sky, ["The sky has changed"], ["good", "RGB is"]),
    (updated, ["live", "RGB is"], ["The sky has changed"]),
    (opened_again, ["2 of 2", "live"], ["The sky has changed", "Objects changed"]),
    (shows_rgb, ["Renders show this too"], []),
    (removed, ["No material is spectral yet"], ["Renders show", "Old light", "live", "baked"]),
]


WHOLE = (no_sky, applied_without_light, shows_rgb)
"""States in which all panels are measured, not only the main one."""

PANELS = (
    panels.SKYLIGHT_PT_main,
    *(
        cls
        for cls in registration.CLASSES
        if issubclass(cls, bpy.types.Panel) and cls is not panels.SKYLIGHT_PT_main
    ),
)


def test_what_the_panel_says_in_each_state(scene, tmp_path, monkeypatch):
    for name in ("Wall", "Roof"):
        places = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        bpy.data.objects[name].data.from_pydata(places, [], [(0, 1, 2, 3)])
    staleness_handlers.attach(background=True)
    try:
        for reach, there, gone in STATES:
            reach(tmp_path)
            bpy.context.view_layer.update()
            text = drawn(panels.SKYLIGHT_PT_main).text
            assert [words for words in there if words not in text] == [], (reach.__name__, text)
            assert [words for words in gone if words in text] == [], (reach.__name__, text)
            for panel in PANELS if reach in WHOLE else PANELS[:1]:
                assert room.cut_off(monkeypatch, room.of_panel(panel)) == [], panel
    finally:
        staleness_handlers.detach()
