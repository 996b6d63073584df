"""What was chosen for a material, in its properties or an operator's, read from its files."""

# No postponed annotations: Blender reads its properties from them.
# mypy: disable-error-code="valid-type"

from dataclasses import dataclass, fields

import bpy

from .. import choices
from ..choices import items
from ..errors import InputError
from .labels import told

UNITS = (
    ("AUTO", "From the File", "From the column headers, or from the range of the values"),
    *items(choices.UNITS, upper=True),
)
KINDS = items(choices.KINDS)
PANES = items(choices.PANES)

DETAILS = ("kind", "unit", "pane", "behind", "behind_column")
"""What is chosen beside file and column."""


class Fields:
    """What is chosen for a material, as properties and operators have it."""

    column: bpy.props.StringProperty(
        name="Column", description="Column of the file. Leave empty if it has only one"
    )
    unit: bpy.props.EnumProperty(
        name="Unit", description="Unit of the values in the file", items=UNITS
    )
    pane: bpy.props.EnumProperty(
        name="Pane",
        description="How the mesh models the glass. The pane tints light once",
        items=PANES,
    )
    behind: bpy.props.StringProperty(
        name="Behind Glass",
        description="Transmittance of the glass that all light on this surface passes through. "
        "Leave empty if there is none",
        subtype="FILE_PATH",
    )
    behind_column: bpy.props.StringProperty(
        name="Glass Column",
        description="Column of the glass file. Leave empty if it has only one",
    )


@dataclass(frozen=True)
class Chosen:
    """What was chosen for a material, as plain values: the names are those of `Fields`."""

    filepath: str
    column: str = ""
    kind: str = "REFLECTANCE"
    unit: str = "AUTO"
    pane: str = "FACE"
    behind: str = ""
    behind_column: str = ""

    @classmethod
    def of(cls, own, **others: str) -> "Chosen":
        """Take it from a material's properties or an operator's; ``others`` go first."""
        return cls(**{f.name: others.get(f.name, getattr(own, f.name)) for f in fields(cls)})

    def read(self, absolute):
        """Return the `Assignment` that it comes to; InputError if a file cannot be read.

        ``absolute`` resolves a path that is relative to the blend file.
        """
        from ..transfer import assignment

        path = absolute(self.filepath)
        if self.kind == "METAL":
            return assignment.read_metal(path)
        unit = None if self.unit == "AUTO" else self.unit.lower()
        panes = {"FACE": assignment.SINGLE_FACE, "BLOCK": assignment.BLOCK}
        faces = panes[self.pane] if self.kind == "GLASS" else 0
        found = assignment.read(path, self.column, unit, faces)
        if self.behind and not faces:
            glass = absolute(self.behind)
            found = found.lit_through(assignment.read(glass, self.behind_column, faces=1))
        return found


def read(material: bpy.types.Material):
    """The `Assignment` of what was chosen for a material; InputError if it cannot be read."""
    return Chosen.of(material.skylight).read(material.skylight.absolute)


def of_scene(scene: bpy.types.Scene):
    """What is chosen for a scene's materials: an `Assignment`, or why it cannot be read."""
    from ..scene.materials import eligibility

    chosen = {}
    for material in eligibility.materials_of(scene):
        if material.skylight.filepath:
            try:
                chosen[material] = read(material)
            except InputError as error:
                chosen[material] = told(error)
    return chosen


def changed_files(materials) -> tuple[dict[bpy.types.Material, str], list[str]]:
    """Of which materials the file on disk is no longer what they were given; lines on lost ones.

    What was chosen anew and not applied yet is no change of the file.
    """
    from ..scene.materials import spectral_material as managing
    from ..transfer.assignment import BEHIND

    changed, lost = {}, []
    for material in materials:
        own, managed = material.skylight, managing.managed(material)
        if managed is None or not own.filepath or own.kind != "REFLECTANCE":
            continue
        if managed.record.reflectance.partition(BEHIND)[0] != own.column:
            continue
        try:
            found = read(material)
        except InputError as error:
            lost.append(f"{material.name} keeps its reflectance. {told(error)}")
        else:
            if found.hash != managed.record.reflectance_hash:
                changed[material] = f"{bpy.path.basename(own.filepath)} has changed: apply it again"
    return changed, lost


def keep(own, chosen: Chosen, name: str) -> None:
    """Keep with a material's properties what it was given; ``name``: of the column read."""
    for field in DETAILS:
        if getattr(own, field) != getattr(chosen, field):
            setattr(own, field, getattr(chosen, field))
    if own.filepath != chosen.filepath:
        own.filepath = chosen.filepath  # and with it what is wrong with it
    own.column = "" if chosen.kind == "METAL" else name
