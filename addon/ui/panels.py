"""The sidebar of the 3D view, tab Skylight: three boxes in one panel, and closed ones below.

Sky · Materials · Look are all that a scene needs. What is rarely needed stands closed under them.
"""

import bpy

from ..choices import ALL_LIGHT
from . import (
    all_materials,
    help,
    look_box,
    material_panel,
    materials_box,
    panel_text,
    sky_box,
    targets,
)


class Sidebar:
    """Where the panels of the 3D view stand, each with the button that opens its help."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Skylight"

    def draw_header_preset(self, context):
        """The button at the header's end."""
        help.button(self.layout, self.bl_label)


class Child(Sidebar):
    """A panel inside the main one."""

    bl_parent_id = "SKYLIGHT_PT_main"


class OfWorld(Child):
    """Settings that lie with the scene's World, under Advanced."""

    bl_parent_id = "SKYLIGHT_PT_advanced"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.scene.world is not None


class SKYLIGHT_PT_main(Sidebar, bpy.types.Panel):
    """All that a scene needs."""

    bl_label = "Spectral Skylight"

    def draw_header_preset(self, context):
        """The button that opens the page at its start."""
        help.button(self.layout, "")

    def draw(self, context):
        layout = self.layout
        sky_box.draw(layout, context)
        later = layout.column()
        later.enabled = sky_box.is_chosen(context.scene.world)
        materials_box.draw(later, context)
        look_box.draw(later, context)


class SKYLIGHT_PT_material(Child, bpy.types.Panel):
    """The active object's active material."""

    bl_label = "Selected Material"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 20

    def draw(self, context):
        material = targets.active(context)
        if material is None:
            self.layout.label(text="Select an object with a material")
            return
        self.layout.label(text=material.name, icon="MATERIAL", translate=False)
        material_panel.draw(self.layout, context, material)


class SKYLIGHT_PT_all(Child, bpy.types.Panel):
    """All spectral materials of the file, a row each."""

    bl_label = "All Materials"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 40

    def draw(self, context):
        layout = self.layout
        all_materials.table(layout, context)
        all_materials.left(layout, context)
        column = layout.column(align=True)
        column.operator("skylight.write_assignments")
        column.operator("skylight.read_assignments")


class SKYLIGHT_PT_advanced(Child, bpy.types.Panel):
    """How the numbers come about."""

    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 95

    def draw(self, context):
        layout = self.layout
        layout.operator("skylight.update", icon="FILE_REFRESH")
        panel_text.view(layout, context)


class SKYLIGHT_PT_last(Child, bpy.types.Panel):
    """The way back."""

    bl_label = "Remove"
    bl_options = {"HIDE_HEADER"}
    bl_order = 99

    def draw(self, context):
        self.layout.operator("skylight.remove_all", text="Remove All and Restore My World")


class SKYLIGHT_PT_light(OfWorld, bpy.types.Panel):
    """Which light of the World reaches materials."""

    bl_label = "Sun, Shadows and Ground"
    bl_order = 11

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        numbers = context.scene.world.skylight
        layout.prop(numbers, "sun")
        layout.prop(numbers, "occlusion")
        if numbers.occlusion in ALL_LIGHT:
            row = layout.row(align=True)
            row.operator("skylight.bake")
            row.operator("skylight.remove_bakes", text="", icon="X")
        layout.prop(numbers, "ground")
        panel_text.lights(layout, context)


class SKYLIGHT_PT_numbers(OfWorld, bpy.types.Panel):
    """What the HDRI's numbers mean."""

    bl_label = "HDRI Interpretation"
    bl_order = 12

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        numbers = context.scene.world.skylight
        layout.prop(numbers, "basis")
        layout.prop(numbers, "sun_told")
        if numbers.sun_told:
            layout.prop(numbers, "sun_elevation")
        layout.prop(numbers, "camera")
        layout.prop(numbers, "white_balanced")
        if numbers.white_balanced:
            layout.prop(numbers, "white")
        panel_text.model(layout, context)


class SKYLIGHT_PT_exactness(OfWorld, bpy.types.Panel):
    """How exact materials are to be, and what of their look stays."""

    bl_label = "Accuracy and Gloss"
    bl_order = 14

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        numbers = context.scene.world.skylight
        layout.prop(numbers, "tolerance")
        layout.prop(numbers, "gloss")
        layout.operator("skylight.apply_all", text="Apply Chosen Files Only")
        panel_text.paragraph(layout, context, "Press Update to apply changes")


CLASSES = (
    SKYLIGHT_PT_main,
    SKYLIGHT_PT_material,
    SKYLIGHT_PT_all,
    SKYLIGHT_PT_advanced,
    SKYLIGHT_PT_light,
    SKYLIGHT_PT_numbers,
    SKYLIGHT_PT_exactness,
    SKYLIGHT_PT_last,
)
