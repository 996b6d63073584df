"""The map of a sky: its kinds, the sun's place, and each kind's part of a face's light."""

import numpy as np
import pytest

from spectral_skylight.addon.pictures import sky_map as maps
from spectral_skylight.addon.pictures.sky_map import MARKS, marked, sky_map
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.light import FACES
from spectral_skylight.addon.sky.sky_classification import FOREIGN, GROUND, SKY, SUN, outside
from spectral_skylight.addon.sky.sun import Sun
from spectral_skylight.addon.spectra.bases import rayleigh
from spectral_skylight.addon.spectra.sensitivities import observer

HEIGHT = 64
WHITE, BLUE = (observer() @ spectrum for spectrum in rayleigh()[:2])
LEAF = np.array([0.3, 1.0, 0.1])


def sky(upper, lower):
    rgb = np.empty((HEIGHT, 2 * HEIGHT, 3), np.float32)
    rgb[: HEIGHT // 2] = upper / upper.mean()
    rgb[HEIGHT // 2 :] = lower / lower.mean()
    return rgb


def test_the_plain_map_shows_the_kinds():
    rgb = sky(BLUE, LEAF)
    picture = marked(outside(rgb, None, FACES), rgb)
    assert picture.shape == (HEIGHT, 2 * HEIGHT, 3) and picture.dtype == np.uint8
    red, green, blue = picture[0, 0].astype(int)
    assert blue > green > red  # the sky as it is
    red, green, blue = picture[-1, 0].astype(int)
    assert red > blue > green  # magenta, and not the leaves' green


def test_a_dark_sky_is_a_picture_too():
    rgb = np.zeros((HEIGHT, 2 * HEIGHT, 3), np.float32)
    assert sky_map(outside(rgb, None, FACES), rgb).shape == (480, 480, 3)


@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 30), (120, 5), (-90, 60)])
def test_the_sun_has_a_ring_where_it_stands(azimuth, elevation):
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    rgb = sky(BLUE, WHITE)
    place = np.argmax(directions(HEIGHT, 2 * HEIGHT) @ towards)
    row, column = np.unravel_index(place, rgb.shape[:2])
    sun = Sun(towards, elevation, azimuth, 0.27, np.ones(3), 0.5, False)
    x, y = maps.sun_place(sun)
    unit = 480 / (2 * HEIGHT)
    assert (x / unit, y / unit) == pytest.approx((column + 0.5, row + 0.5), abs=0.51)
    picture = sky_map(outside(rgb, sun, FACES), rgb, sun)
    yellow = np.abs(picture.astype(int) - np.round(255 * np.array(MARKS[SUN]))).max(axis=-1) < 3
    assert yellow[int(y), int(x)]
    ring = picture[int(y), int(x) + 17].astype(int)
    assert np.abs(ring - 255 * np.array(MARKS[SUN])).max() < 40


def test_bars_are_the_parts_of_the_light():
    rgb = sky(BLUE, LEAF)
    found = outside(rgb, None, FACES)
    picture = sky_map(found, rgb).astype(int)
    first, step = maps.BARS
    for place, face in enumerate((0, 5, 6, 7, 8)):
        row = picture[int(first + step * place) + 12, int(maps.LEFT) :]
        whole = 480 - 12 - maps.LEFT
        for kind in (SKY, GROUND, FOREIGN, SUN):
            like = np.abs(row - np.round(255 * np.array(MARKS[kind]))).max(axis=-1) < 3
            assert like.sum() / whole == pytest.approx(found.shares[face, kind], abs=0.006)


def test_a_fine_sky_is_the_same_picture_again():
    rgb = np.repeat(np.repeat(sky(BLUE, WHITE), 8, axis=0), 8, axis=1)
    found = outside(rgb, None, FACES)
    first = sky_map(found, rgb)
    assert first.shape == (480, 480, 3)
    assert first.tobytes() == sky_map(found, rgb).tobytes()
