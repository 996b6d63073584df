"""Scenes between walls, where much of the light has bounced."""

from dataclasses import replace

from example import Light, camera
from paints import CHECKER, green_pane, paint, paints
from shapes import box, down, east, framed, level, north, slab, south, west
from stage import Matter, Stage, Thing


def courtyard(light: Light) -> Stage:
    """Between four walls the sky is a small piece of itself, and bluer than the whole."""
    w, h = 3.0, 4.5
    things = {
        "floor": Thing("neutral 6.5 (.44 D)", level(-w, -w, w, w)),
        "left": Thing("orange", east(-w, w, 0, h, -w)),
        "right": Thing("blue flower", west(-w, w, 0, h, w)),
        "back": Thing("light skin", south(-w, w, 0, h, w)),
        "front": Thing("foliage", north(-w, w, 0, h, -w)),
        "door": Thing("red", south(-1.8, -0.8, 0, 2.1, w - 0.02)),
        "window": Thing("bluish green", south(0.2, 1.8, 1.0, 2.2, w - 0.02)),
        "bench": Thing("yellow", box(-0.6, 0.6, 0, 1.6, 1.2, 0.5)),
    }
    view = camera(light, (0, -2.8, 2.2), (0, 1.5, 1.5), 1.35)
    return Stage(things, paints(things), light.sky, view)


def bounce(light: Light) -> Stage:
    """A red wall on a white floor, a green lawn under a white soffit."""
    things = {
        "floor": Thing("white 9.5 (.05 D)", level(-4, -4, 0, 2)),
        "lawn": Thing("Summer Grass", level(0, -4, 4, 2)),
        "wall": Thing("red", south(-4, 0, 0, 2.6, 2)),
        "plaster": Thing("neutral 8 (.23 D)", south(0, 4, 0, 2.6, 2)),
        "soffit": Thing("White", slab(0.4, -0.4, 2.6, 4, 2, 2.8)),
    }
    view = camera(light, (0.2, -7.0, 1.3), (0.1, 0, 1.2), 1.2)
    return Stage(things, paints(things), light.sky, view, sun=light.sun)


