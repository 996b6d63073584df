"""One bake from geometry to colours, and what of it is kept for another light.

Light first goes round between coarse patches, which tells where it changes fast: there objects are
divided finely, and patches too. Then rays from the points of objects collect it, in passes that are
each whole. Their hits stay in memory, not in the file: opened elsewhere, they are cast anew.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import baked_light
from ...progress import Progress, aside, mapped
from ...transport import feet, left_out
from ...transport.cells import Cells
from ...transport.hits import Space
from ...transport.radiosity import Radiosity
from ..lights import lighting as world_lights
from . import camera_share, fine_mesh, geometry, layout, passes, patches, storage, surroundings
from . import colours as coloured
from .collected import Collected, Shading
from .how import How
from .least_light import LeastLight
from .light import Light, SceneLight
from .receivers import Points, Receivers, Target
from .scene_key import scene_key
from .shelf import Shelf, there


@dataclass
class Session:
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
    left_out: str = ""
    """What less light would be off by, in words."""
    coarse: bool = False
    """Whether light goes round between the first patches: enough for a picture, not for a meter."""
    least: LeastLight | None = None
    """What was enough, where anything less than all was asked for."""

    @property
    def names(self) -> set[str]:
        """Of its objects."""
        return {target.name for target in self.collected.receivers.targets}


_last: list[Session] = []


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
        raw = fine_mesh.evaluated(objects)
        read = yield from geometry.reading()
        shelf.show_old()
        at_first = Progress(0.0, "geometry")
        fines = yield from aside(at_first, fine_mesh.brought, raw)
        lines, plans = layout.begin(list(zip(objects, shelf.bakes, strict=True)), fines)
        if not plans:
            laid_out = set()
            shelf.clear()
            return lines, 0
        around = yield from aside(at_first, geometry.assembled, read)
        found = yield from aside(at_first, surroundings.signatures, around)
        small = layout.SMALL * around.size
        matter = light.matter(around.materials)
        levels, parts, of_parts, triangle, cells = yield from aside(
            at_first, patches.first_cells, around
        )
        space = yield from aside(at_first, Space, cells, matter, slow)
        coarse = Radiosity(space)
        for done in coarse.cast(patches.sent(coarse, 0), alike=True):
            yield Progress(0.15 * done, patches.BETWEEN)
        at = Progress(0.15, patches.BETWEEN)
        yield from aside(at, coarse.solve, light.sky, np.zeros_like(coarse.E))
        bend = np.zeros(len(levels))
        np.maximum.at(bend, triangle, layout.bends(coarse))
        layout.refine(plans, around, bend, levels, how.tolerance)
        shelf.show_new()
        raw = layout.divide(plans)
        own = set(objects)
        others = [obj for obj in bpy.data.objects if obj not in own and storage.is_lit(obj)]
        kept = fine_mesh.evaluated(others)
        shelf.show_old()
        fines = yield from aside(at, fine_mesh.brought, raw)
        targets = yield from mapped(
            layout.lay_out(plans, fines, around, space),
            lambda done: Progress(0.15 + 0.04 * done, "geometry"),
        )
        others_fine = yield from aside(at, fine_mesh.brought, kept)
        shelf.show_new()
        layout.show(plans, targets)
        shelf.show_old()
        targets += _kept_targets(others, others_fine, around)
        receivers = Receivers(targets, around.materials)
        for done in receivers.look(space):
            yield Progress(0.19 + 0.01 * done, "geometry")
        points = f"{len(receivers):,} points"
        each = how.passes(len(receivers))
        # A first light of coarse patches and few rays, and from then on ever better ones.
        collected = Collected(receivers, space)
        session = Session(0, around.origin, around.materials, coarse, collected)
        at = Progress(0.2, points)
        shading = yield from going_round(session, light, at)
        for done, colours in passes.collect(collected, shading, each[:1]):
            if colours is not None:
                before = [colours, collected.seen]
            yield Progress(0.2 + 0.05 * done, points)
        values = yield from aside(at, coloured.of, collected, before[0])
        shelf.show_new()
        coloured.write(values)
        world_lights.show_baked(bpy.context.scene.world)
        laid_out = {plan.obj.name for plan in plans}
        shelf.clear()
        # Others that were baked before now have the light of what stands here too.
        lit = {plan.obj.name_full: plan.bake for plan in plans}
        lit |= {obj.name_full: storage.bake_of(obj) for obj in others}
        surroundings.remember(lit, found)
        yield Progress(0.25, "a first light")
        if how.first_only:
            return lines, len(plans)
        session.coarse = how.coarse
        begun = 0.25
        if not how.coarse:
            # With what lamps light, which is stored nowhere, but sent on from there.
            at, begun = Progress(0.25, patches.BETWEEN), 0.6
            bends = layout.bends(coarse)
            finer = layout.finer(parts, of_parts, bends, how.tolerance, patches.PATCHES[1])
            parts, finer = yield from aside(at, feet.cut, space, parts, finer)
            cells = yield from aside(at, Cells.of, parts, finer, small)
            space = yield from aside(at, Space, cells, matter, slow)
            del coarse, session
            radiosity = Radiosity(space)
            for done in radiosity.cast(patches.sent(radiosity, 1)):
                yield Progress(0.25 + 0.35 * done, patches.BETWEEN)
            collected = Collected(receivers, space)
            session = Session(0, around.origin, around.materials, radiosity, collected)
            at = Progress(0.6, patches.BETWEEN)
            shading = yield from going_round(session, light, at)
            if isinstance(light, SceneLight):
                seen = camera_share.Eye.of(bpy.context.scene, around.origin)
                session.left_out = yield from aside(at, _left_out, radiosity, light, seen)
        speed = slow if count is None else None
        last = before[0]
        for done, colours in passes.collect(collected, shading, each[1:], before, speed, how.sure):
            if colours is not None:
                at = Progress(begun + (1.0 - begun) * done, points)
                coloured.write((yield from aside(at, coloured.of, session.collected, colours)))
                session.noise = float(np.abs(colours - last).sum() / max(colours.sum(), 1e-30))
                last = colours
            yield Progress(begun + (1.0 - begun) * done, points)
        session.key, session.light = scene_key(), light.key(session.materials)
        session.least = how.said(each[-1])
        _last.append(session)
    finally:
        if laid_out is None:
            shelf.give_back()
        else:
            storage.remove(
                obj for obj in there(objects) if obj.name not in laid_out or not storage.is_lit(obj)
            )
    return lines, len(plans)


def relighting(
    objects: Sequence[bpy.types.Object], light: Light
) -> Generator[Progress, None, list[str]]:
    """Light baked objects anew, yielding how far it is; return lines to say.

    Whoever closes it leaves them the light that they had.
    """
    session, lines = yield from recalling(objects, light)
    if session.light == light.key(session.materials):
        return lines
    at = Progress(0.3, patches.BETWEEN)
    yield at
    shading = yield from going_round(session, light, at)
    coloured.write((yield from lighting(session, shading)))
    session.light = light.key(session.materials)
    return lines


def recalling(
    objects: Sequence[bpy.types.Object], light: Light
) -> Generator[Progress, None, tuple[Session, list[str]]]:
    """Return what baked objects are lit anew with, and lines to say: the last bake of them, or
    where that is not in memory, rays cast anew.
    """
    session = _last[0] if _last and _last[0].key == scene_key() else None
    if session is not None and session.names == {obj.name for obj in objects}:
        return session, []
    _last.clear()
    session = yield from _cast_anew(objects, light)
    _last[:] = [session]
    return session, ["the bake's rays are not in memory: they were cast again"]


def lighting(session: Session, shading: Shading) -> Generator[Progress, None, coloured.Values]:
    """Return what objects show in a light that has gone round between surfaces."""
    collected = session.collected
    at = Progress(0.3, f"{len(collected.receivers):,} points")
    if collected.kept is None:
        collected = Collected(collected.receivers, session.radiosity.space)
        each = passes.rays_of(len(collected.receivers))
        for done, _ in passes.collect(collected, shading, each):
            yield replace(at, done=0.3 + 0.65 * done)
        session.collected = collected
    else:
        yield from aside(at, collected.relight, shading)
    at = Progress(0.95, "all light")
    yield at
    colours = yield from aside(at, collected.colours, shading)
    return (yield from aside(at, coloured.of, collected, colours))


def forget() -> None:
    """Forget the last bake, whose objects have another light or another layout now."""
    _last.clear()


def _cast_anew(
    objects: Sequence[bpy.types.Object], light: Light
) -> Generator[Progress, None, Session]:
    """Return what is needed to light objects that were laid out before, of receivers no rays."""
    around = yield from geometry.gathering()
    radiosity = yield from patches.casting(around, light)
    at = Progress(0.3, patches.BETWEEN)
    fines = yield from aside(at, fine_mesh.brought, fine_mesh.evaluated(objects))
    receivers = Receivers(_kept_targets(objects, fines, around), around.materials)
    for _ in receivers.look(radiosity.space):
        yield at
    collected = Collected(receivers, radiosity.space)
    collected.kept = None
    return Session(scene_key(), around.origin, around.materials, radiosity, collected)


def casting(
    light: Light,
) -> Generator[Progress, None, tuple[NDArray, list[str], Radiosity]]:
    """Cast rays between all surfaces of the open scene, without receivers.

    Returns the origin (3,) of the geometry, the full names of its materials, and the patches.
    """
    around = yield from geometry.gathering()
    radiosity = yield from patches.casting_finely(around, light)
    return around.origin, around.materials, radiosity


def remembered(key: int) -> tuple[NDArray, list[str], Radiosity] | None:
    """What `casting` returns, of the last bake; None where it was of another `scene_key`, or its
    patches are `coarse`."""
    if not _last or _last[0].key != key or _last[0].coarse:
        return None
    return _last[0].origin, _last[0].materials, _last[0].radiosity


def going_round(session: Session, light: Light, at: Progress) -> Generator[Progress, None, Shading]:
    """Let a light go round between surfaces; return what makes colours of it."""
    radiosity = session.radiosity
    matter = light.matter(session.materials)
    radiosity.take(matter)
    _, table, tells = yield from patches.going_round(radiosity, light, session.origin, at)
    return (yield from aside(at, Shading.of, light, session.materials, table, tells))


def account() -> str:
    """How much work the last whole bake was, and what it left, in one line; empty before any."""
    if not _last:
        return ""
    collected, noise = _last[0].collected, _last[0].noise
    rays = max(map(len, collected.patterns), default=0)
    points = f"{len(collected.receivers):,} points of up to {rays:,} rays"
    if (least := _last[0].least) is not None:
        return f"{len(collected.receivers):,} points; {least.line}"
    found = f"{points}, noise under {max(100 * noise, 0.1):.1f} %"
    return f"{found}; {_last[0].left_out}" if _last[0].left_out else found


def _left_out(radiosity: Radiosity, light: SceneLight, eye: camera_share.Eye | None) -> str:
    """What less light would be off by in the camera's picture, or everywhere without one."""
    weight = camera_share.weights(radiosity.space, eye)
    return left_out.left_out(radiosity, light.sky, light.to_XYZ, weight).line


def holds(least: LeastLight | None) -> bool:
    """Whether the last bake has as many rays as are enough now, as far as is remembered."""
    own = _last[0].least if _last else None
    if own is None:
        return True
    return least is not None and least.rays <= own.rays and (least.coarse or not own.coarse)


def lit_by() -> tuple[int, int]:
    """What tells the last bake, and the light that it shows, from others; 0 before any."""
    return (_last[0].key, hash(_last[0].light)) if _last else (0, 0)


def is_lit_by(light: Light) -> bool:
    """Whether all that is baked shows this very light, as far as is remembered."""
    return bool(_last) and _last[0].light == light.key(_last[0].materials)


def _kept_targets(
    objects: Sequence[bpy.types.Object],
    fines: Sequence[fine_mesh.Fine | None],
    around: geometry.Geometry,
) -> list[Target]:
    """Objects as they were laid out before; ``fines``: as they are now."""
    targets = []
    for obj, fine in zip(objects, fines, strict=True):
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
