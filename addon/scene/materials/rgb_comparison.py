"""RGB times RGB beside our numbers, for a look at what changes: one shader with other values.

Each material keeps for sockets of ours the value that multiplying RGB by RGB would give; while that
or the difference shows, it keeps ours. No tree changes, so nothing is compiled, and both ways are
blend data: saved, undone and copied with the material. Whatever makes materials spectral shows our
numbers again.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import skylight_surface, spectral_matrix
from ... import tags
from ...transfer.prediction import rgb_albedo
from ..blend_data import kept
from ..lights.lighting import Lights

SPECTRAL, RGB, DIFFERENCE = 0, 1, 2
"""What materials show: our numbers, RGB times RGB, or where ours differ from it, exaggerated."""

TIMES = 8.0
"""How many times the difference is shown. Sockets are linear in the picture: so is this."""

Values = Mapping[tuple[str, str], Any]
"""By a node's role and an input's name, the value (3 or 4)."""


def surface(found: Lights, rho: NDArray[np.float64]) -> Values:
    """What RGB times RGB gives to the inputs of a surface of a reflectance (81,)."""
    rgb = rgb_albedo(rho, found.transfer.space)
    inputs: dict[str, Any] = {**_rows(rgb, found), **_lit(rgb, found)}
    tint = _tints(rgb[None], found, rho)[0]
    inputs[skylight_surface.TINT] = tint
    # Traced light is multiplied by both.
    inputs[skylight_surface.COLOR] = rgb / np.where(np.abs(tint) < 1e-6, 1.0, tint)
    return {("surface", key): value for key, value in inputs.items()}


def texture(found: Lights, reflectances: NDArray[np.float64], rho: NDArray[np.float64]) -> Values:
    """What RGB times RGB gives to the inputs of a texture's three reflectances (3, 81).

    ``rho`` (81,): the material's own.
    """
    values = {}
    colours = rgb_albedo(reflectances, found.transfer.space)
    tints = _tints(colours, found, rho)
    for channel, rgb, tint in zip(("Red", "Green", "Blue"), colours, tints, strict=True):
        given = {**_rows(rgb, found), **_lit(rgb, found), skylight_surface.TINT: tint}
        for key, value in given.items():
            values["texture", f"{channel} {key}"] = value
    return values


def keep(material: bpy.types.Material, values: Values) -> None:
    """Keep with a material the values that RGB times RGB gives; others that were kept stay."""
    given = _kept(material)
    for (role, name), value in values.items():
        given[f"{role}/{name}"] = [float(part) for part in value]
    material[tags.COMPARISON] = json.dumps(given)


def show(what: int) -> int:
    """Let the file's materials show `SPECTRAL`, `RGB` or `DIFFERENCE`; count what changed.

    Linked materials stay as they are.
    """
    found = [
        m
        for m in bpy.data.materials
        if tags.COMPARISON in m and shown_by(m) != what and m.is_editable
    ]
    for material in found:
        _change(material, what)
    return len(found)


def shown_by(material: bpy.types.Material) -> int:
    """What a material shows now."""
    return int(material.get(tags.SHOWS_RGB, SPECTRAL))


def shown_now() -> list[bpy.types.Material]:
    """The materials of the file that do not show our numbers now."""
    return [material for material in bpy.data.materials if tags.SHOWS_RGB in material]


def matrices(
    material: bpy.types.Material, shown: list[list[float]]
) -> tuple[list[list[float]], list[list[float]] | None]:
    """Our matrix of a material and the one that RGB times RGB amounts to, whichever is ``shown``.

    The second is None where an earlier version made the material.
    """
    given = _kept(material)
    rows = [given.get(f"surface/{row}", []) for row in spectral_matrix.ROWS]
    if not all(len(row) == 3 for row in rows):
        return shown, None
    ours, rgb = _both(np.array(shown), np.array(rows), shown_by(material))
    return ours.tolist(), rgb.tolist()


def _kept(material: bpy.types.Material) -> dict[str, list[float]]:
    found: dict[str, list[float]] = kept.plain(material, tags.COMPARISON, {})
    return {key: value for key, value in found.items() if kept.are_numbers(value)}


def _both(now: NDArray, other: NDArray, shows: int) -> tuple[NDArray, NDArray]:
    """Our value and that of RGB times RGB, from what a socket has now and what is kept of it."""
    if shows == SPECTRAL:
        return now, other
    return other, now if shows == RGB else (TIMES * other - now) / (TIMES - 1.0)


def _change(material: bpy.types.Material, what: int) -> None:
    given, before = _kept(material), shown_by(material)
    for role, socket in _sockets(material):
        key = f"{role}/{socket.name}"
        if key in given and len(given[key]) == len(now := list(socket.default_value)):
            ours, rgb = _both(np.array(now), np.array(given[key]), before)
            shown = {SPECTRAL: ours, RGB: rgb, DIFFERENCE: rgb + TIMES * (ours - rgb)}
            socket.default_value = shown[what]
            given[key] = (rgb if what == SPECTRAL else ours).tolist()
    material[tags.COMPARISON] = json.dumps(given)
    if what == SPECTRAL:
        del material[tags.SHOWS_RGB]
    else:
        material[tags.SHOWS_RGB] = what


def _sockets(material: bpy.types.Material) -> Iterator[tuple[str, bpy.types.NodeSocket]]:
    for node in material.node_tree.nodes if tags.MATERIAL in material else ():
        for socket in node.inputs if tags.NODE in node else ():
            yield node[tags.NODE], socket


def _rows(rgb: NDArray[np.float64], found: Lights) -> dict[str, Sequence[float]]:
    return dict(zip(spectral_matrix.ROWS, np.diag(rgb) @ found.transfer.to_working, strict=True))


def _lit(rgb: NDArray[np.float64], found: Lights) -> dict[str, Sequence[float]]:
    """Of each light what a white surface reflects of it, times the colour."""
    return {name: rgb * white for name, white in found.reflected(np.ones(81)).items()}


def _tints(
    rgb: NDArray[np.float64], found: Lights, rho: NDArray[np.float64]
) -> NDArray[np.float64]:
    """By what baked light is multiplied to be as under the open sky by RGB (m, 3), (m, 3)."""
    return found.tint(rgb * found.under_sky(found.transfer.to_working), rho)
