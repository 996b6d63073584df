"""What a person chooses for a material or a lamp, kept with it in the blend file."""

# No postponed annotations here and in operators: Blender reads its properties from them.
# mypy: disable-error-code="valid-type"

from functools import lru_cache
from pathlib import Path

import bpy

from ..errors import InputError
from . import choice
from .labels import told


def _file_changed(self, context) -> None:
    """Look into a newly chosen file, once; panels draw what is kept."""
    self.problem = ""
    if not self.filepath:
        self.column = ""
        return
    try:
        names = self.read_names(self.filepath, self.kind)
    except InputError as error:
        self.problem = told(error)
        return
    if self.column not in names:
        likely = names[0] if len(names) == 1 else self.id_data.name
        self.column = likely if likely in names else ""


def _swatch(self) -> tuple[float, ...]:
    from ..scene.materials import swatch

    return swatch.shown(*_colour(self.id_data))


def _swatch_scale(self) -> float:
    from ..scene.materials import swatch

    colour, white = _colour(self.id_data)
    return swatch.scale(colour, white) * (white or 1.0)


def _colour(material) -> tuple[tuple[float, ...], float]:
    """A material's colour under its sky, and the luminance of white there."""
    from ..scene.materials import spectral_material

    managed = spectral_material.managed(material)
    if managed is None:
        return (0.0,) * 3, 1.0
    result = managed.details.result
    return (0.0,) * 3 if result is None else result.colour, managed.details.white


@lru_cache(maxsize=8)
def _names(path: str, kind: str, stamp: tuple[int, int]) -> tuple[str, ...]:
    """The names of a file's columns; ``stamp``: what tells that it is another one now."""
    from ..spectra import formats
    from ..spectra.refraction import read_nk

    if kind == "METAL":
        read_nk(path)
        return ()
    return formats.read(path).names


def _columns(self, context, typed) -> tuple[str, ...]:
    """What can be chosen from, read when the field is opened: a library's file has thousands."""
    try:
        return self.read_names(self.filepath, self.kind) if self.filepath else ()
    except InputError:
        return ()


class SkylightReflectance(choice.Fields, bpy.types.PropertyGroup):
    """Which reflectance a material is to have, as `material.skylight`."""

    filepath: bpy.props.StringProperty(
        name="Reflectance File",
        description="CSV with wavelengths in nm and one column of measured values per material. "
        "For a metal: wavelength, n and k",
        update=_file_changed,
    )
    kind: bpy.props.EnumProperty(
        name="Measured", description="What the file holds", items=choice.KINDS, update=_file_changed
    )
    column: bpy.props.StringProperty(
        name="Column", description="Column of the file that holds this material", search=_columns
    )
    problem: bpy.props.StringProperty(description="Why the file cannot be read")
    swatch: bpy.props.FloatVectorProperty(
        name="Under This Sky",
        description="Color of the material on level ground under this sky. White has luminance 1",
        subtype="COLOR",
        get=_swatch,
        set=lambda self, value: None,  # Blender draws a read-only colour dimmed: another colour
    )
    swatch_scale: bpy.props.FloatProperty(
        description="Factor by which the swatch darkens a color that is brighter than white",
        get=_swatch_scale,
    )

    def read_names(self, filepath: str, kind: str) -> tuple[str, ...]:
        """The column names of a file, none of a metal's; InputError if it cannot be read."""
        path = self.absolute(filepath)
        try:
            stat = Path(path).stat()
            stamp = (stat.st_mtime_ns, stat.st_size)
        except (OSError, ValueError):
            stamp = (0, 0)
        return _names(path, kind, stamp)

    def absolute(self, filepath: str) -> str:
        """A path that may be relative to the blend file (``//``), resolved."""
        return bpy.path.abspath(filepath, library=self.id_data.library)


def _spectrum(self) -> str:
    from ..scene.lights import user_lamps

    return user_lamps.spectrum_of(self.id_data)


def _set_spectrum(self, value: str) -> None:
    from ..scene.lights import user_lamps

    user_lamps.set_spectrum(self.id_data, value)


class SkylightLamp(bpy.types.PropertyGroup):
    """The spectrum of a lamp, as `light.skylight`."""

    spectrum: bpy.props.StringProperty(
        name="Spectrum",
        description="A CSV (FILE.csv:COLUMN), an illuminant (A, FL11, LED-B3) or a color "
        "temperature (2700K). Leave empty to restore it from the lamp's color",
        get=_spectrum,
        set=_set_spectrum,
    )
