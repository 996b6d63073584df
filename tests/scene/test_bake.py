"""What becomes of a bake: made, stale, edited, taken away, saved."""

import json

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress
from spectral_skylight.addon.scene.bake import scene_bake, storage
from spectral_skylight.node_groups import baked_light, sky_bake
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import (
    as_bytes,
    box,
    flags,
    ground,
    material,
    sky_share,
)

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def test_a_bake_is_gone_without_a_trace_and_never_touches_the_mesh():
    faces.empty_scene()
    made_of = material()
    obj = box("Wall", (0, 0, 1), (2, 2, 2), made_of)
    ground(5, made_of)
    before = as_bytes(obj.data), as_json()
    progress.run(scene_bake.bake(rays=64))
    assert as_bytes(obj.data) == before[0]
    assert len(scene_bake.baked()) == 2
    assert scene_bake.remove() == 2
    assert (as_bytes(obj.data), as_json()) == before


def as_json():
    kinds = ("objects", "meshes", "node_groups", "materials")
    names = {kind: sorted(each.name for each in getattr(bpy.data, kind)) for kind in kinds}
    modifiers = [m.name for obj in bpy.data.objects for m in obj.modifiers]
    return json.dumps([names, modifiers])


def test_stale_after_a_move_and_only_what_it_concerns():
    faces.empty_scene()
    made_of = material()
    near = [box(f"Near {n}", (4 * n, 0, 1), (1, 1, 2), made_of) for n in range(2)]
    far = box("Far", (3000, 0, 1), (1, 1, 2), made_of)
    assert set(scene_bake.stale()) == {*near, far}
    progress.run(scene_bake.bake(rays=64))
    assert scene_bake.stale() == []
    near[0].location.y += 0.01
    assert set(scene_bake.stale()) == set(near)
    # Only what changed is baked again, and then nothing is.
    assert progress.run(scene_bake.bake(rays=64)) == ["2 object(s) baked"]
    assert progress.run(scene_bake.bake(rays=64)) == ["0 object(s) baked"]
    # What is hidden hides no sky.
    near[0].hide_render = True
    assert scene_bake.stale() == [near[1]]


def test_cancelling_keeps_the_last_whole_light():
    """Before there is one it leaves no trace; after the first pass all is lit, and not stale."""
    faces.empty_scene()
    made_of = material()
    boxes = [box(f"Box {n}", (4 * n, 0, 1), (1, 1, 2), made_of) for n in range(2)]
    work = scene_bake.bake(rays=64)
    next(work)
    work.close()
    assert all(storage.modifier_of(obj) is None for obj in boxes)
    assert scene_bake.baked() == []
    work = scene_bake.bake(rays=64)
    done = []
    for step in work:
        done.append(step)
        if step.line == "a first light":
            break
    work.close()
    assert scene_bake.baked() == boxes
    assert scene_bake.stale() == []
    assert [p.done for p in done] == sorted(p.done for p in done)
    for obj in boxes:
        share, normals = sky_share(obj)
        assert share[normals[:, 2] > 0.9].mean() == pytest.approx(1.0, abs=0.02)


def light_of(obj):
    """What an object shows: its bake's name, and a copy of the light in it."""
    bake = storage.bake_of(obj)
    light = bake.data.attributes[baked_light.LIGHT].data
    values = np.empty(4 * len(light), np.float32)
    light.foreach_get("color", values)
    return bake.name, values.tobytes()


def test_until_new_light_is_there_the_last_one_shows():
    """While rays are cast, when it is stopped, and when what is baked is deleted meanwhile."""
    faces.empty_scene()
    made_of = material()
    boxes = [box(f"Box {n}", (4 * n, 0, 1), (1, 1, 2), made_of) for n in range(2)]
    progress.run(scene_bake.bake(rays=64))
    before, names = [light_of(obj) for obj in boxes], as_json()
    boxes[0].location.x += 1.5
    work = scene_bake.bake(rays=64)
    waits = 0
    for step in work:
        if step.line == "a first light":
            break
        assert [light_of(obj) for obj in boxes] == before
        waits += 1
    assert waits > 2
    assert all(light_of(obj)[1] != old[1] for obj, old in zip(boxes, before, strict=True))
    work.close()
    assert len(scene_bake.baked()) == 2 and as_json() == names

    before, names = [light_of(obj) for obj in boxes], as_json()
    boxes[1].location.x += 0.5
    work = scene_bake.bake(rays=64)
    for _ in range(3):
        next(work)
    work.close()
    assert [light_of(obj) for obj in boxes] == before and as_json() == names
    work = scene_bake.bake(rays=64)
    for _ in range(3):
        next(work)
    bpy.data.objects.remove(boxes[0])
    work.close()
    assert light_of(boxes[1]) == before[1]


def test_an_edited_mesh_falls_back_to_the_open_sky_where_it_was_edited():
    faces.empty_scene()
    obj = box("Wall", (0, 0, 1), (2, 2, 2), material())
    progress.run(scene_bake.bake(rays=64))
    assert np.all(flags(obj))
    obj.data.vertices[7].co.z += 0.1
    obj.data.update()
    moved = flags(obj)
    assert 0.0 < moved.mean() < 1.0
    obj.data.vertices[7].co.z -= 0.1
    obj.data.update()
    assert np.all(flags(obj))
    obj.modifiers.new("More", "ARRAY")  # ours stays the last: other corners, no flag
    assert obj.modifiers[-1].node_group[groups.KIND] == sky_bake.KIND
    assert not np.any(flags(obj))


def test_a_bake_survives_saving_purging_and_loading(tmp_path):
    faces.empty_scene()
    obj = box("Wall", (0, 0, 1), (2, 2, 2), material())
    progress.run(scene_bake.bake(rays=64))
    values, _ = sky_share(obj)
    bpy.ops.outliner.orphans_purge(do_recursive=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "baked.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "baked.blend"))
    obj = bpy.data.objects["Wall"]
    assert np.all(flags(obj))
    np.testing.assert_array_equal(sky_share(obj)[0], values)
    assert scene_bake.stale() == []
    # A copy shares the bake until it gets its own; taking that away leaves the first one's.
    twin = obj.copy()
    twin.location.x = 5.0
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.update()
    assert set(scene_bake.stale()) == {obj, twin}
    progress.run(scene_bake.bake([twin], rays=64))
    assert storage.bake_of(twin) != storage.bake_of(obj)
    assert scene_bake.remove([twin]) == 1
    assert np.all(flags(obj))
