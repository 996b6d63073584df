"""By how much a bake makes a file larger, and a town's bakes grow with it."""

import bpy
import pytest

from spectral_skylight.addon import progress, tags
from spectral_skylight.addon.scene.bake import scene_bake, storage
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import box, ground, material

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def test_a_file_grows_by_a_hundred_bytes_a_cell(tmp_path):
    """Uncompressed, with the node groups and all that a bake brings along."""
    faces.empty_scene()
    made_of = material()
    ground(15, made_of)
    for n, (x, y) in enumerate(((-4, 0), (4, 0), (0, -4), (0, 4))):
        box(f"Wall {n}", (x, y, 2), (1 + abs(y) * 2, 1 + abs(x) * 2, 4), made_of)

    def size():
        path = tmp_path / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False, copy=True)
        return path.stat().st_size

    before = size()
    progress.run(scene_bake.bake(rays=64))
    cells = sum(len(storage.bake_of(obj).data.polygons) for obj in scene_bake.baked())
    assert cells > 10_000
    assert size() - before < 100 * cells


def test_what_stands_around_is_kept_once_for_all():
    """Not with each object, which takes its square; and again with what is baked later."""
    faces.empty_scene()
    made_of = material()
    boxes = [box(f"Box {n}", (4 * n, 0, 1), (1, 1, 2), made_of) for n in range(6)]
    progress.run(scene_bake.bake(rays=16))
    records = {storage.bake_of(obj)[tags.SEEN] for obj in boxes}
    assert len(records) == 1
    boxes[0].location.y += 0.5
    bpy.context.view_layer.update()
    assert set(scene_bake.stale()) == set(boxes)
    progress.run(scene_bake.bake([boxes[0]], rays=16, changed_only=False))
    assert scene_bake.stale() == []
    assert scene_bake.remove() == len(boxes)
    assert not [mesh for mesh in bpy.data.meshes if tags.SEEN_NAMES in mesh]
