"""What an example is, and the light that its scene is given."""

from collections.abc import Callable
from dataclasses import dataclass, field

import bands
import numpy as np
from geometry import Camera, look
from reference import irradiance
from stage import Stage, Sun

WIDTH, HEIGHT = 120, 80

UP = np.array([[0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Light:
    """What a scene is given: the sky (h, 2h, 81), the sun, and the picture's size."""

    sky: np.ndarray
    sun: Sun
    size: tuple[int, int] = (WIDTH, HEIGHT)

    def luminance(self) -> float:
        """Return the luminance of white paper under the open sky, in 10,000 cd/m²."""
        return float(bands.S @ irradiance(self.sky, UP)[0] @ [0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Example:
    """One scene, and the sky over it.

    ``azimuth`` of the sun from north; ``shows``: one sentence for the report; ``sunlit``: whether
    the HDRI holds the sun's disc; ``ground``: what its lower half reflects, by `paints.CHECKER`'s
    name; ``options``: of the command `apply`; ``beside``: those of other ways, judged as well;
    ``samples``: of the referee a pixel and seed, so many that its noise is under 0.25.
    """

    shows: str
    elevation: float
    azimuth: float
    build: Callable[[Light], Stage]
    sunlit: bool = False
    ground: str = "neutral 5 (.70 D)"
    options: tuple[str, ...] = ()
    beside: dict[str, tuple[str, ...]] = field(default_factory=dict)
    samples: int = 256


def camera(light: Light, location, target, scale, orthographic=False) -> Camera:
    """Return a camera of the examples' size."""
    return look(location, target, *light.size, scale, orthographic)
