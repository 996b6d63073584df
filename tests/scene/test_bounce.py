"""One bounce against the light of a wall summed up over its area."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress, tags
from spectral_skylight.addon.scene.bake import interreflection, scene_bake, storage
from spectral_skylight.node_groups import modifiers, sky_visibility
from spectral_skylight.tests import faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]

WALL = 4.0  # high, and as long on either side of the middle


def shown(name, places):
    """An object of one quad with a managed material of the same name."""
    material = bpy.data.materials.new(name)
    material[tags.MATERIAL] = {"id": "test"}
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(places, [], [(0, 1, 2, 3)])
    mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


@pytest.fixture(scope="module")
def corner():
    """A floor (x > 0) before a wall at x = 0 that faces it, and a far post; baked, with a sun."""
    faces.empty_scene()
    floor = shown("Floor", [(0, -6, 0), (6, -6, 0), (6, 6, 0), (0, 6, 0)])
    wall = shown("Wall", [(0, -WALL, 0), (0, WALL, 0), (0, WALL, WALL), (0, -WALL, WALL)])
    shown("Post", [(6, 0.5, 0), (6, -0.5, 0), (6, -0.5, 1), (6, 0.5, 1)])
    progress.run(scene_bake.bake(rays=1024))
    work, steps = interreflection.bounce(sun=np.array([1.0, 0.0, 1.0]), rays=1024), []
    neighbours = progress.run(work, steps.append)
    return floor, wall, steps, neighbours


def stored(obj, place):
    """A channel of the bake's points, and where they are."""
    bake_object = storage.bake_of(obj)
    points = storage.points_of(obj)
    values = storage.read_attribute(bake_object, sky_visibility.attribute(place[0]), points)
    places = np.empty(3 * len(bake_object.data.vertices), np.float32)
    bake_object.data.vertices.foreach_get("co", places)
    return values[:, place[1]], places.reshape(-1, 3)[:points]


def from_wall(place, light):
    """Irradiance / pi on level ground from a wall of this radiance, summed up over its area."""
    steps = 400
    side = ((np.arange(2 * steps) + 0.5) / steps - 1.0) * WALL
    height = (np.arange(steps) + 0.5) / steps * WALL
    y, z = np.meshgrid(side, height, indexing="ij")
    way = np.stack([np.broadcast_to(-place[0], y.shape), y - place[1], z], axis=-1)
    squared = (way**2).sum(axis=-1)
    return light * (z * place[0] / squared**2).sum() / np.pi * (WALL / steps) ** 2


def test_the_floor_gets_the_walls_light(corner):
    floor, *_ = corner
    even, places = stored(floor, sky_visibility.BOUNCES[0][0, 0])
    sun, _ = stored(floor, sky_visibility.BOUNCE_SUN[0])
    # A wall sees half of an even sky, less what the post takes (1 %); the sun of [1, 0, 1] comes
    # at 45 degrees.
    chosen = np.flatnonzero((places[:, 0] > 0.3) & (places[:, 0] < 5) & (np.abs(places[:, 1]) < 4))
    for index in chosen[:: len(chosen) // 20]:
        expected = from_wall(places[index].astype(float), 0.5)
        # 1024 rays, of which a tenth meet the wall: some 3 %, and the walls' own 1 %.
        assert even[index] / 0.28209479 == pytest.approx(expected, rel=0.05, abs=0.002)
        assert sun[index] == pytest.approx(expected / 0.5 * 0.5**0.5, rel=0.05, abs=0.003)


def test_neighbours_by_the_light_they_send(corner):
    *_, steps, found = corner
    assert found["Floor"].first == "Wall"
    assert found["Floor"].others == {"Post": pytest.approx(1.0)}
    assert found["Wall"].first == "Floor"
    assert interreflection.neighbours() == found
    assert np.all(np.diff(steps) > -1e-9)
    assert steps[-1] <= 1.0


def test_the_object_shows_the_bounce_and_its_flag(corner):
    floor, *_ = corner
    mesh = floor.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert {sky_visibility.attribute(number) for number in range(10)} <= set(mesh.attributes.keys())
    assert modifiers.get_input(storage.modifier_of(floor), "Bounce")
    flag, _ = stored(floor, sky_visibility.BAKED)
    assert np.all(flag >= 1.0)
    assert scene_bake.stale() == []


def test_a_sun_that_has_moved_makes_it_stale(corner):
    at = np.array([1.0, 0.0, 1.0])
    assert not interreflection.is_stale(2.0 * at)
    # 1 and 6 degrees away: a few minutes, and half an hour.
    assert not interreflection.is_stale(at + np.array([0.0, 0.025, 0.0]))
    assert interreflection.is_stale(at + np.array([0.0, 0.15, 0.0]))
    assert interreflection.is_stale(None)
    list(interreflection.bounce(sun=None, rays=32))
    assert not interreflection.is_stale(None) and interreflection.is_stale(at)
