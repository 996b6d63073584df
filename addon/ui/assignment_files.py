"""Keeping what materials have been given in a table, and giving it to a re-imported model."""

# mypy: disable-error-code="valid-type"

from pathlib import Path

import bpy

from . import give, operator, properties


class SKYLIGHT_OT_write_assignments(operator.Thin, bpy.types.Operator):
    """Write a table of what every spectral material has been given, which another file or a \
re-imported model reads by the materials' names"""

    bl_idname = "skylight.write_assignments"
    bl_label = "Write Assignments..."

    filepath: bpy.props.StringProperty(
        name="Table", description="A CSV of materials and what they are given", subtype="FILE_PATH"
    )
    filter_glob: bpy.props.StringProperty(default="*.csv", options={"HIDDEN"})

    @classmethod
    def hindrance(cls, context):
        from ..scene.materials import spectral_material

        return "" if spectral_material.ours() else "No material of the file is spectral"

    def invoke(self, context, event):
        if not self.filepath:
            self.filepath = str(Path(bpy.data.filepath or "untitled").with_suffix(".materials.csv"))
        return operator.browse(self, context)

    def run(self, context):
        from ..scene import use_cases

        path = Path(bpy.path.abspath(self.filepath))
        return [("INFO", f"{path.name}: {use_cases.write_table(path)} material(s)")]


class SKYLIGHT_OT_read_assignments(operator.Thin, bpy.types.Operator):
    """Give all materials of the scene what a table has for their names"""

    bl_idname = "skylight.read_assignments"
    bl_label = "Read Assignments..."

    filepath: bpy.props.StringProperty(
        name="Table", description="A CSV of materials and what they are given", subtype="FILE_PATH"
    )
    filter_glob: bpy.props.StringProperty(default="*.csv", options={"HIDDEN"})

    @classmethod
    def hindrance(cls, context):
        return operator.no_sky(context)

    def invoke(self, context, event):
        return operator.browse(self, context)

    def run(self, context):
        from ..scene import use_cases

        path = Path(bpy.path.abspath(self.filepath))
        settings = properties.settings_of(context.scene.world)
        found = use_cases.give_table(context.scene, path, settings)
        lines = [("WARNING" if r.out_of_gamut else "INFO", r.line) for r in found.results]
        return [*give.warnings(found.skipped), *lines]


CLASSES = (SKYLIGHT_OT_write_assignments, SKYLIGHT_OT_read_assignments)
