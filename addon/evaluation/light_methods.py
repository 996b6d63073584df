"""Every way to hold a sky's light for shading, behind one interface, as materials' `methods` are.

A method says what a pixel holds (its normal, or coefficients baked for its place), what the World
holds (``state``), and how the two make irradiance / pi. A further one is one more entry in
`LIGHT_METHODS`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..sky.dome import dome as suns
from ..sky.irradiance import irradiance_map
from ..sky.lat_long import directions, solid_angles
from ..sky.polynomial import exponents, monomials
from .light_places import Place, SkyPicture

LIVE = "24 suns, live"
"""The name of the way that needs no bake."""


@dataclass(frozen=True)
class Held:
    """A sky and a place made ready: ``shade(state, pixels)`` makes irradiance / pi (3, k).

    ``pixels`` (c, k): normals, or what was baked; ``state``: what the World holds, of any shape.
    """

    pixels: NDArray[np.float64]
    state: NDArray[np.float64]
    shade: Callable[[NDArray, NDArray], NDArray]


@dataclass(frozen=True)
class LightMethod:
    """One way to hold a sky: its name, whether it knows of walls, and how it is made ready."""

    name: str
    knows_walls: bool
    prepare: Callable[[SkyPicture, Place], Held]


DAMPING = 0.9925, 3.0**0.5 / 4.0
"""What Eevee keeps of a World's light, and of its first-order harmonic at most, over its mean.

Measured in Eevee 5.2 on white diffuse faces under skies of one lobe: the harmonic is scaled for all
channels alike until its length is at most this part of the mean in each. What then remains is
rounding, 2.5 % of the mean at worst (see the tests)."""


def _world_of_eevee(sky: SkyPicture, place: Place) -> Held:
    """Eevee's own diffuse light: mean and first-order harmonic of the World, the latter damped."""
    height = len(sky.rgb)
    share = solid_angles(height, 2 * height)[:, None, None] / (4.0 * np.pi)
    mean = (sky.rgb * share).sum(axis=(0, 1))
    first = np.einsum("hwd,hwc->dc", directions(height, 2 * height), sky.rgb * share)
    kept, most = DAMPING
    length = np.linalg.norm(first, axis=0)
    damped = min(1.0, float(np.min(most * mean / np.maximum(length, 1e-30))))
    return Held(place.normals.T, kept * np.vstack([mean, 2.0 * damped * first]), _first_order)


def _first_order(state: NDArray, normals: NDArray) -> NDArray:
    return state[1:].T @ normals + state[0][:, None]


def _polynomial(degree: int) -> LightMethod:
    def prepare(sky: SkyPicture, place: Place) -> Held:
        return Held(place.normals.T, sky.polynomials[degree], horner)

    return LightMethod(f"degree {degree}", False, prepare)


def horner(coefficients: NDArray, normals: NDArray) -> NDArray:
    """Return the polynomial of `sky.polynomial` as the shader has it: a multiplication and an
    addition for each coefficient."""
    degree = round(len(coefficients) ** 0.5) - 1
    at = {exponent: k for k, exponent in enumerate(exponents(degree))}
    x, y, z = normals
    halves = []
    for c in (0, 1):
        total: NDArray | float = 0.0
        for a in range(degree - c, -1, -1):
            inner: NDArray | float = 0.0
            for b in range(degree - c - a, -1, -1):
                inner = inner * y + coefficients[at[a, b, c]][:, None]
            total = total * x + inner
        halves.append(total)
    return halves[0] + z * halves[1]


def _texture(width: int) -> LightMethod:
    def prepare(sky: SkyPicture, place: Place) -> Held:
        return Held(place.normals.T, irradiance_map(sky.rgb, width), look_up)

    return LightMethod(f"texture {width} × {width // 2}", False, prepare)


def look_up(texture: NDArray, normals: NDArray) -> NDArray:
    """Read a lat-long texture (h, 2 h, 3) where normals (3, k) point, straight between pixels."""
    height, width = texture.shape[:2]
    pi = normals.dtype.type(np.pi)
    column = (0.5 - np.arctan2(normals[1], normals[0]) / (2 * pi)) * width - 0.5
    row = (0.5 - np.arcsin(np.clip(normals[2], -1, 1)) / pi) * height - 0.5
    row = np.clip(row, 0, height - 1)
    i, j = np.minimum(row.astype(int), height - 2), np.floor(column).astype(int)
    v, u = (row - i)[:, None], (column - j)[:, None]
    left, right = j % width, (j + 1) % width
    upper = (1 - u) * texture[i, left] + u * texture[i, right]
    lower = (1 - u) * texture[i + 1, left] + u * texture[i + 1, right]
    return ((1 - v) * upper + v * lower).T


