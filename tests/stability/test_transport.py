"""Light between surfaces: what breaks it.

Referees are closed forms: a room whose walls shine by 1 and reflect rho has 1 / (1 - rho)
everywhere, under an even sky of 1 nothing is brighter than 1, and what a lamp sends is taken up.
"""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene.bake import geometry, scene_bake, storage
from spectral_skylight.addon.scene.bake.light import Light
from spectral_skylight.addon.transport import extent, feet
from spectral_skylight.addon.transport.cells import Cells, Surfaces, levels_for
from spectral_skylight.addon.transport.hits import Space
from spectral_skylight.addon.transport.radiosity import Radiosity
from spectral_skylight.node_groups import baked_light
from spectral_skylight.tests import buildings, faces
from spectral_skylight.tests.lanes import newest
from spectral_skylight.tests.transport.rooms import (
    DARK,
    SKY,
    WHITE,
    box,
    fronts,
    light,
    matter,
    radiosity,
    solved,
)

ASLANT = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
ASLANT *= np.sign(np.linalg.det(ASLANT))
"""A rotation: no wall is along an axis, where float32 is kinder."""


def square(half, z=0.0):
    """Two triangles that look up."""
    a, b, c, d = [(x * half, y * half, z) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.array([(a, b, c), (a, c, d)], float)


def escaping(found):
    """Which part of the rays from fronts meets nothing."""
    rows = found.hits.rows[: found.space.cells.patches]
    return ((rows >= found.space.sky) & (rows < found.space.lost)).mean()


def test_corners_do_not_leak(keep):
    """200,000 rays from all over a closed room, aslant: none finds a way out between triangles."""
    room = radiosity(box(inwards=True) @ ASLANT.T, matter([0.5]), solid=False, cells=3000)
    assert escaping(room) == 0.0
    solved(room, WHITE)
    assert light(room).max() == 0.0
    keep(
        "a closed room in a bright sky, aslant",
        f"none of {room.hits.rows.size:,} rays leaves it at edges or corners",
        "nothing to do: rays start inwards of edges, and triangles are met without gaps",
    )


@pytest.mark.parametrize("thickness", [1e-2, 1e-6])
def test_a_thin_wall_does_not_leak(thickness, keep):
    """A wall across a room with light in one half: rays do not pass it, but a floor cell that lies
    on both sides has one light, and leaks as much as the part of the floor in such cells. None
    does once they are cut at its foot."""
    # It stands a little into floor, walls and ceiling.
    wall = box(1.0) * [thickness, 2.2, 2.2] + [0.137, 0.0, 0.0]
    corners, kinds = np.concatenate([box(inwards=True), wall]) @ ASLANT.T, np.repeat([0, 1], 12)

    def leak(surfaces, levels):
        room = Radiosity(Space(Cells.of(surfaces, levels), matter([0.5, 0.5])))
        for _ in room.cast(64):
            pass
        kind, middle, _, areas = fronts(room)
        along = (middle @ ASLANT)[:, 0]
        room.emission[: len(along)][along < -0.999] = 1.0
        solved(room)
        bright, dark = (kind == 0) & (along < 0.0), (kind == 0) & (along > 0.45)
        leaks = light(room)[dark].mean() / light(room)[bright].mean()
        assert leaks < np.sqrt(areas[bright].mean()) / 2.0  # of 2, as part of the floor: half
        return leaks, room

    leaks, cut = [], []
    for cells in (500, 2000):
        none = np.zeros(len(corners), np.int32)
        surfaces = Surfaces(corners, kinds.astype(np.int32), none == 0, none)
        levels = levels_for(surfaces, 0.01, cells)
        leaked, room = leak(surfaces, levels)
        leaks.append(leaked)
        parts, finer = feet.cut(room.space, surfaces, levels)
        whole, now = (np.bincount(each.kind, each.lengths**2) for each in (surfaces, parts))
        np.testing.assert_allclose(now, whole)
        cut.append(leak(parts, finer)[0])
    assert leaks == sorted(leaks, reverse=True)
    # No ray of 100,000 passes it; 1 mm of a cell lies within the wall.
    assert max(cut) < 1e-4
    said = " and ".join(f"{100 * each:.1g}" for each in leaks)
    keep(
        f"a wall {1000 * thickness:g} mm thick across a room 2 m wide, light on one side",
        f"the dark side has under 0.01 % of the bright side's light; {said} % with 500 and 2,000 "
        "cells that are not cut",
        "cuts patches by the planes of what stands on them, where both sides are seen",
    )


def test_coplanar_faces(keep):
    """Two floors in one plane: both have the sky's light, and what they send is that of either."""
    block = np.add(box(1.0), [0.0, 0.0, 2.5])
    kinds, solid = np.repeat([0, 1, 2], [2, 2, 12]), np.arange(16) >= 4

    def found(gap):
        corners = np.concatenate([square(1.0), square(1.0, gap), block])
        both = radiosity(corners, matter([0.2, 0.8, 0.5]), kinds, solid, cells=1000, rays=128)
        solved(both, SKY)
        kind, _, normal, _ = fronts(both)
        under = (kind == 2) & (normal[:, 2] < -0.9)
        return [light(both)[some].mean() for some in (kind == 0, kind == 1, under)]

    (lower, upper, sent), (hidden, above, of_upper) = found(0.0), found(1e-4)
    assert lower == pytest.approx(upper, rel=0.01)
    assert upper == pytest.approx(above, rel=0.01)
    assert hidden < 1e-3  # a face 0.1 mm below another is under it, and dark
    assert of_upper / 4.0 < sent < of_upper
    keep(
        "two faces in one plane, of reflectance 0.2 and 0.8",
        f"both have the sky's light to 1 %; they send {sent / of_upper:.2f} of what the light one "
        "alone sends",
        "nothing: which of the two is met is chance, as in Eevee and Cycles",
    )


def test_tiny_and_gigantic_scenes(keep):
    """One room from 1 mm to 10 km, and a room of 2 m somewhere in a scene of 10 km."""
    for size in (1e-3, 1.0, 1e4):
        room = radiosity(size / 2.0 * box(inwards=True) @ ASLANT.T, matter([0.8], 1.0), cells=500)
        np.testing.assert_allclose(solved(room)[: room.space.cells.patches], 5.0, rtol=2e-3)
    leaks = {}
    for size in (1e4, 1e5):
        far = 0.01 * square(1.0)
        ends = [far - size / 2.0, far + size / 2.0]
        room = box(inwards=True) @ ASLANT.T + [0.4 * size, 0.4 * size, 0.0]
        corners = np.concatenate([room, *ends])
        corners -= extent.middle(corners)
        found = radiosity(corners, matter([0.5]), solid=False, cells=600, rays=64)
        solved(found, WHITE)
        leaks[size] = light(found)[np.arange(len(light(found))) < len(light(found)) - 4].max()
    assert leaks[1e4] == leaks[1e5] == 0.0
    keep(
        "scenes of 1 mm, 1 m and 10 km; a closed room 2 m wide 56 km off the middle of one of 100 "
        "km",
        "exact to 0.2 % and dark to the last ray",
        "positions count from where most of a scene is, and rays start over a face by 2 millionths "
        "of the way from there",
    )


def test_a_house_in_a_wide_field(keep):
    """A room with an open side on a field of 10 km has the light that it has on one of 100 m whose
    cells are as fine all over: the house, not the field, says how fine cells are."""
    room = box(4.0)
    room = room[~np.all(room[..., 1] < -1.99, axis=1)]
    shell = np.concatenate([room[:, ::-1], 1.1 * room])

    def floor(corners, size, most, rays):
        none = np.zeros(len(corners), np.int32)
        surfaces = Surfaces(corners, none, none > 0, none, size)
        cells = Cells.of(surfaces, levels_for(surfaces, size / 48.0, most, size / 300.0))
        place = Radiosity(Space(cells, matter([0.5])))
        for _ in place.cast(rays):
            pass
        solved(place, SKY)
        _, middle, normal, areas = fronts(place)
        own = (np.abs(middle[:, 2] + 2.0) < 1e-3) & (normal[:, 2] > 0.9)
        return np.average(light(place)[own], weights=areas[own]), own.sum()

    near, many = floor(np.concatenate([shell, square(50.0, -2.3)]), 24.0, 40_000, 16)
    corners = np.concatenate([shell, square(5000.0, -2.3)])
    size = extent.scale(corners)
    parts, number = extent.graded(corners, size)
    whole, cut = (
        np.linalg.norm(np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]), axis=1)
        for c in (corners, parts)
    )
    np.testing.assert_allclose(np.bincount(number, cut), whole)
    far, some = floor(parts, size, 10_000, 64)
    assert far == pytest.approx(near, rel=0.01)  # what lies beyond 50 m sends less than 1 %
    assert some > many / 8
    keep(
        "a room with an open side on a field of 10 km",
        f"the floor has {far / near:.3f} of the light that it has on even cells of 80 cm",
        "takes the scale of what stands on the field, and cuts the field the finer the nearer; its "
        "own light is as fine as its faces and 128 cells along each allow",
    )


