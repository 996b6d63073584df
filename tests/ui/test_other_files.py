"""What panels say of files by earlier and later versions, and of what is linked."""

from pathlib import Path

import bpy
import pytest

from spectral_skylight.node_groups import skylight_surface
from spectral_skylight.tests.ui.stage import drawn, material, select

pytestmark = pytest.mark.blender

FILES = Path(__file__).parents[1] / "files"


def panels():
    """All of ours that can be drawn now."""
    waiting, found = [bpy.types.Panel], []
    while waiting:
        kind = waiting.pop()
        waiting += kind.__subclasses__()
        ours = kind.__name__.startswith("SKYLIGHT_PT") and kind.is_registered
        if ours and (not hasattr(kind, "poll") or kind.poll(bpy.context)):
            found.append(kind)
    return found


@pytest.mark.parametrize("name", ["surface1", "surface1_models", "surface2"])
def test_every_panel_draws_what_old_files_hold(addon, name):
    bpy.ops.wm.open_mainfile(filepath=str(FILES / f"{name}.blend"), load_ui=False)
    select("Faces")
    shown = {panel.__name__: drawn(panel).text for panel in panels()}
    assert len(shown) > 8
    assert ": 3 measured, 0 estimated" in " ".join(shown.values())
    assert "brick" in shown["SKYLIGHT_PT_material"]


def test_a_newer_file_is_told_in_the_panel_and_by_the_buttons(addon):
    bpy.ops.wm.open_mainfile(filepath=str(FILES / "surface2.blend"), load_ui=False)
    select("Faces")
    record = material("Brick")["spectral_skylight"]
    record["version"] = skylight_surface.VERSION + 1
    texts = " ".join(drawn(panel).text for panel in panels())
    assert "made by a newer version of this add-on; update the add-on" in texts
    with pytest.raises(RuntimeError, match="newer version of this add-on"):
        bpy.ops.skylight.remove(material="Brick")
    assert "spectral_skylight" in material("Brick")
    bpy.ops.skylight.update()  # the others
    assert material("Brick")["spectral_skylight"]["version"] == skylight_surface.VERSION + 1
