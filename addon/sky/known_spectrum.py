"""The spectra of a sky that is known in full: simulated, or computed or measured in many channels.

A panorama of three numbers says little of a sky's spectra. Where those are known, they are kept
beside it, coarsely: light on a face is a mean over half the sphere, and of that only the mixture of
spectra matters, for the panorama itself says how much of it there is.
"""

from __future__ import annotations

import base64
import struct
import zlib
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.grid import WAVELENGTHS, WEIGHTS
from ..spectra.sensitivities import cmfs
from .irradiance import spread
from .lat_long import directions, solid_angles
from .products import product

ATTRIBUTE = "skylightSpectrum"
"""The entry of an OpenEXR header that holds one as text."""

ROWS = 24
"""Of its cells: 7.5 degrees each. Twice as many change no color by CIEDE2000 0.01."""

_FINER = 4
_COMPONENTS = 12
"""Of which the cells' spectra are sums in a file: what is left of any is under its noise."""

_FACES = 150
"""Orientations that a matrix has to serve, evenly spread."""

_SINGLE = 0.1
"""How much single directions of the sky count beside whole faces: a courtyard sees few of them."""

_APART = 0.03
"""Part of a face's light by which a panorama may differ and still be of these spectra."""


@dataclass(frozen=True, eq=False)
class KnownSpectrum:
    """The spectra of a sky by direction.

    ``cells`` (`ROWS`, 2 `ROWS`, 81): mean radiance without the sun's disc, laid out as a panorama
    and in its units; ``sun`` (81,): irradiance / pi of a face that looks at the sun, and
    ``towards`` (3,) where that stands; both None where no disc is in the panorama. ``sun_apart``:
    whether the sun's light is another's than the sky's, as where its disc was found.
    """

    cells: NDArray[np.float64]
    sun: NDArray[np.float64] | None = None
    towards: NDArray[np.float64] | None = None
    sun_apart: bool = True

    def irradiance(self, normals: ArrayLike) -> NDArray[np.float64]:
        """Return the sky's irradiance / pi on faces of normals (n, 3), (n, 81).

        With the sun's where that is not apart.
        """
        normals = np.asarray(normals, dtype=float)
        of_cells = _weights(normals.tobytes(), len(normals))
        found = product(of_cells, self.cells.reshape(-1, WAVELENGTHS.size))
        return found if self.sun_apart else found + self._of_sun(normals)

    def lit_and_shaded(self, normals: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the irradiance / pi of faces of normals (n, 3) without the sun and with it.

        (2 n, 81); (n, 81) where there is no sun.
        """
        shaded = replace(self, sun_apart=True).irradiance(normals)
        if self.sun is None:
            return shaded
        return np.concatenate([shaded, shaded + self._of_sun(normals)])

    def _of_sun(self, normals: NDArray[np.float64]) -> NDArray[np.float64]:
        """The sun's irradiance / pi on faces, (n, 81)."""
        if self.sun is None or self.towards is None:
            return np.zeros((len(normals), WAVELENGTHS.size))
        return np.maximum(normals @ self.towards, 0.0)[:, None] * self.sun

    def of(
        self,
        normals: NDArray[np.float64],
        light: NDArray[np.float64],
        S_in: NDArray[np.float64],
        rows: int,
    ) -> KnownSpectrum | None:
        """Return it in the units of a panorama that gives faces (n, 3) this light (n, 3).

        ``S_in`` (3, 81): what made the panorama's numbers, of ``rows`` pixels in height. None where
        these are of other light.
        """
        own = self.irradiance(normals) @ S_in.T
        size = float((own * light).sum() / max((own**2).sum(), 1e-300))
        apart = np.abs(size * own - light).max(axis=1)
        allowed = _APART * (light.max(axis=1) + 0.01 * light.max())
        if self.sun is not None and self.towards is not None and not self.sun_apart:
            # A disc that was not found is somewhere in a pixel.
            sees = normals @ self.towards > -np.pi / rows
            allowed = allowed + sees * (np.pi / rows * size * float((S_in @ self.sun).max()))
        if not size > 0.0 or (apart > allowed).any():
            return None
        sun = None if self.sun is None else size * self.sun
        return replace(self, cells=size * self.cells, sun=sun)

    @cached_property
    def members(self) -> NDArray[np.float64]:
        """The spectra that a matrix has to serve, (m, 81): of faces with the sun and without, and,
        less, of single cells; each of luminance 1, times the root of how much it counts."""
        Y = cmfs()[1] * WEIGHTS
        normals = spread(_FACES)
        faces = self.lit_and_shaded(normals)
        of_faces = faces @ Y
        seen = of_faces > 1e-4 * of_faces.max()
        cells = self.cells.reshape(-1, WAVELENGTHS.size)
        of_cells = np.maximum(cells @ Y, 0.0)
        share = of_cells * np.repeat(solid_angles(ROWS, 2 * ROWS), 2 * ROWS)
        bright = share > 1e-6 * share.max()
        weight = np.concatenate(
            [
                np.full(seen.sum(), (1.0 - _SINGLE) / seen.sum()),
                _SINGLE * share[bright] / share.sum(),
            ]
        )
        spectra = np.concatenate([faces[seen], cells[bright]])
        luminance = np.concatenate([of_faces[seen], of_cells[bright]])
        return spectra * (np.sqrt(weight) / luminance)[:, None]

    @property
    def below(self) -> NDArray[np.float64]:
        """Irradiance / pi (81,) of a face that looks down."""
        return self.irradiance([[0.0, 0.0, -1.0]])[0]

    def to_text(self) -> str:
        """Return it as text for a file's header, some tens of kilobytes."""
        flat = self.cells.reshape(-1, WAVELENGTHS.size)
        components = np.linalg.eigh(product(flat.T, flat))[1][:, ::-1].T[:_COMPONENTS]
        parts = [product(flat, components.T), components]
        if self.sun is not None and self.towards is not None:
            parts += [self.sun, self.towards]
        content = b"".join(np.asarray(part, "<f4").tobytes() for part in parts)
        head = struct.pack("<4B", _VERSION, ROWS, _COMPONENTS, self.sun is not None)
        return base64.b64encode(head + zlib.compress(content, 9)).decode()

    @classmethod
    def from_text(cls, text: str) -> KnownSpectrum | None:
        """Read what `to_text` wrote; None where that is damaged, or of a later version."""
        try:
            packed = base64.b64decode(text, validate=True)
            version, rows, count, has_sun = struct.unpack("<4B", packed[:4])
            if (version, rows, count) != (_VERSION, ROWS, _COMPONENTS):
                return None
            cells, n = 2 * ROWS * ROWS, WAVELENGTHS.size
            sizes = [cells * count, count * n, *([n, 3] if has_sun else [])]
            unpacking = zlib.decompressobj()
            content = unpacking.decompress(packed[4:], 4 * sum(sizes) + 1)
            if len(content) != 4 * sum(sizes) or not unpacking.eof:
                return None
        except (ValueError, struct.error, zlib.error):
            return None
        values = np.frombuffer(content, "<f4").astype(float)
        if not np.isfinite(values).all():
            return None
        scores, components, *rest = np.split(values, np.cumsum(sizes)[:-1])
        flat = product(scores.reshape(-1, count), components.reshape(count, n))
        return cls(flat.reshape(ROWS, 2 * ROWS, n), *rest)


_VERSION = 1


def cell_means(panorama: NDArray) -> NDArray[np.float64]:
    """Return what each cell has of a panorama (h, 2 h, n) in the mean, (`ROWS`, 2 `ROWS`, n)."""
    height, width, n = panorama.shape
    rows = _overlap(*(1.0 - np.cos(np.linspace(0.0, np.pi, k + 1)) for k in (ROWS, height)))
    columns = _overlap(*(np.linspace(0.0, 1.0, k + 1) for k in (2 * ROWS, width)))
    level = product(rows, panorama.reshape(height, -1)).reshape(ROWS, width, n)
    return columns @ level


def _overlap(coarse: NDArray, fine: NDArray) -> NDArray[np.float64]:
    """What each of some intervals between edges has of finer ones, as a share of itself."""
    high = np.minimum(coarse[1:, None], fine[1:])
    shared = np.maximum(high - np.maximum(coarse[:-1, None], fine[:-1]), 0.0)
    return shared / np.diff(coarse)[:, None]


@cache
def _weights(normals: bytes, count: int) -> NDArray[np.float64]:
    """What each cell counts on faces, (count, cells); finer points see to each face's horizon."""
    rows, columns = ROWS * _FINER, 2 * ROWS * _FINER
    faces = np.frombuffer(normals).reshape(count, 3)
    cosine = np.maximum(directions(rows, columns) @ faces.T, 0.0)
    cosine *= solid_angles(rows, columns)[:, None, None] / np.pi
    blocks = cosine.reshape(ROWS, _FINER, 2 * ROWS, _FINER, count)
    return blocks.sum(axis=(1, 3)).reshape(-1, count).T
