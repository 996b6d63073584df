"""Sky files as images of Blender: loaded so that Blender shows what the file means.

Blender reads most files as `sky.panorama` does once the image has the right colour space. Where it
does not (other layers first, a cropped panorama, channels that were multiplied, an infinite sun,
primaries that Blender has no name for) the sky as it was read is packed into the blend file.
"""

from __future__ import annotations

import io
import json
import tempfile
from collections.abc import Generator, Mapping
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import tags
from ...errors import InputError
from ...progress import Progress, aside, run
from ...sky.file_claims import regular_size
from ...sky.header_notes import Said, read_said
from ...sky.known_spectrum import ATTRIBUTE, KnownSpectrum
from ...sky.panorama import Panorama, write_panorama
from ...spectra.working_spaces import DEFAULT_SPACE
from ..blend_data import kept, working_space
from ..files.exr_decoder import read_sky

LOAD = "load it with Load Sky HDRI"
SPECTRA = "its file holds spectra, which Blender does not show"


def load(path: Path, raw: bool = False, shown: bpy.types.Image | None = None) -> bpy.types.Image:
    """Load a sky file as an image, as `loading` does."""
    return run(loading(path, raw, shown))


def loading(
    path: Path, raw: bool = False, shown: bpy.types.Image | None = None
) -> Generator[Progress, None, bpy.types.Image]:
    """Load a sky file as an image; the numbers of a ``raw`` one are a camera's, never converted.

    An image of the file that is there already is returned, ``shown`` first, if it shows what the
    file means. Raises InputError where `sky.panorama.read_panorama` does; nothing is loaded then.
    """
    there = [
        image
        for image in ([] if shown is None else [shown]) + list(bpy.data.images)
        if (image == shown or (image.users and image.library is None)) and is_of(image, path)
    ]
    for image in there:
        if tags.SKY in image and _kept(image).get("raw") == raw:
            return image
    sky = yield from aside(Progress(0.0, path.name), read_sky, path, raw)
    if not sky.space:
        return _packed(path, sky, raw)
    for image in there:
        # Of a file that says nothing a user's own choice stands, as a raw one's is judged later.
        chosen = sky.space == DEFAULT_SPACE or (raw and image == shown)
        if tags.SKY not in image and (chosen or image.colorspace_settings.name == sky.space):
            return image
    image = bpy.data.images.load(str(path))
    # Blender knows some colour spaces by names of theirs that we do not: its choice stands.
    if sky.space == DEFAULT_SPACE or _tag(image, sky.space):
        return image
    bpy.data.images.remove(image)
    return _packed(path, sky, raw)


def _tag(image: bpy.types.Image, space: str) -> bool:
    """Give an image a colour space; False where this Blender has none of that name."""
    try:
        image.colorspace_settings.name = space
    except TypeError:
        return False
    return True


def _packed(path: Path, sky: Panorama, raw: bool) -> bpy.types.Image:
    # Under a name of its own: unpacking must not overwrite the file that was read.
    white = sky.metadata.get("whiteLuminance")
    attributes: dict[str, Any] = {"whiteLuminance": white} if kept.is_number(white) else {}
    if sky.spectrum is not None:
        attributes[ATTRIBUTE] = sky.spectrum.to_text()
    image = _in_file(f"{path.stem}.as_read.exr", sky.rgb, attributes)
    image.colorspace_settings.name = "Non-Color" if raw else DEFAULT_SPACE
    image.name = path.name
    image[tags.SKY] = json.dumps({"file": _stamp(path), "raw": raw, "notes": list(sky.notes)})
    return image


def simulated(
    name: str,
    rgb: NDArray[np.float32],
    attributes: Mapping[str, Any],
    made: Mapping[str, Any],
    elevation: float,
) -> bpy.types.Image:
    """Keep a sky that was simulated, (h, 2 h, 3) in linear Rec.709, in the blend file.

    ``attributes``: of the EXR that is packed; ``made``: what is kept with the image, as JSON has
    it; ``elevation``: the sun's [degrees].
    """
    image = _in_file(f"{name.replace(':', '')}.exr", rgb, attributes)
    image.colorspace_settings.name = DEFAULT_SPACE
    image.use_half_precision = False  # the sun's disc is brighter than 65504
    image.name = name
    image[tags.SKY] = json.dumps({"sun_elevation": elevation, **made})
    return image


def made(image: bpy.types.Image) -> dict[str, Any]:
    """Return what is kept with a sky that we simulated; empty of any other."""
    return {} if sun_elevation(image) is None else _kept(image)


def sun_elevation(image: bpy.types.Image) -> float | None:
    """Return the elevation [degrees] of the sun of a sky that we simulated; None of any other."""
    found = _kept(image).get("sun_elevation", "") if tags.SKY in image else ""
    return float(found) if kept.is_number(found) else None


def white_luminance(image: bpy.types.Image) -> float | None:
    """Return the luminance [cd/m²] of (1, 1, 1) that an image's file says; None where it does not.

    OpenEXR's attribute ``whiteLuminance``.
    """
    said = _said(image)
    return None if said is None else said.white_luminance


