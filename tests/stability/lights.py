"""Light and materials that the stability tests share, and errors under them."""

from functools import lru_cache

import numpy as np
from colour.colorimetry import SDS_ILLUMINANTS, SDS_LIGHT_SOURCES

from spectral_skylight.addon.sky.atmosphere import Atmosphere
from spectral_skylight.addon.sky.daylight_ensemble import _LEAVES
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import resample
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E

S = observer()
LEAVES = _LEAVES / 100
CHECKER = colorchecker()[1]
NAMES = colorchecker()[0]


def source(name):
    """An illuminant or lamp of colour-science, (81,)."""
    spectrum = SDS_ILLUMINANTS[name] if name in SDS_ILLUMINANTS else SDS_LIGHT_SOURCES[name]
    return bright(resample(spectrum.wavelengths, spectrum.values))


def bright(light):
    """Light of luminance 1."""
    light = np.asarray(light, float)
    return light / (light @ S.T @ [0.2126, 0.7152, 0.0722])[..., None]


@lru_cache
def sky(elevation, **air):
    """A simulated sky over level ground, roughly: noise of a per cent or so at any wavelength."""
    quality = Quality(once=(24, 13), more=(12, 9), ways=128, shells=30)
    return simulate(elevation, Atmosphere(**air), quality=quality, cached=False)


@lru_cache
def skylight(elevation, **air):
    """The light of a sky, without the sun, on level ground, (81,)."""
    return bright(sky(elevation, **air).irradiance())


@lru_cache
def daylight(elevation, **air):
    """The light of sky and sun on level ground, (81,)."""
    found = sky(elevation, **air)
    return bright(found.irradiance() + found.direct * max(np.sin(np.radians(elevation)), 0.0))


def true(lights, rho=CHECKER):
    """Colours of materials (m, 81) under lights (k, 81), (k, m, 3)."""
    return np.einsum("il,ml,kl->kmi", S, rho, np.atleast_2d(lights))


def errors(lights, mapping=None, rho=CHECKER, seen=None):
    """CIEDE2000 (k, m) of a mapping, the paper's where None, or of ``"rgb"``, today's way.

    ``seen`` (k, 3): what the HDRI makes of the lights, where it is not what it should be.
    """
    lights = np.atleast_2d(lights)
    mapping = transfer() if mapping is None else mapping
    white = lights @ S.T
    if isinstance(mapping, str):
        D65 = source("D65")
        albedo = (rho * D65) @ S.T / (S @ D65)
        estimate = albedo * (white if seen is None else seen)[:, None]
    else:
        seen = lights @ mapping.S_in.T if seen is None else np.atleast_2d(seen)
        estimate = np.einsum("mij,kj->kmi", mapping.matrices(rho), seen)
    return delta_E(estimate, true(lights, rho), white[:, None])
