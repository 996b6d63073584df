"""What a person gives a material to be made of, read from files: reflectance, glass or metal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...spectra.formats.igsdb import TRANSMITTANCE
from ...spectra.reflectance import column_of, read_reflectances, reflectance_hash
from ...spectra.refraction import read_nk
from ...transfer.metals import conductor

REFLECTANCE, GLASS, METAL = "REFLECTANCE", "GLASS", "METAL"
BEHIND = " behind "


@dataclass(frozen=True)
class Given:
    """The reflectance (81,) of a material, or where ``faces`` is not 0 the transmittance of a pane.

    ``metal``: n and k, (81,) each, of one whose reflectance is a metal's; ``faces``: 1 for a pane
    that is one face, 2 for a closed block; ``measured``: from where to where [nm]; ``notes``: what
    was done to the data, a sentence each.
    """

    name: str
    values: NDArray[np.float64]
    metal: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
    faces: int = 0
    measured: tuple[float, float] | None = None
    notes: tuple[str, ...] = ()

    @property
    def hash(self) -> str:
        """What a material keeps of it, to tell it from others."""
        return reflectance_hash(self.values)

    @property
    def column(self) -> str:
        """The column it was read from."""
        return self.name.partition(BEHIND)[0]


def read(path: str, column: str = "", unit: str | None = None, faces: int = 0) -> Given:
    """Read the one reflectance, or transmittance where ``faces`` is not 0, that a file holds.

    ``unit`` as in `read_reflectances`, which says what raises InputError; so does a file of many
    without a ``column``.
    """
    wanted = column or (column_of(path, TRANSMITTANCE) if faces else None)
    found = read_reflectances(path, unit, wanted)
    if len(found.names) > 1:
        raise InputError(path, f"holds {len(found.names)} materials", "choose a column")
    notes = tuple(found.notes)
    return Given(found.names[0], found.values[0], None, faces, found.measured, notes)


def read_metal(path: str) -> Given:
    """Read a metal's n and k; raises InputError as `read_nk` does."""
    n, k = read_nk(path)
    return Given(bpy.path.display_name_from_filepath(path), conductor(n, k), (n, k))


def behind(given: Given, glass: Given) -> Given:
    """Return what a surface is that is lit through a glass alone: their product."""
    name = f"{given.name}{BEHIND}{glass.name}"
    return replace(given, name=name, values=given.values * glass.values)


def apart(chosen: Mapping[bpy.types.Material, Given]) -> dict[str, dict[bpy.types.Material, Any]]:
    """Return what was given as `spectral.make_spectral` takes it: by the names of its arguments."""
    return {
        "reflectances": {m: (g.name, g.values) for m, g in chosen.items() if not g.faces},
        "metals": {m: g.metal for m, g in chosen.items() if g.metal is not None},
        "measured": {m: g.measured for m, g in chosen.items() if g.measured is not None},
        "glazings": {m: (g.name, g.values, g.faces) for m, g in chosen.items() if g.faces},
    }
