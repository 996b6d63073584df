"""What users choose from: each choice once, with its identifier, label and description.

The command line, the panel and a batch's study show these; the first of each is the default. The
rooms that do the work know them by the identifiers, which files and scripts hold.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """How a choice is shown: ``label`` in the panel, ``description`` in tooltips and help."""

    label: str
    description: str


Choices = dict[str, Entry]
"""By identifier, in the order in which they are shown."""


def default(choices: Choices) -> str:
    """Return the identifier that is taken where none is given."""
    return next(iter(choices))


def listed(choices: Iterable[str]) -> str:
    """Return the identifiers as a sentence has them: ``open, dome or baked``."""
    *others, last = choices
    return f"{', '.join(others)} or {last}" if others else last


def described(choices: Choices) -> str:
    """Return what the choices are, as help has it: ``open: …; dome: …``."""
    return "; ".join(f"{name}: {one.description}" for name, one in choices.items())


def items(choices: Choices, *, upper: bool = False) -> tuple[tuple[str, str, str], ...]:
    """Return the choices as items of Blender's enums; ``upper``: identifiers in capital letters."""
    names = ((name.upper() if upper else name, one) for name, one in choices.items())
    return tuple((name, one.label, one.description) for name, one in names)


BASES: Choices = {
    "rayleigh": Entry(
        "Rayleigh", "Unscattered, once and twice scattered sunlight. For clear skies"
    ),
    "daylight": Entry(
        "CIE Daylight", "CIE daylight functions, from measured days. Also for overcast"
    ),
    "atmosphere": Entry(
        "Atmosphere", "Simulated skylight for the sun's elevation. Also for a low sun"
    ),
}
"""Each is a function of `spectra.bases`, of this name."""

BASIS = "atmosphere"
"""The basis that is taken where none is given."""

SIMPLEST = "simplest"


def offered_bases() -> Choices:
    """Return the bases with `SIMPLEST` before them, which `transfer.choice` makes one of them."""
    chosen = Entry("Simplest", "Rayleigh where it meets the tolerance, else Atmosphere")
    return {SIMPLEST: chosen, **BASES}


AUTO, OPEN, DOME, BAKED, TRACED = "auto", "open", "dome", "baked", "traced"

ALL_LIGHT = AUTO, BAKED
"""The occlusions that hold all light."""

OCCLUSIONS: Choices = {
    AUTO: Entry(
        "All Light",
        "Each place gets all its light, reflected light too, in Eevee and Cycles. It is baked when "
        "materials become spectral, and in Blender's window again after every change",
    ),
    OPEN: Entry("Open Sky", "The whole sky lights every face; only the sun casts shadows"),
    DOME: Entry(
        "Live",
        "24 soft sun lamps cast the sky's shadows in Eevee, also of moving objects. Shaders "
        "compile once, and each frame takes longer",
    ),
    BAKED: Entry(
        "Baked",
        "All light, baked only when it is asked for",
    ),
    TRACED: Entry(
        "Traced",
        "Cycles traces all light at once, with the color of each material in the light that "
        "falls on it. Not as exact as baked light. Eevee shows the open sky",
    ),
}
"""How geometry that hides the sky darkens materials."""

GROUNDS: Choices = {
    "auto": Entry(
        "Automatic", "Modeled where geometry lies under the materials, else from the HDRI"
    ),
    "hdri": Entry("From the HDRI", "The lower half of the HDRI"),
    "modelled": Entry(
        "Modeled", "Level ground with the reflectance of the geometry under the materials"
    ),
    "none": Entry("None", "No light comes from below"),
}
"""Where light from below comes from."""

ENGINES: Choices = {
    "eevee": Entry("Eevee", "Fast, as in the viewport"),
    "cycles": Entry("Cycles", "Exact"),
}

SPACES: Choices = {
    "Linear Rec.709": Entry("Rec.709", "Blender's default"),
    "Linear Rec.2020": Entry("Rec.2020", "Wide gamut, for television"),
    "ACEScg": Entry("ACEScg", "Wide gamut, for film"),
}
"""Blender's working spaces, by its own names."""