def _in_file(name: str, rgb: NDArray[np.float32], attributes: Mapping[str, Any]) -> bpy.types.Image:
    """Return an image whose numbers are packed into the blend file; ``name``: of that EXR."""
    with tempfile.TemporaryDirectory(prefix="skylight-") as folder:
        copy = Path(folder) / name
        write_panorama(copy, rgb, attributes)
        image = bpy.data.images.load(str(copy))
        image.pack()
    image.filepath_raw = f"//{name}"
    return image


def is_of(image: bpy.types.Image, path: Path) -> bool:
    """Return whether an image shows a file, or holds it as it was read."""
    if tags.SKY in image:
        return bool(_kept(image).get("file") == _stamp(path))
    file = bpy.path.abspath(image.filepath, library=image.library)
    return image.source == "FILE" and bool(file) and Path(file).resolve() == path


def _kept(image: bpy.types.Image) -> dict[str, Any]:
    """Return what is kept with an image; empty where that was overwritten."""
    try:
        found = json.loads(image[tags.SKY])
    except (TypeError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _stamp(path: Path) -> list[str | int]:
    """Return what tells whether a file is still the one that was read."""
    try:
        found = path.stat()
    except OSError:
        return [str(path), 0, 0]
    return [str(path), found.st_size, found.st_mtime_ns]


def notes(image: bpy.types.Image) -> list[str]:
    """Return what should be known of an image's numbers, by the header of its file, a line each."""
    if tags.SKY in image:
        found = _kept(image).get("notes")
        return [str(note) for note in found] if isinstance(found, list) else []
    said = _said(image)
    if said is None:
        return []
    tag = image.colorspace_settings
    if said.in_channels:
        return [f"{SPECTRA}; {LOAD}, which uses them"]
    found = list(said.declared.told)
    if said.layer:
        found.append(f"{said.layer}; {LOAD}, so that Blender shows the same")
    if said.declared.factors is not None:
        found.append(f"{said.factors}; {LOAD}, which divides that out")
    if said.primaries and not tag.is_data:
        space = said.declared.space
        if tag.name == space:
            found.append(f"{said.primaries}: converted")
        elif space:
            found.append(
                f"{said.primaries}, but its Color Space is {tag.name}: set that to {space}"
            )
        else:
            found.append(f"{said.primaries}; {LOAD}, which converts them")
    return found


def spectrum(image: bpy.types.Image) -> KnownSpectrum | None:
    """Return the spectra of a sky that the header of an image's file holds; None without."""
    said = _said(image)
    return None if said is None else said.spectrum


def check_whole(image: bpy.types.Image) -> None:
    """Raise InputError for an image whose file is a part of a panorama, which Blender stretches."""
    said = None if tags.SKY in image else _said(image)
    if said is not None and said.black:
        what = "its file is cropped, and Blender stretches it over the whole sphere"
        raise InputError(f'image "{image.name}"', what, f"{LOAD}, which fills in black")


def check_shown(image: bpy.types.Image) -> None:
    """Raise InputError for an image that Blender cannot load because its file holds spectra."""
    if holds_spectra(image):
        raise InputError(f'image "{image.name}"', SPECTRA, LOAD)


def holds_spectra(image: bpy.types.Image) -> bool:
    """Whether the pixels of an image's file are spectra."""
    said = _said(image)
    return said is not None and said.in_channels


def read_layer(image: bpy.types.Image) -> Panorama:
    """Read an image of several layers, which Blender hands over none of, from its file.

    Raises InputError where `sky.panorama.read_panorama` does.
    """
    if not image.packed_file:
        return read_sky(_file(image), raw=image.colorspace_settings.is_data)
    with tempfile.TemporaryDirectory(prefix="skylight-") as folder:
        copy = Path(folder) / "packed.exr"
        copy.write_bytes(image.packed_file.data)
        return read_sky(copy, raw=image.colorspace_settings.is_data)


def state(image: bpy.types.Image) -> tuple[str | int, ...] | None:
    """Return what tells whether an image still has the numbers that it had; None where that cannot
    be told but by them: it was painted, or is no plain file."""
    if image.source != "FILE" or image.type != "IMAGE" or image.packed_file or image.is_dirty:
        return None
    numbers = image.colorspace_settings.name, image.alpha_mode, working_space.name()
    return (image.session_uid, image.name_full, *image.size, *numbers, *_stamp(_file(image)))


def _said(image: bpy.types.Image) -> Said | None:
    """Return what the header of an image's file says; None where there is no file to ask."""
    if image.source != "FILE":
        return None
    try:
        if image.packed_file:
            content = image.packed_file.data
            return read_said(io.BytesIO(content), len(content), image.name)
        path = _file(image)
        size = regular_size(path)
        with path.open("rb") as file:
            return read_said(file, size, image.name)
    except (InputError, OSError):
        return None  # what is wrong with it is said where its pixels are read


def _file(image: bpy.types.Image) -> Path:
    return Path(bpy.path.abspath(image.filepath, library=image.library))
