"""Choosing which measured reflectance a material is to have."""

# mypy: disable-error-code="valid-type"

import bpy

from ..errors import InputError
from . import operator, targets

ENDINGS: tuple[str, ...] = (".cgats", ".cie", ".csv", ".cxf", ".it8", ".json", ".mat", ".sli")
ENDINGS += (".sp", ".ti3", ".tsv", ".txt")
"""Endings of reflectance files; a test holds them to `spectra.formats`, which loads too much."""


class SKYLIGHT_OT_choose_reflectance(operator.Thin, bpy.types.Operator):
    """Choose the CSV with a material's measured reflectance; it shows once it is applied"""

    bl_idname = "skylight.choose_reflectance"
    bl_label = "Choose Reflectance"

    filepath: bpy.props.StringProperty(
        name="CSV", description="Wavelength in nm, then reflectances", subtype="FILE_PATH"
    )
    column: bpy.props.StringProperty(
        name="Column", description="Empty: the only one, or the one named as the material"
    )
    material: bpy.props.StringProperty(name="Material", description="Empty: the active one")
    filter_glob: bpy.props.StringProperty(
        default=";".join(f"*{ending}" for ending in ENDINGS), options={"HIDDEN"}
    )

    def invoke(self, context, event):
        return operator.browse(self, context)

    def run(self, context):
        (material,), _ = targets.editable([targets.named(context, self.material)])
        choice = material.skylight
        names = choice.read_names(self.filepath)
        if self.column and self.column not in names:
            some = ", ".join(f"'{name}'" for name in names[:8])
            raise InputError(self.filepath, f"no column '{self.column}'", f"there are {some}")
        choice.filepath = self.filepath
        if self.column:
            choice.column = self.column
        chosen = f"column {choice.column}" if choice.column else "choose a column"
        return [("INFO", f"{material.name}: {len(names)} column(s), {chosen}")]


CLASSES = (SKYLIGHT_OT_choose_reflectance,)
