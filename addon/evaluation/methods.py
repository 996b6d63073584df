"""Every way from light and reflectance to colour, behind one interface.

A method says which numbers of the light a pixel holds (``channels``), what it keeps of each
material (``state``) and how a pixel is shaded with the two. Error, speed, set-up time and memory
are then measured alike for all of them. A further method is one more entry in `METHODS`.

All of a method that depends on the material alone is in its state. So all linear ones shade by one
product: N bands as a (3, N) matrix, Darling's six channels as (3, 6). None pays for what its
inventors had to keep apart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..choices import BASES
from ..errors import InputError, parameter
from ..spectra import sensitivities
from ..spectra.ensemble import shipped
from ..spectra.grid import WAVELENGTHS
from ..spectra.illuminants import D65
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import DEFAULT_SPACE, XYZ_to_working
from ..transfer.matrices import transfer
from ..transfer.prediction import rgb_albedo
from ..transfer.textures import basis
from . import upsampling


@dataclass(frozen=True)
class Sky:
    """What there is to know of a sky; a method looks at no more than it is told.

    ``lights`` (k, 81): spectra on faces, the first a level one; ``sun_elevation`` [degrees];
    ``camera``: what took the sky's numbers, as in `matrices.transfer`.
    """

    lights: NDArray[np.float64]
    sun_elevation: float | None = None
    camera: str | None = None

    @property
    def S_in(self) -> NDArray[np.float64]:
        """What makes three numbers of light, (3, 81)."""
        return observer() if self.camera is None else sensitivities.camera(self.camera)


@dataclass(frozen=True)
class Prepared:
    """A method ready for some materials under some sky.

    ``channels`` (c, 81) make a pixel's c numbers of a spectrum. ``shade(state, pixels)`` makes
    colours (3, k) of one material's state and pixels (c, k), (m, 3, k) of the states of all.
    ``to_rec709`` (3, 3) is the view transform's work, or a scene-wide setting: no shader pays.
    """

    channels: NDArray[np.float64]
    state: NDArray[np.float64]
    shade: Callable[[NDArray, NDArray], NDArray] = np.matmul
    to_rec709: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))

    def colours(self, lights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return linear Rec.709 colours (k, m, 3) of all materials under lights (k, 81)."""
        colours = self.to_rec709 @ self.shade(self.state, self.channels @ lights.T)
        return np.moveaxis(colours, -1, 0)


@dataclass(frozen=True)
class Method:
    """One way to shade: its name, the family it belongs to, and what of the sky it is told.

    ``told`` holds any of "colour" (the RGB of the sky's light), "elevation" (the sun's),
    "spectrum" (that of the light on level ground) and "truth": all lights and true colours, which
    makes it no method but the limit of its kind. ``prepare(sky, rho)`` readies it for reflectances
    (m, 81).
    """

    name: str
    family: str
    prepare: Callable[[Sky, NDArray[np.float64]], Prepared]
    told: tuple[str, ...] = ()

    @property
    def is_limit(self) -> bool:
        """Whether it was fitted to the truth itself."""
        return "truth" in self.told