def test_reflectances_of_0_and_1(keep):
    """White furnaces: 1 under an even sky whatever reflects, 1 / (1 - rho) in a closed room."""
    boxes = [np.add(box(), [x, y, 1.0]) for x in (-2.0, 2.0) for y in (-3.0, 0.0, 3.0)]
    street = np.concatenate([*boxes, square(9.0)])
    for rho in (0.0, 1.0):
        found = radiosity(street, matter([rho]), cells=1500, rays=64)
        solved(found, WHITE)
        seen = light(found)
        assert seen.max() <= 1.0 + 1e-4
        # What stands on the ground hides some of it; all else has all of the light, or a part.
        lit = seen[seen > 1e-3]
        assert len(lit) > 0.8 * len(seen)
        assert not rho or lit.min() > 0.99
    for rho, sweeps in ((0.0, 1), (0.5, 5), (0.96, 5), (0.99, 5)):
        room = radiosity(box(inwards=True), matter([rho], 1.0), cells=300, rays=64)
        table, _, count = room.solve(DARK, run(room.lit_by([])))
        shown = table[: room.space.cells.patches]
        np.testing.assert_allclose(shown, 1.0 / (1.0 - rho), rtol=1e-3)
        assert count <= sweeps
    # There is no answer: light that goes round for ever.
    room = radiosity(box(inwards=True), matter([1.0], 1.0), cells=300, rays=64)
    table, _, _ = room.solve(DARK, run(room.lit_by([])))
    assert 100.0 < table.max() < 1000.0
    keep(
        "reflectances of 0 and 1 under an even sky; 0.99 in a closed room that shines",
        "1 to 0.01 %; 1 / (1 - 0.99) to 0.1 % after 3 sweeps",
        "scales each sweep until as much light comes as is lost; reflectance 1 in a closed room, "
        "which has no answer, ends after 200 sweeps",
    )


