"""Every method's error under one sky whose spectra are known: the referee of its matrices."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..choices import BASES, BASIS
from ..errors import InputError
from ..sky.irradiance import spread
from ..sky.light import SkyLight
from ..transfer.matrices import OWN, transfer
from .evaluation import Errors, errors_of, of_one_luminance
from .methods import BEST, METHODS, TODAY, Method, Prepared, Sky, with_basis

_FACES = 97
"""Orientations, other ones than the matrices are fitted to."""


def evaluate_sky(
    light: SkyLight, reflectances: NDArray[np.float64], bases: Sequence[str] = tuple(BASES)
) -> list[Errors]:
    """Return the errors of every method on faces all around, in the sun and out of it.

    Each is told what it is told in a scene: the sun's elevation and the colours of the light, and
    last the spectra themselves; the best 3x3 is the limit. Light is integrated over the whole
    spectrum. Raises `InputError` for a sky whose spectra are not known.
    """
    known = light.spectrum
    if known is None:
        cure = "give one that the command sky writes, a spectral .exr or an .hsr"
        raise InputError(light.name, "holds no spectra of its light", cure)
    elevation = light.sun_elevation()
    told = ("colour",) if elevation is None else ("colour", "elevation")

    def prepare(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
        mapping = transfer(BASIS, known=known.members, sky_rgb=light.faces, sun_elevation=elevation)
        return Prepared(mapping.S_in, mapping.matrices(rho))

    methods = [METHODS[name] for name in TODAY]
    methods += [with_basis(name, *(told if name == BASIS else ())) for name in bases]
    methods += [Method(OWN, "3x3", prepare, ("spectrum",)), METHODS[BEST]]
    lights = known.lit_and_shaded(spread(_FACES, 1.0))
    bright = lights.max(axis=1) > 1e-4 * lights.max()
    sky = Sky(of_one_luminance(lights[bright]), elevation)
    return list(errors_of(methods, [sky], np.atleast_2d(reflectances).astype(float)))
