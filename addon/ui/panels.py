"""The sidebar of the 3D view, tab Skylight: three steps from top to bottom.

Sky · Materials · Result. What is rarely needed stands in a closed panel under its step.
"""

import bpy

from ..choices import AUTO, BAKED
from . import material_panel, panel_text, result, targets


class Sidebar:
    """Where the panels of the 3D view stand."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Skylight"


class Child(Sidebar):
    """A panel inside the main one."""

    bl_parent_id = "SKYLIGHT_PT_main"


class OfWorld(Child):
    """Settings that lie with the scene's World."""

    bl_parent_id = "SKYLIGHT_PT_sky"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.scene.world is not None


class SKYLIGHT_PT_main(Sidebar, bpy.types.Panel):
    """How far the scene is."""

    bl_label = "Spectral Skylight"

    def draw(self, context):
        result.summary(self.layout, context)


class SKYLIGHT_PT_sky(Child, bpy.types.Panel):
    """First step: what lights the scene."""

    bl_label = "Sky"
    bl_order = 10

    def draw(self, context):
        layout = self.layout
        layout.template_ID(context.scene, "world")
        layout.operator("skylight.load_sky", text="Load Sky HDRI...", icon="FILEBROWSER")
        panel_text.sky(layout, context)


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
        if numbers.occlusion in (AUTO, BAKED):
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


class SKYLIGHT_PT_materials(Child, bpy.types.Panel):
    """Second step: what the scene is made of."""

    bl_label = "Materials"
    bl_order = 20

    def draw(self, context):
        layout = self.layout
        column = layout.column()
        column.scale_y = 1.6
        column.operator("skylight.make_spectral", icon="MATERIAL")
        row = layout.row(align=True)
        row.operator("skylight.update", icon="FILE_REFRESH")
        row.operator("skylight.remove_all", text="Remove All", icon="X")
        result.problems(layout, context)


class SKYLIGHT_PT_material(Child, bpy.types.Panel):
    """The active object's active material."""

    bl_label = "Active Material"
    bl_parent_id = "SKYLIGHT_PT_materials"
    bl_order = 21

    def draw(self, context):
        material = targets.active(context)
        if material is None:
            self.layout.label(text="Select an object with a material")
            return
        self.layout.label(text=material.name, icon="MATERIAL")
        material_panel.draw(self.layout, context, material)


class SKYLIGHT_PT_left(Child, bpy.types.Panel):
    """Materials of the scene that one click does not change, each with the reason."""

    bl_label = "Left Alone"
    bl_parent_id = "SKYLIGHT_PT_materials"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 28

    @classmethod
    def poll(cls, context):
        return bool(result.left_alone(context))

    def draw(self, context):
        result.left(self.layout, context)


class SKYLIGHT_PT_exactness(OfWorld, bpy.types.Panel):
    """How exact materials are to be, and what of their look stays."""

    bl_label = "Accuracy and Gloss"
    bl_parent_id = "SKYLIGHT_PT_materials"
    bl_order = 29

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        numbers = context.scene.world.skylight
        layout.prop(numbers, "tolerance")
        layout.prop(numbers, "gloss")
        layout.operator("skylight.apply_all", text="Apply Chosen Files Only")
        row = layout.row(align=True)
        row.operator("skylight.write_assignments")
        row.operator("skylight.read_assignments")
        panel_text.paragraph(layout, context, "Press Update to apply changes")


class SKYLIGHT_PT_result(Child, bpy.types.Panel):
    """Third step: what is seen, and how far it can be trusted."""

    bl_label = "Result"
    bl_order = 30

    def draw(self, context):
        layout = self.layout
        column = layout.column(align=True)
        column.scale_y = 1.2
        column.operator("skylight.show_in_viewport", icon="SHADING_RENDERED")
        result.before_after(column)
        result.view(layout, context)
        result.caption(layout, context)


class SKYLIGHT_PT_all(Child, bpy.types.Panel):
    """All spectral materials of the file, a row each."""

    bl_label = "All Spectral Materials"
    bl_parent_id = "SKYLIGHT_PT_result"
    bl_order = 32

    def draw(self, context):
        result.table(self.layout)


CLASSES = (
    SKYLIGHT_PT_main,
    SKYLIGHT_PT_sky,
    SKYLIGHT_PT_light,
    SKYLIGHT_PT_numbers,
    SKYLIGHT_PT_materials,
    SKYLIGHT_PT_material,
    SKYLIGHT_PT_left,
    SKYLIGHT_PT_exactness,
    SKYLIGHT_PT_result,
    SKYLIGHT_PT_all,
)
