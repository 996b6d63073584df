"""What a canvas covers of its pixels, by areas known beforehand; letters beside matplotlib's."""

import numpy as np
import pytest

from spectral_skylight.addon.pictures import lettering
from spectral_skylight.addon.pictures.canvas import Canvas
from spectral_skylight.tests.pictures import letters

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


def sheet(scale=1.0):
    return Canvas(40, 30, scale, BLACK)


def covered(canvas):
    """The area that is white [square units]."""
    return canvas.pixels[..., 0].sum() / 255.0 / canvas.scale**2


@pytest.mark.parametrize("scale", [0.5, 1.0, 2.7])
def test_shapes_cover_their_areas(scale):
    canvas = sheet(scale)
    canvas.rectangle(3.3, 4.6, 12.9, 9.2, WHITE)
    assert covered(canvas) == pytest.approx(9.6 * 4.6, rel=0.01)
    canvas = sheet(scale)
    canvas.frame(5.0, 5.0, 25.0, 20.0, WHITE, 2.0)
    assert covered(canvas) == pytest.approx(20 * 15 - 16 * 11, rel=0.01)
    canvas = sheet(scale)
    canvas.frame(5.0, 5.0, 6.0, 6.0, WHITE, 2.0)
    assert covered(canvas) == pytest.approx(1.0, rel=0.02)
    canvas = sheet(scale)
    canvas.area([4.0, 20.0, 36.0], [25.0, 5.0, 25.0], 25.0, WHITE)
    assert covered(canvas) == pytest.approx(20 * 32 / 2, rel=0.01)
    canvas = sheet(scale)
    canvas.disc(20.2, 15.1, 7.0, WHITE)
    assert covered(canvas) == pytest.approx(np.pi * 49, rel=0.02)
    canvas = sheet(scale)
    canvas.line([6.0, 30.0], [4.0, 22.0], WHITE, 3.0)
    assert covered(canvas) == pytest.approx(3.0 * 30.0 + np.pi * 1.5**2, rel=0.03)


def test_a_crossing_line_is_as_bright_as_its_colour_and_no_brighter():
    canvas = sheet()
    canvas.line([5.0, 35.0, 5.0], [15.0, 15.0, 15.0], WHITE, 4.0, opacity=0.5)
    assert canvas.pixels.max() == 128


def test_dashes_follow_the_line_over_its_corners():
    canvas = sheet()
    canvas.line([2.0, 10.0, 20.0, 38.0], [15.0] * 4, WHITE, 2.0, dash=(6.0, 6.0))
    row = canvas.pixels[14, :, 0] > 128
    assert row[2:8].all() and not row[10:13].any() and row[14:20].all() and not row[22:25].any()


def test_shapes_beyond_the_edge_are_cut_off():
    canvas = sheet()
    canvas.rectangle(-5, -5, 3, 50, WHITE)
    canvas.line([-10, 60], [29, 29], WHITE, 2.0)
    canvas.disc(45, 5, 3, WHITE)
    canvas.text(-8, 12, "left", 12, WHITE)
    canvas.text(30, 29, "right", 12, WHITE)
    canvas.text(80, 80, "nowhere", 12, WHITE)
    assert canvas.pixels.shape == (30, 40, 3)


def test_a_picture_keeps_its_mean_in_any_rectangle():
    rgb = np.random.default_rng(1).random((64, 128, 3))
    canvas = sheet()
    canvas.image(rgb, 4.5, 5.25, 36.5, 21.25)
    mean = canvas.pixels.reshape(-1, 3).sum(axis=0) / 255.0 / (32 * 16)
    assert mean == pytest.approx(rgb.mean(axis=(0, 1)), abs=0.004)


def test_a_text_stands_where_it_should_and_fits_its_room():
    ends = {}
    for align in (0.0, 0.5, 1.0):
        canvas = Canvas(200, 30, 1.0, BLACK)
        width = canvas.text(100, 20, "HHH", 14, WHITE, align)
        columns = np.flatnonzero(canvas.pixels[..., 0].any(axis=0))
        ends[align] = columns[0], columns[-1] + 1
        rows = np.flatnonzero(canvas.pixels[..., 0].any(axis=1))
        assert rows[-1] == 19  # on the baseline
    assert ends[0.0][0] >= 100 and ends[1.0][1] <= 100
    assert ends[0.0][1] - ends[0.0][0] == pytest.approx(width, abs=4)
    canvas = Canvas(200, 30, 1.0, BLACK)
    assert canvas.text(0, 20, "a very long name of a material", 14, WHITE, room=90) <= 90
    assert canvas.pixels[:, 92:].max() == 0 and canvas.pixels[:, 70:90].max() > 0


def test_letters_are_those_of_the_font():
    """What is stored is what matplotlib's FreeType makes of DejaVu Sans today."""
    pytest.importorskip("matplotlib")
    made = letters.make()
    with np.load(letters.SHIPPED) as shipped:
        assert list(shipped["characters"]) == list(made["characters"])
        np.testing.assert_allclose(shipped["boxes"], made["boxes"], atol=0.01)
        difference = shipped["pixels"].astype(int) - made["pixels"]
    assert np.abs(difference).max() <= 16


def test_a_letter_of_another_size_has_its_ink():
    stored, *_ = lettering.line("g", lettering.EM, 20.0, 40.0)
    small, *_ = lettering.line("g", lettering.EM / 4, 20.3, 40.7)
    assert small.sum() * 16 == pytest.approx(stored.sum(), rel=0.01)


def test_an_unknown_character_is_a_box():
    box, *_ = lettering.line("□", 12, 0, 0)
    np.testing.assert_array_equal(lettering.line("漢", 12, 0, 0)[0], box)
