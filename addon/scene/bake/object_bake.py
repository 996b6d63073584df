"""Baking one object: as many points as its light needs, and what each of them sees."""

from __future__ import annotations

from collections.abc import Generator

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import modifiers, sky_bake
from ....node_groups import sky_visibility as names
from ... import tags
from ...sky.harmonics import KEYS
from . import raycast as casting
from . import storage, visibility

MOST = 10_000_000
"""Vertices beyond which an object is not baked."""

FINEST = 300_000
"""Points beyond which an object is not subdivided further."""

START, SMALLEST = 1.0 / 48.0, 1.0 / 2000.0
"""Cells' length, of the scene's size: at first at most so long, for what is smaller may fall
between them unseen; and none is halved that is so short."""

STEEP, SHORT = 0.4, 1.0 / 200.0
"""Cells whose corners differ by more than this part are halved whatever their middle tells, down to
this length of the scene's size: where walls meet, light changes without end."""

DARK = 0.05
"""Light, of an open sky's on level ground, under which errors are relative to that."""

PROBES = np.zeros((16, 5))
"""Harmonics of five skies that tell how light changes: an even one, and ones that are bright in
the east, west, north and south, all with irradiance/pi 1 on open level ground."""
PROBES[0] = 1.0 / 0.28209479177387814
PROBES[3, 1:3] = np.array([0.9, -0.9]) / 0.4886025119029199
PROBES[1, 3:5] = np.array([0.9, -0.9]) / 0.4886025119029199


def is_managed(obj: bpy.types.Object) -> bool:
    """Whether an object, as it is or evaluated, has a managed material."""
    materials = (slot.material for slot in obj.material_slots)
    return any(material is not None and tags.MATERIAL in material for material in materials)


