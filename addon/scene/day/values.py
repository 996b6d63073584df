"""Values of the blend file that follow the sun: gathered at key skies, and driven between them.

Whatever writing the light of a key sky changes is gathered afterwards, so this knows nothing of
what materials hold. A driver reads the sun's elevation and its curve says what belongs to that:
plain drivers, which play in a file without the add-on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import light_probe, skylight_surface
from ... import tags
from ..lights import sun_lamp
from .curves import slopes

SAME = 1e-6
"""Of its largest, by which a value that changes less is taken to stand still."""


@dataclass(frozen=True)
class Place:
    """One number of a node tree: of what, where, and which axis of it, -1 of a plain number.

    ``kind`` and ``name``: which tree it is, see `_tree_of`: by the part that it plays, for what a
    key sky lacks is made anew under another name; ``light``: whether it grows with the
    light and is thus divided by its level; ``sun``: 1 of what a material makes of the sun's RGB, -1
    of that, 0 of anything else.
    """

    kind: str
    name: str
    path: str
    axis: int
    light: bool
    sun: int = 0


def gather(
    world: bpy.types.World, scenes: Iterable[bpy.types.Scene], materials: Iterable
) -> dict[Place, float]:
    """Return all numbers that writing a light may change, as they are now."""
    found: dict[Place, float] = {}
    for material in materials:
        own = [node for node in material.node_tree.nodes if tags.NODE in node]
        found |= _numbers("materials", material.name, material.node_tree, own, False)
    surface = skylight_surface.find(world)
    names = (skylight_surface.SKY, skylight_surface.GROUND, skylight_surface.PROBE)
    for name in names if surface else ():
        tree = skylight_surface.part(surface, name)
        if tree is not None:
            own = [node for node in tree.nodes if _holds_light(node)]
            found |= _numbers("parts", name, tree, own, True)
    for scene in scenes:
        lamp = sun_lamp.find(scene, sun_lamp.SUN)
        if lamp is not None:
            tree = lamp.data.node_tree
            own = [node for node in tree.nodes if node.type == "EMISSION"]
            found |= _numbers("suns", scene.name, tree, own, True)
    return found


def _holds_light(node: bpy.types.Node) -> bool:
    """Whether a node of a World's groups holds light, and no constant of the shader."""
    probe = light_probe.SUN, light_probe.GREEN, light_probe.BLUE
    return node.name in probe or node.name.startswith(("x", "row "))


def _numbers(
    kind: str, name: str, tree: bpy.types.NodeTree, nodes: Iterable[bpy.types.Node], light: bool
) -> dict[Place, float]:
    data = tree.animation_data
    moving = {curve.data_path for curve in data.drivers} if data else set()
    found = {}
    for node in nodes:
        for socket in node.inputs:
            if socket.is_linked or socket.type not in ("VALUE", "VECTOR", "RGBA"):
                continue
            path = socket.path_from_id("default_value")
            if path in moving:
                continue
            if socket.type == "VALUE":
                found[Place(kind, name, path, -1, light)] = float(socket.default_value)
                continue
            sun = int(not light and socket.name.split()[-1] == light_probe.SUN)
            if kind == "suns" or node.name == light_probe.SUN:
                sun = -1
            for axis, part in enumerate(socket.default_value[:3]):
                found[Place(kind, name, path, axis, light, sun)] = float(part)
    return found


def drive_all(
    world: bpy.types.World,
    elevations: Sequence[float],
    levels: Sequence[float],
    evens: NDArray[np.float64],
    gathered: Sequence[Mapping[Place, float]],
) -> int:
    """Let all that differs between key skies follow the sun; return how many numbers do.

    Of light that is missing at a key sky there is none. ``levels`` (n,) and ``evens`` (n, 3) as
    `moments.Moment` has them.
    """
    count = 0
    for place in dict.fromkeys(place for each in gathered for place in each):
        missing = 0.0 if place.light else np.nan
        numbers = _held(np.array([each.get(place, missing) for each in gathered]))
        if np.ptp(numbers) <= SAME * np.abs(numbers).max():
            continue  # of the shader itself, or of what no sky changes
        scale = evens[:, max(place.axis, 0)] ** place.sun
        if place.light:
            scale = scale / np.asarray(levels)
        numbers = numbers * scale
        rise = slopes(np.asarray(elevations), numbers)
        drive(_tree_of(world, place), place.path, place.axis, world, elevations, numbers, rise)
        count += 1
    return count


