"""One bake from geometry to colours, and what of it is kept for another light.

Light first goes round between coarse patches, which tells where it changes fast: there objects are
divided finely, and patches too. Then rays from the points of objects collect it, in passes that are
each whole. Their hits stay in memory, not in the file: opened elsewhere, they are cast anew.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import baked_light
from ...progress import Progress
from ...transport.cells import Cells, levels_for, pieces
from ...transport.hits import Space
from ...transport.radiosity import Radiosity
from . import geometry, layout, passes, storage, surroundings
from .collected import Collected, Shading
from .light import Light
from .receivers import Points, Receivers, Target, filled
from .shelf import Shelf, there

PATCHES = 20_000, 60_000
"""At most so many at first and at last, where a scene has no more triangles."""

SENT = 64, 128
"""Rays from each side of a patch, at first and at last, at most …"""

ALL_SENT = 4e6, 1.6e7
"""… and from all of them; but at least `LEAST_SENT` from each."""

LEAST_SENT = 16

FIRST = 64
"""Rays from points for a first light, where users say how many at last."""


@dataclass
class _Session:
    """What another light can be cast on without a ray."""

    key: int
    origin: NDArray
    """(3,), to which the geometry's places are relative."""
    materials: list[str]
    radiosity: Radiosity
    collected: Collected
    light: bytes = b""
    """`Light.key` of the one that it was lit by last."""
    noise: float = 0.0
    """By which part the last pass of rays has changed the light, in the mean: less is left."""

    @property
    def names(self) -> set[str]:
        """Of its objects."""
        return {target.name for target in self.collected.receivers.targets}


@dataclass(frozen=True)
class How:
    """How to bake: see `scene_bake.bake`; ``first_only``: no more than a first light."""

    rays: int | None
    tolerance: float
    slow: bool
    first_only: bool = False


_last: list[_Session] = []


def baking(
    objects: Sequence[bpy.types.Object],
    light: Light,
    how: How,
) -> Generator[Progress, None, tuple[list[str], int]]:
    """Lay out and light objects; return lines to say and how many are baked."""
    count, slow = how.rays, how.slow
    _last.clear()
    yield Progress(0.0, "geometry")
    shelf = Shelf(objects)
    laid_out: set[str] | None = None
    try:
        lines, plans = layout.begin(list(zip(objects, shelf.bakes, strict=True)))
        if not plans:
            laid_out = set()
            shelf.clear()
            return lines, 0
        around = geometry.gather(bpy.context.evaluated_depsgraph_get())
        found = surroundings.signatures(around)
        surfaces = around.surfaces
        matter = light.matter(around.materials)
        shelf.show_old()
        levels = levels_for(
            surfaces, layout.START * around.size, PATCHES[0], layout.SMALL * around.size
        )
        parts, of_parts, triangle = pieces(surfaces, levels)
        space = Space(Cells.of(parts, of_parts, layout.SMALL * around.size), matter, slow)
        coarse = Radiosity(space)
        for done in coarse.cast(_sent(coarse, 0), alike=True):
            yield Progress(0.2 * done, "light between surfaces")
        coarse.solve(light.sky, np.zeros_like(coarse.E))
        bend = np.zeros(len(levels))
        np.maximum.at(bend, triangle, layout.bends(coarse))
        layout.refine(plans, around, bend, levels, how.tolerance)
        shelf.show_new()
        targets = layout.lay_out(plans, around, space)
        own = set(objects)
        others = [obj for obj in bpy.data.objects if obj not in own and storage.is_lit(obj)]
        targets += _kept_targets(others, around)
        shelf.show_old()
        receivers = Receivers(targets, around.materials, space)
        points = f"{len(receivers):,} points"
        each = passes.rays_of(len(receivers), slow) if count is None else [FIRST, count]
        # A first light of coarse patches and few rays, and from then on ever better ones.
        collected = Collected(receivers, space)
        session = _Session(0, around.origin, around.materials, coarse, collected)
        shading = _shading(session, light)
        for done, _ in passes.collect(collected, shading, each[:1]):
            yield Progress(0.2 + 0.05 * done, points)
        before = passes.found(collected, shading)
        shelf.show_new()
        _write(session, before[0])
        laid_out = {plan.obj.name for plan in plans}
        shelf.clear()
        # Others that were baked before now have the light of what stands here too.
        lit = {plan.obj.name_full: plan.bake for plan in plans}
        lit |= {obj.name_full: storage.bake_of(obj) for obj in others}
        surroundings.remember(lit, found)
        yield Progress(0.25, "a first light")
        if how.first_only:
            return lines, len(plans)
        # With what lamps light, which is stored nowhere, but sent on from there.
        finer = layout.finer(parts, of_parts, layout.bends(coarse), how.tolerance, PATCHES[1])
        space = Space(Cells.of(parts, finer, layout.SMALL * around.size), matter, slow)
        del coarse, session
        radiosity = Radiosity(space)
        for done in radiosity.cast(_sent(radiosity, 1)):
            yield Progress(0.25 + 0.35 * done, "light between surfaces")
        collected = Collected(receivers, space)
        session = _Session(0, around.origin, around.materials, radiosity, collected)
        shading = _shading(session, light)
        speed = slow if count is None else None
        last = before[0]
        for done, colours in passes.collect(collected, shading, each[1:], before, speed):
            if colours is not None:
                _write(session, colours)
                session.noise = float(np.abs(colours - last).sum() / max(colours.sum(), 1e-30))
                last = colours
            yield Progress(0.6 + 0.4 * done, points)
        session.key, session.light = scene_key(), light.key(session.materials)
        _last.append(session)
    finally:
        if laid_out is None:
            shelf.give_back()
        else:
            storage.remove(
                obj for obj in there(objects) if obj.name not in laid_out or not storage.is_lit(obj)
            )
    return lines, len(plans)


