"""Our own CIE L*a*b* and CIEDE2000, beside the published pairs and colour-science."""

import io

import colour
import numpy as np
import pytest

from spectral_skylight.addon.spectra.cielab import XYZ_to_Lab, delta_E_2000

SHARMA = np.loadtxt(
    io.StringIO("""
    50      2.6772  -79.7751 50       0      -82.7485  2.0425
    50      3.1571  -77.2803 50       0      -82.7485  2.8615
    50      2.8361  -74.02   50       0      -82.7485  3.4412
    50     -1.3802  -84.2814 50       0      -82.7485  1.0000
    50     -1.1848  -84.8006 50       0      -82.7485  1.0000
    50     -0.9009  -85.5211 50       0      -82.7485  1.0000
    50      0         0      50      -1        2       2.3669
    50     -1         2      50       0        0       2.3669
    50      2.49     -0.001  50      -2.49     0.0009  7.1792
    50      2.49     -0.001  50      -2.49     0.001   7.1792
    50      2.49     -0.001  50      -2.49     0.0011  7.2195
    50      2.49     -0.001  50      -2.49     0.0012  7.2195
    50     -0.001     2.49   50       0.0009  -2.49    4.8045
    50     -0.001     2.49   50       0.001   -2.49    4.8045
    50     -0.001     2.49   50       0.0011  -2.49    4.7461
    50      2.5       0      50       0       -2.5     4.3065
    50      2.5       0      73      25      -18      27.1492
    50      2.5       0      61      -5       29      22.8977
    50      2.5       0      56     -27       -3      31.9030
    50      2.5       0      58      24       15      19.4535
    50      2.5       0      50       3.1736   0.5854  1.0000
    50      2.5       0      50       3.2972   0       1.0000
    50      2.5       0      50       1.8634   0.5757  1.0000
    50      2.5       0      50       3.2592   0.335   1.0000
    60.2574 -34.0099 36.2677 60.4626 -34.1751 39.4387  1.2644
    63.0109 -31.0961 -5.8663 62.8187 -29.7946 -4.0864  1.2630
    61.2901   3.7196 -5.3901 61.4292   2.248  -4.962   1.8731
    35.0831 -44.1164  3.7933 35.0232 -40.0716  1.5901  1.8645
    22.7233 20.0904 -46.694  23.0331  14.973 -42.5619  2.0373
    36.4612 47.858   18.3852 36.2715  50.5065 21.2231  1.4146
    90.8027 -2.0831   1.441  91.1528  -1.6435  0.0447  1.4441
    90.9257 -0.5406  -0.9208 88.6381  -0.8985 -0.7239  1.5381
     6.7747 -0.2908  -2.4247  5.8714  -0.0985 -2.2286  0.6377
     2.0776  0.0795  -1.135   0.9033  -0.0636 -0.5514  0.9082
    """)
)
"""Sharma, Wu and Dalal 2005 (DOI 10.1002/col.20070), Table 1: L, a, b of both, and CIEDE2000."""

SAME = 1e-10
"""Sums of numbers up to 100 by other ways round otherwise."""


def test_the_published_pairs():
    one, other, expected = SHARMA[:, :3], SHARMA[:, 3:6], SHARMA[:, 6]
    assert len(SHARMA) == 34
    # Printed to four digits.
    np.testing.assert_allclose(delta_E_2000(one, other), expected, atol=1e-4)
    np.testing.assert_allclose(delta_E_2000(other, one), expected, atol=1e-4)


@pytest.mark.parametrize("apart", [0.01, 1.0, 30.0, 300.0])
def test_random_colours_as_by_colour_science(apart):
    rng = np.random.default_rng(int(apart))
    one = rng.uniform([0, -130, -130], [100, 130, 130], (50_000, 3))
    other = one + rng.normal(0.0, apart, one.shape)
    one[:50, 1:] = other[25:75, 1:] = 0.0  # greys, each beside a colour and beside another grey
    other[100:150] = one[100:150]
    theirs = colour.delta_E(one, other, method="CIE 2000")
    np.testing.assert_allclose(delta_E_2000(one, other), theirs, atol=SAME, rtol=SAME)


def test_equal_colours_are_not_apart():
    colours = np.random.default_rng(1).uniform(-100, 100, (1000, 3))
    assert not delta_E_2000(colours, colours).any()
    assert delta_E_2000([50, 0, 0], [50, 0, 0]) == 0.0


def test_shapes_broadcast():
    one, other = np.ones((4, 1, 3)), np.ones((5, 3))
    assert delta_E_2000(one, other).shape == (4, 5)
    assert XYZ_to_Lab(np.ones((4, 1, 3)), other).shape == (4, 5, 3)


def test_lab_is_colour_science_s():
    rng = np.random.default_rng(0)
    xy = rng.uniform(0.25, 0.4, (2000, 2))
    white = colour.xy_to_XYZ(xy)
    # Some under 0, as colours out of gamut are, and many near black, where the curve is straight.
    XYZ = rng.uniform(-0.1, 1.2, (2000, 3)) * np.where(rng.random((2000, 1)) < 0.3, 0.02, 1.0)
    theirs = colour.XYZ_to_Lab(XYZ, xy)
    np.testing.assert_allclose(XYZ_to_Lab(XYZ, white), theirs, atol=SAME)
    np.testing.assert_allclose(XYZ_to_Lab(7.0 * XYZ, 7.0 * white), theirs, atol=SAME)
    np.testing.assert_allclose(XYZ_to_Lab(white, white), [[100.0, 0.0, 0.0]] * 2000, atol=SAME)
