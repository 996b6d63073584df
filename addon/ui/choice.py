"""What was chosen for a material, in its properties or an operator's, read from its files."""

# No postponed annotations: Blender reads its properties from them.
# mypy: disable-error-code="valid-type"

import bpy

from ..errors import InputError

UNITS = (
    ("AUTO", "From the File", "By the column headers, else by the size of the numbers"),
    ("PERCENT", "Percent", "0 to 100"),
    ("FRACTION", "Fraction", "0 to 1"),
)
KINDS = (
    ("REFLECTANCE", "Reflectance", "A surface: what it reflects of each wavelength"),
    ("GLASS", "Glass", "A pane: what it lets through of each wavelength, measured face on"),
    ("METAL", "Metal", "A polished metal: its refractive index n and extinction k"),
)
PANES = (
    ("FACE", "Single Face", "Each face of the mesh is a whole pane"),
    ("BLOCK", "Closed Block", "The mesh has a face on either side of the pane"),
)


DETAILS = ("kind", "unit", "pane", "behind", "behind_column")
"""What is chosen beside file and column."""


class Fields:
    """What is chosen for a material, as properties and operators have it."""

    column: bpy.props.StringProperty(
        name="Column", description="Which of the file's materials; empty: the only one"
    )
    unit: bpy.props.EnumProperty(
        name="Unit", description="What the file's numbers are", items=UNITS
    )
    pane: bpy.props.EnumProperty(
        name="Pane",
        description="How glass is modelled: it tints once, however many faces it has",
        items=PANES,
    )
    behind: bpy.props.StringProperty(
        name="Behind Glass",
        description="Transmittance of a glazing through which alone this surface is lit, for light "
        "that passed it has another spectrum; empty: none",
        subtype="FILE_PATH",
    )
    behind_column: bpy.props.StringProperty(
        name="Glass Column", description="Which of the glazing file's; empty: the only one"
    )


def read(choice, material: bpy.types.Material, column: str = ""):
    """The `scene.given.Given` of what was chosen for a material; InputError if it cannot be read.

    ``choice``: the material's own properties, or an operator with a file; ``column`` goes first.
    """
    from ..scene.materials import assignment

    absolute = material.skylight.absolute
    path = absolute(choice.filepath)
    if choice.kind == assignment.METAL:
        return assignment.read_metal(path)
    unit = None if choice.unit == "AUTO" else choice.unit.lower()
    faces = (1 + (choice.pane == "BLOCK")) if choice.kind == assignment.GLASS else 0
    found = assignment.read(path, column or choice.column, unit, faces)
    if choice.behind and not faces:
        found = assignment.behind(
            found, assignment.read(absolute(choice.behind), choice.behind_column, faces=1)
        )
    return found


def of_scene(scene: bpy.types.Scene):
    """What is chosen for a scene's materials: each a `Given`, or the line why it cannot be read."""
    from ..scene.materials import eligibility

    chosen = {}
    for material in eligibility.materials_of(scene):
        if material.skylight.filepath:
            try:
                chosen[material] = read(material.skylight, material)
            except InputError as error:
                chosen[material] = str(error)
    return chosen


def changed_files(materials) -> tuple[dict[bpy.types.Material, str], list[str]]:
    """Of which materials the file on disk is no longer what they were given; lines on lost ones.

    What was chosen anew and not applied yet is no change of the file.
    """
    from ..scene.materials import assignment
    from ..scene.materials import spectral_material as managing

    changed, lost = {}, []
    for material in materials:
        own, managed = material.skylight, managing.managed(material)
        if managed is None or not own.filepath or own.kind != assignment.REFLECTANCE:
            continue
        if managed.reflectance_name.partition(assignment.BEHIND)[0] != own.column:
            continue
        try:
            found = read(own, material)
        except InputError as error:
            lost.append(f"{material.name} keeps its reflectance, but {error}")
        else:
            if found.hash != managed.reflectance_hash:
                changed[material] = f"{bpy.path.basename(own.filepath)} has changed: apply it anew"
    return changed, lost


def keep(own, choice, name: str) -> None:
    """Keep with a material what an operator was given for it; ``name``: of the column read."""
    for field in DETAILS:
        if getattr(own, field) != getattr(choice, field):
            setattr(own, field, getattr(choice, field))
    if own.filepath != choice.filepath:
        own.filepath = choice.filepath  # and with it what is wrong with it
    own.column = "" if choice.kind == "METAL" else name
