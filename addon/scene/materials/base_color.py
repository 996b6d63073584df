"""The colours of base-colour textures, by which reflectances vary over a surface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import bpy
import numpy as np
from bpy.types import NodeSocket as Socket
from numpy.typing import NDArray

from ....node_groups import skylight_surface, spectral_matrix, spectral_texture
from ...spectra.working_spaces import from_srgb, rec709_to_working
from ...transfer.assignment import ESTIMATED, Assignment, estimate
from ...transfer.prediction import rgb_albedo
from ...transfer.textures import basis, carried
from ..blend_data import working_space
from ..lights.lighting import Lights
from . import eligibility, shader_rewrite, spectral_material


def estimated(material: bpy.types.Material) -> Assignment:
    """Return a reflectance of the color that a material has without us, or its texture.

    Mallett and Yuksel's (2019, DOI 10.2312/sr.20191216).
    """
    found = spectral_material.look_of(material)
    mean = mean_colour(found.colour)
    rgb = _plain_colour(found) if mean is None else mean
    return estimate(np.clip(rgb @ basis(working_space.name()), 0.0, 1.0))


def source(material: bpy.types.Material) -> list[Any]:
    """Return what a material's base colour comes from, as plain data: another is another colour.

    No pixel is looked at, so that it can be asked whenever something changes.
    """
    found = spectral_material.look_of(material)
    image = getattr(found.colour.node, "image", None) if found.colour is not None else None
    rgb = [round(float(part), 5) for part in _plain_colour(found)]
    if image is None:
        return rgb if found.colour is None else [*rgb, found.colour.node.name]
    return [image.name_full, image.filepath, image.colorspace_settings.name]


def _plain_colour(found: shader_rewrite.Look) -> NDArray[np.float64]:
    """Return the colour (3,) of a look without its texture."""
    if found.colour is not None and found.colour.node.type == "RGB":
        return np.array(found.colour.default_value)[:3]
    return np.array(found.rgb, dtype=float)


def shown_colour(material: bpy.types.Material) -> tuple[float, float, float] | None:
    """Return the color (3,) under D65 of what a material has, measured or not; None without one.

    No pixel of a texture is looked at.
    """
    managed = spectral_material.managed(material)
    if managed is None or not managed.details.values:
        return known_colour(material)
    red, green, blue = rgb_albedo(managed.values, working_space.name()).tolist()
    return red, green, blue


def known_colour(material: bpy.types.Material) -> tuple[float, float, float] | None:
    """Return the base color (3,) that a measured reflectance could take the place of.

    That of an estimate, a texture's mean too, or of a plain material that can be made spectral;
    None where it is measured already, or where a texture had to be read. No pixel is looked at.
    """
    managed = spectral_material.managed(material)
    if managed is not None:
        if managed.record.reflectance != ESTIMATED or not managed.details.values:
            return None
        red, green, blue = rgb_albedo(managed.values, working_space.name()).tolist()
        return red, green, blue
    if eligibility.reason(material):
        return None
    found = spectral_material.look_of(material)
    if found.colour is not None and found.colour.node.type != "RGB":
        return None
    red, green, blue = _plain_colour(found).tolist()
    return red, green, blue


def varied(material: bpy.types.Material, given: Assignment) -> NDArray[np.float64] | None:
    """Return what red, green and blue of a material's texture reflect, (3, 81); None without one.

    A texture of an estimated reflectance is all that there is; that of a measured one varies it.
    """
    space = working_space.name()
    colour = spectral_material.look_of(material).colour
    if given.estimated:
        return None if colour is None else basis(space)
    mean = mean_colour(colour)
    return None if mean is None else carried(given.values, mean, space)


def values(
    lights: Lights, reflectances: NDArray[np.float64], mean: NDArray[np.float64]
) -> Mapping[str, Any]:
    """Return what `spectral_texture.set_values` wants of three reflectances (3, 81).

    ``mean`` (81,): the material's own, by which baked and traced light go.
    """
    matrices = lights.transfer.matrices(reflectances)
    rows = {row: matrices[:, k] for k, row in enumerate(spectral_matrix.ROWS)}
    tint = lights.tint(lights.under_sky(matrices), mean)
    found = {**rows, **lights.reflected(reflectances), skylight_surface.TINT: tint}
    return {name: values for name, values in found.items() if name in spectral_texture.OUTPUTS}


def mean_colour(colour: Socket | None) -> NDArray[np.float64] | None:
    """Return the mean of what feeds a base colour, (3,) in the working space; None for no image.

    An Image Texture right there; what stands between would change its colour.
    """
    node = None if colour is None else colour.node
    if node is None or node.type != "TEX_IMAGE" or node.image is None or not node.image.size[0]:
        return None
    image = node.image
    pixels = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(-1, image.channels)
    if image.channels < 3:
        pixels = np.repeat(pixels[:, :1], 3, axis=1)
    rgb = pixels[:, :3].astype(np.float64)
    if image.is_float or image.colorspace_settings.is_data:
        return rgb.mean(axis=0)  # in the working space already
    # Blender hands out the file's own bytes: sRGB.
    return rec709_to_working(working_space.name()) @ from_srgb(rgb).mean(axis=0)