def _sent(radiosity: Radiosity, stage: int) -> int:
    """How many rays go from each side of a patch, a power of 2."""
    each = ALL_SENT[stage] / max(len(radiosity.patch), 1)
    return int(np.clip(2 ** np.floor(np.log2(max(each, 1.0))), LEAST_SENT, SENT[stage]))


def relighting(
    objects: Sequence[bpy.types.Object], light: Light
) -> Generator[Progress, None, list[str]]:
    """Light baked objects anew, yielding how far it is; return lines to say.

    Whoever closes it leaves them the light that they had.
    """
    lines: list[str] = []
    session = _last[0] if _last and _last[0].key == scene_key() else None
    if session is None or session.names != {obj.name for obj in objects}:
        _last.clear()
        session = yield from _cast_anew(objects, light)
        lines.append("the bake's rays are not in memory: they were cast again")
    elif session.light == light.key(session.materials):
        return lines
    yield Progress(0.3, "light between surfaces")
    shading, collected = _shading(session, light), session.collected
    if collected.kept is None:
        collected = Collected(collected.receivers, session.radiosity.space)
        each = passes.rays_of(len(collected.receivers))
        for done, _ in passes.collect(collected, shading, each):
            yield Progress(0.3 + 0.65 * done, f"{len(collected.receivers):,} points")
        session.collected = collected
    else:
        collected.relight(shading)
    yield Progress(0.95, "all light")
    _write(session, collected.colours(shading))
    session.light = light.key(session.materials)
    _last[:] = [session]
    return lines


def _cast_anew(
    objects: Sequence[bpy.types.Object], light: Light
) -> Generator[Progress, None, _Session]:
    """Return what is needed to light objects that were laid out before, of receivers no rays."""
    around = geometry.gather(bpy.context.evaluated_depsgraph_get())
    radiosity = yield from _cast_between(around, light)
    receivers = Receivers(_kept_targets(objects, around), around.materials, radiosity.space)
    collected = Collected(receivers, radiosity.space)
    collected.kept = None
    return _Session(scene_key(), around.origin, around.materials, radiosity, collected)


def casting(
    light: Light,
) -> Generator[Progress, None, tuple[NDArray, list[str], Radiosity]]:
    """Cast rays between all surfaces of the open scene, without receivers.

    Returns the origin (3,) of the geometry, the full names of its materials, and the patches.
    """
    around = geometry.gather(bpy.context.evaluated_depsgraph_get())
    radiosity = yield from _cast_between(around, light)
    return around.origin, around.materials, radiosity


def remembered(key: int) -> tuple[NDArray, list[str], Radiosity] | None:
    """What `casting` returns, of the last bake; None where it was of another `scene_key`."""
    if not _last or _last[0].key != key:
        return None
    return _last[0].origin, _last[0].materials, _last[0].radiosity


