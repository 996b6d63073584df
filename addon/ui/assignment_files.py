"""Keeping what materials have been given in a table, and giving it to a re-imported model."""

# mypy: disable-error-code="valid-type"

from pathlib import Path

import bpy

from . import give, operator, properties


class SKYLIGHT_OT_write_assignments(operator.Thin, bpy.types.Operator):
    """Write a table with the assignment of every spectral material. Another file or a re-imported \
model reads it by material name"""

    bl_idname = "skylight.write_assignments"
    bl_label = "Write Assignments..."

    filepath: bpy.props.StringProperty(
        name="Table", description="CSV with materials and their assignments", subtype="FILE_PATH"
    )
    filter_glob: bpy.props.StringProperty(default="*.csv", options={"HIDDEN"})

    @classmethod
    def disabled_reason(cls, context):
        from ..scene.materials import spectral_material

        return "" if spectral_material.ours() else "No material is spectral yet"

    def invoke(self, context, event):
        if not self.filepath:
            self.filepath = str(Path(bpy.data.filepath or "untitled").with_suffix(".materials.csv"))
        return operator.browse(self, context)

    def run(self, context):
        from ..scene import use_cases

        path = Path(bpy.path.abspath(self.filepath))
        return [("INFO", f"Wrote {use_cases.write_table(path)} material(s) to {path.name}")]


class SKYLIGHT_OT_read_assignments(operator.Thin, bpy.types.Operator):
    """Assign to the materials of the scene what a table holds for their names"""

    bl_idname = "skylight.read_assignments"
    bl_label = "Read Assignments..."

    filepath: bpy.props.StringProperty(
        name="Table", description="CSV with materials and their assignments", subtype="FILE_PATH"
    )
    filter_glob: bpy.props.StringProperty(default="*.csv", options={"HIDDEN"})

    @classmethod
    def disabled_reason(cls, context):
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
