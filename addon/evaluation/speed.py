"""What shading costs: processor time per pixel of vectorised float32 numpy.

Processor time, not the wall's, so that neither threads nor other work on the machine count.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

_NUMBERS = 2**18
"""Of pixels times numbers in the state: so much is at hand in the cache, and left to one thread."""
_ROUND = 0.004
"""[s] that a task takes in each round."""
_LEAST = 0.1
"""[ns] a pixel: less is a busy machine's noise, for a processor's cycle is as long."""

Shade = Callable[[NDArray, NDArray], NDArray]
"""``shade(state, pixels)`` of `methods` or `light_methods`, pixels (c, k)."""


def nanoseconds(
    tasks: Mapping[str, tuple[Shade, NDArray, NDArray]], rounds: int
) -> dict[str, tuple[float, float]]:
    """Return least and median time of each task ``(shade, state, pixels)`` [ns per pixel].

    Tasks that differ in their numbers alone are one task. Pixels are repeated until there are many.
    Rounds take all tasks in turn, so that ratios hold while the machine does other work. What a
    call costs whatever its pixels drops out: the time of an eighth of the pixels is taken off.
    """
    kinds = {
        name: (shade, state.shape, len(pixels)) for name, (shade, state, pixels) in tasks.items()
    }
    ready = {}
    for name, (shade, state, pixels) in tasks.items():
        count = int(np.clip(_NUMBERS // state.size, 1024, 32768))
        many = np.resize(pixels.T, (count, len(pixels))).T.astype(np.float32, order="C")
        few = np.ascontiguousarray(many[:, : count // 8])
        ready[kinds[name]] = shade, np.ascontiguousarray(state, np.float32), many, few
    times: dict[tuple, list[tuple[float, float]]] = {kind: [] for kind in ready}
    repeats = {}
    for kind, (shade, state, many, _) in ready.items():
        _seconds(shade, state, many, 1)  # the first call fills caches
        repeats[kind] = max(1, int(_ROUND / max(_seconds(shade, state, many, 3), 1e-9)))
    for _ in range(rounds):
        for kind, (shade, state, many, few) in ready.items():
            both = (_seconds(shade, state, pixels, repeats[kind]) for pixels in (many, few))
            times[kind].append((next(both), next(both)))
    found = {}
    for kind, (_, _, many, few) in ready.items():
        pairs = np.array(times[kind])
        least, median = (
            float(long - short) * 1e9 / (many.shape[1] - few.shape[1])
            for long, short in (pairs.min(axis=0), np.median(pairs, axis=0))
        )
        # The clock's own grain can leave less than nothing of the cheapest.
        found[kind] = max(least, _LEAST), max(median, _LEAST)
    return {name: found[kind] for name, kind in kinds.items()}


def _seconds(shade: Shade, state: NDArray, pixels: NDArray, repeats: int) -> float:
    start = time.process_time()
    for _ in range(repeats):
        shade(state, pixels)
    return (time.process_time() - start) / repeats
