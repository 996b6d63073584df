"""Choosing which measured reflectance a material is to have."""

# mypy: disable-error-code="valid-type"

import bpy

from ..errors import InputError
from . import choice, operator, targets

_ENDINGS = (
    ".asc .cgats .cie .csv .cxf .dat .dx .it8 .jcm .jdx .json .mat .qtx .sed "
    ".sig .sli .sp .spd .spdx .tab .ti3 .trt .tsv .ttt .txt"
)
ENDINGS = tuple(_ENDINGS.split(" "))
"""Endings of reflectance files; a test holds them to `spectra.formats`, which loads too much."""


class SKYLIGHT_OT_choose_reflectance(choice.Fields, operator.Thin, bpy.types.Operator):
    """Choose the file with a material's measured reflectance. Press Apply to use it"""

    bl_idname = "skylight.choose_reflectance"
    bl_label = "Choose Reflectance"

    filepath: bpy.props.StringProperty(
        name="File",
        description="File with wavelengths in nm and measured values",
        subtype="FILE_PATH",
    )
    kind: bpy.props.EnumProperty(
        name="Measured", description="What the file holds", items=choice.KINDS
    )
    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the active material"
    )
    filter_glob: bpy.props.StringProperty(
        default=";".join(f"*{ending}" for ending in ENDINGS), options={"HIDDEN"}
    )

    def invoke(self, context, event):
        return operator.browse(self, context)

    def run(self, context):
        from ..scene import use_cases

        (material,), _ = use_cases.editable([targets.named(context, self.material)])
        own = material.skylight
        told = [name for name in choice.DETAILS if self.properties.is_property_set(name)]
        names = own.read_names(self.filepath, self.kind if "kind" in told else own.kind)
        if self.column and self.column not in names:
            some = ", ".join(f"'{name}'" for name in names[:8])
            raise InputError(self.filepath, f"no column '{self.column}'", f"its columns are {some}")
        for name in told:
            setattr(own, name, getattr(self, name))
        own.filepath = self.filepath
        if self.column:
            own.column = self.column
        chosen = f"column {own.column}" if own.column else "choose a column"
        found = f"{len(names)} column(s), {chosen}" if names else "n and k of a metal"
        return [("INFO", f"{material.name}: {found}")]


CLASSES = (SKYLIGHT_OT_choose_reflectance,)
