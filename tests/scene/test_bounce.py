"""Light that has bounced against the light of a wall summed up over its area."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress, tags
from spectral_skylight.addon.scene.bake import scene_bake
from spectral_skylight.addon.scene.bake.light import Light
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.lamps import Direct
from spectral_skylight.node_groups import baked_light
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import colours

pytestmark = [pytest.mark.blender, pytest.mark.slow]

WALL = 4.0  # high, and as long on either side of the middle
REFLECTED = {"Wall": 0.5}


class Walls(Light):
    """An even sky, or a sun that is not seen, on a wall that reflects half before a black floor."""

    def __init__(self, *lamps):
        self.lamps = lamps

    @property
    def sky(self):
        return super().sky * (not self.lamps)

    def matter(self, names):
        found = super().matter(names)
        found.reflectance[:] = np.array([REFLECTED.get(name, 0.0) for name in names])[:, None]
        return found

    def mix(self, name):
        return super().mix(name) * 0.0  # what has bounced alone


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


EVEN = np.ones(COUNT, np.float32)
SUN = Direct(None, np.array([1, 0, 1]) / 2**0.5, EVEN)
LAMP = Direct(np.array([1.0, -1.0, 3.0]), np.array([0.0, 0.0, -1.0]), EVEN)


def lit_by_lamp(y, z):
    """Radiance of the wall, which reflects half, by `LAMP`: cosine by the distance's square."""
    across, along, up = LAMP.place
    return 0.5 * across / (across**2 + (y - along) ** 2 + (z - up) ** 2) ** 1.5


def from_wall(place, light):
    """Irradiance / pi on level ground from a wall of this radiance, summed up over its area."""
    steps = 400
    side = ((np.arange(2 * steps) + 0.5) / steps - 1.0) * WALL
    height = (np.arange(steps) + 0.5) / steps * WALL
    y, z = np.meshgrid(side, height, indexing="ij")
    way = np.stack([np.broadcast_to(-place[0], y.shape), y - place[1], z], axis=-1)
    squared = (way**2).sum(axis=-1)
    light = light(y, z) if callable(light) else light
    return (light * z * place[0] / squared**2).sum() / np.pi * (WALL / steps) ** 2


def test_the_floor_gets_the_walls_light():
    """A floor (x > 0) before a wall at x = 0 that faces it: of the sky's half, of a sun's, and of a
    lamp's, which stands where it stands though the scene's middle is elsewhere."""
    faces.empty_scene()
    floor = shown("Floor", [(0, -6, 0), (6, -6, 0), (6, 6, 0), (0, 6, 0)])
    shown("Wall", [(0, -WALL, 0), (0, WALL, 0), (0, WALL, WALL), (0, -WALL, WALL)])
    progress.run(scene_bake.bake(light=Walls(), rays=1024))
    lit = ((), 0.5 * 0.5), ((SUN,), 0.5 * 0.5**0.5), ((LAMP,), lit_by_lamp)
    for lamps, light in lit:
        assert progress.run(scene_bake.relighting(Walls(*lamps))) == []
        mesh = floor.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        values = colours(mesh, baked_light.LIGHT)[:, 0]
        at = np.array([mesh.vertices[loop.vertex_index].co for loop in mesh.loops])
        chosen = np.flatnonzero((at[:, 0] > 0.3) & (at[:, 0] < 5) & (np.abs(at[:, 1]) < 4))
        assert len(chosen) > 20
        for index in chosen[:: len(chosen) // 20]:
            # 1024 rays, of which a tenth meet the wall: some 3 %.
            expected = from_wall(at[index], light)
            assert values[index] == pytest.approx(expected, rel=0.05, abs=0.002)
