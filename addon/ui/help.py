"""Help: the page of the panel, at the section that is asked for, from a button and from F1."""

# mypy: disable-error-code="valid-type"

from pathlib import Path

import bpy


class SKYLIGHT_OT_help(bpy.types.Operator):
    """Open the manual in the browser. It ships with the add-on and needs no network"""

    bl_idname = "skylight.help"
    bl_label = "Help"
    bl_options = {"REGISTER"}

    section: bpy.props.StringProperty(
        name="Section", description="Heading of the manual. Leave empty for the first"
    )

    def execute(self, context):
        """Write the page into Blender's own temporary folder, and open it."""
        bpy.ops.wm.url_open(url=address(self.section))
        return {"FINISHED"}


def button(layout: bpy.types.UILayout, section: str) -> None:
    """Draw the button that opens a section, in a panel's header."""
    layout.operator("skylight.help", text="", icon="QUESTION", emboss=False).section = section


def address(section: str = "") -> str:
    """Return where a section of the page is."""
    from . import manual

    page = manual.write(Path(bpy.app.tempdir)).as_uri()
    return f"{page}#{manual.anchor(section)}" if section else page


def _manual() -> tuple[str, tuple[tuple[str, str], ...]]:
    """Return what Blender looks up for F1 over a button or a field: the page, and its places."""
    from . import manual

    names = [name for name in manual.headings(manual.PAGE.read_text("utf-8")) if "." in name]
    buttons = [(f"bpy.ops.{name}", manual.anchor(name)) for name in names]
    fields = [
        ("bpy.types.skylightreflectance.*", "The fields of a file"),
        ("bpy.types.skylightlibrary.*", "The library of reflectances"),
        ("bpy.types.skylightbatch.*", "Many pictures"),
        ("bpy.types.skylight*", "Settings"),
    ]
    places = [*buttons, *((pattern, manual.anchor(name)) for pattern, name in fields)]
    return f"{address()}#", tuple(places)


CLASSES = (SKYLIGHT_OT_help,)


def attach() -> None:
    """Let Blender's Online Manual know of our buttons and fields."""
    bpy.utils.register_manual_map(_manual)


def detach() -> None:
    """Let it forget them."""
    bpy.utils.unregister_manual_map(_manual)