def _cast_between(around: geometry.Geometry, light: Light) -> Generator[Progress, None, Radiosity]:
    """Return the patches of what stands in a scene, with their rays cast."""
    surfaces = around.surfaces
    levels = levels_for(
        surfaces, layout.START * around.size, PATCHES[1], layout.SMALL * around.size
    )
    cells = Cells.of(surfaces, levels, layout.SMALL * around.size)
    radiosity = Radiosity(Space(cells, light.matter(around.materials)))
    for done in radiosity.cast(_sent(radiosity, 1)):
        yield Progress(0.3 * done, "light between surfaces")
    return radiosity


def _shading(session: _Session, light: Light) -> Shading:
    """What makes colours of a light that has gone round."""
    radiosity = session.radiosity
    matter = light.matter(session.materials)
    radiosity.take(matter)
    lamps = [lamp.seen_from(session.origin) for lamp in light.lamps]
    table, tells, _ = radiosity.solve(light.sky, radiosity.lit_by(lamps))
    return Shading.of(light, session.materials, table, tells)


def account() -> str:
    """How much work the last whole bake was, and what it left, in one line; empty before any."""
    if not _last:
        return ""
    collected, noise = _last[0].collected, _last[0].noise
    rays = max(map(len, collected.patterns), default=0)
    points = f"{len(collected.receivers):,} points of up to {rays:,} rays"
    return f"{points}, noise under {max(100 * noise, 0.1):.1f} %"


def lit_by() -> tuple[int, int]:
    """What tells the last bake, and the light that it shows, from others; 0 before any."""
    return (_last[0].key, hash(_last[0].light)) if _last else (0, 0)


def is_lit_by(light: Light) -> bool:
    """Whether all that is baked shows this very light, as far as is remembered."""
    return bool(_last) and _last[0].light == light.key(_last[0].materials)


def _write(session: _Session, colours: NDArray[np.float32]) -> None:
    """Leave on all objects their colours."""
    told = session.collected.told
    objects = {obj.name: obj for obj in bpy.data.objects if obj.library is None}
    for target in session.collected.receivers.targets:
        obj = objects[target.name]
        bake = storage.bake_of(obj)
        assert bake is not None  # else it is no target
        for side, name in ((1.0, baked_light.LIGHT), (-1.0, baked_light.BEHIND)):
            points, numbers = target.numbers[side]
            if side < 0 and not target.backs.any():
                continue
            values = np.zeros((len(target.fine.places), 4), np.float32)
            share = np.zeros(len(values))
            values[points, :3], share[points] = colours[numbers], told[numbers]
            values[points, 3] = baked_light.FLAG
            values[len(values) - len(target.fine.twin_of) :, 3] = baked_light.FLAG
            values[:, :3] = filled(target.fine, values[:, :3], share)
            storage.write_attribute(bake, name, values)
        bake.data.update()
        bake.update_tag()
        obj.update_tag()


def _kept_targets(objects: Sequence[bpy.types.Object], around: geometry.Geometry) -> list[Target]:
    """Objects as they were laid out before."""
    if not objects:
        return []
    targets = []
    for obj, fine in zip(objects, storage.evaluated(objects), strict=True):
        bake = storage.bake_of(obj)
        if fine is None or bake is None:
            continue
        fine = storage.as_baked(fine, bake)
        if fine is None:
            continue  # no longer the mesh that was baked
        points = Points(obj, fine, around.origin, around.size)
        backs = np.full(len(fine.places), baked_light.BEHIND in bake.data.attributes)
        targets.append(Target(obj.name, fine, points, backs))
    return targets


def scene_key() -> int:
    """What stands in the scene, in one number: another place or mesh is another."""
    parts = []
    bpy.context.view_layer.update()
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        mesh = instance.object.data
        if instance.object.type == "MESH" and mesh is not None:
            place = tuple(round(value, 6) for row in instance.matrix_world for value in row)
            slots = [s.material.name_full for s in instance.object.material_slots if s.material]
            parts.append((instance.object.name, place, _shape(mesh), *slots))
    return hash(tuple(sorted(parts)))


def _shape(mesh: bpy.types.Mesh) -> int:
    """What a mesh's vertices are, in one number."""
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    return hash(places.tobytes())
