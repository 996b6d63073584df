"""How much of the sky geometry hides, against form factors that are known."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.bake import placed_meshes
from spectral_skylight.addon.scene.bake.sky_exposure import ground_below, hidden_share

pytestmark = pytest.mark.blender

CHANCE = 0.04
"""Of 4,096 rays from 64 places: a standard error of some 0.015."""


@pytest.fixture
def floor():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.data.materials.new("Floor")


def box(corners, faces, name, material=None):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    if material:
        mesh.materials.append(material)
    shown = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(shown)
    return shown


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


def square(material):
    """One large face: places lie all over it."""
    return box(SQUARE, [(0, 1, 2, 3)], "Floor", material)


def walls():
    top = [(x, y, 1) for x, y, _ in SQUARE]
    return box(SQUARE + top, [(k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4)], "Walls")


def test_an_open_floor_sees_the_whole_sky(floor):
    square(floor)
    assert hidden_share(bpy.context.scene, [floor]) == 0.0


def test_a_courtyard_as_deep_as_wide(floor):
    """Opposite faces of a cube exchange 0.1998 of their light (J. R. Howell, form factor C-11)."""
    square(floor)
    walls()
    assert hidden_share(bpy.context.scene, [floor]) == pytest.approx(1 - 0.1998, abs=CHANCE)


def test_turned_scaled_and_instanced(floor):
    """The courtyard ten times as large, mirrored and turned, as an instance of a collection."""
    square(floor)
    walls()
    group = bpy.data.collections.new("Courtyard")
    for shown in list(bpy.context.scene.collection.objects):
        bpy.context.scene.collection.objects.unlink(shown)
        group.objects.link(shown)
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", group
    empty.scale, empty.rotation_euler, empty.location = (-10, 10, 10), (0, 0, 0.6), (3, 4, 5)
    bpy.context.scene.collection.objects.link(empty)
    assert hidden_share(bpy.context.scene, [floor]) == pytest.approx(1 - 0.1998, abs=CHANCE)


def test_rays_meet_what_blender_says_they_meet(floor):
    """Against Blender's own ray casts: turned, mirrored, stretched and instanced, 3,000 rays."""
    rng = np.random.default_rng(3)
    scene = bpy.context.scene
    cube = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    group = bpy.data.collections.new("Group")
    for k in range(3):
        part = box(cube, sides, f"Part {k}", floor)
        part.location.x = 3.0 * k
        scene.collection.objects.unlink(part)
        group.objects.link(part)
    for k in range(60):
        if k % 2:
            shown = box(cube, sides, "Cube", floor)
        else:
            shown = bpy.data.objects.new("Instance", None)
            shown.instance_type, shown.instance_collection = "COLLECTION", group
            scene.collection.objects.link(shown)
        shown.location, shown.rotation_euler = rng.uniform(-30, 30, 3), rng.uniform(0, 7, 3)
        shown.scale = rng.uniform(0.3, 2.0, 3) * rng.choice([-1, 1], 3)
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    around = placed_meshes.gather(depsgraph)
    assert len(around.starts) == 34 and len(around.mesh) == 120  # each mesh is held once
    starts, ways = rng.uniform(-30, 30, (3000, 3)), rng.standard_normal((3000, 3))
    place, triangle = around.first_hits(starts, ways)
    wanted = [
        scene.ray_cast(depsgraph, a, b)[:3]
        for a, b in zip(starts.tolist(), ways.tolist(), strict=True)
    ]
    hit = np.array([each[0] for each in wanted])
    assert 300 < hit.sum() < 2900
    np.testing.assert_array_equal(place >= 0, hit)
    for k in np.flatnonzero(hit):
        matrix = around.matrices[place[k]]
        a, b, c = around.triangles[triangle[k]] @ matrix[:3, :3].T + matrix[:3, 3]
        normal = np.cross(b - a, c - a)
        far = (a - starts[k]) @ normal / (ways[k] @ normal)
        np.testing.assert_allclose(starts[k] + far * ways[k], wanted[k][1], atol=1e-3)
    square = around.areas(np.ones(len(around.triangles), bool))
    for k in range(0, 120, 7):  # the area at a place is that of its triangles there
        matrix = around.matrices[k]
        corners = around.triangles[around.of(k)] @ matrix[:3, :3].T + matrix[:3, 3]
        own = np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        assert square[k] == pytest.approx(own.sum() / 2)
        np.testing.assert_allclose(np.linalg.norm(around.normals(k), axis=1), own / 2)


def test_nothing_around_and_nothing_there(floor):
    around = placed_meshes.gather(bpy.context.evaluated_depsgraph_get())
    assert [hit.tolist() for hit in around.first_hits(np.zeros((1, 3)), np.ones((1, 3)))] == [
        [-1],
        [-1],
    ]
    assert ground_below(bpy.context.scene, [floor]) == (False, None)
    for corner in ([0, 0, 0], [0, 0, 9]):
        box(np.add(SQUARE, corner).tolist(), [(0, 1, 2, 3)], "Level", floor)
    around = placed_meshes.gather(bpy.context.evaluated_depsgraph_get())
    none = np.empty((0, 3))
    assert [len(hit) for hit in around.first_hits(none, none)] == [0, 0]


def test_what_lies_below(floor):
    """Walls over a lawn, of which a tenth stands beside it: the lawn's; over nothing: none."""
    lawn = bpy.data.materials.new("Lawn")
    box([(x, y, 0) for x, y in ((-5, -5), (5, -5), (5, 5), (-5, 5))], [(0, 1, 2, 3)], "Lawn", lawn)
    corners = [(x, y, z + 1) for x, y, z in SQUARE] + [(x, y, 2) for x, y, _ in SQUARE]
    house = box(
        corners, [(k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4)], "House", floor
    )
    assert ground_below(bpy.context.scene, [floor]) == (True, lawn)
    house.location.x = 40.0
    bpy.context.view_layer.update()
    assert ground_below(bpy.context.scene, [floor]) == (False, None)


def test_only_faces_of_the_material_count_and_none_is_none(floor):
    square(floor)
    assert hidden_share(bpy.context.scene, [bpy.data.materials.new("Other")]) is None
    assert hidden_share(bpy.context.scene, []) is None
