"""What a material is given: a measured reflectance, a pane of glass, a metal, or an estimate."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..spectra.formats.igsdb import TRANSMITTANCE
from ..spectra.reflectance import read_one, reflectance_hash
from ..spectra.refraction import read_nk
from .metals import conductor

ESTIMATED = "estimated from the base colour"
"""The name of a reflectance that nobody measured, wherever it appears; files hold it."""

BEHIND = " behind "
SINGLE_FACE, BLOCK = 1, 2


@dataclass(frozen=True, eq=False)
class Assignment:
    """What one material is given.

    Parameters
    ----------
    name
        Of the reflectance, as the file has it.
    values
        Reflectance (81,) on the grid, 0 to 1; of glass the transmittance at normal incidence.
    metal
        Refractive index n and extinction k, (81,) each, of a metal; its ``values`` follow.
    faces
        0 for a surface; of a pane how many faces of the mesh a ray crosses: `SINGLE_FACE`, or
        `BLOCK` for a closed one.
    unit
        ``percent`` or ``fraction``, as the file was read; empty where no file was.
    measured
        From where to where [nm] it was measured; beyond, the grid holds the end values.
    source, behind
        ``FILE[:COLUMN]`` that the values were read from, and those of the pane that all light on
        this surface passes; empty where no file was.
    notes
        What was done to the data, a sentence each.
    """

    name: str
    values: NDArray[np.float64]
    metal: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
    faces: int = 0
    unit: str = ""
    measured: tuple[float, float] | None = None
    source: str = ""
    behind: str = ""
    notes: tuple[str, ...] = ()

    @property
    def hash(self) -> str:
        """A fingerprint of the values, which a material keeps."""
        return reflectance_hash(self.values)

    @property
    def estimated(self) -> bool:
        """Whether nobody measured it: it was restored from a base color."""
        return self.name == ESTIMATED

    @property
    def column(self) -> str:
        """The column of the file that it was read from."""
        return self.name.partition(BEHIND)[0]

    @property
    def content(self) -> str:
        """A hash of all that decides what a material looks like with it."""
        metal = None if self.metal is None else [part.tolist() for part in self.metal]
        plain: list[Any] = [self.name, self.values.tolist(), metal, self.faces]
        return hashlib.sha256(json.dumps(plain).encode()).hexdigest()[:24]

    def lit_through(self, glass: Assignment) -> Assignment:
        """Return what a surface is that is lit through a pane alone: the product of the two."""
        return replace(
            self,
            name=f"{self.name}{BEHIND}{glass.name}",
            values=self.values * glass.values,
            behind=glass.source,
            notes=(*self.notes, *glass.notes),
        )


def estimate(values: NDArray[np.float64]) -> Assignment:
    """Return a reflectance (81,) that was restored from a base color, named as such."""
    return Assignment(ESTIMATED, values)


def read(file: str, column: str = "", unit: str | None = None, faces: int = 0) -> Assignment:
    """Read the reflectance, or where ``faces`` is not 0 the transmittance, of ``FILE[:COLUMN]``.

    ``column``: where it is not in ``file``; ``unit`` as in `read_reflectances`. Raises InputError
    as `read_one` does.
    """
    text = f"{file}:{column}" if column else file
    found = read_one(text, unit, TRANSMITTANCE if faces else "")
    return Assignment(
        found.names[0],
        found.values[0],
        faces=faces,
        unit=found.unit,
        measured=found.measured,
        source=f"{found.path}:{found.names[0]}",
        notes=tuple(found.notes),
    )


def read_metal(file: str) -> Assignment:
    """Read a metal's n and k; raises InputError as `read_nk` does."""
    n, k = read_nk(file)
    return Assignment(Path(file).stem, conductor(n, k), (n, k), source=str(file))