def estimate(method: Method, skies: list[Sky], rho: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a method's colours (lights of all skies, m, 3), prepared for each sky if told any."""
    lights = np.concatenate([sky.lights for sky in skies])
    if method.told and not method.is_limit:
        return np.concatenate([method.prepare(sky, rho).colours(sky.lights) for sky in skies])
    return method.prepare(Sky(lights, camera=skies[0].camera), rho).colours(lights)


def true_colours(lights: NDArray[np.float64], rho: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return linear Rec.709 colours (k, m, 3) of reflectances (m, 81) under lights (k, 81)."""
    return np.einsum("il,ml,kl->kmi", observer(), rho, lights, optimize=True)


def with_basis(basis: str, *told: str) -> Method:
    """Return the material matrices with a basis that `bases.basis` understands."""
    kind, _, file = basis.partition(" ")
    name = f"{kind} {Path(file).name}" if file else basis
    if told:
        name += f", {' and '.join(told)} known"

    def prepare(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
        known: dict[str, Any] = {}
        if "colour" in told:
            known["sky_rgb"] = sky.lights @ sky.S_in.T
        if "elevation" in told:
            if sky.sun_elevation is None:
                raise InputError(parameter("sun_elevation"), f"{name} has none", "give one")
            known["sun_elevation"] = sky.sun_elevation
        mapping = transfer(basis, camera=sky.camera, **known)
        return Prepared(mapping.S_in, mapping.matrices(rho))

    return Method(name, "3x3", prepare, told)


def rgb_times_rgb(name: str, from_XYZ: Callable[[], NDArray[np.float64]], *told: str) -> Method:
    """Return products of RGB in the space that ``from_XYZ`` (3, 3) leads to.

    The albedo is the reflectance's RGB under D65, over white's; told the spectrum, under the
    light on level ground.
    """

    def prepare(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
        to_rec709 = XYZ_to_working(DEFAULT_SPACE) @ np.linalg.inv(from_XYZ())
        S = np.linalg.inv(to_rec709) @ observer()
        seen = S * (sky.lights[0] if told else D65())
        albedo = rho @ seen.T / seen.sum(axis=1)
        return Prepared(S, albedo[:, :, None], product, to_rec709)

    return Method(name, "RGB × RGB", prepare, told)


def product(state: NDArray, pixels: NDArray) -> NDArray:
    """Return channel times channel: of a state (..., 3, 1) and pixels (3, k), (..., 3, k).

    numpy is fastest when told so as a diagonal matrix.
    """
    return (state * np.eye(3, dtype=state.dtype)) @ pixels


def _sharp() -> NDArray[np.float64]:
    """From XYZ to the sharpened primaries that Ward and Eydelberg-Vileshin multiply in."""
    from colour.adaptation import CHROMATIC_ADAPTATION_TRANSFORMS

    return np.asarray(CHROMATIC_ADAPTATION_TRANSFORMS["Sharp"])


def _best_diagonal(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
    pixels = sky.lights @ sky.S_in.T
    true = true_colours(sky.lights, rho)
    scale = np.einsum("kmi,ki->mi", true, pixels) / (pixels**2).sum(axis=0)
    return Prepared(sky.S_in, scale[:, :, None], product)


def _best_matrix(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
    pixels = sky.lights @ sky.S_in.T
    true = true_colours(sky.lights, rho).reshape(len(pixels), -1)
    fitted, *_ = np.linalg.lstsq(pixels, true, rcond=None)
    return Prepared(sky.S_in, np.moveaxis(fitted.reshape(3, -1, 3), 0, -1))


def _reflected(rho: NDArray[np.float64], restoration: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return matrices (m, 3, c) of materials where c numbers are restored to spectra (81, c)."""
    return (rho[:, None, :] * observer()) @ restoration


SECOND_TRIPLET = 610.0, 15.0
"""Edge and width [nm] of the yellow filter through which the second triplet of numbers is taken,
``1 / (1 + exp((edge - wavelength) / width))``. Of edges from 570 to 640 nm and widths from 12 to
30, one of the best for light that we expect on a ColorChecker, multiplied and as a 3x6 matrix."""


def six_channels() -> NDArray[np.float64]:
    """Return the observer's RGB and the same through a yellow filter, (6, 81).

    Two pictures of the sky with one camera, the second through a filter, as Darling, Ferwerda,
    Berns and Chen took them: "Real-time multispectral rendering with complex illumination",
    Color and Imaging Conference 19, 2011.
    """
    edge, width = SECOND_TRIPLET
    filter_ = 1.0 / (1.0 + np.exp((edge - WAVELENGTHS) / width))
    return np.concatenate([observer(), observer() * filter_])


def _six_multiplied(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
    """Darling et al.: light times reflectance in each of six channels, then six to three.

    Products want channels that hardly overlap, so these six are mixed until each keeps to a sixth
    of the observer's range: G. Finlayson, M. Drew and B. Funt 1994, DOI 10.1364/JOSAA.11.001553.
    """
    channels = six_channels()
    mix = np.empty((6, 6))
    square = channels @ channels.T
    for k, part in enumerate(_parts(6)):
        inside = (channels * part) @ channels.T
        values, vectors = np.linalg.eig(np.linalg.solve(square, inside))
        mix[k] = np.real(vectors[:, np.argmax(np.real(values))])
    sharp = mix @ channels
    to_rgb = observer() @ np.linalg.pinv(sharp)
    albedo = (rho * D65()) @ sharp.T / (sharp @ D65())
    return Prepared(sharp, albedo[:, None, :] * to_rgb)


def _six_matrix(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
    """A 3x6 matrix a material: six numbers are restored to the spectrum that we then expect.

    By the second moment of `ensemble`'s spectra, as three are by the basis `atmosphere`.
    """
    channels = six_channels()
    seen = channels @ shipped().spectra.T
    restoration = np.linalg.solve(seen @ seen.T, seen @ shipped().spectra).T
    return Prepared(channels, _reflected(rho, restoration))


def _parts(count: int) -> NDArray[np.float64]:
    """Return which nodes belong to which band, (count, 81) of 0 and 1.

    Bands are narrow where the observer sees much, as the root of it goes, which served 8 to 31
    bands better than even cuts of any range did. 81 bands are the nodes.
    """
    share = np.sqrt(np.abs(observer()).sum(axis=0)).cumsum()
    edges = np.searchsorted(share / share[-1], np.arange(1, count) / count) + 1
    order, nodes = np.arange(1, count), WAVELENGTHS.size
    edges = np.maximum.accumulate(np.maximum(edges, order) - order) + order
    edges = np.minimum(edges, nodes - count + order)
    band = np.searchsorted(edges, np.arange(nodes), side="right")
    return (band == np.arange(count)[:, None]).astype(float)


def _bands(count: int) -> Method:
    """N numbers a pixel and N a material, each the mean over a band; the rest is a product."""

    def prepare(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
        parts = _parts(count)
        weights = parts * np.abs(observer()).sum(axis=0)
        means = weights / weights.sum(axis=1, keepdims=True)
        return Prepared(means, (rho @ means.T)[:, None, :] * (observer() @ parts.T))

    return Method(f"{count} bands", "bands", prepare)


def _restored(name: str, restore: Callable[[], upsampling.Restore]) -> Method:
    """The spectrum of each pixel, 81 numbers made of three, times the material's."""

    def prepare(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
        spectra = restore()

        def shade(state: NDArray, pixels: NDArray) -> NDArray:
            return state @ spectra(pixels)

        return Prepared(observer(), rho[:, None, :] * observer(), shade)

    return Method(name, "spectrum restored", prepare)


def _mallett_yuksel(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
    """Linear in RGB, so that it too is a 3x3 matrix a material, and as fast."""
    return Prepared(observer(), _reflected(rho, upsampling.mallett_yuksel()))


def _texture(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
    """All that a texture knows of a material is its RGB under D65: see `textures`.

    Three matrices, the same for every texture; each pixel mixes what they make of its light.
    """
    three = with_basis("atmosphere", "colour", "elevation").prepare(sky, basis()).state

    def shade(state: NDArray, pixels: NDArray) -> NDArray:
        each = three.reshape(9, 3).astype(pixels.dtype) @ pixels
        return np.tensordot(state, each.reshape(3, 3, -1), 1)

    return Prepared(sky.S_in, rgb_albedo(rho), shade)


TODAY = {f"RGB × RGB in {space.split()[-1]}": space for space in (DEFAULT_SPACE, "Linear Rec.2020")}
"""Today's way by the space that it multiplies in: two marks to beat."""

BEST = "best 3x3"
"""The other mark: for each material the one matrix that least squares finds for this very light."""


_SPACES = {name: partial(XYZ_to_working, space) for name, space in TODAY.items()}

METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        *(rgb_times_rgb(name, XYZ) for name, XYZ in _SPACES.items()),
        *(
            rgb_times_rgb(f"{name}, own white", space, "spectrum")
            for name, space in _SPACES.items()
        ),
        # Ward and Eydelberg-Vileshin 2002, DOI 10.2312/EGWR/EGWR02/117-124.
        rgb_times_rgb("prefiltered RGB", _sharp, "spectrum"),
        Method("best diagonal", "3x3", _best_diagonal, ("truth",)),
        *map(with_basis, BASES),
        with_basis("atmosphere", "colour"),
        with_basis("atmosphere", "elevation"),
        with_basis("atmosphere", "colour", "elevation"),
        Method(BEST, "3x3", _best_matrix, ("truth",)),
        Method("texture, three matrices", "texture", _texture, ("colour", "elevation")),
        Method("six channels multiplied", "six channels", _six_multiplied),
        Method("six channels, 3x6", "six channels", _six_matrix),
        *(_bands(count) for count in (4, 8, 16, 31, 81)),
        Method("Mallett-Yuksel", "spectrum restored", _mallett_yuksel),
        _restored("Jakob-Hanika", upsampling.jakob_hanika),
        _restored("Otsu", upsampling.otsu),
        _restored("nearest daylight, bent", upsampling.nearest_daylight),
    )
}
"""All methods by name. `with_basis("measured FILE.csv")` is one more, made when it is asked for."""