QUALITIES: Choices = {
    "preview": Entry("Preview", "Takes seconds"),
    "reference": Entry("Reference", "Takes minutes, with less noise"),
}
"""Of simulated skies."""

QUANTITIES: Choices = {
    "illuminance": Entry("Illuminance", "Light that falls on a surface, in lux"),
    "luminance": Entry("Luminance", "Light that a surface sends towards the eye, in cd/m²"),
    "melanopic": Entry(
        "Melanopic EDI", "Light that sets the body's clock, as lux of daylight that acts alike"
    ),
    "rhodopic": Entry("Rhodopic EDI", "Light for the rods, as lux of daylight that acts alike"),
    "s-cone-opic": Entry(
        "S-Cone EDI", "Light for the cones for blue, as lux of daylight that acts alike"
    ),
    "m-cone-opic": Entry(
        "M-Cone EDI", "Light for the cones for green, as lux of daylight that acts alike"
    ),
    "l-cone-opic": Entry(
        "L-Cone EDI", "Light for the cones for red, as lux of daylight that acts alike"
    ),
}
"""What is measured of light, each linear in its spectrum; EDI is CIE S 026's equivalent daylight
(D65) illuminance. See `spectra.photometry`."""

WEATHERS: Choices = {
    "clear": Entry("Clear Sky", "Clear air, with the haze that is set"),
    "cie": Entry("CIE Sky", "A standard general sky of the CIE: how bright each direction is"),
    "epw": Entry("EPW File", "The measured sun and sky of one hour of a weather file"),
}
"""Of simulated skies."""

STANDARD_SKIES: Choices = {
    "1": Entry("1 Overcast, Steep", "overcast, three times as bright in the zenith"),
    "2": Entry("2 Overcast, Steep, to Sun", "overcast, steep gradation, brighter towards the sun"),
    "3": Entry("3 Overcast", "overcast, moderate gradation"),
    "4": Entry("4 Overcast, to Sun", "overcast, moderate gradation, brighter towards the sun"),
    "5": Entry("5 Uniform", "uniform, alike in all directions"),
    "6": Entry("6 Cloudy, Even", "partly cloudy, no gradation, brighter towards the sun"),
    "7": Entry("7 Cloudy, Even, Bright", "partly cloudy, no gradation, bright around the sun"),
    "8": Entry("8 Cloudy, Even, Corona", "partly cloudy, no gradation, distinct corona"),
    "9": Entry("9 Cloudy, Sun Hidden", "partly cloudy, the sun obscured"),
    "10": Entry("10 Cloudy, Bright", "partly cloudy, bright around the sun"),
    "11": Entry("11 White-Blue, Corona", "white-blue, distinct corona"),
    "12": Entry("12 Clear", "clear, little turbidity"),
    "13": Entry("13 Clear, Polluted", "clear, polluted air"),
    "14": Entry("14 Cloudless, Turbid", "cloudless and turbid, broad corona"),
    "15": Entry("15 White-Blue, Turbid", "white-blue and turbid, broad corona"),
}
"""The standard general skies of the CIE, ISO 15469:2004, by the number of its Table 1."""

UNITS: Choices = {
    "percent": Entry("Percent", "0 to 100"),
    "fraction": Entry("Fraction", "0 to 1"),
}
"""Of reflectances and transmittances."""

KINDS: Choices = {
    "REFLECTANCE": Entry("Reflectance", "A surface: the fraction of light that it reflects"),
    "GLASS": Entry("Glass", "A pane: the fraction of light that it transmits at normal incidence"),
    "METAL": Entry(
        "Metal", "A polished metal: its refractive index n and extinction coefficient k"
    ),
}
"""What a material's file holds, by identifiers that blend files and scripts of the panel hold."""

PANES: Choices = {
    "FACE": Entry("Single Face", "Each face of the mesh is a whole pane"),
    "BLOCK": Entry("Closed Block", "The mesh has faces on both sides of the pane"),
}
"""How glass is modelled, by the panel's identifiers."""

ORDERS: Choices = {
    "name": Entry("Name", "By name"),
    "hue": Entry("Hue", "By hue under D65; neutral colors come last"),
    "lightness": Entry("Lightness", "From dark to light"),
    "source": Entry("Source", "By folder and file"),
}
"""In which a library is shown."""
