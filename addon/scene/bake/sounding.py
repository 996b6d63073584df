"""What a whole picture will be off by in less light, told before anything is baked.

Light goes round between a tenth of the patches of a bake; some places that stand for the picture
cast its rays. That takes some tenths of a second.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside, mapped
from ...transport.cells import Cells
from ...transport.hits import Space
from ...transport.probed import PLACES, Places, Sent, probing, seen_along, spread
from ...transport.radiosity import Radiosity
from . import camera_share, geometry, layout, patches
from .light import SceneLight

PATCHES, RAYS = (2_000, 6_000), 64
"""At most so many patches at first and where light is found to change, where a scene has no more
triangles, and rays from each side of one."""

BEND = 0.1
"""Part by which light may change within one."""

LOOKS = 4_000
"""Looks from the eye, for places that a picture shows."""

AT = Progress(0.0, "which light")


@dataclass(frozen=True)
class Sounding:
    """Mean CIEDE2000 of spectral materials in the camera's picture, or everywhere without a camera.

    ``models``: what their matrices leave; ``bounces`` and ``open_sky``: without that light;
    ``noise``: by how many rays points cast; ``patches``: by the light of a bake's first patches.
    """

    models: float
    bounces: float
    open_sky: float
    noise: dict[int, float]
    patches: float


def sounding(
    light: SceneLight, open_sky: NDArray[np.float32], models: Mapping[str, float]
) -> Generator[Progress, None, Sounding | None]:
    """Find what the open scene's picture would be off by; None where it shows no spectral material.

    ``open_sky`` (SKY, 16): the sky as it lights materials under the open sky, with its ground;
    ``models``: what is expected of each spectral material's matrix, by its full name.
    """
    around = yield from geometry.gathering()
    matter, small = light.matter(around.materials), layout.SMALL * around.size
    _, parts, of_parts, _, cells = yield from aside(AT, patches.first_cells, around, PATCHES[0])
    space = yield from aside(AT, Space, cells, matter)
    coarse, rough = yield from _going_round(space, light, around.origin, True)
    bends = yield from aside(AT, layout.bends, coarse)
    finer = yield from aside(AT, layout.finer, parts, of_parts, bends, BEND, PATCHES[1])
    cells = yield from aside(AT, Cells.of, parts, finer, small)
    space = yield from aside(AT, Space, cells, matter)
    _, sent = yield from _going_round(space, light, around.origin, False)
    known = np.array([models.get(name, np.nan) for name in around.materials])
    eye = camera_share.Eye.of(bpy.context.scene, around.origin)
    places = yield from aside(AT, _places, sent.space, eye, np.isfinite(known))
    lamps = light.lamps_from(around.origin)
    probe = probing(sent, rough, places, lamps, light.to_XYZ)
    probed = yield from mapped(probe, lambda _: AT)
    if probed is None:
        return None
    return Sounding(
        float(known[cells.kind[places.cell]].mean()),
        probed.without_bounces(),
        probed.under(open_sky),
        probed.noise(),
        probed.of_fewer_patches(),
    )


def _going_round(
    space: Space, light: SceneLight, origin: NDArray[np.float64], alike: bool
) -> Generator[Progress, None, tuple[Radiosity, Sent]]:
    """Let light go round in a space, ``alike`` as between the first patches of a bake."""
    radiosity = Radiosity(space)
    for _ in radiosity.cast(RAYS, alike):
        yield AT
    _, table, tells = yield from patches.going_round(radiosity, light, origin, AT)
    return radiosity, Sent(space, table, tells)


def _places(space: Space, eye: camera_share.Eye | None, counts: NDArray[np.bool_]) -> Places:
    """Return places of a picture on kinds of material that count, all over them without an eye."""
    cells = space.cells
    if eye is None:
        areas = np.bincount(cells.patch, cells.areas, cells.patches)
        return spread(space, areas * counts[cells.kind[cells.first]])
    places = seen_along(space, *eye.looking(LOOKS))
    chosen = np.flatnonzero(counts[cells.kind[places.cell]])
    # Where little of the picture counts, all that was met; else evenly chosen ones.
    return places.part(chosen[:: -(-len(chosen) // PLACES) or 1])
