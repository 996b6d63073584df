"""Spectra of light out of RGB alone: what spectral renderers do with pictures of light.

The published ways make *reflectances* of RGB. For light, renderers (pbrt-v4, Mitsuba 3) scale the
colour so that its largest component is a half, take the reflectance of that colour under D65, and
give D65 through it. So it is done here. RGB is linear Rec.709; negative components are cut off.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..spectra.chromaticity import uv
from ..spectra.datasets import BASIS_REFLECTANCES, dataset
from ..spectra.grid import WAVELENGTHS, resample
from ..spectra.illuminants import D65, KELVIN, daylight
from ..spectra.sensitivities import cmfs, observer

Restore = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""From RGB (3, k) to spectra (81, k)."""

_NODES = 17
"""Along each side of the table of sigmoids: to 0.1 % of a colour like the table's own cells."""


def mallett_yuksel() -> NDArray[np.float64]:
    """Return the spectra (81, 3) of red, green and blue light; all other light is their mixture.

    Mallett and Yuksel 2019, DOI 10.2312/sr.20191216, from colour-science.
    """
    table = dataset(BASIS_REFLECTANCES, "Mallett 2019")
    spectra = resample(table.wavelengths, table.values).T * _neutral()[:, None]
    # Off the paper's own grid red, green and blue come out some thousandths mixed.
    return spectra @ np.linalg.inv(observer() @ spectra)


