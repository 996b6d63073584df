"""What a way to the whole picture is: how long it takes and what it leaves, in one Blender."""

import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np
import pictures
from ready import Ready

from spectral_skylight.addon.scene.files import blend_file
from spectral_skylight.addon.scene.output import render

SAMPLES = 16
"""Of ours in Cycles, a pixel: its surfaces shine of their own, so that only edges need more."""


class Clock:
    """How long things have taken: wall and processor seconds (2,)."""

    def __init__(self) -> None:
        self.seconds = np.zeros(2)

    def __enter__(self) -> "Clock":
        self._began = np.array([time.perf_counter(), time.process_time()])
        return self

    def __exit__(self, *_: object) -> None:
        self.seconds += np.array([time.perf_counter(), time.process_time()]) - self._began


@dataclass
class Shot:
    """A picture (h, w, 3) in linear Rec.709, and what it took.

    ``seconds`` until it was there and of them ``setup`` before its render; of what comes
    ``again``: a further ``frame``, another ``hour``, another ``paint``; wall and processor (2,)
    each. ``megabytes`` of the file; ``memory`` [MB] at most, None: of this process.
    """

    picture: np.ndarray
    seconds: np.ndarray
    setup: np.ndarray
    again: dict[str, np.ndarray] = field(default_factory=dict)
    megabytes: float = 0.0
    memory: float | None = None


@dataclass(frozen=True)
class Way:
    """A way to the picture: ``family``, its series in the chart; ``label``, which of it this is.

    ``shots`` yields the pictures of a scene, and with True also measures what comes ``again``.
    """

    family: str
    label: str
    shots: Callable[[Ready, bool], Iterator[Shot]]


def opened(ready: Ready) -> bpy.types.Scene:
    """Open the scene as an architect has it."""
    return blend_file.open_scene(ready.blend)


def rendered(scene: bpy.types.Scene, ready: Ready, engine: str) -> tuple[np.ndarray, np.ndarray]:
    """Render a picture; return it and how long that took (2,)."""
    if engine == "cycles":
        sample(scene, ready, SAMPLES)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "way.exr"
        with Clock() as clock:
            render.render(scene, path, engine=engine)
        return pictures.read(path), clock.seconds


def sample(scene: bpy.types.Scene, ready: Ready, samples: int) -> None:
    """Let Cycles take so many samples of each pixel, and look at the sky as the referee does."""
    settings = scene.cycles
    settings.device, settings.samples = "CPU", samples
    settings.use_adaptive_sampling = settings.use_denoising = False
    scene.world.cycles.sampling_method = "MANUAL"  # left to itself it takes seconds
    scene.world.cycles.sample_map_resolution = ready.stage.sky.shape[1]


def megabytes() -> float:
    """Return the size of the open file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "way.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, check_existing=False)
        return path.stat().st_size / 1e6
