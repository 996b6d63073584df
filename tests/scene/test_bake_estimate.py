"""How long a bake will take, told before it starts."""

import bpy
import pytest

from spectral_skylight.addon.scene.bake import scene_bake
from spectral_skylight.addon.scene.bake.estimate import estimate
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import box, ground, material

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def test_the_time_is_told_before_any_work():
    """Of more rays more, the first light before all; and shown as the first step."""
    faces.empty_scene()
    made_of = material()
    ground(10, made_of)
    boxes = [box(f"Box {n}", (4 * n, 0, 1), (1, 1, 2), made_of) for n in range(3)]
    few, more = estimate(boxes, 64), estimate(boxes, 1024)
    assert 0.0 < few.first < few.all < more.all
    bpy.context.view_layer.update()
    work = scene_bake.bake(rays=256)
    told = next(work)
    assert told.done == 0.0 and told.line.startswith("about ")
    assert scene_bake.baked() == []  # nothing has been done yet
    work.close()
    assert scene_bake.baked() == []
