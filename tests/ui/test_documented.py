"""Every operator and property is documented, and every button of the panels is one of them."""

import re
from pathlib import Path

import bpy

from spectral_skylight.addon import registration
from spectral_skylight.addon.ui import menu

UI = Path(__file__).resolve().parents[2] / "addon" / "ui"
TEXT = (UI / "README.md").read_text(encoding="utf-8")
WITHOUT_A_MENU = {"add_folder", "remove_folder", "drop_reflectance"}
"""Those of the preferences and of a drop: what nobody searches for."""


def sections():
    """The text under each operator's heading."""
    parts = re.split(r"^###? ", TEXT, flags=re.MULTILINE)
    return {part.partition("\n")[0]: part.partition("\n")[2] for part in parts}


def test_every_operator_and_property(addon):
    found = sections()
    fields = found["The fields of a file"]
    for name in dir(bpy.ops.skylight):
        text = found[f"skylight.{name}"]
        assert f"bpy.ops.skylight.{name}(" in text, f"{name} has no example"
        text += fields if "(#the-fields-of-a-file)" in text else ""
        for each in getattr(bpy.ops.skylight, name).get_rna_type().properties:
            if each.identifier != "rna_type" and not each.is_hidden:
                assert f"`{each.identifier}`" in text, f"{name}: {each.identifier}"
                if each.type == "ENUM":
                    assert all(f"`{item.identifier}`" in text for item in each.enum_items), each
    documented = {name.removeprefix("skylight.") for name in found if name.startswith("skylight.")}
    assert documented == set(dir(bpy.ops.skylight))


def test_every_property_of_data(addon):
    for owner, group, name in (
        ("material", bpy.types.Material, "skylight"),
        ("world", bpy.types.World, "skylight"),
        ("light", bpy.types.Light, "skylight"),
        ("scene", bpy.types.Scene, "skylight_batch"),
        ("scene", bpy.types.Scene, "skylight_place"),
        ("scene", bpy.types.Scene, "skylight_meter"),
    ):
        line = next(line for line in TEXT.splitlines() if line.startswith(f"| `{owner}.{name}`"))
        for each in group.bl_rna.properties[name].fixed_type.properties:
            if each.identifier not in ("rna_type", "name"):
                assert f"`{each.identifier}`" in line, each.identifier


def test_every_button_has_an_operator_and_is_searched_for(addon):
    """Read from the source, so that a button behind a condition counts too."""
    named = {
        name
        for file in UI.glob("*.py")
        for name in re.findall(r'"skylight\.(\w+)"', file.read_text(encoding="utf-8"))
    }
    assert named == set(dir(bpy.ops.skylight))
    menus = {name for step in menu.STEPS for name in step}
    assert menus == set(dir(bpy.ops.skylight)) - WITHOUT_A_MENU


def test_whatever_changes_the_file_can_be_undone(addon):
    # These change views, other files, or nothing.
    apart = {
        "show_in_viewport",
        "library_problems",
        "browse_library",
        "split_view",
        "help",
        "explain",
        "measure",
        "false_color",
        "sunlight",
        "hide_false_color",
        "stop_light",
        "stop_refining",
        "batch_write",
        "batch_start",
        "batch_cancel",
    }
    for cls in registration.CLASSES:
        if issubclass(cls, bpy.types.Operator):
            assert cls.__doc__ and cls.bl_label
            if cls.bl_idname.removeprefix("skylight.") not in apart | WITHOUT_A_MENU:
                assert {"REGISTER", "UNDO"} <= cls.bl_options, cls
