"""The examples by name: what `sh examples/run NAME` shows, each built to see one thing."""

from enclosed_scenes import bounce, courtyard, glass, room, street, white
from example import Example
from open_scenes import dusk, gloss, sun, texture

OPEN_SKY = {"open sky": ("--occlusion", "open")}
LIVE = {"live shadows": ("--occlusion", "dome"), **OPEN_SKY}

SCENES = {
    "sun": Example(
        *("Sun and sky, and a tower's shadow", 15, 235, sun),
        sunlit=True,
        beside=OPEN_SKY,
        samples=64,
    ),
    "courtyard": Example(
        *("A courtyard that sees a piece of the sky", 30, 200, courtyard),
        beside=LIVE,
        samples=128,
    ),
    "bounce": Example(
        *("Red wall, green lawn: each in the other's light", 50, 170, bounce),
        sunlit=True,
        options=("--ground", "hdri"),
        beside=OPEN_SKY,
        samples=96,
    ),
    "street": Example(
        *("A street between two fronts, one of them in the sun", 40, 250, street),
        sunlit=True,
        beside=OPEN_SKY,
        samples=256,
    ),
    "room": Example(
        *("A room open to the north: nothing in it sees the sun", 45, 170, room),
        sunlit=True,
        beside=OPEN_SKY,
        samples=768,
    ),
    "white": Example(
        *("A patio with white walls", 35, 215, white),
        sunlit=True,
        beside=OPEN_SKY,
        samples=256,
    ),
    "dusk": Example(
        *("After sunset, with a warm LED and a sodium lamp", -2, 300, dusk),
        beside=OPEN_SKY,
        samples=64,
    ),
    "texture": Example(
        "Textures: many paints, and one measured brick", 35, 180, texture, samples=32
    ),
    "gloss": Example("Clear coats and metals", 35, 150, gloss, options=("--gloss",), samples=64),
    "glass": Example(
        *("A room behind green glass", 40, 330, glass),
        options=("--ground", "hdri"),
        beside=OPEN_SKY,
        samples=128,
    ),
}
