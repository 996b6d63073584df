"""The library as a grid of large swatches under this sky, over the panel: what is pressed is given.

A cell a reflectance; nothing is selected, so that nothing can be assigned that is not seen.
"""

# mypy: disable-error-code="valid-type"

from functools import partial

import bpy

from . import assign, library, library_state, preferences, preview_cache, targets
from .translation import translated

COLUMNS, ROWS = 5, 4
WIDTH = 660
"""[pixels] of the pop-up: a cell's name has some 20 letters."""
SCALE = 3.8
"""Of a swatch, in icons."""


class SKYLIGHT_OT_browse_library(bpy.types.Operator):
    """Show measured reflectances as swatches under this sky, those nearest to the material's \
base color and name first. Press one to make the material spectral with it"""

    bl_idname = "skylight.browse_library"
    bl_label = "Library..."
    bl_options = {"REGISTER"}  # it changes nothing: the buttons in it are undo steps of their own

    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the active material"
    )

    def invoke(self, context, event):
        """Open the grid, with nothing searched for yet."""
        self.execute(context)
        return context.window_manager.invoke_popup(self, width=WIDTH)

    def execute(self, context):
        """Make the library ready: without its folders, where they were not read yet."""
        if library_state.library is None:
            library.show_built_in(context)
        elif library_state.is_stale(context):
            library_state.light(context)
        own = context.window_manager.skylight_library
        own.search, own.category = "", library_state.ALL
        own.material = self.material or getattr(targets.active(context), "name", "")
        library_state.look_near(bpy.data.materials.get(own.material))
        draw_swatches(own)
        return {"FINISHED"}

    def draw(self, context):
        """A row to search in, then the cells."""
        layout, own = self.layout, context.window_manager.skylight_library
        row = layout.row()
        row.label(text=own.material, icon="MATERIAL", translate=False)
        found = row.row()
        found.activate_init = True  # one types at once
        found.prop(own, "search", text="", icon="VIEWZOOM")
        row.prop(own, "category", text="")
        numbers = library_state.found(own)
        grid = layout.grid_flow(row_major=True, columns=COLUMNS, even_columns=True, align=False)
        for number in numbers[: COLUMNS * ROWS]:
            _cell(grid.column(align=True), own.material, number)
        if not numbers:
            layout.label(text="Nothing has all these words")
        row = layout.row()
        if (more := len(numbers) - COLUMNS * ROWS) > 0:
            row.label(text=translated(f"{more} more: search, or choose a kind"))
        if library_state.partial and preferences.folders(context):
            row.operator("skylight.refresh_library", text="Read My Folders", icon="FILE_FOLDER")


def _cell(layout: bpy.types.UILayout, material: str, number: int) -> None:
    """A swatch under this sky, else under D65, and the button that gives it."""
    shown = library_state.library
    layout.template_icon(icon_value=_icon(number), scale=SCALE)
    name, kind = shown.names[number], shown.classes[number]
    button = layout.operator("skylight.apply", text=name.removeprefix(f"{kind}: "), translate=False)
    button.material, button.filepath, button.column = material, shown.paths[number], name
    button.kind = assign.kind(kind)


def draw_swatches(own) -> None:
    """Make the swatches of what is found, before they are drawn."""
    for number in library_state.found(own)[: COLUMNS * ROWS]:
        _icon(number)
    preview_cache.draw_wanted()


def _icon(number: int) -> int:
    color = library_state.swatch(number)
    return preview_cache.icon(("swatch", color), partial(_flat, color))


def _flat(color: tuple[int, int, int]):
    from ..pictures.preview import flat

    return flat(color)


CLASSES = (SKYLIGHT_OT_browse_library,)
