"""Scenes that nobody has tuned anything to:  sh examples/run random --seed N

Boxes stand about on a ground, in half of the scenes between walls. Each has a paint of its own,
mixed of two measured ones. One box in eight is left unmanaged; in half of the scenes one shines.
"""

import bands
import colour
import numpy as np
from example import Example, Light, camera
from paints import CHECKER, mixture, reflectance
from shapes import box, slab
from stage import Matter, Stage, Thing

LAMPS = "LED-B3", "LED-V1", "FL11", "A"
"""Illuminants of colour-science, of which one is the light of what shines."""


def example(seed: int) -> Example:
    """Return the example of a seed: the same for the same seed."""
    rng = np.random.default_rng(seed)
    elevation, azimuth = rng.uniform(6, 60), rng.uniform(0, 360)
    sunlit = bool(rng.random() < 0.7)
    return Example(
        f"Random scene {seed}, its sun at {elevation:.0f}°{'' if sunlit else ', hidden'}",
        *(round(elevation, 1), round(azimuth, 1)),
        lambda light: _build(light, np.random.default_rng(seed), sunlit),
        sunlit=sunlit,
        beside={"open sky": ("--occlusion", "open")},
    )


def _build(light: Light, rng: np.random.Generator, sunlit: bool) -> Stage:
    things, matter = {}, {}

    def add(name: str, quads: list, of: Matter | None = None) -> None:
        things[name] = Thing(f"{name} paint", quads)
        matter[f"{name} paint"] = of or _paint(rng)

    add("ground", slab(-40, -40, -0.5, 40, 40, 0))
    if rng.random() < 0.5:
        w, d, h = rng.uniform(3.5, 6), rng.uniform(3, 6), rng.uniform(2.5, 7)
        add("left", box(-w - 0.3, -d, 0, -w, d, h))
        add("right", box(w, -d, 0, w + 0.3, d, h))
        add("back", box(-w - 0.3, d, 0, w + 0.3, d + 0.3, h))
    # On a grid with a jitter of less than its gaps, so that no two boxes meet.
    places = [(x, y) for x in (-2.4, 0.0, 2.4) for y in (-1.8, 0.4, 2.2)]
    shining = rng.random() < 0.5
    for k, at in enumerate(rng.permutation(places)[: rng.integers(4, 9)]):
        (x, y), size = at + rng.uniform(-0.2, 0.2, 2), rng.uniform(0.25, 0.85, 2)
        quads = box(x - size[0], y - size[1], 0, x + size[0], y + size[1], rng.uniform(0.4, 2.6))
        unmanaged = bool(rng.random() < 1 / 8)
        of = _sign(light, rng) if shining and k == 0 else _paint(rng, unmanaged)
        add(f"box {k}", quads, of)
    turn = rng.uniform(-0.6, 0.6)
    place = 11 * np.sin(turn), -11 * np.cos(turn), rng.uniform(1.8, 4.5)
    view = camera(light, place, (0, 0.3, 1.1), 0.75)
    return Stage(things, matter, light.sky, view, sun=light.sun if sunlit else None)


def _paint(rng: np.random.Generator, unmanaged: bool = False) -> Matter:
    """Return a mixture of two measured paints."""
    a, b = (reflectance(name) for name in rng.choice(list(CHECKER), 2, replace=False))
    return Matter(mixture(a, b, rng.uniform(0.2, 0.8)), unmanaged=unmanaged)


def _sign(light: Light, rng: np.random.Generator) -> Matter:
    """Return what shines like white paper under the open sky, or up to four times as bright."""
    spectrum = bands.spectrum(colour.SDS_ILLUMINANTS[rng.choice(LAMPS)])
    luminance = float(bands.S @ spectrum @ [0.2126, 0.7152, 0.0722])
    return Matter(emission=spectrum * rng.uniform(1, 4) * light.luminance() / luminance)