def jakob_hanika() -> Restore:
    """Return the way by smooth sigmoids, their coefficients read between a table's nodes.

    Jakob and Hanika 2019, DOI 10.1111/cgf.13626.
    """

    def restore(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
        table, x, neutral = (p.astype(rgb.dtype) for p in (_sigmoids(), _PLACE, _neutral()))
        rgb, largest = _scaled(rgb)
        first, pixel = np.argmax(rgb, axis=0), np.arange(rgb.shape[1])
        # The two components beside the largest, from 0 to 1, between the table's nodes.
        place = np.stack([rgb[(first + 1) % 3, pixel], rgb[(first + 2) % 3, pixel]])
        place = np.minimum(2.0 * (_NODES - 1) * place, _NODES - 1.000001)
        (i, j), (u, v) = (cell := place.astype(int)), (place - cell)[..., None]
        c = (1 - u) * ((1 - v) * table[first, i, j] + v * table[first, i, j + 1])
        c += u * ((1 - v) * table[first, i + 1, j] + v * table[first, i + 1, j + 1])
        a, b, c = np.ascontiguousarray(c.T)
        p = x[:, None] * a  # in place from here on: its size is what costs
        p += b
        p *= x[:, None]
        p += c
        root = p * p
        root += 1.0
        p /= np.sqrt(root, out=root)
        p += 1.0
        p *= 0.5 * largest
        p *= neutral[:, None]
        return p

    return restore


def otsu() -> Restore:
    """Return the way by principal components of measured reflectances, a set for each of 8 colours.

    Otsu, Yamamoto and Hachisuka 2018, DOI 10.1111/cgf.13332, its data from colour-science.
    """
    from colour.recovery.otsu2018 import DATASET_REFERENCE_OTSU2018 as data

    functions = resample(data.shape.wavelengths, data.basis_functions.reshape(-1, 36).T)
    functions = functions.reshape(-1, 3, WAVELENGTHS.size)
    means = resample(data.shape.wavelengths, data.means.T)
    S = observer() * _neutral()
    inverse = np.linalg.inv(np.einsum("il,cjl->cij", S, functions))
    linear = np.einsum("cjl,cji->cli", functions, inverse)
    constant = means - np.einsum("cli,ci->cl", linear, means @ S.T)
    to_XYZ = cmfs() * D65() @ np.linalg.pinv(observer() * D65())
    thresholds, axes, *sides = np.asarray(data.selector_array).T
    axes, turns = axes.astype(int), np.array(sides).astype(int)

    def restore(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
        first, then, neutral = (p.astype(rgb.dtype) for p in (linear, constant, _neutral()))
        rgb, largest = _scaled(rgb)
        XYZ = to_XYZ.astype(rgb.dtype) @ rgb
        xy = XYZ[:2] / np.maximum(XYZ.sum(axis=0), 1e-30)
        pixel, place = np.arange(rgb.shape[1]), np.full(rgb.shape[1], _ROOT)
        while (open_ := place < 0).any():
            node = np.where(place == _ROOT, 0, -place)[open_]
            side = xy[axes[node], pixel[open_]] > thresholds[node]
            place[open_] = turns[side.astype(int), node]
        spectra = np.empty((len(neutral), rgb.shape[1]), rgb.dtype)
        for each in range(len(first)):
            its = place == each
            spectra[:, its] = first[each] @ rgb[:, its] + then[each][:, None]
        return np.clip(spectra, 0.0, 1.0) * largest * neutral[:, None]

    return restore


_ROOT = np.iinfo(int).min
"""Where the search for a set begins: row 0, that the dataset's minus signs cannot name."""


def nearest_daylight() -> Restore:
    """Return the way by the known light that is nearest in colour, bent until it has the colour.

    After L. Tódová and A. Wilkie, "Constrained Spectral Uplifting for HDR Environment Maps",
    Computer Graphics Forum 44, 2025, DOI 10.1111/cgf.15280, as far as its abstract tells: a pixel's
    light is identified among measured emission spectra, and an uplift of the rest keeps its RGB.
    Not reproduced: their measured spectra, which are not public (for a sky, whose lights are
    daylight, here CIE's daylight from 4000 to 25,000 K; the nearest is that in u'v'); their
    sigmoids (here the parabola over the wavelength that sigmoids are where little is to be bent);
    and how they take pictures for it.
    """
    spectra = daylight(np.geomspace(*KELVIN, 24))
    powers = np.stack([np.ones_like(_PLACE), _PLACE, _PLACE**2])
    parts = spectra[:, None, :] * powers  # (n, 3, 81)
    restoring = np.moveaxis(parts, 1, 2) @ np.linalg.inv(np.moveaxis(parts @ observer().T, 1, 2))
    places = uv(spectra @ cmfs().T)
    to_XYZ = cmfs() * D65() @ np.linalg.pinv(observer() * D65())

    def restore(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
        table, own = restoring.astype(rgb.dtype), places.astype(rgb.dtype)
        rgb = np.maximum(rgb, 0.0)
        at = uv((to_XYZ.astype(rgb.dtype) @ rgb).T, 1e-30)
        nearest = ((at[:, None] - own) ** 2).sum(axis=-1).argmin(axis=1)
        spectra = np.empty((table.shape[1], rgb.shape[1]), rgb.dtype)
        for each in np.unique(nearest):
            its = nearest == each
            spectra[:, its] = table[each] @ rgb[:, its]
        return np.maximum(spectra, 0.0)

    return restore


def _scaled(rgb: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return colours whose largest component is a half, and what they were divided by (k,)."""
    rgb = np.maximum(rgb, 0.0)
    scale = 2.0 * np.maximum(rgb.max(axis=0), 1e-30)
    return rgb / scale, scale


@cache
def _neutral() -> NDArray[np.float64]:
    """Return D65 of such a size that its RGB is (1, 1, 1)."""
    return D65() / (observer() @ D65()).mean()


_PLACE = np.linspace(0.0, 1.0, WAVELENGTHS.size)


@cache
def _sigmoids() -> NDArray[np.float64]:
    """Return coefficients (3, n, n, 3) by the largest component and by the two that follow it.

    Newton's steps along the way from grey, all nodes together.
    """
    side = np.linspace(0.0, 0.5, _NODES)
    others = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1)
    target = np.concatenate([others, np.full((*others.shape[:2], 1), 0.5)], axis=-1)
    # Whose largest is red has green and blue to follow it, and so on around.
    target = np.stack([np.roll(target, first + 1, axis=-1) for first in range(3)]).reshape(-1, 3)
    S = observer() * _neutral()
    powers = np.stack([_PLACE**2, _PLACE, np.ones_like(_PLACE)])
    products = np.einsum("il,jl->lij", S, powers).reshape(-1, 9)
    c = np.zeros((len(target), 3))
    for way in np.linspace(0.05, 1.0, 20):
        for _ in range(4):
            p = c @ powers
            root = np.sqrt(1.0 + p * p)
            missing = 0.5 + way * (target - 0.5) - (0.5 + 0.5 * p / root) @ S.T
            slope = (0.5 / root**3 @ products).reshape(-1, 3, 3)
            c += np.linalg.solve(slope, missing[..., None])[..., 0]
    return c.reshape(3, _NODES, _NODES, 3)
