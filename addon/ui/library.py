"""The library of reflectances: a list to search, with swatches under this sky and under D65."""

# mypy: disable-error-code="valid-type"

from typing import TYPE_CHECKING

import bpy

from ..choices import ORDERS, items
from . import library_state, operator, panel_text, panels, preferences
from .translation import translated

if TYPE_CHECKING:
    from ..spectra.library import Library

ROWS = 8
TOLD = 40
"""Problems that a pop-up has room for."""


class SkylightSpectrum(bpy.types.PropertyGroup):
    """One reflectance of the library; all but its name lies on the shelf."""

    number: bpy.props.IntProperty()
    sky: bpy.props.FloatVectorProperty(
        name="Under This Sky",
        description="Color on level ground under this sky. A white diffuser has luminance 1",
        subtype="COLOR",
        get=lambda self: library_state.colour(library_state.under_sky, self.number),
        set=lambda self, value: None,  # Blender draws a read-only colour dimmed: another colour
    )
    daylight: bpy.props.FloatVectorProperty(
        name="Under D65",
        description="Color under D65, the standard light for comparing samples",
        subtype="COLOR",
        get=lambda self: library_state.colour(library_state.daylight, self.number),
        set=lambda self, value: None,
    )


def _found_anew(own, context) -> None:
    """Draw the swatches of what is found now, and the grid with them."""
    from . import swatch_grid

    if own.material and library_state.library is not None:
        swatch_grid.draw_swatches(own)
    if (grid := getattr(context, "region_popup", None)) is not None:
        grid.tag_refresh_ui()


class SkylightLibrary(bpy.types.PropertyGroup):
    """What of the library is shown, as `window_manager.skylight_library`: in no file."""

    spectra: bpy.props.CollectionProperty(type=SkylightSpectrum)
    active: bpy.props.IntProperty(name="Reflectance")
    search: bpy.props.StringProperty(
        name="Search",
        description="Show reflectances whose name, kind or file contains all these words",
        options={"TEXTEDIT_UPDATE"},
        update=_found_anew,
    )
    category: bpy.props.EnumProperty(
        name="Kind",
        description="What kind of material the grid shows",
        items=lambda self, context: library_state.categories(id(library_state.library)),
        update=_found_anew,
    )
    material: bpy.props.StringProperty(description="Which material the grid is for")
    order: bpy.props.EnumProperty(
        name="Order", description="How the list is sorted", items=items(ORDERS, upper=True)
    )


class SKYLIGHT_UL_library(bpy.types.UIList):
    """Rows: the colour under this sky, that under D65, the name, where it is from."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property):
        split = layout.split(factor=0.2)
        swatches = split.row(align=True)
        if library_state.under_sky is not None:
            swatches.prop(item, "sky", text="")
        swatches.prop(item, "daylight", text="")
        split.label(text=item.name, translate=False)

    def draw_filter(self, context, layout):
        """Nothing: search and order stand above the list."""

    def filter_items(self, context, data, name):
        found, places = library_state.shown(data.search, data.order)
        return [self.bitflag_filter_item if each else 0 for each in found], places


class SKYLIGHT_OT_refresh_library(operator.Long, bpy.types.Operator):
    """Read the library's folders and show the colors under this sky. Assigned materials do not \
change. Press Esc to stop"""

    bl_idname = "skylight.refresh_library"
    bl_label = "Refresh Library"
    doing = "Reading"

    def work(self, context):
        from ..spectra import library

        found = yield from library.index(preferences.folders(context))
        return library.built_in() + found

    def finish(self, context, done):
        from . import assignments

        if done is None:
            return [("WARNING", "Stopped. The next refresh continues from here")]
        show(context, done)
        unused = f", {done.unused} unusable" if done.unused else ""
        return [*assignments.refresh(done), ("INFO", f"{len(done)} reflectances{unused}")]


