"""Baking as a World's settings ask: what objects see of the sky, and bounces between them."""

from __future__ import annotations

from collections.abc import Collection, Generator
from typing import Any

import bpy

from ..progress import Progress, mapped
from . import scene_lighting
from .bake import interreflection, scene_bake
from .spectral import analysed
from .world.settings import Settings


def bake(
    world: bpy.types.World,
    settings: Settings,
    objects: Collection[bpy.types.Object] | None = None,
    **options: Any,
) -> Generator[Progress, None, list[str]]:
    """Bake what objects see of the sky, and bounces where wanted, yielding how far it is.

    Of the active scene, None for all its managed objects; ``options``: those of `scene_bake.bake`.
    Returns lines to say; `spectral.update` then lights it.
    """
    share = 0.7 if settings.bounce else 1.0
    work = scene_bake.bake(objects, **options)
    lines = yield from mapped(work, lambda at: Progress(share * at.done, at.line))
    if settings.bounce:
        sun = scene_lighting.towards_sun(world, analysed(world, settings), settings)
        for done in interreflection.bounce(sun):
            yield Progress(share + (1.0 - share) * done, "one bounce")
    return lines
