"""What surfaces are made of: measured paints, their mixtures, metals and glass, as spectra."""

import bands
import colour
import numpy as np
from reference import WAVELENGTHS
from stage import Matter, Thing

CHECKER = {**colour.SDS_COLOURCHECKERS["BabelColor Average"], **colour.SDS_COLOURCHECKERS["PMC"]}
"""Measured reflectances that come with colour-science."""


def reflectance(name: str) -> np.ndarray:
    """Return a measured reflectance (81,) by its name in `CHECKER`."""
    return np.clip(bands.spectrum(CHECKER[name]), 0.0, 1.0)


def paint(name: str) -> Matter:
    """Return a matt surface of one of the checker's colours."""
    return Matter(reflectance(name))


def paints(things: dict[str, Thing]) -> dict[str, Matter]:
    """Return the checker's paints by the names that things use."""
    return {thing.matter: paint(thing.matter) for thing in things.values()}


def mixture(a: np.ndarray, b: np.ndarray, share: float) -> np.ndarray:
    """Return the reflectance (81,) of two paints' mixture, of which ``share`` is the second.

    Absorption over scattering adds up: P. Kubelka and F. Munk, "Ein Beitrag zur Optik der
    Farbanstriche", Zeitschrift für technische Physik 12, 1931.
    """
    a, b = (np.clip(rho, 1e-3, 1.0) for rho in (a, b))
    ratio = (1 - share) * (1 - a) ** 2 / (2 * a) + share * (1 - b) ** 2 / (2 * b)
    return 1 + ratio - np.sqrt(ratio**2 + 2 * ratio)


BRICK = "moderate red"
"""The measured reflectance of the texture's average brick."""


def bricks() -> np.ndarray:
    """Return a pavement (12, 8, 81) of bricks that hold more and less of the pigment of `BRICK`.

    More pigment is a power of the reflectance (as the Beer-Lambert law has it), so its spectrum is
    not a multiple of the measured one.
    """
    amount = np.random.default_rng(7).uniform(0.6, 1.5, (12, 8, 1))
    return reflectance(BRICK) ** amount


def green_pane() -> np.ndarray:
    """Return the transmittance (81,) of green float glass, as a smooth curve.

    Iron takes the red end (Fe²⁺, around 1000 nm) and the violet (Fe³⁺, under 400 nm).
    """
    red = 4.0 * np.exp(-(((WAVELENGTHS - 1000) / 230) ** 2))
    violet = 0.8 * np.exp(-(((WAVELENGTHS - 380) / 40) ** 2))
    return 0.92 * np.exp(-red - violet)


def metal(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the refractive index and extinction (81,) of a metal.

    Lorentz and Drude's oscillators as fitted by Rakić et al., "Optical properties of metallic films
    for vertical-cavity optoelectronic devices", Applied Optics 37, 1998, doi:10.1364/AO.37.005271.
    """
    plasma, *oscillators = METALS[name]
    energy = 1239.842 / WAVELENGTHS  # eV
    permittivity = 1.0 + sum(
        strength * plasma**2 / (at**2 - energy**2 - 1j * energy * width)
        for strength, width, at in oscillators
    )
    index = np.sqrt(permittivity)
    return index.real, index.imag


METALS = {
    "copper": (
        *(10.83, (0.575, 0.030, 0.0), (0.061, 0.378, 0.291), (0.104, 1.056, 2.957)),
        *((0.723, 3.213, 5.300), (0.638, 4.305, 11.18)),
    ),
    "gold": (
        *(9.03, (0.760, 0.053, 0.0), (0.024, 0.241, 0.415), (0.010, 0.345, 0.830)),
        *((0.071, 0.870, 2.969), (0.601, 2.494, 4.304), (4.384, 2.214, 13.32)),
    ),
    "aluminium": (
        *(14.98, (0.523, 0.047, 0.0), (0.227, 0.333, 0.162), (0.050, 0.312, 1.544)),
        *((0.166, 1.351, 1.808), (0.030, 3.382, 3.473)),
    ),
}
"""Plasma frequency [eV], then strength, width [eV] and place [eV] of each oscillator."""