def glass(light: Light) -> Stage:
    """A room behind a green pane, which tints the light that comes in, and again what one sees.

    The pane mirrors the HDRI's own ground, for Eevee mirrors nothing nearer.
    """
    w, d, h = 2.0, 2.6, 2.6
    things = {
        "floor": Thing("light skin", level(-w, 0, w, d)),
        "ceiling": Thing("white 9.5 (.05 D)", down(-w, 0, w, d, h)),
        "left": Thing("orange yellow", east(0, d, 0, h, -w)),
        "right": Thing("neutral 8 (.23 D)", west(0, d, 0, h, w)),
        "back": Thing("blue flower", south(-w, w, 0, h, d)),
        "chest": Thing("red", box(-1.2, 1.4, 0, -0.2, 2.0, 0.8)),
        "stool": Thing("yellow", box(0.5, 0.7, 0, 1.1, 1.3, 0.5)),
        "pane": Thing("glass", south(-w, w, 0, h, 0)),
        "roof": Thing("neutral 5 (.70 D)", box(-w - 0.1, 0, h + 0.01, w + 0.1, d + 0.1, h + 0.2)),
        "outside": Thing("red", south(w + 0.15, w + 0.9, 0, 1.6, 0)),
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


def street(light: Light) -> Stage:
    """Between two rows of houses: one front in the sun, the other lit by it and by the sky."""
    w = 3.5
    houses = {  # side, from, to, height, paint
        "baker": (-1, -7, 0, 7.5, "neutral 8 (.23 D)"),
        "mason": (-1, 0, 8, 8.5, "blue flower"),
        "smith": (1, -7, 1, 8.0, "light skin"),
        "cooper": (1, 1, 8, 7.0, "orange yellow"),
    }
    things = {
        "road": Thing("neutral 5 (.70 D)", level(-60, -60, 60, 60)),
        "end": Thing("moderate red", box(-9, 13, 0, 9, 19, 7.5)),
    }
    for name, (side, y0, y1, height, of) in houses.items():
        x0, x1 = sorted((side * w, side * (w + 6)))
        things[name] = Thing(of, box(x0, y0, 0, x1, y1, height))
    for name, side, y, z0, z1, of in (
        ("baker's door", -1, -3.6, 0.0, 2.2, "red"),
        ("baker's shutter", -1, -3.6, 3.6, 5.4, "bluish green"),
        ("mason's door", -1, 3.0, 0.0, 2.4, "yellow"),
        ("mason's shutter", -1, 3.0, 4.0, 5.8, "neutral 8 (.23 D)"),
        ("smith's door", 1, -3.4, 0.0, 2.2, "blue"),
        ("smith's shutter", 1, -3.4, 3.6, 5.4, "green"),
        ("cooper's shutter", 1, 4.0, 2.6, 4.6, "purple"),
    ):
        face, at = (east, -w + 0.02) if side < 0 else (west, w - 0.02)
        things[name] = Thing(of, face(y - 0.7, y + 0.7, z0, z1, at))
    view = camera(light, (0.2, -13.5, 2.0), (0.1, 0, 2.7), 0.95)
    return Stage(things, paints(things), light.sky, view, sun=light.sun)


def room(light: Light) -> Stage:
    """A room that is open to the north: it sees the sky and a sunny square, never the sun."""
    w, d, h, thick = 2.2, 3.0, 2.6, 0.2
    outer, far, top, under = w + thick, -d - thick, h + thick, -0.1
    opening = -w + 0.1, w - 0.1, 0.0, h - 0.1
    x0, x1, _, head = opening
    outside = [
        *south(-outer, outer, under, top, far),
        *east(far, thick, under, top, outer),
        *west(far, thick, under, top, -outer),
        *framed(north, opening, (-outer, outer, under, top), thick),
        *level(-outer, far, outer, thick, top),
    ]
    reveals = [
        *level(x0, 0, x1, thick),
        *down(x0, 0, x1, thick, head),
        *east(0, thick, 0, head, x0),
        *west(0, thick, 0, head, x1),
    ]
    things = {
        "square": Thing("neutral 5 (.70 D)", level(-60, -60, 60, 60, under)),
        "shell": Thing("neutral 8 (.23 D)", [*outside, *reveals]),
        "floor": Thing("neutral 8 (.23 D)", level(-w, -d, w, 0)),
        "ceiling": Thing("white 9.5 (.05 D)", down(-w, -d, w, 0, h)),
        "front": Thing("white 9.5 (.05 D)", framed(south, opening, (-w, w, 0, h), 0)),
        "left": Thing("blue flower", west(-d, 0, 0, h, w)),
        "right": Thing("White", east(-d, 0, 0, h, -w)),
        "back": Thing("white 9.5 (.05 D)", north(-w, w, 0, h, -d)),
        "door": Thing("red", north(-1.8, -0.9, 0, 2.1, -d + 0.02)),
        "shelf": Thing("bluish green", slab(0.2, -d, 1.0, 1.7, -d + 0.35, 1.5)),
        "bed": Thing("green", box(0.6, -2.3, 0, 2.0, -0.5, 0.45)),
        "stool": Thing("purple", box(-1.2, -1.7, 0, -0.7, -1.2, 0.5)),
    }
    view = camera(light, (-0.5, 3.0, 1.5), (0.05, -2.0, 1.2), 0.9)
    return Stage(things, paints(things), light.sky, view, sun=light.sun)


def white(light: Light) -> Stage:
    """A patio with white walls in the sun: most light in its shade has bounced, and often."""
    under = -0.02
    steps = [(2.3, 1.2 + 0.4 * k, 0, 3.2, 1.6 + 0.4 * k, 0.3 * (k + 1)) for k in range(5)]
    things = {
        "lawn": Thing("Summer Grass", level(-60, -60, 60, 60, under)),
        "terrace": Thing("White", level(-3.2, -3.0, 3.2, 3.2)),
        "left": Thing("white 9.5 (.05 D)", box(-3.4, -3.0, under, -3.2, 3.4, 3.2)),
        "right": Thing("white 9.5 (.05 D)", box(3.2, -3.0, under, 3.4, 3.4, 3.2)),
        "back": Thing("white 9.5 (.05 D)", box(-3.2, 3.2, under, 3.2, 3.4, 3.2)),
        "roof": Thing("white 9.5 (.05 D)", slab(-3.2, 1.0, 3.0, 0.4, 3.2, 3.2)),
        "pillar": Thing("white 9.5 (.05 D)", box(0.0, 1.1, 0, 0.3, 1.4, 3.0)),
        "stairs": Thing("White", [quad for step in steps for quad in box(*step)]),
        "door": Thing("blue", south(-2.4, -1.4, 0, 2.1, 3.18)),
        "pot": Thing("orange", box(-2.6, 0.2, 0, -1.8, 1.0, 0.7)),
        "bench": Thing("yellow green", box(0.9, 0.2, 0, 2.2, 0.9, 0.5)),
    }
    view = camera(light, (-0.3, -7.5, 2.6), (0, 1.0, 1.15), 0.95)
    return Stage(things, paints(things), light.sky, view, sun=light.sun)
