"""Amounts of light as colours: the table, round scales, isolines where they belong."""

import numpy as np
import pytest

from spectral_skylight.addon.pictures import false_colour as fc
from spectral_skylight.addon.pictures.theme import LIGHT


def test_the_colours_are_viridis():
    import matplotlib

    whole = np.array(matplotlib.colormaps["viridis"].colors)
    found = fc.colours(np.linspace(0.0, 1.0, 256))
    assert np.abs(found - whole).max() < 0.007  # linear between 33 stops of 8 bits


@pytest.mark.parametrize("decade", [1e-3, 1.0, 1e5])
def test_a_scale_is_round_and_holds_what_it_is_of(decade):
    even = fc.scale_of(decade * np.linspace(1.0, 4.3, 500))
    assert (even.low, even.logarithmic) == (0.0, False)
    assert even.high == pytest.approx(5.0 * decade)
    wide = fc.scale_of(decade * np.geomspace(1.0, 3e3, 500))
    assert wide.logarithmic
    assert (wide.low, wide.high) == (pytest.approx(decade), pytest.approx(3e3 * decade))
    for scale in (even, wide):
        assert scale.place([scale.low, scale.high]) == pytest.approx([0.0, 1.0])
        assert scale.levels == sorted(scale.levels) and 4 <= len(scale.levels) <= 13
        assert scale.low * 0.99 <= scale.levels[0] and scale.levels[-1] <= scale.high * 1.01


def test_without_light_there_is_a_scale_all_the_same():
    for dark in ([], [0.0, 0.0], [np.nan, -1.0]):
        assert fc.scale_of(dark) == fc.Scale(0.0, 1.0)


def test_isolines_stand_where_a_level_is_passed_and_not_at_edges():
    ramp = np.tile(np.linspace(0.0, 100.0, 201), (4, 1))
    scale = fc.Scale(0.0, 100.0)
    lines = fc.isolines(ramp, scale)[0]
    passed = [ramp[0, k] for k in np.flatnonzero(lines)]
    # Each within a pixel of its level.
    assert np.allclose(passed, scale.levels[: len(passed)], atol=0.51)
    assert len(passed) >= 5
    step = np.where(np.arange(40) < 20, 5.0, 95.0)[None].repeat(4, axis=0)
    assert not fc.isolines(step, scale).any()
    hole = ramp.copy()
    hole[:, 90:110] = np.nan
    assert not fc.isolines(hole, scale)[:, 89:110].any()


def test_the_picture_shows_amounts_paper_and_legend():
    amounts = np.full((40, 60), 300.0)
    amounts[:20] = np.nan
    pixels = fc.false_colour(amounts, "Illuminance", "lx", scale=fc.Scale(0.0, 600.0)) / 255.0
    assert np.allclose(pixels[10, 10], LIGHT.paper, atol=0.01)
    assert np.allclose(pixels[-20, 10], fc.colours(0.5), atol=0.01)
    assert pixels.shape[1] > 60 * 8 + fc.LEGEND - 1


@pytest.mark.parametrize(
    ("amount", "said"),
    [(0.0, "0"), (123456.0, "123,000"), (1000.0, "1,000"), (99.96, "100"), (0.01234, "0.0123")],
)
def test_amounts_are_written_as_people_do(amount, said):
    assert fc.text(amount) == said
