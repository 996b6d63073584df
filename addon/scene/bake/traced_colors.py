"""Colors where Cycles traces the light: what materials reflect of the light that falls on them.

RGB times RGB is exact for light of one spectrum if a color is what the material reflects of that
very light (Ward and Eydelberg-Vileshin 2002, DOI 10.2312/EGWR/EGWR02/117-124). The light on a
material differs from place to place less than it differs from D65: so its mean is found, bounced
light and lamps and all, between as few patches as tell which light is enough.
"""

from __future__ import annotations

from collections.abc import Generator

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside
from ...transfer.prefilter import prefiltered
from ...transport.hits import Space
from ...transport.radiosity import Radiosity
from . import camera_share, geometry, patches
from .light import SceneLight

PATCHES, RAYS = 2_000, 64
"""At most so many patches, where a scene has no more triangles, and rays from each side of one."""

AT = Progress(0.0, "colors in this light")


def finding(
    light: SceneLight, space: str
) -> Generator[Progress, None, dict[str, NDArray[np.float64]]]:
    """Find the RGB (3,) in a working space that Cycles is to multiply traced light by, for each
    material of the open scene on which any falls, by its full name.

    Places count by how much of the camera's picture they are, and by their light; those of a
    material that the picture does not show, or without a camera, by their area.
    """
    around = yield from geometry.gathering()
    matter = light.matter(around.materials)
    *_, cells = yield from aside(AT, patches.first_cells, around, PATCHES)
    radiosity = Radiosity((yield from aside(AT, Space, cells, matter)))
    for _ in radiosity.cast(RAYS):
        yield AT
    yield from patches.going_round(radiosity, light, around.origin, AT)
    eye = camera_share.Eye.of(bpy.context.scene, around.origin)
    found = yield from aside(AT, _on_kinds, radiosity, eye, len(around.materials))
    return {
        name: prefiltered(light.reflectance(name), light.sources.restored(bands), space)
        for name, bands in zip(around.materials, found, strict=True)
        if bands.any()
    }


def _on_kinds(
    radiosity: Radiosity, eye: camera_share.Eye | None, kinds: int
) -> NDArray[np.float64]:
    """The light on each kind of material in bands, (kinds, 16), of any size.

    Of what has two sides the one that the eye sees counts: which is the front, Cycles does not ask.
    """
    cells = radiosity.space.cells
    kind = cells.kind[cells.first]
    views: list[list[tuple[camera_share.Eye | None, int]]] = [[(None, -1)], [(None, 1)]]
    if eye is not None:
        views.append([(eye, 1), (eye, -1)])
    found = np.zeros((kinds, radiosity.E.shape[1]))
    for seen in views:  # the last that has any light on a material counts
        own = np.zeros_like(found)
        for each, side in seen:
            light = radiosity.E[radiosity.side == side].astype(float)
            patch = radiosity.patch[radiosity.side == side]
            weight = camera_share.weights(radiosity.space, each, side)[patch]
            np.add.at(own, kind[patch], weight[:, None] * light)
        found[own.any(axis=1)] = own[own.any(axis=1)]
    return found
