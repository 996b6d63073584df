"""What a person sets once for all files: the folders of the library."""

# mypy: disable-error-code="valid-type"

from pathlib import Path

import bpy

from ..errors import InputError
from . import operator

ADDON = __package__.removesuffix(".addon.ui")
"""The add-on's name, by which Blender keeps its preferences: `bl_ext.….spectral_skylight` too."""


class SkylightFolder(bpy.types.PropertyGroup):
    """One folder of reflectance files."""

    path: bpy.props.StringProperty(
        name="Folder",
        description="Folder of reflectance files, with its subfolders: CSV, USGS, ECOSTRESS, SLUM, "
        "IGSDB, CGATS, CxF, MATLAB, ENVI",
        subtype="DIR_PATH",
    )


class SkylightPreferences(bpy.types.AddonPreferences):
    """The add-on's page in the preferences."""

    bl_idname = ADDON

    folders: bpy.props.CollectionProperty(type=SkylightFolder)

    def draw(self, context):
        draw_folders(self.layout, context)


def of(context: bpy.types.Context) -> SkylightPreferences | None:
    """The add-on's preferences, None where it runs without being enabled there, as in scripts."""
    found = context.preferences.addons.get(ADDON)
    return found and found.preferences


def folders(context: bpy.types.Context) -> list[str]:
    """The library's folders, absolute, empty rows left out."""
    own = of(context)
    return [bpy.path.abspath(folder.path) for folder in own.folders if folder.path] if own else []


def draw_folders(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """A row for each folder, and a button for another."""
    own = of(context)
    if own is None:
        return
    column = layout.column(align=True)
    for number, folder in enumerate(own.folders):
        row = column.row(align=True)
        row.prop(folder, "path", text="")
        row.operator("skylight.remove_folder", text="", icon="X").number = number
    column.operator("skylight.add_folder", icon="FILE_FOLDER")


class SKYLIGHT_OT_add_folder(operator.Thin, bpy.types.Operator):
    """Add a folder of reflectance files, with its subfolders, to the library and read it"""

    bl_idname = "skylight.add_folder"
    bl_label = "Add Folder..."

    directory: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH")
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    @classmethod
    def disabled_reason(cls, context):
        return "" if of(context) else "Enable the add-on in the preferences"

    def invoke(self, context, event):
        return operator.browse(self, context)

    def run(self, context):
        folder = Path(bpy.path.abspath(self.directory))
        if not self.directory or not folder.is_dir():
            raise InputError(self.directory or "the folder", "is not a folder", "choose a folder")
        own = of(context)
        if all(Path(known) != folder for known in folders(context)):
            own.folders.add().path = str(folder)
            context.preferences.is_dirty = True
        # With a window it goes on by itself, with progress, and Esc ends it.
        how = "EXEC_DEFAULT" if context.window is None else "INVOKE_DEFAULT"
        bpy.ops.skylight.refresh_library(how)
        return [("INFO", f"Added {folder} to the library")]


class SKYLIGHT_OT_remove_folder(operator.Thin, bpy.types.Operator):
    """Remove a folder from the library. Its files and the assigned materials do not change"""

    bl_idname = "skylight.remove_folder"
    bl_label = "Remove Folder"

    number: bpy.props.IntProperty(name="Number", description="Index of the folder, from 0")

    def run(self, context):
        own = of(context)
        if own is None or not 0 <= self.number < len(own.folders):
            raise InputError("the library", f"has no folder {self.number}", "choose another number")
        own.folders.remove(self.number)
        context.preferences.is_dirty = True
        return [("INFO", "Press Refresh Library to update the list")]


CLASSES = (
    SkylightFolder,
    SkylightPreferences,
    SKYLIGHT_OT_add_folder,
    SKYLIGHT_OT_remove_folder,
)
