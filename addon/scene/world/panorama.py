"""The light of a World as a panorama: an HDRI's own pixels, or what a bake of the World holds."""

from __future__ import annotations

import hashlib
from collections.abc import Generator
from dataclasses import replace

import bpy
import numpy as np

from ...errors import InputError
from ...progress import Progress, aside, run
from ...sky.known_spectrum import KnownSpectrum
from ...sky.light import SkyLight, analyse
from ...sky.panorama import from_pixels
from ...spectra.working_spaces import rec709_to_working
from ..blend_data import working_space
from . import capture, sky_image, sky_texture
from . import hdri as worlds

CUT_OFF = "its image has 8 bits per channel and clips light above white; use an .exr or .hdr"


ANALYZING = Progress(0.0, "the sky")


def light_of(world: bpy.types.World | None, sensors: np.ndarray) -> SkyLight:
    """The light of a World, as `analyzing` finds it."""
    return run(analyzing(world, sensors))


def analyzing(
    world: bpy.types.World | None, sensors: np.ndarray
) -> Generator[Progress, None, SkyLight]:
    """Take the light of a World apart; what it follows live is not in it (`hdri.WorldSky`).

    ``sensors`` (3, 81) as in `sky.light.analyse`. Raises InputError where `hdri.sky_of`,
    `pixels_of`, `capture.bake` and `sky.panorama.from_pixels` do.
    """
    sky = worlds.sky_of(world)
    assert world is not None
    name = f'World "{world.name}"' if sky.image is None else f'image "{sky.image.name}"'
    signs = [sky.line] if sky.line else []
    spectrum, state = None, None
    if sky.image is not None and (sky.image.is_float or not sky.image.has_data):
        signs += sky_image.notes(sky.image)
        spectrum = sky_image.spectrum(sky.image)
        state = sky_image.state(sky.image)
        pixels = None if _is_known(state, sensors) else (yield from reading(sky.image))
    else:
        if sky.image is not None:  # Blender 4.5 has 8 bits of what it cannot show, too
            spectra = sky_image.holds_spectra(sky.image)
            signs += sky_image.notes(sky.image) if spectra else [CUT_OFF]
        pixels, frame = capture.bake(world, sky)
        signs += [f"the World is animated: its light is that of frame {frame}"] if frame else []
    elevation = _sun_elevation(world, sky)
    if pixels is None:
        found = next(iter(_last.values()))
    else:
        found = yield from aside(ANALYZING, _analysed, pixels, name, sensors, spectrum)
        _state[:] = [(state, sensors.tobytes())]
    return replace(found, signs=(*signs, *found.signs), known_elevation=elevation)


def _sun_elevation(world: bpy.types.World, sky: worlds.WorldSky) -> float | None:
    """The sun's elevation [degrees] where the sky is a model that says it."""
    if sky.image is None:
        return sky_texture.sun_elevation(worlds.output_of(world))
    upright = not any(sky.rotation[:2])
    return sky_image.sun_elevation(sky.image) if upright else None


def _analysed(
    pixels: np.ndarray, name: str, sensors: np.ndarray, spectrum: KnownSpectrum | None
) -> SkyLight:
    content = hashlib.blake2b(name.encode() + sensors.tobytes())
    content.update(b"" if spectrum is None else spectrum.cells.tobytes())
    content.update(pixels.data)
    if content.digest() not in _last:
        panorama = replace(from_pixels(pixels, name), spectrum=spectrum)
        found = analyse(panorama, S_in=sensors)
        _last.clear()
        _last[content.digest()] = found
    return _last[content.digest()]


_last: dict[bytes, SkyLight] = {}  # of the last sky, by a hash of its numbers: it takes seconds
_state: list[tuple[tuple | None, bytes]] = []  # which image that was of, and what made its numbers


def _is_known(state: tuple | None, sensors: np.ndarray) -> bool:
    """Whether the last sky was that of an image in this state: reading 4k takes a second."""
    return state is not None and bool(_last) and _state == [(state, sensors.tobytes())]


def pixels_of(image: bpy.types.Image) -> np.ndarray:
    """The pixels of an HDRI, as `reading` reads them."""
    return run(reading(image))


def reading(image: bpy.types.Image) -> Generator[Progress, None, np.ndarray]:
    """Read the pixels of an HDRI as float32 RGB (h, w, 3), top row first, in the working space.

    Blender has then applied the image's colour space (none for Non-Color); packed, external
    and linked images give the same. Of several layers it is the one that `sky.exr_layers` chooses.
    Raises InputError for a missing or cropped file and for 8 bits a channel.
    """
    place = f'image "{image.name}"'
    width, height = image.size  # asking makes Blender load the file
    yield ANALYZING
    if image.type == "MULTILAYER":
        raw = image.colorspace_settings.is_data
        matrix = np.eye(3) if raw else rec709_to_working(working_space.name())
        return sky_image.read_layer(image).rgb @ matrix.T.astype(np.float32)
    if width == 0 or height == 0:
        sky_image.check_shown(image)
        file = bpy.path.abspath(image.filepath, library=image.library)
        raise InputError(place, f'cannot be read from "{file}"', "restore or pack the file")
    if not image.is_float:
        raise InputError(place, "has 8 bits per channel", "use an .exr or .hdr, which holds light")
    sky_image.check_whole(image)
    pixels = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    yield ANALYZING
    return (yield from aside(ANALYZING, _rgb, pixels.reshape(height, width, image.channels)))


def _rgb(pixels: np.ndarray) -> np.ndarray:
    """The three channels (h, w, 3) of an image, bottom row first, of one or more channels."""
    rgb = np.repeat(pixels, 3, axis=2) if pixels.shape[2] == 1 else pixels[:, :, :3]
    return np.ascontiguousarray(rgb[::-1])
