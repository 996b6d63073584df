"""What is known of a sky's light: all that errors are predicted by and models chosen by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from ..sky.light import SkyLight

UNKNOWN_WHITE = "the sky appears white-balanced, and its neutral light is not set"
"""A doubt: see `transfer.white`."""


@dataclass(frozen=True, eq=False)
class KnownLight:
    """The colors of a sky's light and what else tells of its spectrum.

    Parameters
    ----------
    colors
        RGB irradiances (k, 3) as the HDRI's numbers are; one alone may be (3,).
    sun_elevation
        [degrees]. Where it is not known, a sun over some 8° is expected; a lower one makes larger
        errors than predicted.
    foreign
        The part of the light, 0 to 1, that is known to be no skylight
        (`sky.sky_classification`).
    doubt
        Why no error can be predicted, as `UNKNOWN_WHITE`; empty where it can.
    spectra
        Those of the lights, (k, 81) of any size, where they are known: then they are all that
        counts.
    """

    colors: ArrayLike
    sun_elevation: float | None = None
    foreign: float = 0.0
    doubt: str = ""
    spectra: NDArray[np.float64] | None = None

    @classmethod
    def of(
        cls,
        light: SkyLight,
        sun_elevation: float | None = None,
        *,
        white_is_doubtful: bool = False,
        to_working: NDArray[np.float64] | None = None,
    ) -> KnownLight:
        """Return what an analysed sky tells.

        ``sun_elevation`` [degrees] where it is given, which goes before the HDRI's;
        ``white_is_doubtful``: a white balance is suspected that is not undone
        (`white.estimate_white`); ``to_working`` (3, 3): applied to the sky's numbers, for a matrix
        of another working space than the HDRI's.
        """
        spectra = light.face_spectra
        mostly = spectra is None and light.outside.mostly
        return cls(
            light.faces if to_working is None else light.faces @ to_working.T,
            light.sun_elevation(sun_elevation),
            light.outside.foreign,
            UNKNOWN_WHITE if white_is_doubtful else f"it is {light.outside.verdict}" * mostly,
            spectra,
        )

    @property
    def lights(self) -> NDArray[np.float64]:
        """The colors as an array (k, 3)."""
        return np.atleast_2d(np.asarray(self.colors, dtype=float))
