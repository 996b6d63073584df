"""Which pixels of a panorama hang together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..spectra.sorting import distinct


def spots(mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return for each pixel that is set in a mask (h, w) which spot it belongs to, (k,).

    In the order of ``np.nonzero``, numbered from 0. Pixels hang together by sides and corners, and
    over the seam between the last column and the first.
    """
    rows, columns = np.nonzero(mask)
    width = mask.shape[1]
    place = rows * width + columns
    one, other = [], []
    for down, right in ((0, 1), (1, -1), (1, 0), (1, 1)):
        wanted = (rows + down) * width + (columns + right) % width
        found = np.searchsorted(place, wanted)
        is_there = np.append(place, -1)[found] == wanted
        one.append(np.flatnonzero(is_there))
        other.append(found[is_there])
    a, b = np.concatenate(one), np.concatenate(other)
    # Each pixel takes the least number among its neighbours, then that one's own, until all agree.
    number = np.arange(len(place))
    while (number[a] != number[b]).any():
        least = np.minimum(number[a], number[b])
        for pixel in (number[a], number[b], a, b):
            np.minimum.at(number, pixel, least)
        number = number[number]
    return distinct(number)[2]
