"""Baking as a World's settings ask: what objects see of the sky, and bounces between them."""

from __future__ import annotations

from collections.abc import Collection, Generator
from typing import Any

import bpy

from . import bake as sky_bake
from . import bounce, surrounding_lights
from .settings import Settings
from .spectral import analysed


def bake(
    world: bpy.types.World,
    settings: Settings,
    objects: Collection[bpy.types.Object] | None = None,
    **options: Any,
) -> Generator[sky_bake.Progress, None, list[str]]:
    """Bake what objects see of the sky, and bounces where wanted, yielding how far it is.

    Of the active scene, None for all its managed objects; ``options`` as `bake.bake` has them.
    Returns lines to say; `spectral.update` then lights it.
    """
    lines = []
    work = sky_bake.bake(objects, **options)
    share = 0.7 if settings.bounce else 1.0
    while True:
        try:
            progress = next(work)
        except StopIteration as end:
            lines += end.value
            break
        yield sky_bake.Progress(share * progress.done, progress.line)
    if settings.bounce:
        sun = surrounding_lights.towards_sun(world, analysed(world, settings), settings)
        for done in bounce.bounce(sun):
            yield sky_bake.Progress(share + (1.0 - share) * done, "one bounce")
    return lines
