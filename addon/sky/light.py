"""A sky taken apart for lighting: sun, sky irradiance, and the light on faces of a building."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..spectra.sensitivities import observer
from .hdri_checks import signs
from .irradiance import Fit, exact_irradiance, fit_coefficients, running_sums
from .known_spectrum import KnownSpectrum
from .panorama import Panorama
from .polynomial import exponents
from .sky_classification import KINDS, Outside, outside
from .sun import Sun, separate_sun


def _faces() -> NDArray[np.float64]:
    tilts = np.radians([45.0, 90.0])
    azimuths = np.radians([90.0, 0.0, 270.0, 180.0])  # north, east, south, west
    ring = np.stack([np.cos(azimuths), np.sin(azimuths), np.zeros(4)], axis=-1)
    faces = [np.array([[0.0, 0.0, 1.0]])]
    for tilt in tilts:
        faces.append(np.sin(tilt) * ring + np.cos(tilt) * np.array([0.0, 0.0, 1.0]))
    return np.concatenate(faces)


FACES: NDArray[np.float64] = _faces()
"""Normals (9, 3) that stand for a building: up, then 45° and vertical to N, E, S and W."""


@dataclass(frozen=True)
class SkyLight:
    """What of a sky lights materials.

    ``fitting``: returns `fit`, which not all that a sky is asked for needs; ``sun``: the disc, or
    None; ``sky`` (h, 2 h, 3): the panorama without the disc; ``faces`` (9, 3): RGB irradiance of
    the sky on `FACES`; ``outside``: which of its pixels are no skylight, and their shares of the
    light on `FACES`.
    """

    name: str
    sky: NDArray[np.float32]
    fitting: Callable[[], Fit]
    sun: Sun | None
    faces: NDArray[np.float64]
    outside: Outside
    negatives: int = 0
    """Count of the HDRI's negative values, which were set to zero."""
    signs: tuple[str, ...] = ()
    """What speaks against the HDRI's numbers being light, a sentence each."""
    known_elevation: float | None = None
    """[degrees] of the sun, where the sky is a model that says it; a sun below it is known too."""
    spectrum: KnownSpectrum | None = None
    """The sky's own spectra in its units, where they are known; its sun's where it has a disc."""

    @property
    def fit(self) -> Fit:
        """The coefficients of the sky's irradiance without the sun's disc."""
        return self.fitting()

    @property
    def face_spectra(self) -> NDArray[np.float64] | None:
        """The spectra (9, 81) of the sky's light on `FACES`; None where they are not known."""
        return None if self.spectrum is None else self.spectrum.irradiance(FACES)

    @property
    def sun_share(self) -> float:
        """The part (0 to 1) of the light on level ground that is the sun's."""
        return self.sun.share if self.sun else 0.0

    def sun_elevation(self, given: float | None = None) -> float | None:
        """Return the sun's elevation [degrees]: given, else known, else the HDRI's, else None."""
        found = None if self.sun is None else self.sun.elevation
        return next((e for e in (given, self.known_elevation, found) if e is not None), None)

    @property
    def caption(self) -> str:
        """What a picture must say as long as neither occlusion nor the sun are in it."""
        if self.sun is None:
            return "open sky: no shadows yet"
        share = f"{100 * self.sun_share:.0f} % of this sky's light"
        return f"open sky: no shadows yet; the sun ({share}) is not on your materials"

    @property
    def notes(self) -> list[str]:
        """What a person should know before trusting colours under this sky, a sentence each."""
        notes = list(self.signs)
        if self.negatives:
            notes.append(f"{self.negatives} negative value(s) were set to zero")
        if self.spectrum is not None:
            return notes
        if self.sun_elevation() is None:
            notes.append("no sun found: daytime assumed. If the sun is low, set its elevation")
        elif self.sun is not None and self.sun.clipped:
            notes.append("the HDRI clips the sun: the real sun was brighter")
        return notes if self.outside.holds else [*notes, self.outside.verdict]

    def report(self) -> dict[str, Any]:
        """Return all that was found as plain numbers and text, ready for JSON or blend data.

        Polynomial: ``degree``, ``exponents`` (a, b, c) of x^a y^b z^c and ``coefficients`` RGB of
        each, irradiance / pi; ``errors`` of each degree as fractions; the ``sun`` where there is;
        ``outside``: the shares (9, 4) of the light on `FACES` by ``kinds`` and a ``verdict``;
        ``notes``: warnings.
        """
        sun = self.sun
        return {
            "name": self.name,
            "degree": self.fit.degree,
            "exponents": [list(exponent) for exponent in exponents(self.fit.degree)],
            "coefficients": self.fit.coefficients.tolist(),
            "errors": [asdict(error) for error in self.fit.errors],
            "upward": self.faces[0].tolist(),
            "negatives": self.negatives,
            "notes": self.notes,
            "caption": self.caption,
            "outside": {
                "kinds": list(KINDS),
                "shares": self.outside.shares.tolist(),
                "verdict": self.outside.verdict,
                "mostly": self.outside.mostly,
            },
        } | (
            {}
            if sun is None
            else {
                "sun": {
                    "direction": sun.direction.tolist(),
                    "elevation": sun.elevation,
                    "azimuth": sun.azimuth,
                    "angular_radius": sun.angular_radius,
                    "irradiance": sun.irradiance.tolist(),
                    "share": sun.share,
                    "clipped": sun.clipped,
                }
            }
        )


def analyse(
    panorama: Panorama, degree: int | None = None, S_in: NDArray[np.float64] | None = None
) -> SkyLight:
    """Set the sun apart, fit the irradiance polynomial and look for what is no skylight.

    ``degree`` as in `fit_coefficients`. ``S_in`` (3, 81): what made the HDRI's numbers, by which
    alone the colors of skylight are known: as in `locus_distance`, over a balanced one's white.
    """
    sky, sun = separate_sun(panorama.rgb)
    sums = running_sums(sky)
    faces = exact_irradiance(sums, FACES)
    spectrum, doubt = _own_spectrum(panorama, sun, faces, S_in)
    return SkyLight(
        name=panorama.name,
        sky=sky,
        fitting=cache(partial(fit_coefficients, sums, degree)),
        sun=sun,
        faces=faces,
        outside=outside(sky, sun, FACES, S_in),
        negatives=panorama.negatives,
        signs=(*signs(panorama), *doubt),
        spectrum=spectrum,
    )


def _own_spectrum(
    panorama: Panorama,
    sun: Sun | None,
    faces: NDArray[np.float64],
    S_in: NDArray[np.float64] | None,
) -> tuple[KnownSpectrum | None, tuple[str, ...]]:
    """Return known spectra in the panorama's units; None, and why, where it is of other light."""
    spectrum, rows = panorama.spectrum, len(panorama.rgb)
    if spectrum is None:
        return None, ()
    S_in = observer() if S_in is None else S_in
    found = replace(spectrum, sun_apart=sun is not None).of(FACES, faces, S_in, rows)
    if found is None:
        return None, ("its numbers are no longer those of the spectra in its header: not used",)
    if sun is not None and found.sun is not None:
        shown = S_in @ found.sun
        if np.abs(shown - sun.irradiance).max() > _SUN_APART * np.abs(shown).max():
            return replace(found, sun=None, towards=None), ()
    return found, ()


_SUN_APART = 0.1
"""Part of the sun's light by which a panorama's disc may differ from the known sun, as by what
surrounds it; a clipped one differs more."""
