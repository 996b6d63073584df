"""What can be chosen for one material, and the panels of the properties editor that show it."""

import bpy

from ..errors import InputError
from . import library_state, panel_text, targets
from .labels import told


def draw(layout, context, material) -> None:
    """Choose what a material is made of, apply and remove it, and read what it does."""
    from ..scene.materials import spectral_material

    try:
        spectral_material.check_editable(material)
    except InputError as error:
        panel_text.paragraph(layout, context, told(error), "LIBRARY_DATA_DIRECT")
    else:
        _choose(layout, context, material)
    panel_text.material(layout, context, material)


def _choose(layout, context, material) -> None:
    from ..scene.materials import spectral_material

    choice = material.skylight
    layout.prop(choice, "kind", text="")
    row = layout.row(align=True)
    row.prop(choice, "filepath", text="", placeholder="Measured values (CSV)")
    row.operator("skylight.choose_reflectance", text="", icon="FILEBROWSER")
    if choice.problem:
        panel_text.paragraph(layout, context, choice.problem, "ERROR")
    elif choice.filepath:
        _details(layout, choice)
    row = layout.row(align=True)
    if choice.filepath:
        row.operator("skylight.apply")
    else:
        row.operator("skylight.estimate", text="Estimate")
    row.operator("skylight.browse_library").material = material.name
    if material in spectral_material.ours():
        row.operator("skylight.remove", text="", icon="X")
        row.operator("skylight.explain", text="", icon="QUESTION")
    _measured(layout, context, material)
    row = layout.row(align=True)
    row.operator("skylight.apply_selected", text="To Selection")
    row.operator("skylight.remove_selected", text="From Selection")


def _details(layout, choice) -> None:
    if choice.kind == "METAL":
        return
    layout.prop(choice, "column", icon="MATERIAL")
    layout.prop(choice, "unit")
    if choice.kind == "GLASS":
        layout.prop(choice, "pane")
        return
    layout.prop(choice, "behind", text="Behind")
    if choice.behind:
        layout.prop(choice, "behind_column")


def _measured(layout, context, material) -> None:
    """Offer the measured reflectances that an estimated or painted material may be."""
    from ..scene.blend_data import working_space
    from ..scene.materials import base_color

    color = base_color.known_colour(material)
    if color is None:
        return
    if library_state.library is None:
        layout.operator("skylight.refresh_library", text="Find Measured...", icon="VIEWZOOM")
        return
    found = library_state.nearest(color, material.name, working_space.name())
    if found:
        panel_text.paragraph(layout, context, "Nearest measured, and the ΔE of choosing it")
    column = layout.column(align=True)
    for one in found:
        name, path = (
            library_state.library.names[one.number],
            library_state.library.paths[one.number],
        )
        text = f"{name}   ΔE {one.delta_E:.1f}"
        button = column.operator("skylight.apply", text=text, translate=False)
        button.material, button.filepath, button.column = material.name, path, name


class Properties:
    """Where the panels of the properties editor stand."""

    bl_label = "Spectral Skylight"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"


class SKYLIGHT_PT_material_properties(Properties, bpy.types.Panel):
    """The material that the properties editor shows."""

    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return targets.active(context) is not None

    def draw(self, context):
        draw(self.layout, context, targets.active(context))


class SKYLIGHT_PT_lamp(Properties, bpy.types.Panel):
    """The spectrum of the lamp that the properties editor shows."""

    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return getattr(context, "light", None) is not None

    def draw(self, context):
        self.layout.use_property_split = True
        light = getattr(context, "light", None)
        if light is None:
            return
        self.layout.prop(light.skylight, "spectrum")
        panel_text.paragraph(self.layout, context, "Press Update to apply it to spectral materials")


CLASSES = (SKYLIGHT_PT_material_properties, SKYLIGHT_PT_lamp)
