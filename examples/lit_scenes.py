"""The seven scenes as data: where the light of a street differs from an open sky's on matt paint.

Each is what an architect would build to see one thing. `SCENES` is the table. Metres, y north.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import bands
import colour
import numpy as np
from geometry import Camera, look
from reference import WAVELENGTHS, irradiance
from stage import Lamp, Matter, Stage, Sun, Thing

WIDTH, HEIGHT = 168, 112

CHECKER = {**colour.SDS_COLOURCHECKERS["BabelColor Average"], **colour.SDS_COLOURCHECKERS["PMC"]}
"""Measured reflectances that come with colour-science."""


@dataclass(frozen=True)
class Light:
    """What a scene is given: the sky (h, 2h, 81), the sun, and white's light facing up, in RGB."""

    sky: np.ndarray
    sun: Sun
    level: np.ndarray
    size: tuple[int, int]

    def luminance(self) -> float:
        """Return the luminance of white paper under the open sky, in 10,000 cd/m²."""
        return float(self.level @ [0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Example:
    """One scene, and the sky over it.

    ``azimuth`` of the sun from north; ``shows``: one sentence for the report; ``sunlit``: whether
    the HDRI holds the sun's disc; ``ground``: what its lower half reflects, by `CHECKER`'s name;
    ``options``: of the command `apply`; ``beside``: those of other ways, judged as well.
    """

    shows: str
    elevation: float
    azimuth: float
    build: Callable[[Light], Stage]
    sunlit: bool = False
    ground: str = "neutral 5 (.70 D)"
    options: tuple[str, ...] = ()
    beside: dict[str, tuple[str, ...]] = field(default_factory=dict)


def paint(name: str) -> Matter:
    """Return a matt surface of one of the checker's colours."""
    return Matter(reflectance(name))


def reflectance(name: str) -> np.ndarray:
    """Return a measured reflectance (81,) by its name in `CHECKER`."""
    return np.clip(bands.spectrum(CHECKER[name]), 0.0, 1.0)


def box(x0, y0, z0, x1, y1, z1) -> list:
    """Return the five faces of a box that stands on something, outwards."""
    a, b, c, d = (x0, y0), (x1, y0), (x1, y1), (x0, y1)
    sides = [[(*p, z0), (*q, z0), (*q, z1), (*p, z1)] for p, q in ((a, b), (b, c), (c, d), (d, a))]
    return [*sides, [(*p, z1) for p in (a, b, c, d)]]


def level(x0, y0, x1, y1, z=0.0) -> list:
    """Return a face that looks up."""
    return [[(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]]


def upright(x0, x1, z0, z1, y) -> list:
    """Return a face that looks south."""
    return [[(x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1)]]


def camera(light: Light, location, target, scale, orthographic=False) -> Camera:
    """Return a camera of the examples' size."""
    return look(location, target, *light.size, scale, orthographic)


def sun(light: Light) -> Stage:
    """A tower's shadow on a house with painted panels."""
    panels = {"blue": -1, "green": 0, "bluish green": 1, "purple": 2}
    things = {
        "ground": Thing("neutral 5 (.70 D)", level(-40, -40, 40, 40)),
        "tower": Thing("moderate red", box(-3.6, -2.2, 0, -2.0, -0.6, 4.2)),
        "house": Thing("orange yellow", box(-1.6, -0.6, 0, 3.6, 2, 2.6)),
    }
    for name, x in panels.items():
        things[name] = Thing(name, upright(x - 0.35, x + 0.35, 0.5, 1.9, -0.62))
    return Stage(
        things,
        _paints(things),
        light.sky,
        camera(light, (4.5, -10.5, 3.4), (0, 0, 1.2), 0.95),
        sun=light.sun,
    )


def courtyard(light: Light) -> Stage:
    """Between four walls the sky is a small piece of itself, and bluer than the whole."""
    w, h = 3.0, 4.5
    things = {
        "floor": Thing("neutral 6.5 (.44 D)", level(-w, -w, w, w)),
        "left": Thing("orange", [[(-w, -w, 0), (-w, w, 0), (-w, w, h), (-w, -w, h)]]),
        "right": Thing("blue flower", [[(w, w, 0), (w, -w, 0), (w, -w, h), (w, w, h)]]),
        "back": Thing("light skin", upright(-w, w, 0, h, w)),
        "front": Thing("foliage", [[(w, -w, 0), (-w, -w, 0), (-w, -w, h), (w, -w, h)]]),
        "door": Thing("red", upright(-1.8, -0.8, 0, 2.1, w - 0.02)),
        "window": Thing("bluish green", upright(0.2, 1.8, 1.0, 2.2, w - 0.02)),
        "bench": Thing("yellow", box(-0.6, 0.6, 0, 1.6, 1.2, 0.5)),
    }
    view = camera(light, (0, -2.8, 2.2), (0, 1.5, 1.5), 1.35)
    return Stage(things, _paints(things), light.sky, view)


def bounce(light: Light) -> Stage:
    """A red wall on a white floor, a green lawn under a white soffit."""
    things = {
        "floor": Thing("white 9.5 (.05 D)", level(-4, -4, 0, 2)),
        "lawn": Thing("Summer Grass", level(0, -4, 4, 2)),
        "wall": Thing("red", upright(-4, 0, 0, 2.6, 2)),
        "plaster": Thing("neutral 8 (.23 D)", upright(0, 4, 0, 2.6, 2)),
        "soffit": Thing("White", [*box(0.4, -0.4, 2.6, 4, 2, 2.8), *_down(0.4, -0.4, 4, 2, 2.6)]),
    }
    view = camera(light, (0.2, -7.0, 1.3), (0.1, 0, 1.2), 1.2)
    return Stage(things, _paints(things), light.sky, view, sun=light.sun, bounces=1)


def dusk(light: Light) -> Stage:
    """A façade after sunset: a deep blue sky, a warm LED, and a sodium lamp in the street."""
    things = {
        "ground": Thing("neutral 5 (.70 D)", level(-30, -30, 30, 30)),
        "house": Thing("light skin", box(-3.5, 0, 0, 3.5, 3, 3.2)),
        "door": Thing("blue", upright(-1.9, -0.9, 0, 2.1, -0.02)),
        "panel": Thing("bluish green", upright(0.8, 1.6, 0.4, 2.0, -0.02)),
        "post": Thing("moderate red", upright(2.0, 2.8, 0.4, 2.0, -0.02)),
        "planter": Thing("Summer Grass", box(-0.6, -1.6, 0, 0.6, -1.0, 0.6)),
    }
    lamps = {}
    for name, at, spectrum, share in (
        ("LED", (-1.4, -0.9, 2.7), colour.SDS_ILLUMINANTS["LED-B1"], 4.0),
        ("sodium", (2.2, -2.2, 3.0), colour.SDS_LIGHT_SOURCES["Super HPS"], 8.0),
    ):
        shine = bands.spectrum(spectrum)
        shine = shine / (bands.S @ shine).max()
        # At one metre, facing it, white is `share` times as bright as under the sky.
        energy = share * light.luminance() / (bands.S @ shine @ [0.2126, 0.7152, 0.0722])
        lamps[name] = Lamp(at, shine, 4 * np.pi**2 * energy, 0.08)
    view = camera(light, (-0.6, -8.5, 2.2), (0, 0, 1.45), 0.9)
    return Stage(things, _paints(things), light.sky, view, lamps=lamps)


def texture(light: Light) -> Stage:
    """Two pavements in the shade: a mosaic of 24 paints, and one brick that varies."""
    names = [name for name in CHECKER if name in colour.SDS_COLOURCHECKERS["PMC"]][:24]
    mosaic = np.stack([reflectance(name) for name in names]).reshape(4, 6, 81)
    things = {
        "mosaic": Thing("mosaic", level(-3.05, 0, -0.05, 3)),
        "brick": Thing("brick", level(0.05, 0, 3.05, 3)),
    }
    matter = {"mosaic": Matter(mosaic), "brick": Matter(bricks(), sample=reflectance(BRICK))}
    view = camera(light, (0, 1.4, 9), (0, 1.5, 0), 6.4, orthographic=True)
    return Stage(things, matter, light.sky, view)


BRICK = "moderate red"
"""The measured reflectance of the texture's average brick."""


def bricks() -> np.ndarray:
    """Return a pavement (12, 8, 81) of bricks that hold more and less of the pigment of `BRICK`.

    More pigment is a power of the reflectance (as the Beer-Lambert law has it), so its spectrum is
    not a multiple of the measured one.
    """
    amount = np.random.default_rng(7).uniform(0.6, 1.5, (12, 8, 1))
    return reflectance(BRICK) ** amount


def gloss(light: Light) -> Stage:
    """Paint under a clear coat, and three metals, before the open sky."""
    matter = {
        "red gloss": Matter(reflectance("red"), roughness=0.1),
        "blue satin": Matter(reflectance("blue"), roughness=0.35),
        "green gloss": Matter(reflectance("Unitary green"), roughness=0.2),
        "copper": Matter(metal=metal("copper"), roughness=0.25),
        "gold": Matter(metal=metal("gold"), roughness=0.25),
        "aluminium": Matter(metal=metal("aluminium"), roughness=0.25),
    }
    view = camera(light, (0, -14, 3.5), (0, 0, 0), 7.6, orthographic=True)
    things = {}
    for k, name in enumerate(matter):
        # Each far behind the one before: none is seen in another.
        across, up = 2.4 * (k % 3 - 1), 1.2 * (1 - 2 * (k // 3))
        centre = across * view.right + up * view.up - 15.0 * k * view.back
        things[name] = Thing(name, ball=(tuple(centre), 0.9))
    return Stage(things, matter, light.sky, view)


def glass(light: Light) -> Stage:
    """A room behind a green pane, which tints the light that comes in, and again what one sees.

    The pane mirrors the HDRI's own ground, for Eevee mirrors nothing nearer.
    """
    w, d, h = 2.0, 2.6, 2.6
    things = {
        "floor": Thing("light skin", level(-w, 0, w, d)),
        "ceiling": Thing("white 9.5 (.05 D)", _down(-w, 0, w, d, h)),
        "left": Thing("orange yellow", [[(-w, 0, 0), (-w, d, 0), (-w, d, h), (-w, 0, h)]]),
        "right": Thing("neutral 8 (.23 D)", [[(w, d, 0), (w, 0, 0), (w, 0, h), (w, d, h)]]),
        "back": Thing("blue flower", upright(-w, w, 0, h, d)),
        "chest": Thing("red", box(-1.2, 1.4, 0, -0.2, 2.0, 0.8)),
        "stool": Thing("yellow", box(0.5, 0.7, 0, 1.1, 1.3, 0.5)),
        "pane": Thing("glass", upright(-w, w, 0, h, 0)),
        "roof": Thing("neutral 5 (.70 D)", box(-w - 0.1, 0, h + 0.01, w + 0.1, d + 0.1, h + 0.2)),
        "outside": Thing("red", upright(w + 0.15, w + 0.9, 0, 1.6, 0)),
    }
    inside = "floor", "ceiling", "left", "right", "back", "chest", "stool"
    things |= {
        name: replace(things[name], matter=f"{things[name].matter} inside") for name in inside
    }
    matter = {"glass": Matter(transmittance=green_pane(), ior=1.52)}
    for thing in things.values():
        name = thing.matter.removesuffix(" inside")
        if name in CHECKER:
            behind = "glass" if name != thing.matter else None
            matter[thing.matter] = replace(paint(name), behind=behind)
    view = camera(light, (0.5, -6.0, 1.7), (0.15, 0.5, 1.25), 0.75)
    return Stage(things, matter, light.sky, view)


def green_pane() -> np.ndarray:
    """Return the transmittance (81,) of green float glass, as a smooth curve.

    Iron takes the red end (Fe²⁺, around 1000 nm) and the violet (Fe³⁺, under 400 nm).
    """
    red = 4.0 * np.exp(-(((WAVELENGTHS - 1000) / 230) ** 2))
    violet = 0.8 * np.exp(-(((WAVELENGTHS - 380) / 40) ** 2))
    return 0.92 * np.exp(-red - violet)


def metal(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the refractive index and extinction (81,) of a metal.

    Lorentz and Drude's oscillators as fitted by Rakić et al., "Optical properties of metallic films
    for vertical-cavity optoelectronic devices", Applied Optics 37, 1998, doi:10.1364/AO.37.005271.
    """
    plasma, *oscillators = METALS[name]
    energy = 1239.842 / WAVELENGTHS  # eV
    permittivity = 1.0 + sum(
        strength * plasma**2 / (at**2 - energy**2 - 1j * energy * width)
        for strength, width, at in oscillators
    )
    index = np.sqrt(permittivity)
    return index.real, index.imag


METALS = {
    "copper": (
        *(10.83, (0.575, 0.030, 0.0), (0.061, 0.378, 0.291), (0.104, 1.056, 2.957)),
        *((0.723, 3.213, 5.300), (0.638, 4.305, 11.18)),
    ),
    "gold": (
        *(9.03, (0.760, 0.053, 0.0), (0.024, 0.241, 0.415), (0.010, 0.345, 0.830)),
        *((0.071, 0.870, 2.969), (0.601, 2.494, 4.304), (4.384, 2.214, 13.32)),
    ),
    "aluminium": (
        *(14.98, (0.523, 0.047, 0.0), (0.227, 0.333, 0.162), (0.050, 0.312, 1.544)),
        *((0.166, 1.351, 1.808), (0.030, 3.382, 3.473)),
    ),
}
"""Plasma frequency [eV], then strength, width [eV] and place [eV] of each oscillator."""


def _down(x0, y0, x1, y1, z) -> list:
    return [[(x0, y1, z), (x1, y1, z), (x1, y0, z), (x0, y0, z)]]


def _paints(things: dict[str, Thing]) -> dict[str, Matter]:
    """Return the checker's paints by the names that things use."""
    return {thing.matter: paint(thing.matter) for thing in things.values()}


def light_of(sky: np.ndarray, sun: Sun, size: tuple[int, int] = (WIDTH, HEIGHT)) -> Light:
    """Return what scenes are given by a sky (h, 2h, 81)."""
    return Light(sky, sun, bands.S @ irradiance(sky, np.array([[0.0, 0.0, 1.0]]))[0], size)


BAKED = ("--occlusion", "baked")
BOUNCED = *BAKED, "--bounce"

SCENES = {
    "sun": Example("Sun and sky, and a tower's shadow", 15, 235, sun, sunlit=True, options=BAKED),
    "courtyard": Example(
        "A courtyard that sees a piece of the sky",
        30,
        200,
        courtyard,
        options=BAKED,
        beside={"live shadows": ("--occlusion", "dome"), "open sky": ()},
    ),
    "bounce": Example(
        "Red wall, green lawn: light that has bounced once",
        50,
        170,
        bounce,
        sunlit=True,
        options=(*BAKED, "--bounce", "--ground", "hdri"),
    ),
    "dusk": Example(
        "After sunset, with a warm LED and a sodium lamp", -2, 300, dusk, options=BAKED
    ),
    "texture": Example("Textures: many paints, and one measured brick", 35, 180, texture),
    "gloss": Example("Clear coats and metals", 35, 150, gloss, options=("--gloss",)),
    "glass": Example(
        "A room behind green glass", 40, 330, glass, options=(*BAKED, "--ground", "hdri")
    ),
}
"""The examples by name: what `sh examples/run NAME` shows."""