def bake_object(
    obj: bpy.types.Object,
    around: casting.Occluders,
    rays: int,
    tolerance: float,
    slow: bool = False,
) -> Generator[float, None, list[str]]:
    """Bake one object among what stands around it, yielding 0 to 1; return lines to say.

    Points lie on the corners of its faces, which are halved until a cell's middle is within
    `tolerance` of what its corners would tell. A point in something solid (it sees nothing but
    backs of faces) takes what its neighbour sees: the foot of a wall casts no shadow on the floor
    beside it. Without managed faces, or with too many, it ends without a bake.
    """
    kept = storage.ensure(obj)
    modifiers.set_inputs(storage.modifier_of(obj), Faces=0, Near=0.0, Bounce=False)
    storage.write_levels(kept, np.empty(0), np.empty(0))
    fine = evaluated(obj)
    wanted = np.zeros(0, bool) if fine is None else fine.managed
    problem = ""
    if fine is not None and len(fine.places) > MOST:
        problem = f"has over {MOST:,} vertices: bake it in parts"
    elif not wanted.any():
        problem = "has no faces of a spectral material"
    elif abs(np.linalg.det(np.array(obj.matrix_world)[:3, :3])) < 1e-20:
        problem = "is scaled to nothing"
    if problem or fine is None:
        storage.remove(obj)
        return [f'object "{obj.name}" {problem}: not baked']

    lines: list[str] = []
    is_open = _is_open(fine)
    # Cells cannot be told from what the rays themselves leave.
    tolerance = max(tolerance, 3.0 * rays**-0.75)
    levels, split = _first_levels(obj, fine, wanted, around.size)
    known: tuple[NDArray, visibility.Views] | None = None
    for step in range(sky_bake.LEVELS + 1):
        storage.write_levels(kept, levels, split & (levels > 0))
        fine = evaluated(obj)
        assert fine is not None  # it had faces just now
        points = Points(obj, fine, wanted, around.size)
        views = visibility.Views.empty(len(fine.places), rays)
        todo = points.shown.copy()
        if known is not None:
            at = np.minimum(np.searchsorted(known[0], fine.keys), len(known[0]) - 1)
            had = known[0][at] == fine.keys
            views.put(np.flatnonzero(had), known[1].at(at[had]))
            todo &= ~had
        share = 0.7**step
        for done in _look(views, np.flatnonzero(todo), around, points.starts, points.normals, slow):
            yield 1.0 - share * (1.0 - 0.15 * done)
        known = fine.keys, views
        views = _filled(fine, points, views)
        if step == sky_bake.LEVELS:
            break
        spread = _spread(fine, points, views)
        cells = (spread > tolerance) & (points.radius > SMALLEST * around.size)
        middles = np.flatnonzero(cells & (levels[fine.coarse] < sky_bake.LEVELS))
        seen = visibility.Views.empty(len(middles), rays)
        starts, normals = points.middles[middles], points.middle_normals[middles]
        for done in _look(seen, np.arange(len(middles)), around, starts, normals, slow):
            yield 1.0 - share * (1.0 - 0.15 - 0.15 * done)
        told = fine.mean((views.sky @ PROBES)[fine.point])[middles]
        light = seen.sky @ PROBES
        wrong = (np.abs(light - told) / (light + DARK)).max(axis=1) > tolerance
        wrong |= (spread[middles] > STEEP) & (points.radius[middles] > SHORT * around.size)
        raised = np.zeros(len(levels), bool)
        raised[fine.coarse[middles[wrong & ~seen.inside]]] = True
        growth = 3 * np.count_nonzero(raised[fine.coarse])
        if not raised.any():
            break
        if len(fine.places) + growth > FINEST:
            lines.append(f'object "{obj.name}": light changes faster than {FINEST:,} points follow')
            break
        levels = levels + raised
    flag = points.shown * names.mark(obj.matrix_world)
    attributes = _attributes(views, flag)
    split = split & (levels > 0)
    bits = {storage.BITS: views.bits}
    backed = np.zeros(len(flag))
    if is_open:
        behind = visibility.Views.empty(len(flag), rays // 2)
        starts, turned = points.starts_behind, -points.normals
        for done in _look(behind, np.flatnonzero(points.shown), around, starts, turned, slow):
            yield 1.0 - 0.1 * (1.0 - done)
        behind = _filled(fine, points, behind)
        backed = points.shown & ~behind.inside
    if backed.any():
        free = np.maximum(0.5 + 0.5 * points.normals[:, 2], 1e-3)
        back = np.zeros((len(flag), 4), np.float32)
        back[:, 3] = behind.ground / free
        attributes[names.BACK], bits[storage.BEHIND] = back, behind.bits
    normals = np.column_stack([points.normals, backed])
    storage.write(obj, kept, fine, levels, split, attributes, bits, normals)
    yield 1.0
    return lines


class Points:
    """The points of a mesh in the world, and where rays start from them.

    `wanted` (f before subdivision,): the faces that are baked; `size`: the scene's.
    """

    def __init__(self, obj, fine, wanted, size):
        to_world = np.array(obj.matrix_world)
        self.places = fine.places @ to_world[:3, :3].T + to_world[:3, 3]
        normals = fine.normals @ np.linalg.inv(to_world[:3, :3])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self.normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
        self.wanted = wanted[fine.coarse]
        count = len(self.places)
        shown = np.bincount(fine.point, self.wanted[fine.face], count) > 0
        self.shown = shown & (length[:, 0] > 0.0)
        at = self.places[fine.point]
        middles = fine.mean(at)
        inwards = middles[fine.face] - at
        away = np.linalg.norm(inwards, axis=1)
        self.radius = np.maximum.reduceat(away, fine.starts[:-1])
        # A little off the face, for a ray must not meet it, and inwards, where two walls meet.
        lift = np.clip(1e-3 * self.radius, 2e-6 * size, 2e-5 * size)
        inwards *= np.minimum(0.01, 1e-3 * size / np.maximum(away, 1e-30))[:, None]
        # Never into a surface that bends away.
        normals = self.normals[fine.point]
        inwards -= np.minimum((inwards * normals).sum(axis=1), 0.0)[:, None] * normals
        shares = np.bincount(fine.point, minlength=count)
        off = [np.bincount(fine.point, column, count) for column in (*inwards.T, lift[fine.face])]
        off = np.stack(off, axis=1) / np.maximum(shares, 1)[:, None]
        self.starts = self.places + off[:, :3] + off[:, 3:] * self.normals
        self.starts_behind = self.places + off[:, :3] - off[:, 3:] * self.normals
        normal = fine.mean(self.normals[fine.point])
        self.middle_normals = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-9)[:, None]
        self.middles = middles + lift[:, None] * self.middle_normals


def evaluated(obj: bpy.types.Object) -> storage.Fine | None:
    """The faces of an object after its modifiers, ours the last; None without a face."""
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = obj.evaluated_get(depsgraph)
    if obj.type != "MESH":  # a curve or text shows its mesh as an instance of itself
        made = (i.object for i in depsgraph.object_instances if i.object.original == obj)
        shown = next((each for each in made if each.type == "MESH"), None)
    if shown is None or not shown.data.polygons:
        return None
    fine = storage.read(shown.data)
    # Of the evaluated object, for instances that became real bring their materials along.
    materials = [slot.material for slot in shown.material_slots] or [None]
    fine.slots = np.minimum(fine.slots, len(materials) - 1)
    fine.materials = [each.name_full if each else "" for each in materials]
    managed = [each is not None and tags.MATERIAL in each for each in materials]
    fine.managed = np.array(managed)[fine.slots]
    return fine