def show(context: bpy.types.Context, found: "Library", part: bool = False) -> None:
    """Show a library, what was chosen before chosen again; ``part``: without its folders."""
    own = context.window_manager.skylight_library
    before = library_state.place(library_state.chosen(context))
    library_state.put(found, part)
    library_state.light(context)
    own.spectra.clear()
    for number, name in enumerate(found.names):
        row = own.spectra.add()
        row.name, row.number = name, number
    places = zip(found.paths, found.names, strict=True)
    own.active = next((k for k, place in enumerate(places) if place == before), 0)


def show_built_in(context: bpy.types.Context) -> None:
    """Show what needs no file, at once."""
    from ..spectra import library

    show(context, library.built_in(), bool(preferences.folders(context)))


class SKYLIGHT_OT_library_problems(bpy.types.Operator):
    """List the files and spectra of the library that cannot be used, with the reason"""

    bl_idname = "skylight.library_problems"
    bl_label = "Unusable Files"

    def invoke(self, context, event):
        """Open the list."""
        return context.window_manager.invoke_popup(self, width=900)

    def draw(self, context):
        """A line each."""
        problems = library_state.library.problems if library_state.library is not None else ()
        for line in problems[:TOLD]:
            self.layout.label(text=line, translate=False)
        if len(problems) > TOLD:
            self.layout.label(text=translated(f"and {len(problems) - TOLD} more"))

    def execute(self, context):
        """Tell them to the log."""
        for line in library_state.library.problems if library_state.library is not None else ():
            self.report({"WARNING"}, line)
        return {"FINISHED"}


class SKYLIGHT_PT_library(panels.Child, bpy.types.Panel):
    """Measured reflectances to choose from."""

    bl_label = "Library of Reflectances"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 30

    def draw(self, context):
        layout = self.layout
        own = context.window_manager.skylight_library
        number = library_state.chosen(context)
        if number is None:
            text = "Building materials, color checkers, and the measured materials in your folders"
            panel_text.paragraph(layout, context, text)
            layout.operator("skylight.refresh_library", text="Show Library", icon="ASSET_MANAGER")
        else:
            _list(layout, context, own)
            if library_state.seen(context) is None:
                layout.label(text="Choose a row of the list")
            else:
                _about(layout, context, number)
        preferences.draw_folders(layout, context)


def _list(layout, context, own) -> None:
    layout.prop(own, "search", text="", icon="VIEWZOOM")
    row = layout.row(align=True)
    row.prop(own, "order", text="")
    row.operator("skylight.refresh_library", text="", icon="FILE_REFRESH")
    lit = library_state.under_sky is not None
    layout.label(text="This sky · D65" if lit else "D65: the World has no sky")
    layout.template_list("SKYLIGHT_UL_library", "", own, "spectra", own, "active", rows=ROWS)
    library_state.follow_sky(context)


def _about(layout, context, number: int) -> None:
    found = library_state.library
    box = layout.box()
    panel_text.paragraph(box, context, found.names[number], "MATERIAL")
    for line in (found.classes[number], found.sources[number], f"Read as {found.kinds[number]}"):
        if line:
            panel_text.paragraph(box, context, line)
    row = layout.row(align=True)
    row.operator("skylight.assign_to_active")
    row.operator("skylight.assign_to_selected")
    layout.operator("skylight.write_assets", icon="ASSET_MANAGER")
    if found.problems:
        text = translated(f"{found.unused} Unusable...")
        layout.operator("skylight.library_problems", text=text, icon="ERROR", translate=False)


CLASSES = (
    SkylightSpectrum,
    SkylightLibrary,
    SKYLIGHT_UL_library,
    SKYLIGHT_OT_refresh_library,
    SKYLIGHT_OT_library_problems,
    SKYLIGHT_PT_library,
)


def attach() -> None:
    """Give the window manager what is shown of the library."""
    bpy.types.WindowManager.skylight_library = bpy.props.PointerProperty(type=SkylightLibrary)


def detach() -> None:
    """Take it off again."""
    del bpy.types.WindowManager.skylight_library
