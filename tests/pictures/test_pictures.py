"""Pictures say what their numbers say: curves, colours, sizes and labels, pixel by pixel."""

import numpy as np
import pytest

from spectral_skylight.addon.pictures import curve as curves
from spectral_skylight.addon.pictures import errors as bars
from spectral_skylight.addon.pictures import matrix as matrices
from spectral_skylight.addon.pictures.curve import curve
from spectral_skylight.addon.pictures.errors import errors
from spectral_skylight.addon.pictures.matrix import matrix
from spectral_skylight.addon.pictures.spectral_colours import spectral_colours
from spectral_skylight.addon.pictures.theme import DARK, LIGHT, THEMES
from spectral_skylight.addon.spectra.grid import WAVELENGTHS

RHO = 0.1 + 0.7 / (1.0 + np.exp((590.0 - WAVELENGTHS) / 12.0))
SKY = (550.0 / WAVELENGTHS) ** 4


def byte(colour):
    return np.round(np.asarray(colour) * 255.0).astype(int)


def pixel(picture, x, y):
    return picture[int(y), int(x)].astype(int)


def is_like(found, colour, within=40):
    return bool(np.abs(found - byte(colour)).max() <= within)


@pytest.mark.parametrize("theme", [DARK, LIGHT])
@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_the_curve_passes_where_its_values_say(theme, scale):
    picture = curve(RHO, theme=theme, scale=scale)
    assert picture.shape == (480 * scale, 480 * scale, 3)
    x, y = curves.place_x(WAVELENGTHS), curves.place_y(RHO, 1.0)
    for k in range(1, 80):
        assert is_like(pixel(picture, scale * x[k], scale * y[k]), theme.ink)
        above = pixel(picture, scale * x[k], scale * (y[k] - 12))
        assert not is_like(above, theme.ink) or abs(RHO[k + 1] - RHO[k - 1]) > 0.02


def test_dark_materials_get_a_closer_look():
    assert [curves.highest(np.array([top])) for top in (0.04, 0.1, 0.3, 0.5)] == [0.1, 0.2, 0.5, 1]
    picture = curve(RHO / 10)
    k = 60
    y = curves.place_y(RHO[k] / 10, 0.1)
    assert is_like(pixel(picture, curves.place_x(WAVELENGTHS[k]), y), DARK.ink)


def test_the_band_has_the_colours_that_colour_science_gives():
    import colour

    XYZ = colour.wavelength_to_XYZ(WAVELENGTHS)
    rgb = np.maximum(colour.XYZ_to_RGB(XYZ, "sRGB", apply_cctf_encoding=False), 0.0)
    expected = colour.RGB_COLOURSPACES["sRGB"].cctf_encoding(rgb / rgb.max())
    # The grid averages under its hats, and the matrix has more digits than the standard's.
    assert np.abs(spectral_colours() - expected).max() < 0.03
    picture = curve(RHO)
    y = curves.BOTTOM + 12
    for k in range(2, 79):
        found = pixel(picture, curves.place_x(WAVELENGTHS[k]), y)
        assert np.abs(found - byte(expected[k])).max() <= 12


def test_what_the_material_reflects_stands_in_its_colours_under_the_skys_light():
    picture, bare = curve(RHO, sky=SKY), curve(RHO)
    light = 0.94 * SKY / SKY[(WAVELENGTHS >= 420) & (WAVELENGTHS <= 680)].max()
    for nm in (455, 545, 625):
        k = int(np.flatnonzero(WAVELENGTHS == nm)[0])
        x = curves.place_x(nm)
        top = curves.place_y(light[k] * RHO[k], 1.0)
        inside, outside = pixel(picture, x, top + 4), pixel(picture, x, top - 4)
        assert is_like(inside, 0.8 * spectral_colours()[k] + 0.2 * DARK.cell, 25)
        np.testing.assert_array_equal(outside, pixel(bare, x, top - 4))
        assert is_like(pixel(picture, x, curves.place_y(light[k], 1.0)), DARK.sky, 60)


def gaps(picture, y, start, end):
    """How often a level line at y is interrupted between two wavelengths."""
    columns = slice(*(int(x) for x in curves.place_x([start, end])))
    ink = np.abs(picture[int(y), columns].astype(int) - byte(DARK.ink)).max(axis=-1) < 60
    return int(np.count_nonzero(np.diff(ink.astype(int)) < 0))


