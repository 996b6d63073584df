"""The sun is found where it is, as strong as it is, and nothing else is taken for it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.sky.lat_long import directions, solid_angles
from spectral_skylight.addon.sky.panorama import read_panorama
from spectral_skylight.addon.sky.sun import separate_sun
from spectral_skylight.addon.spectra.working_spaces import LUMINANCE

HEIGHT = 256
PITCH = 180.0 / HEIGHT
COLOUR = np.array([1.2, 1.0, 0.7])


def towards(elevation, azimuth):
    e, a = np.radians([elevation, azimuth])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def angles(direction, height=HEIGHT):
    """Angle of every pixel from a direction [deg]."""
    return np.degrees(np.arccos(np.clip(directions(height, 2 * height) @ direction, -1.0, 1.0)))


def plain_sky(height=HEIGHT):
    """Blue above, brighter to the horizon, a dull ground."""
    z = directions(height, 2 * height)[..., 2:]
    sky = np.where(z > 0.0, [0.3, 0.4, 0.7] + (1.0 - np.abs(z)) ** 4, [0.1, 0.1, 0.08])
    return sky.astype(np.float32)


def add_disc(sky, direction, radius, irradiance, fine=8):
    """Draw a disc with pixels partly covered; `irradiance` / pi of a face that looks at it."""
    height = len(sky)
    near = np.argwhere(angles(direction, height) < radius + 2.0 * 180.0 / height)
    step = (np.arange(fine) + 0.5) / fine
    cover = np.zeros(sky.shape[:2])
    for row, column in near:
        e = (0.5 - (row + step) / height) * np.pi
        a = (0.5 - (column + step) / (2 * height)) * 2.0 * np.pi
        e, a = np.meshgrid(e, a)
        to = np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)], axis=-1)
        cover[row, column] = np.mean(to @ direction > np.cos(np.radians(radius)))
    area = cover.sum(axis=1) @ solid_angles(height, 2 * height)
    sky += (cover[..., None] * COLOUR * irradiance * np.pi / area).astype(np.float32)
    return sky


@given(
    st.floats(1.0, 90.0),
    st.floats(-180.0, 180.0),
    st.sampled_from([0.27, 0.5, 1.2]),
    st.floats(0.3, 8.0),
)
@settings(max_examples=30, deadline=None)
def test_a_disc_is_found_wherever_it_stands(elevation, azimuth, radius, irradiance):
    """Zenith, seam and horizon are no exception; a disc may be smaller than a pixel."""
    direction = towards(elevation, azimuth)
    before = plain_sky()
    sky, sun = separate_sun(add_disc(before.copy(), direction, radius, irradiance))
    assert sun is not None
    # The disc is drawn with 8 x 8 samples a pixel, and where it lies in a pixel cannot be seen.
    assert np.degrees(np.arccos(min(1.0, sun.direction @ direction))) < 0.55 * PITCH
    # The sky's own gradient over the filled circle counts as sun or as none of it.
    np.testing.assert_allclose(sun.irradiance, irradiance * COLOUR, rtol=0.02)
    if elevation > 6.0:  # else ground is filled like sky
        np.testing.assert_allclose(sky, before, atol=0.35)
    assert sun.angular_radius == pytest.approx(max(radius, 0.6 * PITCH), abs=0.6 * PITCH)
    assert sun.direction @ towards(sun.elevation, sun.azimuth) == pytest.approx(1.0)


def test_share_and_what_is_left():
    direction = towards(40.0, 100.0)
    whole = add_disc(plain_sky(), direction, 0.5, 2.0)
    sky, sun = separate_sun(whole)
    up = exact_irradiance(whole, [[0, 0, 1]]) @ LUMINANCE
    assert sun.share == pytest.approx(2.0 * COLOUR @ LUMINANCE * direction[2] / up[0], rel=0.01)
    normals = np.vstack([direction, np.eye(3)[2], towards(10.0, 60.0)])
    together = (
        exact_irradiance(sky, normals)
        + np.maximum(normals @ sun.direction, 0.0)[:, None] * sun.irradiance
    )
    # The disc is not a point: its cosine differs over it by its radius squared, 1e-4, and pixels
    # by their size, 1e-4.
    np.testing.assert_allclose(together, exact_irradiance(whole, normals), rtol=3e-4)


@pytest.mark.parametrize("height", [512, 1024])
def test_finer_pixels_and_the_true_radius(height):
    direction = towards(30.0, -36.0)
    whole = add_disc(plain_sky(height), direction, 0.2666, 3.0)
    _, sun = separate_sun(whole)
    # Half a pixel either way, for a pixel counts when it is covered by half.
    assert sun.angular_radius == pytest.approx(0.2666, abs=0.5 * 180.0 / height)
    assert not sun.clipped


def test_the_aureole_stays_in_the_sky():
    """Glare falls off as 1 / angle^2 over some degrees; only what is under the disc goes."""
    direction = towards(35.0, 20.0)
    glare = plain_sky()
    glare += (20.0 / (0.5 + angles(direction)) ** 2)[..., None].astype(np.float32)
    whole = add_disc(glare.copy(), direction, 0.3, 2.0)
    sky, sun = separate_sun(whole)
    np.testing.assert_allclose(sun.irradiance, 2.0 * COLOUR, rtol=0.05)
    assert sun.angular_radius < 1.0
    apart = np.any(sky != whole, axis=2)
    assert angles(direction)[apart].max() < 3.0 * PITCH
    assert np.any(apart)


def test_clipping_is_seen():
    direction = towards(35.0, 20.0)
    whole = plain_sky(512)
    whole += (400.0 / (0.02 + angles(direction, 512)) ** 1.5)[..., None].astype(np.float32)
    assert not separate_sun(whole)[1].clipped
    _, sun = separate_sun(np.minimum(whole, 300.0))  # a plateau of a degree
    assert sun.clipped
    half = (400.0 / 150.0) ** (2.0 / 3.0) - 0.02  # where 150 is reached, without the sky's own 1
    assert sun.angular_radius == pytest.approx(half, abs=0.05)
    orange = add_disc(plain_sky(512), direction, 0.2666, 3.0) * np.float32([1.0, 0.5, 0.1])
    assert not separate_sun(orange)[1].clipped
    # Channels clip one by one: the core turns white.
    assert separate_sun(np.minimum(orange, 0.08 * orange.max()))[1].clipped
    half = add_disc(plain_sky(512), direction, 0.2666, 3.0)
    half *= 65504.0 / half.max()
    assert separate_sun(half)[1].clipped  # the largest half float


def test_half_behind_a_cloud_or_the_horizon():
    direction = towards(0.1, 170.0)
    whole = add_disc(plain_sky(1024), direction, 0.2666, 1.0)
    below = directions(1024, 2048)[..., 2] < 0.0
    whole[below] = [0.1, 0.1, 0.08]
    sky, sun = separate_sun(whole)
    assert 0.0 < sun.elevation < 0.35
    # The part of a circle over a chord at 0.1 / 0.2666 of its radius; the disc is 3 pixels wide.
    chord = 0.1 / 0.2666
    part = 0.5 + (np.arcsin(chord) + chord * np.sqrt(1.0 - chord**2)) / np.pi
    assert sun.irradiance[1] == pytest.approx(part, abs=0.03)
    assert sky.max() < 2.0


def test_what_is_no_sun():
    def none(sky):
        result, sun = separate_sun(sky)
        assert sun is None
        assert result is sky  # unchanged, not even copied

    sky = plain_sky(512)
    none(sky)
    none(np.ones((512, 1024, 3), np.float32))
    to = directions(512, 1024)
    overcast = ((1.0 + 2.0 * np.maximum(to[..., 2:], 0.0)) / 3.0).repeat(3, axis=2)
    none(overcast.astype(np.float32))

    def with_patch(rows, columns, value, base=sky):
        changed = base.copy()
        changed[rows, columns] = value
        return changed

    # A façade in the sun, five times as bright as the sky and 20° wide.
    none(with_patch(slice(200, 250), slice(300, 360), 5.0))
    dark = 0.02 * np.ones_like(sky)
    none(with_patch(slice(200, 212), slice(300, 306), 3.0, dark))  # a window, 2° by 4°
    none(with_patch(slice(200, 212), slice(300, 340), 500.0))  # a strip light
    none(with_patch(slice(300, 302), slice(300, 302), 9e3))  # the sun in a puddle
    none(with_patch(slice(100, 101), slice(300, 301), 60.0))  # a glint: 0.2 % of the light
    lamps = with_patch(slice(200, 202), slice(300, 302), 2e3)
    lamps[200:202, 600:602] = lamps[190:192, 800:802] = 1.9e3
    none(lamps)


def test_a_dead_pixel_does_not_hide_the_sun():
    height = 2048  # where one pixel is too small to be the sun
    direction = towards(35.0, 20.0)
    whole = add_disc(plain_sky(height), direction, 0.2666, 2.0, fine=3)
    whole[300, 300] = 50.0 * whole.max()
    _, sun = separate_sun(whole)
    assert sun is not None
    assert sun.direction @ direction > np.cos(np.radians(0.05))


FOUND = {
    # elevation, azimuth [deg] as seen in the pictures: the brightest pixel, which Poly Haven turns
    # to 36° right of the middle
    "city": (47.6, -36.0),
    "forest": (19.5, -35.9),  # between leaves
    "sunrise": (7.9, -35.9),
    "sunset": (3.3, -36.0),
    "immenstadter_horn_1k": (35.4, -36.1),
    "rooitou_park_1k": (10.4, -36.0),
    "sunrise_unclipped_1k": (7.9, -35.8),
    "venice_sunset_1k": (3.3, -36.0),
    "wasteland_clouds_puresky_1k": (7.6, -36.0),
}


def test_photographed_skies(shared_data, capsys):
    suns = {}
    for path in sorted((shared_data / "hdri").glob("*/*.[eh][xd]r")):
        _, suns[path.stem] = separate_sun(read_panorama(path).rgb)
    with capsys.disabled():
        print("\nsun                            elevation azimuth radius share E/pi clipped")
        for name, sun in suns.items():
            print(f"{name:28}", end=" ")
            print(
                f"{sun.elevation:8.2f} {sun.azimuth:8.2f} {sun.angular_radius:6.2f} "
                f"{100 * sun.share:6.1f} % {sun.irradiance @ LUMINANCE:6.3f} {sun.clipped}"
                if sun
                else "none"
            )
    assert {name for name, sun in suns.items() if sun is None} == {
        "courtyard",
        "mud_road_puresky_1k",
    }
    for name, place in FOUND.items():
        apart = np.degrees(np.arccos(suns[name].direction @ towards(*place)))
        assert apart < 0.36, name  # a pixel
    assert {name for name, sun in suns.items() if sun and sun.clipped} == {"sunrise"}
    # The same skies twice.
    for one, other in (("sunrise", "sunrise_unclipped_1k"), ("sunset", "venice_sunset_1k")):
        assert suns[one].direction @ suns[other].direction > np.cos(np.radians(0.1))
    assert suns["sunrise"].irradiance @ LUMINANCE < suns["sunrise_unclipped_1k"].irradiance @ (
        LUMINANCE
    )
    assert suns["sunset"].share == pytest.approx(suns["venice_sunset_1k"].share, rel=0.06)
