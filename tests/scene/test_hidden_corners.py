"""The foot of a wall below the floor: its darkness is not shown above."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress
from spectral_skylight.addon.scene.bake import scene_bake, session
from spectral_skylight.addon.scene.bake.light import Light
from spectral_skylight.node_groups import baked_light
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import colours, material, shown

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def light_of_cells(obj):
    """Height of each cell's middle, and what its corners have, (f, 4) and flags."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    values = colours(mesh, baked_light.LIGHT)
    middle = np.array([face.center.z for face in mesh.polygons])
    loops = np.array([list(face.loop_indices) for face in mesh.polygons])
    return middle, values[loops, 0], values[:, 3]


def test_the_foot_of_a_wall_takes_its_light_from_above_the_floor():
    """An upright wall sees half of an even sky, whatever lies under the sheet that it goes into.
    The same after the rays are forgotten."""
    faces.empty_scene()
    made_of = material()
    wall = shown(
        "Wall", [(0, -3, -0.25), (0, 3, -0.25), (0, 3, 3), (0, -3, 3)], [range(4)], made_of
    )
    shown("Floor", [(0, -6, 0), (6, -6, 0), (6, 6, 0), (0, 6, 0)], [range(4)], made_of)
    progress.run(scene_bake.bake(light=Light(), rays=256))
    for forget in (False, True):
        if forget:
            session._last.clear()
            assert progress.run(scene_bake.relighting(Light()))
        height, light, flags = light_of_cells(wall)
        assert (flags == baked_light.FLAG).all()
        above = light[height > 0.0]
        assert len(above) > 100
        np.testing.assert_allclose(above, 0.5, atol=0.02)
        # The floor's other side is the dark that the foot stands in.
        assert light[height < 0.0].max(initial=0.0) < 0.25
