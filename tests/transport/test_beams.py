"""Thin beams of the sun: as much light is there as comes in."""

import numpy as np
import pytest

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.lamps import Direct
from spectral_skylight.tests.stability.test_small_sources import with_hole
from spectral_skylight.tests.transport.rooms import box, fronts, matter, radiosity
from spectral_skylight.tests.transport.test_emitters import sheet

ROOM = box(inwards=True)
ROOM = ROOM[~np.all(ROOM[..., 2] > 0.99, axis=1)]
"""A room of 2 m without its ceiling."""


def comes_in(ceiling, way, of=None, kinds=0, lamps=()):
    """The sun's flux on all inside of the room under a ceiling, and on the inside by `lamps`."""
    way = np.array(way) / np.linalg.norm(way)
    found = radiosity(np.concatenate([ROOM, ceiling]), of or matter([0.5]), kinds, False, 2000, 16)
    sun = Direct(None, way, np.ones(COUNT, np.float32))
    _, middle, _, areas = fronts(found)
    inside = middle[:, 2] < 0.999
    light = run(found.lit_by([sun, *lamps]))[: len(areas), 0]
    return (light * areas)[inside].sum() / way[2]


def boards(count, slit):
    """A ceiling of so many boards with slits between them, and at both ends."""
    wide = (2.0 - (count + 1) * slit) / count
    at = -1.0 + slit + wide / 2.0 + np.arange(count) * (wide + slit)
    return np.concatenate([sheet([x, 0, 1], [wide / 2, 0, 0], [0, -1, 0]) for x in at])


@pytest.mark.parametrize("way", [(0.0, 0.0, 1.0), (0.0, 0.3, 0.9)], ids=["steep", "aslant"])
def test_slits_between_boards(way):
    """Many thin beams, of which rays from the sun meet some: others count by places, none twice."""
    slit = 0.006
    light = comes_in(boards(10, slit), way)
    # Rays 2 to 5 mm apart count beams of 6 mm, each by 1,000 of them: 2 % by luck.
    assert light == pytest.approx(11 * slit * 2.0, rel=0.05)


def test_a_beam_through_a_pane_and_beside_a_lamp():
    """Seven tenths of it; and a lamp's light there stays whole."""
    half = 0.01
    pane = sheet([0, 0, 1.1], [1, 0, 0], [0, 1, 0])
    ceiling = np.concatenate([with_hole(half), pane])
    of = matter([0.5, 0.0])
    of.clear[1], of.transmittance[1] = True, 0.7
    kinds = np.repeat([0, 1], [len(ROOM) + len(ceiling) - 2, 2])
    light = comes_in(ceiling, (0, 0, 1), of, kinds)
    assert light == pytest.approx(0.7 * 4.0 * half**2, rel=0.1)
    lamp = Direct(np.array([0.0, 0, 0]), np.array([0.0, 0, -1]), np.ones(COUNT, np.float32))
    both = comes_in(ceiling, (0, 0, 1), of, kinds, [lamp])
    # All of the lamp's but what falls on the ceiling, a sixth of all around it.
    assert both == pytest.approx(4.0 * np.pi * 5.0 / 6.0, rel=0.01)
