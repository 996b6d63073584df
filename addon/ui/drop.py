"""Dropping a file of reflectances on the 3D view gives it to the material under the mouse."""

# mypy: disable-error-code="valid-type"

import bpy

from ..errors import InputError
from . import assign, choice, give, operator, targets
from .choose_reflectance import ENDINGS
from .labels import told
from .translation import translated

_items: dict[str, list[tuple[str, str, str]]] = {}
"""Of each dropped file the columns to choose from: Blender keeps no copy of their text."""


def _columns(self, context):
    return _items.get(self.filepath, [])


class SKYLIGHT_OT_drop_reflectance(choice.Fields, operator.Long, bpy.types.Operator):
    """Assign a reflectance of the dropped file to the material under the mouse or the active one"""

    bl_idname = "skylight.drop_reflectance"
    bl_label = "Assign Reflectance"
    bl_property = "chosen"
    doing = "Assigning"

    filepath: bpy.props.StringProperty(
        name="File", description="Measured reflectances", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )
    kind: bpy.props.EnumProperty(
        name="Measured", description="What the file holds", items=choice.KINDS
    )
    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the object's material, or the active one"
    )
    object: bpy.props.StringProperty(name="Object", options={"SKIP_SAVE"})
    slot: bpy.props.IntProperty(name="Material Slot", min=0, options={"SKIP_SAVE"})
    chosen: bpy.props.EnumProperty(
        name="Column", description="Column of the file", items=_columns, options={"SKIP_SAVE"}
    )

    def invoke(self, context, event):
        """Look what is under the mouse; of many columns let one be chosen."""
        from . import under_mouse

        found = under_mouse.under_mouse(context, event.mouse_region_x, event.mouse_region_y)
        if found is not None:
            self.object, self.slot = found[0].name, found[1]
        try:
            names = tuple(self._kinds())
        except InputError as error:
            self.report({"ERROR"}, translated(told(error)))
            return {"CANCELLED"}
        if len(names) > 1 and not self.column:
            _items[self.filepath] = [(name, name, "") for name in names]
            self.asked = True
            context.window_manager.invoke_search_popup(self)
            return {"RUNNING_MODAL"}
        return super().invoke(context, event)

    def work(self, context):
        if not self.filepath:
            raise InputError("the file", "has no path", "drop a file, or set filepath")
        from ..scene import use_cases

        column = self.column
        if not column and self.properties.is_property_set("chosen"):
            column = self.chosen
        kinds = self._kinds()
        if not column:
            if len(kinds) > 1:
                some = ", ".join(f"'{name}'" for name in list(kinds)[:8])
                raise InputError(
                    self.filepath, f"holds {len(kinds)} materials", f"choose a column: {some}"
                )
            column = next(iter(kinds))
        kind = assign.kind(kinds.get(column, ""))
        chosen = choice.Chosen.of(self, column=column, kind=kind)
        found, skipped = use_cases.editable([self._target(context, column)])
        return [
            *give.warnings(skipped),
            *(yield from give.giving(context, dict.fromkeys(found, chosen))),
        ]

    def _target(self, context, column: str) -> bpy.types.Material:
        from . import under_mouse

        obj = context.scene.objects.get(self.object) if not self.material else None
        if obj is None and not self.material and targets.active(context) is None:
            obj = context.view_layer.objects.active
        if obj is not None and hasattr(obj.data, "materials"):
            return under_mouse.material_in(obj, self.slot, column)
        return targets.named(context, self.material)

    def _kinds(self) -> dict[str, str]:
        """The columns that can be used, and what kind of thing each is; InputError if none can."""
        from ..spectra.reflectance import read_all

        found = read_all(
            bpy.path.abspath(self.filepath), None if self.unit == "AUTO" else self.unit.lower()
        )
        if not found.names:
            raise next(iter(found.problems.values()))
        return dict(zip(found.names, found.classes or ("",) * len(found.names), strict=True))


class SKYLIGHT_FH_reflectance(bpy.types.FileHandler):
    """Tells Blender which files can be dropped."""

    bl_idname = "SKYLIGHT_FH_reflectance"
    bl_label = "Measured Reflectance"
    bl_import_operator = "skylight.drop_reflectance"
    bl_file_extensions = ";".join(ENDINGS)

    @classmethod
    def poll_drop(cls, context):
        """Whether it can be dropped here."""
        return context.area is not None and context.area.type == "VIEW_3D"


CLASSES = (SKYLIGHT_OT_drop_reflectance, SKYLIGHT_FH_reflectance)
