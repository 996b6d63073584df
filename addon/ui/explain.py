"""Showing why the active material has the color it has."""

# mypy: disable-error-code="valid-type"

import bpy

from ..errors import InputError
from . import panel_text, targets
from .translation import translated

WIDTH = 600
"""[pixels] of the pop-up."""


class SKYLIGHT_OT_explain(bpy.types.Operator):
    """Show each step from the material's file to its color, and list what looks wrong"""

    bl_idname = "skylight.explain"
    bl_label = "Why Is This Color Wrong?"
    bl_options = {"REGISTER"}

    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the active material"
    )

    def invoke(self, context, event):
        """Open the text over the panel."""
        try:
            self.lines = self._lines(context)
        except InputError as error:
            self.report({"ERROR"}, translated(str(error)))
            return {"CANCELLED"}
        return context.window_manager.invoke_popup(self, width=WIDTH)

    def draw(self, context):
        """A paragraph for each line."""
        for line in self.lines:
            wrong = line.startswith("Suspicious: ") and line != "Suspicious: nothing"
            panel_text.paragraph(self.layout, context, line, "ERROR" if wrong else "NONE", WIDTH)

    def execute(self, context):
        """Report the lines, for scripts."""
        try:
            lines = self._lines(context)
        except InputError as error:
            self.report({"ERROR"}, translated(str(error)))
            return {"CANCELLED"}
        for line in lines:
            self.report({"INFO"}, translated(line))
        return {"FINISHED"}

    def _lines(self, context) -> list[str]:
        from ..scene import explain

        return explain.explain(context.scene, targets.named(context, self.material)).lines


CLASSES = (SKYLIGHT_OT_explain,)
