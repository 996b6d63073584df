"""Scenes under the open sky: what sun, lamps, textures and gloss do there."""

import bands
import colour
import numpy as np
from example import Light, camera
from paints import BRICK, CHECKER, bricks, metal, paints, reflectance
from shapes import box, level, south
from stage import Lamp, Matter, Stage, Thing


def sun(light: Light) -> Stage:
    """A tower's shadow on a house with painted panels."""
    panels = {"blue": -1, "green": 0, "bluish green": 1, "purple": 2}
    things = {
        "ground": Thing("neutral 5 (.70 D)", level(-40, -40, 40, 40)),
        "tower": Thing("moderate red", box(-3.6, -2.2, 0, -2.0, -0.6, 4.2)),
        "house": Thing("orange yellow", box(-1.6, -0.6, 0, 3.6, 2, 2.6)),
    }
    for name, x in panels.items():
        things[name] = Thing(name, south(x - 0.35, x + 0.35, 0.5, 1.9, -0.62))
    return Stage(
        things,
        paints(things),
        light.sky,
        camera(light, (4.5, -10.5, 3.4), (0, 0, 1.2), 0.95),
        sun=light.sun,
    )


def dusk(light: Light) -> Stage:
    """A façade after sunset: a deep blue sky, a warm LED, and a sodium lamp in the street."""
    things = {
        "ground": Thing("neutral 5 (.70 D)", level(-30, -30, 30, 30)),
        "house": Thing("light skin", box(-3.5, 0, 0, 3.5, 3, 3.2)),
        "door": Thing("blue", south(-1.9, -0.9, 0, 2.1, -0.02)),
        "panel": Thing("bluish green", south(0.8, 1.6, 0.4, 2.0, -0.02)),
        "post": Thing("moderate red", south(2.0, 2.8, 0.4, 2.0, -0.02)),
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
    return Stage(things, paints(things), light.sky, view, lamps=lamps)


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
