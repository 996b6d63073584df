"""An asset library of reflectances: materials with swatches for previews, sorted into catalogues.

A material among them shows its colour under D65 until it is made spectral; what it was measured as
it brings along.
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Generator, Sequence
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...progress import Progress
from ...spectra.working_spaces import rec709_to_working, srgb
from ...whole_files import write_text
from ..blend_data import nodes, working_space
from .whole_blend import writing_blend

SIZE = 32
"""Side of a preview [pixels]: two areas of one colour, for hundreds of materials."""

CATALOGUES = "blender_assets.cats.txt"

_HEAD = "# This is an Asset Catalog Definition file for Blender.\nVERSION 1\n"
_IDS = uuid.UUID("2c5c1f0a-6a0e-5c0b-9a63-5b7f3f2a8c11")  # of ours, so that ids are always the same


def write(
    folder: Path,
    names: Sequence[str],
    kinds: Sequence[str],
    sources: Sequence[str],
    colours: tuple[NDArray[np.float64], NDArray[np.float64]],
    measured: Callable[[bpy.types.Material, int], None],
) -> Generator[Progress, None, Path]:
    """Write ``reflectances.blend`` and its catalogues into a folder, yielding how far it is.

    ``colours``: scene-linear, under the sky and under D65, (m, 3) each, the previews' halves;
    ``measured``: gives a material what it was measured as, by its number. The open file is as it
    was before, also where the work is ended. Raises InputError for a folder that is none or cannot
    be written to.
    """
    if not folder.is_dir():
        raise InputError(folder, "is not a folder", "choose one")
    made: list[bpy.types.Material] = []
    paths = [source.replace(":", " ") for source in sources]
    try:
        for number, name in enumerate(names):
            if number % 16 == 0:
                yield Progress(number / len(names), name)
            material = bpy.data.materials.new(name)
            made.append(material)
            _dress(material, [half[number] for half in colours])
            measured(material, number)
            material.asset_mark()
            material.asset_data.description = " · ".join(
                word for word in (kinds[number], sources[number]) if word
            )
            material.asset_data.catalog_id = str(uuid.uuid5(_IDS, paths[number]))
            for word in {word for word in kinds[number].split(", ") if word}:
                material.asset_data.tags.new(word)
        path = folder / "reflectances.blend"
        with writing_blend(path) as part:
            bpy.data.libraries.write(str(part), set(made), fake_user=True)
        _catalogues(folder / CATALOGUES, paths)
        return path
    finally:
        bpy.data.batch_remove(made)


def _dress(material: bpy.types.Material, halves: Sequence[NDArray[np.float64]]) -> None:
    """Give a material its base colour and a preview of two halves."""
    nodes.use(material)
    red, green, blue = np.clip(halves[1], 0.0, 1.0).tolist()
    shader = material.node_tree.nodes.get("Principled BSDF")
    if shader is not None:
        shader.inputs["Base Color"].default_value = (red, green, blue, 1.0)
    material.diffuse_color = (red, green, blue, 1.0)
    pixels = np.ones((SIZE, SIZE, 4), np.float32)
    to_rec709 = np.linalg.inv(rec709_to_working(working_space.name())).T
    for start, half in zip((0, SIZE // 2), halves, strict=True):
        pixels[:, start : start + SIZE // 2, :3] = srgb(half @ to_rec709)
    preview = material.preview_ensure()
    preview.image_size = (SIZE, SIZE)
    preview.image_pixels_float.foreach_set(pixels.ravel())


def _catalogues(path: Path, paths: Sequence[str]) -> None:
    """Add what is missing to the folder's catalogues; what others wrote there stays."""
    try:
        text = path.read_text(encoding="utf-8") if path.exists() else _HEAD
    except UnicodeDecodeError:
        raise InputError(path, "is not UTF-8 text", "save it as UTF-8") from None
    known = {line.partition(":")[0] for line in text.splitlines()}
    for source in dict.fromkeys(paths):
        number = str(uuid.uuid5(_IDS, source))
        if number not in known:
            text = f"{text.rstrip()}\n{number}:Reflectances/{source}:{source.replace('/', '-')}\n"
    write_text(path, text)
