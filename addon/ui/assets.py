"""Writing the library, or what is found in it, as an asset library for Blender's asset browser."""

# mypy: disable-error-code="valid-type"

from pathlib import Path

import bpy

from ..errors import InputError
from . import assign, library_state, operator


class SKYLIGHT_OT_write_assets(operator.Long, bpy.types.Operator):
    """Write the listed reflectances to a folder as materials of an asset library. Make Everything \
Spectral gives them their measured reflectances. Press Esc to stop"""

    bl_idname = "skylight.write_assets"
    bl_label = "Write Asset Library..."
    doing = "Writing"

    directory: bpy.props.StringProperty(
        name="Folder", description="Folder of the asset library, as set in the preferences"
    )
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    @classmethod
    def disabled_reason(cls, context):
        return "" if library_state.chosen(context) is not None else "Show the library first"

    def invoke(self, context, event):
        """Ask for the folder; the work goes on from there."""
        if not self.directory:
            return operator.browse(self, context)
        return operator.Long.invoke(self, context, event)

    def work(self, context):
        from ..scene.files import asset_library

        if not self.directory:
            raise InputError("the asset library", "has no folder", "choose one")
        own = context.window_manager.skylight_library
        found, places = library_state.shown(own.search, own.order)
        wanted = [k for k in sorted(range(len(found)), key=places.__getitem__) if found[k]]
        if not wanted:
            raise InputError("the search", "matches no reflectance", "use fewer words")
        chosen = library_state.library.only(wanted)
        halves = [
            half[wanted]
            for half in (library_state.under_sky, library_state.daylight)
            if half is not None
        ]

        def measured(material, number):
            material.skylight.kind = assign.kind(chosen.classes[number])
            material.skylight.column = chosen.names[number]
            material.skylight.filepath = chosen.paths[number]

        return asset_library.write(
            Path(bpy.path.abspath(self.directory)),
            chosen.names,
            chosen.classes,
            chosen.sources,
            (halves[0], halves[-1]),
            measured,
        )

    def finish(self, context, done):
        if done is None:
            return [("WARNING", "Stopped: nothing was written")]
        return [("INFO", f"Wrote {done}. Add its folder to the asset libraries in the preferences")]


CLASSES = (SKYLIGHT_OT_write_assets,)