@newest
@pytest.mark.blender
@pytest.mark.slow
def test_normals_inside_out(keep):
    """A house whose faces look inwards is no house that one may look into: what it hides and
    sends is the same."""
    made = []
    for inwards in (False, True):
        faces.empty_scene()
        house = buildings.box("House", (0, 0, 1.001), (2, 2, 2), buildings.material())
        buildings.ground(9, house.data.materials[0])
        if inwards:
            house.data.flip_normals()
        around = progress.run(geometry.gathering())
        own = around.of("House")
        assert around.solid[own].all() == (not inwards)
        kinds = np.zeros(len(around.corners), np.int32)
        found = radiosity(around.corners, matter([0.5]), kinds, around.solid, cells=3000, rays=64)
        solved(found, SKY)
        _, middle, normal, _ = fronts(found)
        away = np.abs(middle[:, :2]).max(axis=1)
        made.append(light(found)[(normal[:, 2] > 0.9) & (away > 1.2) & (away < 2.0)].mean())
    right, turned = made
    assert turned == pytest.approx(right, rel=0.01)
    keep(
        "a house with its normals inside out",
        f"the ground beside it has {turned:.3f} of the sky's light, {right:.3f} with them right",
        "takes its faces for sheets with two sides, each with its own light",
    )


@newest
@pytest.mark.blender
@pytest.mark.slow
def test_a_moved_object_and_a_bake_of_another_version(keep):
    faces.empty_scene()
    made_of = buildings.material()
    house, ground = buildings.box("House", (0, 0, 1), (2, 2, 2), made_of), None
    ground = buildings.ground(4, made_of)
    progress.run(scene_bake.bake(rays=16, tolerance=1.0, light=Light()))
    assert scene_bake.stale() == []
    before = _lit(house).mean()
    house.location.x += 1.0
    assert set(scene_bake.stale()) == {house, ground}
    was = _at(ground, (1.7, 0.0))
    progress.run(scene_bake.bake(rays=16, tolerance=1.0, light=Light()))
    now = _at(ground, (1.7, 0.0))
    # Where the house stands now nothing is seen of the sky; the house itself has what it had.
    assert was > 0.4 > 0.1 > now
    assert _lit(house).mean() == pytest.approx(before, rel=0.05)
    keep(
        "a house moved by half its width after the bake",
        f"the ground under it keeps {was:.2f} of the sky's light, {now:.2f} is right",
        "says that it and all that it may light are out of date; in Blender's window bakes again",
    )
    bake = storage.bake_of(house)
    bake.data.attributes.remove(bake.data.attributes[baked_light.LIGHT])
    assert scene_bake.stale() == [house] and not storage.is_lit(house)
    lines = progress.run(scene_bake.relighting(Light()))
    assert "1 bake(s) of an earlier version hold no bounced light: bake again" in lines
    keep(
        "a bake of an earlier version, without light",
        "the open sky's light: as much too bright as the sky is hidden",
        "says so and bakes it again when all light is asked for",
    )


def _lit(obj):
    """The light on all corners of an object's mesh as it is shown, (c,)."""
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return buildings.colours(shown.data, baked_light.LIGHT)[:, 0]


def _at(obj, place):
    """The light at the corner that is nearest to a place."""
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    at = np.array([shown.vertices[loop.vertex_index].co[:2] for loop in shown.loops])
    return _lit(obj)[np.argmin(((at - place) ** 2).sum(axis=1))]