def test_what_was_not_measured_is_dashed_and_said():
    grey = np.full(81, 0.5)
    whole, part = curve(grey), curve(grey, measured=(450.0, 700.0))
    y = curves.place_y(0.5, 1.0)
    assert gaps(whole, y, 385, 775) == 0
    assert gaps(part, y, 460, 690) == 0
    assert gaps(part, y, 385, 445) >= 2 and gaps(part, y, 705, 775) >= 2
    key = np.s_[8:40, 250:470]
    assert (part[key] != whole[key]).any() and (whole[key] == byte(DARK.paper)).all()
    np.testing.assert_array_equal(curve(grey, measured=(350.0, 800.0)), whole)


def test_what_is_estimated_is_dotted_and_said():
    grey = np.full(81, 0.5)
    plain, estimated = curve(grey), curve(grey, estimated=True)
    assert gaps(estimated, curves.place_y(0.5, 1.0), 385, 775) > 30
    label = np.s_[8:40, 250:360]  # after "Reflectance"
    assert (plain[label] == byte(DARK.paper)).all()
    assert (estimated[label] != byte(DARK.paper)).mean() > 0.1


M = np.array([[0.129, -0.047, -0.016], [0.004, 0.278, 0.019], [-0.008, 0.002, 0.0]])


def test_areas_are_sizes_and_colours_are_signs():
    picture = matrix(M)
    for (row, column), value in np.ndenumerate(M):
        x, y = (int(place) for place in matrices.centre(row, column))
        cell = picture[y - 64 : y + 36, x - 60 : x + 60].astype(int)
        area = {
            sign: (np.abs(cell - byte(colour)).max(axis=-1) < 12).sum()
            for sign, colour in ((1, DARK.plus), (-1, DARK.minus))
        }
        assert area[-int(np.sign(value) or 1)] == 0
        expected = matrices.LARGEST**2 * abs(value) / 0.278
        edge = 4.0 * np.sqrt(expected)  # pixels that are partly covered
        assert area[int(np.sign(value) or 1)] == pytest.approx(expected, abs=edge + 4)


def test_the_diagonal_of_today_is_outlined():
    today = np.diag([0.06, 0.278, 0.06]) + 1e-17  # as products of matrices have it
    plain, picture = matrix(M), matrix(M, today=today)
    for row, column in np.ndindex(3, 3):
        x, y = (int(place) for place in matrices.centre(row, column))
        cell = np.s_[y - 60 : y + 60, x - 60 : x + 60]
        assert (plain[cell] != picture[cell]).any() == (row == column)
    half = matrices.side(0.06, 0.278) / 2
    x, y = matrices.centre(0, 0)
    assert is_like(pixel(picture, x, y - 14 - half + 1), DARK.ink, 60)


def test_numbers_have_their_signs():
    assert [matrices.signed(v) for v in (0.1286, -0.047, -1e-5, 1.0)] == [
        "+0.129",
        "−0.047",
        "0.000",
        "+1.000",
    ]
    assert matrix(np.zeros((3, 3))).shape == (480, 480, 3)


def lengths(picture, colour):
    """Lengths of the bars of a colour, from top to bottom."""
    like = np.abs(picture[int(bars.TOP) :, int(bars.LEFT) :].astype(int) - byte(colour)).max(-1) < 9
    rows = like.sum(axis=1)
    starts = np.flatnonzero((rows[1:] > 0) & (rows[:-1] == 0)) + 1
    return [rows[start + 3] for start in starts]


def test_bars_are_as_long_as_errors_and_the_worst_comes_first():
    today, ours = [0.5, 4.0, np.nan, 2.0], [0.25, 1.0, np.nan, 0.5]
    picture = errors(["a", "b", "c", "d"], today, ours, theme=LIGHT)
    unit = (bars.RIGHT - bars.LEFT) / 4.0
    # Where the line of what is just noticeable crosses, two pixels are its own.
    assert lengths(picture, LIGHT.today) == pytest.approx([4 * unit, 2 * unit, 0.5 * unit], abs=3)
    assert lengths(picture, LIGHT.ours) == pytest.approx([1 * unit, 0.5 * unit, 0.25 * unit], abs=3)


def test_unknown_errors_have_no_bars():
    unknown = np.full(2, np.nan)
    assert lengths(errors(["a", "b"], unknown, unknown), LIGHT.today) == []
    assert errors([], [], []).shape[1] == 480


@pytest.mark.parametrize("theme", THEMES.values())
def test_the_same_numbers_are_the_same_bytes(theme):
    for draw in (
        lambda: curve(RHO, sky=SKY, measured=(400, 700), theme=theme),
        lambda: matrix(M, today=np.diag(np.diag(M)), theme=theme),
        lambda: errors(["a"], [1.0], [0.1], theme=theme),
    ):
        assert draw().tobytes() == draw().tobytes()
