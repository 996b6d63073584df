"""Maps of values: the order of the colors, and where the lines run."""

import numpy as np

from spectral_skylight.addon.pictures.false_colour import colours, scale_of
from spectral_skylight.addon.pictures.light_map import _crossings, light_map
from spectral_skylight.addon.spectra.working_spaces import LUMINANCE, from_srgb


def test_brighter_is_more_also_in_gray_and_for_the_color_blind():
    shown = from_srgb(colours(np.linspace(0.0, 1.0, 65)))
    assert (np.diff(shown @ LUMINANCE) > 0.0).all()
    # Without red cones (F. Viénot, H. Brettel and J. Mollon 1999, DOI
    # 10.1002/(SICI)1520-6378(199908)24:4<243::AID-COL5>3.0.CO;2-3), two colors are left.
    protan = (
        shown
        @ np.array([[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]]).T
    )
    assert (np.diff(protan @ LUMINANCE) > 0.0).all()


def test_lines_run_where_the_values_are():
    y, x = np.mgrid[0:9, 0:13].astype(float)
    pieces = np.concatenate(_crossings(2.0 * x + y, 10.3))
    np.testing.assert_allclose(2.0 * pieces[:, 0] + pieces[:, 1], 10.3)  # of a plane exactly
    hole = np.where((x == 4) & (y == 4), np.nan, x)
    assert all((abs(each - [4.5, 4.0]) > 0.4).any() for each in _crossings(hole, 4.5))


def test_the_picture_has_the_values_colors_and_is_as_wide_as_the_plan():
    values = np.array([[100.0, 200.0], [np.nan, 400.0]])
    picture = light_map(values, (1.0, 2.0), "Lux", "lx", scale=1.0)
    height, width, _ = picture.shape
    assert height > width and picture.dtype == np.uint8
    bottom_left, top_right = picture[-30, 40], picture[60, 16 + 280 - 30]
    shown = colours(scale_of(values).place([100.0, 400.0]))
    np.testing.assert_allclose(bottom_left, 255 * shown[0], atol=1.0)
    np.testing.assert_allclose(top_right, 255 * shown[1], atol=1.0)