def _tree_of(world: bpy.types.World, place: Place) -> bpy.types.NodeTree:
    """The node tree of a place: of ``materials`` by name, the World's ``parts`` by theirs, and of
    the lamps of ``suns`` by their scene's."""
    if place.kind == "materials":
        return bpy.data.materials[place.name].node_tree
    if place.kind == "parts":
        return skylight_surface.part(skylight_surface.find(world), place.name)
    sun = sun_lamp.find(bpy.data.scenes[place.name], sun_lamp.SUN)
    assert sun is not None  # its place was written with it
    return sun.data.node_tree


def _held(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Numbers with those that are missing as the nearest that is there."""
    there = np.flatnonzero(np.isfinite(values))
    if not len(there) or len(there) == len(values):
        return values
    nearest = np.abs(np.arange(len(values))[:, None] - there).argmin(axis=1)
    return values[there[nearest]]


def drive(
    owner: bpy.types.bpy_struct,
    path: str,
    axis: int,
    world: bpy.types.World,
    elevations: Sequence[float] | NDArray[np.float64],
    values: Sequence[float] | NDArray[np.float64],
    rise: NDArray[np.float64] | None = None,
) -> None:
    """Let a number be ``values`` (n,) at these elevations [degrees], ascending, of a World's sun.

    Between them it goes straight, or as its slopes ``rise`` (n,) say; beyond them it stays.
    """
    owner.driver_remove(path, axis)
    curve = owner.driver_add(path, axis)
    curve.driver.type = "AVERAGE"  # of one value: no expression that Blender might refuse to run
    target = curve.driver.variables.new().targets[0]
    target.id_type, target.id = "WORLD", world
    target.data_path = ELEVATION
    for modifier in list(curve.modifiers):
        curve.modifiers.remove(modifier)
    write_keys(curve, elevations, values, rise)


def write_keys(
    curve: bpy.types.FCurve,
    x: Sequence[float] | NDArray[np.float64],
    y: Sequence[float] | NDArray[np.float64],
    rise: NDArray[np.float64] | None = None,
) -> None:
    """Give a curve these keys (n,), straight between, or with slopes ``rise`` (n,) as cubics."""
    points = curve.keyframe_points
    points.clear()
    points.add(len(x))
    points.foreach_set("co", np.stack([x, y], axis=1).ravel())
    curve.extrapolation = "CONSTANT"
    kind = "LINEAR" if rise is None else "BEZIER"
    number = type(points[0]).bl_rna.properties["interpolation"].enum_items[kind].value
    points.foreach_set("interpolation", np.full(len(x), number, np.uint8))
    if rise is not None:
        free = type(points[0]).bl_rna.properties["handle_left_type"].enum_items["FREE"].value
        widths = np.diff(np.asarray(x, float)) / 3.0
        for side, step in (
            ("left", -np.concatenate([widths[:1], widths])),
            ("right", np.concatenate([widths, widths[-1:]])),
        ):
            points.foreach_set(f"handle_{side}_type", np.full(len(x), free, np.uint8))
            handles = np.stack([np.asarray(x) + step, np.asarray(y) + step * rise], axis=1)
            points.foreach_set(f"handle_{side}", handles.ravel())
    curve.update()


ELEVATION = f'["{tags.SUN_ELEVATION}"]'
"""The data path, from a World, of its sun's elevation."""


def release(world: bpy.types.World) -> None:
    """Take away all drivers that follow a World's sun."""
    for owner in _animated():
        data = owner.animation_data
        for curve in [c for c in data.drivers if _follows(c, world)]:
            data.drivers.remove(curve)


def _follows(curve: bpy.types.FCurve, world: bpy.types.World) -> bool:
    targets = (target for v in curve.driver.variables for target in v.targets)
    return any(t.id == world and t.data_path == ELEVATION for t in targets)


def _animated() -> Iterator[bpy.types.ID]:
    """All of this file's data-blocks and trees that have drivers."""
    holders = (*bpy.data.materials, *bpy.data.worlds, *bpy.data.lights)
    trees = [one.node_tree for one in holders if one.node_tree]
    for each in (*trees, *bpy.data.node_groups, *bpy.data.worlds, *bpy.data.objects):
        if each.animation_data and each.animation_data.drivers and each.library is None:
            yield each