def _ambient_occlusion(sky: SkyPicture, place: Place) -> Held:
    """What is often done: the light of the open sky, times the share of it that a face sees."""
    open_sky = Place(place.normals).transfer(len(sky.fine)).sum(axis=1)
    share = place.transfer(len(sky.fine)).sum(axis=1) / open_sky

    def shade(state: NDArray, pixels: NDArray) -> NDArray:
        return horner(state, pixels[:3]) * pixels[3]

    pixels = np.vstack([place.normals.T, share])
    return Held(pixels, sky.polynomials[4], shade)


def _visibility(count: int) -> LightMethod:
    """Precomputed transfer: coefficients of what a face sees, times coefficients of the sky.

    P.-P. Sloan, J. Kautz and J. Snyder 2002, DOI 10.1145/566654.566612. The sky is fitted by least
    squares where any face sees it: a projection would give half its terms to what none sees.
    """
    degree = round(count**0.5) - 1

    def prepare(sky: SkyPicture, place: Place) -> Held:
        height = len(sky.fine)
        transfer = place.transfer(height)
        terms = monomials(directions(height, 2 * height).reshape(-1, 3), degree)
        weight = np.sqrt(np.repeat(solid_angles(height, 2 * height), 2 * height))
        weight = (weight * (transfer > 0).any(axis=0))[:, None]
        fitted, *_ = np.linalg.lstsq(terms * weight, sky.fine.reshape(-1, 3) * weight, rcond=None)
        return Held((transfer @ terms).T, fitted.T, np.matmul)

    return LightMethod(f"visibility, {count} coefficients", True, prepare)


def _all_bounces(count: int, rays: int) -> LightMethod:
    """Beside the visibility, one colour at each place: what has bounced, any number of times.

    From each strip of the surroundings go rays whose hits are kept; their direct light comes from
    the same coefficients.
    """
    visibility = _visibility(count)

    def prepare(sky: SkyPicture, place: Place) -> Held:
        held = visibility.prepare(sky, place)
        pixels = np.vstack([held.pixels, np.zeros((3, len(place.normals)))])
        if place.neighbours is not None:
            around = visibility.prepare(sky, place.neighbours.strips)
            direct = around.shade(around.state, around.pixels)
            pixels[count:] = direct @ place.neighbours.by_rays(rays).T
        return Held(
            pixels, held.state, lambda state, pixels: state @ pixels[:count] + pixels[count:]
        )

    return LightMethod(f"visibility, {count} coefficients, and all bounces", True, prepare)


def _suns(sky: SkyPicture, place: Place) -> Held:
    """Soft suns that shine live, each for its share of the sky (`sky.dome`), with their shadows.

    What a pixel holds is each sun's part that its face sees; what that takes is not counted here.
    """
    lamps = suns(sky.rgb)
    to = directions(len(sky.fine), 2 * len(sky.fine)).reshape(-1, 3)
    inside = to @ lamps.towards.T >= 1.0 - lamps.solid_angle / (2.0 * np.pi)
    size = np.repeat(solid_angles(len(sky.fine), 2 * len(sky.fine)), 2 * len(sky.fine)) @ inside
    seen = place.transfer(len(sky.fine)) @ inside * (lamps.solid_angle / size)
    return Held(seen.T, (lamps.numbers @ lamps.colours).T, np.matmul)


LIGHT_METHODS: dict[str, LightMethod] = {
    method.name: method
    for method in (
        LightMethod("Eevee's own world light", False, _world_of_eevee),
        *(_polynomial(degree) for degree in (0, 1, 2, 4, 6)),
        *(_texture(width) for width in (16, 64)),
        LightMethod("degree 4 × ambient occlusion", True, _ambient_occlusion),
        LightMethod(LIVE, True, _suns),
        *(_visibility(count) for count in (9, 16, 25)),
        _all_bounces(25, rays=256),
    )
}
"""All methods by name."""
