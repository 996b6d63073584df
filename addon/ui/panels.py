"""The panels: 3D view, sidebar, tab Skylight; and in the material's properties."""

import bpy

from ..errors import InputError
from . import readout, targets, wheels


class Sidebar:
    """Where the panels of the 3D view stand."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Skylight"


class Child(Sidebar):
    """A panel inside the main one; without the wheels that one says all there is to say."""

    bl_parent_id = "SKYLIGHT_PT_main"

    @classmethod
    def poll(cls, context):
        return not wheels.missing()


class SKYLIGHT_PT_main(Sidebar, bpy.types.Panel):
    """The sky, and what concerns all materials."""

    bl_label = "Spectral Skylight"

    def draw(self, context):
        layout = self.layout
        if wheels.missing():
            wheels.draw(layout, context)
            return
        layout.template_ID(context.scene, "world")
        layout.operator("skylight.load_sky", text="Load Sky HDRI...", icon="FILEBROWSER")
        readout.sky(layout, context)
        column = layout.column(align=True)
        column.operator("skylight.update", icon="FILE_REFRESH")
        column.operator("skylight.apply_all", text="Apply All Chosen Reflectances")
        column.operator("skylight.remove_all", text="Remove from All Materials")


class SKYLIGHT_PT_numbers(Child, bpy.types.Panel):
    """What the HDRI's numbers mean."""

    bl_label = "Sky Numbers"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        world = context.scene.world
        if world is None:
            layout.label(text="The scene has no World")
            return
        numbers = world.skylight
        layout.prop(numbers, "tolerance")
        layout.prop(numbers, "basis")
        layout.prop(numbers, "camera")
        layout.prop(numbers, "white_balanced")
        if numbers.white_balanced:
            layout.prop(numbers, "white")
        readout.paragraph(layout, context, "Changes show after Update")


class SKYLIGHT_PT_light(Child, bpy.types.Panel):
    """Which light of the World reaches materials."""

    bl_label = "Light"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        world = context.scene.world
        if world is None:
            layout.label(text="The scene has no World")
            return
        numbers = world.skylight
        layout.prop(numbers, "sun")
        layout.prop(numbers, "occlusion")
        if numbers.occlusion == "baked":
            layout.prop(numbers, "bounce")
            row = layout.row(align=True)
            row.operator("skylight.bake")
            row.operator("skylight.remove_bakes", text="", icon="X")
        layout.prop(numbers, "ground")
        layout.prop(numbers, "gloss")
        readout.lights(layout, context)


class SKYLIGHT_PT_lamp(bpy.types.Panel):
    """The spectrum of the lamp that the properties editor shows."""

    bl_label = "Spectral Skylight"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
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
        readout.paragraph(self.layout, context, "Shows on spectral materials after Update")


class SKYLIGHT_PT_material(Child, bpy.types.Panel):
    """The active object's active material."""

    bl_label = "Material"

    def draw(self, context):
        material = targets.active(context)
        if material is None:
            self.layout.label(text="Select an object with a material")
            return
        self.layout.label(text=material.name, icon="MATERIAL")
        _material(self.layout, context, material)


class SKYLIGHT_PT_all(Child, bpy.types.Panel):
    """All spectral materials of the file, a row each."""

    bl_label = "All Spectral Materials"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        readout.table(self.layout)


class SKYLIGHT_PT_material_properties(bpy.types.Panel):
    """The material that the properties editor shows."""

    bl_label = "Spectral Skylight"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return targets.active(context) is not None

    def draw(self, context):
        if wheels.missing():
            wheels.draw(self.layout, context)
            return
        _material(self.layout, context, targets.active(context))


def _material(layout, context, material) -> None:
    """Choose a reflectance, apply and remove it, and read what it does."""
    from ..scene import materials

    try:
        materials.check_editable(material)
    except InputError as error:
        readout.paragraph(layout, context, str(error), "LIBRARY_DATA_DIRECT")
    else:
        _choose(layout, context, material)
    readout.material(layout, context, material)


def _choose(layout, context, material) -> None:
    from ..scene import materials

    choice = material.skylight
    row = layout.row(align=True)
    row.prop(choice, "filepath", text="", placeholder="Reflectance CSV")
    row.operator("skylight.choose_reflectance", text="", icon="FILEBROWSER")
    if choice.problem:
        readout.paragraph(layout, context, choice.problem, "ERROR")
    elif choice.filepath:
        layout.prop_search(choice, "column", choice, "columns", icon="MATERIAL")
        layout.prop(choice, "unit")
    row = layout.row(align=True)
    if choice.filepath:
        row.operator("skylight.apply")
    else:
        row.operator("skylight.estimate")
    if materials.is_managed(material):
        row.operator("skylight.remove")
    row = layout.row(align=True)
    row.operator("skylight.apply_selected")
    row.operator("skylight.remove_selected")


CLASSES = (
    SKYLIGHT_PT_main,
    SKYLIGHT_PT_light,
    SKYLIGHT_PT_lamp,
    SKYLIGHT_PT_material,
    SKYLIGHT_PT_numbers,
    SKYLIGHT_PT_all,
    SKYLIGHT_PT_material_properties,
)
