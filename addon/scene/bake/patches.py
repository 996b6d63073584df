"""Patches of what stands in a scene, between which light goes round: how many, and their rays."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside, mapped
from ...transport import feet
from ...transport.cells import Cells, Surfaces, levels_for, pieces
from ...transport.hits import Space
from ...transport.radiosity import Radiosity
from . import layout
from .geometry import Geometry
from .light import Light

PATCHES = 20_000, 60_000
"""At most so many at first and at last, where a scene has no more triangles."""

SENT = 64, 128
"""Rays from each side of a patch, at first and at last, at most …"""

ALL_SENT = 4e6, 1.6e7
"""… and from all of them; but at least `LEAST_SENT` from each."""

LEAST_SENT = 16

BETWEEN = "light between surfaces"


def first_cells(
    around: Geometry, most: int = PATCHES[0]
) -> tuple[NDArray, Surfaces, NDArray, NDArray, Cells]:
    """Cut triangles into patches between which light first goes round, about so many at most: how
    often each was, `pieces` of them, and their cells."""
    surfaces, small = around.surfaces, layout.SMALL * around.size
    levels = levels_for(surfaces, layout.START * around.size, most, small)
    parts, of_parts, triangle = pieces(surfaces, levels)
    return levels, parts, of_parts, triangle, Cells.of(parts, of_parts, small)


def sent(radiosity: Radiosity, stage: int) -> int:
    """How many rays go from each side of a patch, a power of 2."""
    each = ALL_SENT[stage] / max(len(radiosity.patch), 1)
    return int(np.clip(2 ** np.floor(np.log2(max(each, 1.0))), LEAST_SENT, SENT[stage]))


def casting(around: Geometry, light: Light) -> Generator[Progress, None, Radiosity]:
    """Return the patches of what stands in a scene, with their rays cast."""
    at = Progress(0.0, BETWEEN)
    surfaces, small = around.surfaces, layout.SMALL * around.size
    levels = yield from aside(
        at, levels_for, surfaces, layout.START * around.size, PATCHES[1], small
    )
    cells = yield from aside(at, Cells.of, surfaces, levels, small)
    space = yield from aside(at, Space, cells, light.matter(around.materials))
    radiosity = Radiosity(space)
    for done in radiosity.cast(sent(radiosity, 1)):
        yield Progress(0.3 * done, BETWEEN)
    return radiosity


def casting_finely(
    around: Geometry, light: Light, tolerance: float = 0.1
) -> Generator[Progress, None, Radiosity]:
    """Return the same, finely where light changes by more than a tolerance within a patch, as at a
    shadow's edge: what lies just beside it, as before an open door, counts for those inside."""
    at, matter = Progress(0.0, BETWEEN), light.matter(around.materials)
    _, parts, of_parts, _, cells = yield from aside(at, first_cells, around)
    coarse = Radiosity((yield from aside(at, Space, cells, matter)))
    for done in coarse.cast(sent(coarse, 0), alike=True):
        yield Progress(0.1 * done, BETWEEN)
    at = Progress(0.1, BETWEEN)
    yield from going_round(coarse, light, around.origin, at)
    finer = layout.finer(parts, of_parts, layout.bends(coarse), tolerance, PATCHES[1])
    parts, finer = yield from aside(at, feet.cut, coarse.space, parts, finer)
    cells = yield from aside(at, Cells.of, parts, finer, layout.SMALL * around.size)
    radiosity = Radiosity((yield from aside(at, Space, cells, matter)))
    for done in radiosity.cast(sent(radiosity, 1)):
        yield Progress(0.1 + 0.3 * done, BETWEEN)
    return radiosity


def going_round(
    radiosity: Radiosity,
    light: Light,
    origin: NDArray[np.float64],
    at: Progress,
    leaks: bool = True,
) -> Generator[Progress, None, tuple[NDArray, NDArray, NDArray]]:
    """Let a light go round between patches whose places are relative to an origin (3,).

    Returns what lamps send straight to their sides (r, 16), and as `Radiosity.solve` does the table
    and which of its rows tell anything; ``leaks`` as there.
    """
    direct = yield from mapped(radiosity.lit_by(light.lamps_from(origin)), lambda _: at)
    table, tells, _ = yield from aside(at, radiosity.solve, light.sky, direct, leaks)
    return direct, table, tells
