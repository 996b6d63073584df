"""Material matrices: reflectance times sky, spectrum by spectrum, in nine numbers.

With sensitivities ``S_in`` (what made the HDRI's numbers) and ``S_out`` (what the scene's working
space sees), a basis ``B`` of skylight and a reflectance ``rho``::

    A = S_in B^T                        sky matrix
    M(rho) = S_out diag(rho) B^T A^-1   material matrix

T. Tachi, "Full-Spectral Image-Based Lighting with Skylight".
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import BASIS
from ..errors import InputError, parameter
from ..spectra import bases, sensitivities
from ..spectra.working_spaces import DEFAULT_SPACE


@dataclass(frozen=True)
class Transfer:
    """The linear map from reflectances to matrices, for one HDRI, basis and working space.

    ``S_in``, ``S_out`` (3, 81) with quadrature weights, ``restoration`` (81, 3): ``B^T A^-1``,
    whose columns are the paper's s_r, s_g, s_b, so that ``restoration @ rgb`` is the spectrum of
    a sky pixel. ``white`` (3,): the RGB that neutral light had before the HDRI was balanced; None
    where it was not.
    """

    S_in: NDArray[np.float64]
    S_out: NDArray[np.float64]
    restoration: NDArray[np.float64]
    white: NDArray[np.float64] | None
    basis: str
    space: str

    def matrices(self, reflectances: ArrayLike) -> NDArray[np.float64]:
        """Return the matrices M of reflectances on the grid, (81,) or (m, 81), in one product.

        Shape (3, 3) or (m, 3, 3): ``M @ rgb`` is the colour that a diffuser of this reflectance
        returns of light ``rgb``. Linear in the reflectance; entries may be negative.
        """
        rho = np.asarray(reflectances, dtype=float)
        return (rho @ self._kernel).reshape(*rho.shape[:-1], 3, 3)

    @property
    def to_working(self) -> NDArray[np.float64]:
        """The matrix M(1) (3, 3) that shows the sky itself in the working space."""
        return self.matrices(np.ones(self.restoration.shape[0]))

    @property
    def largest(self) -> float:
        """The largest entry, either sign, that the matrix of any reflectance from 0 to 1 can have.

        The same with and without a white. About 1 where the basis is light; more where a channel
        is a difference of large numbers, which multiplies whatever the sky's numbers are off by.
        """
        kernel = self.S_out.T[:, :, None] * self.restoration[:, None, :]
        if self.S_in is not self.S_out:  # a camera's numbers have other sizes
            kernel = kernel @ np.linalg.inv(self.S_out @ self.restoration)
        parts = np.maximum(kernel, 0.0).sum(axis=0), np.maximum(-kernel, 0.0).sum(axis=0)
        return float(np.max(parts))

    @cached_property
    def _kernel(self) -> NDArray[np.float64]:
        """``M`` per unit of reflectance at every node, (81, 9).

        A balanced HDRI was scaled by ``D = diag(1 / white)``: its light must be unbalanced before
        it meets the material and balanced again after, for the picture to keep its balance,
        ``D M D^-1``. A camera's channels are not the working space's: the second scale is then
        the one that takes neutral light, ``M(1) white``, to (1, 1, 1).
        """
        kernel = self.S_out.T[:, :, None] * self.restoration[:, None, :]
        if self.white is not None:
            kernel *= self.white / self.neutral[:, None]
        return kernel.reshape(-1, 9)

    @cached_property
    def neutral(self) -> NDArray[np.float64]:
        """The working-space RGB that a balanced HDRI makes (1, 1, 1), (3,); ones for others."""
        if self.white is None:
            return np.ones(3)
        return self.S_out @ self.restoration @ self.white

    def unbalanced(self, lights: ArrayLike) -> NDArray[np.float64]:
        """Return the HDRI's numbers (..., 3) as they were before it was white-balanced."""
        return np.asarray(lights, dtype=float) * (1.0 if self.white is None else self.white)


OWN = "own spectrum"
"""The name of the basis that a sky's own spectrum is."""

_TOO_LARGE = 2.0
"""Entries that no basis made of light comes near (1.1), and one made of noise soon passes."""


def transfer(
    basis: str = "rayleigh",
    *,
    camera: str | None = None,
    white: ArrayLike | None = None,
    space: str = DEFAULT_SPACE,
    sun_elevation: float | None = None,
    sky_rgb: ArrayLike | None = None,
    known: NDArray[np.float64] | None = None,
) -> Transfer:
    """Prepare the map from reflectances to matrices.

    Parameters
    ----------
    basis
        A name that `bases.basis` understands; without one the paper's, which wants to know nothing
        of the sky.
    camera
        The camera whose raw numbers the HDRI holds, as `sensitivities.camera` understands it;
        None for a colorimetric HDRI, read into the working space.
    white
        RGB of neutral light in the HDRI before it was white-balanced, (3,), above 0.
    space
        Working space of the scene: a name from `WORKING_SPACES`.
    sun_elevation
        [degrees] of the sun over the horizon; `atmosphere` alone makes use of it.
    sky_rgb
        The sky's light as the HDRI's numbers have it, (3,) or (k, 3); so too.
    known
        The sky's own spectra, where they are known: `sky.known_spectrum.KnownSpectrum.members`.
        They go before what `atmosphere` expects; other bases are taken as they are.

    Raises
    ------
    InputError
        An unknown basis, camera or space; a white that is not three positive numbers; a basis
        whose functions are no light but noise.
    """
    S_out = sensitivities.observer(space)
    S_in = S_out if camera is None else sensitivities.camera(camera)
    white = None if white is None else check_white(white)
    if sky_rgb is not None and white is not None:
        sky_rgb = np.asarray(sky_rgb, dtype=float) * white
    B = bases.basis(basis, S_in, sun_elevation=sun_elevation, sky_rgb=sky_rgb)
    mapping = Transfer(
        S_in=S_in,
        S_out=S_out,
        restoration=bases.restoration(B, S_in),
        white=white,
        basis=basis,
        space=space,
    )
    if known is not None and basis == BASIS:
        return _fitted(mapping, known)
    if mapping.largest > _TOO_LARGE:
        raise InputError(
            parameter("basis"),
            f"'{basis}': its spectra differ too little; a sky's noise could grow "
            f"{mapping.largest:.0f} times",
            "give more varied skies or another basis",
        )
    return mapping


def _fitted(expected: Transfer, known: NDArray[np.float64]) -> Transfer:
    """Return the mapping of known light, as near to the expected one as keeps its entries small.

    Of light that hardly varies some of what it does is the grain of its numbers.
    """
    B = expected.restoration.T
    for share in bases.SHARES:
        own = bases.restoration(bases.fitted(B, expected.S_in, known, share), expected.S_in)
        mapping = replace(expected, restoration=own, basis=OWN)
        if mapping.largest <= _TOO_LARGE:
            return mapping
    return expected


def check_white(white: ArrayLike) -> NDArray[np.float64]:
    """Return ``white`` as three positive floats (3,); `InputError` for anything else."""
    values = np.asarray(white, dtype=float)
    if values.shape != (3,) or not np.all(np.isfinite(values) & (values > 0)):
        raise InputError(
            parameter("white"),
            f"{values.tolist()} is not a color",
            "give three numbers above 0: R,G,B",
        )
    return values