def _is_open(fine):
    """Whether faces end somewhere, so that their backs may be seen."""
    step = storage.STEP * (float(np.ptp(fine.places, axis=0).max()) or 1.0)
    where = np.round(fine.places / step).astype(np.int64)
    corner = np.unique(where, axis=0, return_inverse=True)[1].reshape(-1)[fine.point]
    last, following = fine.starts[1:] - 1, np.arange(1, len(corner) + 1)
    following[last] = fine.starts[:-1]
    edges = np.sort(np.stack([corner, corner[following]], axis=1), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    return bool((np.unique(edges, axis=0, return_counts=True)[1] == 1).any())


def _first_levels(obj, fine, wanted, size):
    """How often each face must be halved to be no longer than `START`, and which to triangulate.

    Halving goes by the mean of a face's corners, which may lie outside a concave face, and bends
    one that is not plane.
    """
    at = (fine.places @ np.array(obj.matrix_world)[:3, :3].T)[fine.point]
    last, following = fine.starts[1:] - 1, np.arange(1, len(fine.point) + 1)
    following[last] = fine.starts[:-1]
    edge = at[following] - at
    length = np.maximum.reduceat(np.linalg.norm(edge, axis=1), fine.starts[:-1])
    vector = np.add.reduceat(np.cross(at, at[following]), fine.starts[:-1])
    normal = vector / np.maximum(np.linalg.norm(vector, axis=1), 1e-30)[:, None]
    turn = np.empty(len(edge))
    turn[following] = (np.cross(edge, edge[following]) * normal[fine.face]).sum(axis=1)
    off = np.abs(((at - fine.mean(at)[fine.face]) * normal[fine.face]).sum(axis=1))
    concave = np.minimum.reduceat(turn, fine.starts[:-1]) < -1e-6 * length**2
    bent = np.maximum.reduceat(off, fine.starts[:-1]) > 1e-4 * length
    sides = np.diff(fine.starts)
    halvings = np.ceil(np.log2(np.maximum(length / (START * size), 1.0)))
    levels = np.where(wanted, np.minimum(halvings, sky_bake.LEVELS - 2), 0).astype(int)
    return levels, (sides > 4) | ((sides == 4) & (concave | bent))


def _look(views, at, around, starts, normals, slow):
    """Fill in the views of points by their numbers, yielding 0 to 1."""
    rays = 4 * views.bits.shape[1]
    for part, seen in visibility.look(around, starts[at], normals[at], rays, slow):
        views.put(at[part], seen)
        yield min(1.0, part.stop / len(at))


def _filled(fine, points, views):
    """The views where points in something solid have those of a neighbour, two cells far."""
    views = views.at(np.arange(len(points.places)))
    last = fine.starts[1:] - 1
    following = np.arange(1, len(fine.point) + 1)
    following[last] = fine.starts[:-1]
    one, other = fine.point, fine.point[following]
    one, other = np.concatenate([one, other]), np.concatenate([other, one])
    for _ in range(2):
        pairs = np.flatnonzero(views.inside[one] & ~views.inside[other] & points.shown[other])
        taken = views.at(other[pairs])
        views.put(one[pairs], taken)
    return views


def _spread(fine, points, views):
    """By which part the light on the corners of each cell (f,) differs."""
    light = (views.sky @ PROBES)[fine.point]
    high = np.maximum.reduceat(light, fine.starts[:-1], axis=0)
    low = np.minimum.reduceat(light, fine.starts[:-1], axis=0)
    return points.wanted * ((high - low) / (high + DARK)).max(axis=1)


def _attributes(views, flag):
    """The five colours (p, 4) of each point, as `node_groups.sky_visibility` reads them."""
    values = np.zeros((5, len(flag), 4), np.float32)
    for index, key in enumerate(KEYS):
        number, channel = names.PLACES[key]
        values[number, :, channel] = views.sky[:, index]
    for (number, channel), column in ((names.GROUND, views.ground), (names.BAKED, flag)):
        values[number, :, channel] = column
    return {names.attribute(number): each for number, each in enumerate(values)}
