"""What a study asks of its blend files is looked up before the night."""

import bpy
import pytest

from spectral_skylight.addon.batch.plan import prepared_files, tasks
from spectral_skylight.addon.batch.prepare import prepare
from spectral_skylight.addon.batch.scenes import look_into
from spectral_skylight.addon.batch.study import read_study
from spectral_skylight.addon.errors import InputError
from spectral_skylight.tests.batch.studies import (
    write_inputs,
    write_scene,
    write_study,
)

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A study's inputs, with a scene that has two cameras and one that misses its texture."""
    folder = write_inputs(tmp_path_factory.mktemp("scenes"))
    write_scene(folder / "house.blend", cameras=2, frame_current=5)
    image = bpy.data.images.new("Bricks", 4, 4)
    image.filepath_raw, image.file_format = str(folder / "bricks.png"), "PNG"
    image.save()
    image.source, image.use_fake_user = "FILE", True
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "bricks.blend"))
    return folder


def look(folder, **changes):
    return look_into(read_study(write_study(folder, **changes)))[0]


def test_what_is_not_asked_for_is_the_scenes_own(folder):
    found = look(folder, engine=None, resolution=None)
    assert found.cameras == ("View 1", "View 2")
    assert (found.scene, found.frame, found.engine) == ("Scene", 5, "cycles")
    assert found.resolution == (16, 16)
    assert look(folder, cameras=["View 2"]).cameras == ("View 2",)


def test_the_hash_follows_the_scene_and_its_textures(folder):
    before = look(folder, scenes=["bricks.blend"]).content
    assert look(folder, scenes=["bricks.blend"]).content == before != look(folder).content
    texture = folder / "bricks.png"
    kept = texture.read_bytes()
    texture.write_bytes(kept + b"\0")
    assert look(folder, scenes=["bricks.blend"]).content != before
    texture.unlink()
    with pytest.raises(InputError, match=r'bricks\.blend: lacks image "Bricks" \(.*bricks\.png\)'):
        look(folder, scenes=["bricks.blend"])
    texture.write_bytes(kept)


def newer(folder):
    """A blend file as a Blender of next year would begin it."""
    bpy.ops.wm.open_mainfile(filepath=str(folder / "house.blend"))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "newer.blend"), compress=False, copy=True)
    content = bytearray((folder / "newer.blend").read_bytes())
    digits = content.index(b"v", 7)  # BLENDER-v405 to 4.5, BLENDER17-01v0500 from 5.0
    count = 4 if content[digits + 1 : digits + 2] == b"0" else 3
    content[digits + 1 : digits + 1 + count] = b"0903" if count == 4 else b"903"
    (folder / "newer.blend").write_bytes(bytes(content))


def test_mistakes_name_file_and_cure(folder):
    newer(folder)
    (folder / "typo.csv").write_text("material,reflectance\nWal,paint.csv:red\n")
    (folder / "broken.blend").write_bytes((folder / "house.blend").read_bytes()[:2000])
    mistakes = [
        ({"cameras": ["View 3"]}, 'house.blend: has no camera "View 3"; did you mean "View 2"?'),
        ({"cameras": ["Xyz"]}, 'has no camera "Xyz"; it has "View 1", "View 2"'),
        (
            {"variants": [{"name": "x", "assign": "typo.csv"}]},
            'house.blend, variant x: has no material "Wal"; did you mean "Wall"?',
        ),
        ({"scenes": ["newer.blend"]}, "newer.blend: "),
        ({"scenes": ["broken.blend"]}, "broken.blend: "),
    ]
    said = []
    for changes, part in mistakes:
        with pytest.raises(InputError) as caught:
            look(folder, **changes)
        said.append(str(caught.value))
        assert part in said[-1] and "\n" not in said[-1], said[-1]
    assert "9.3" in said[3] or "newer" in said[3].removeprefix(str(folder / "newer.blend")), said[3]


def test_a_film_is_of_the_scenes_own_sky_and_frames(folder):
    """As `animate` leaves a file: prepared, it is as it was."""
    path = folder / "film.blend"
    write_scene(path, frame_start=3, frame_end=6)
    world = bpy.context.scene.world
    world["spectral_skylight_test"] = 1.0
    world.keyframe_insert('["spectral_skylight_test"]', frame=3)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    study = read_study(
        write_study(folder, scenes=["film.blend"], skies=["as-is"], frames="all", variants=None)
    )
    scenes = look_into(study)
    assert [task.frame for task in tasks(study, scenes, "p")] == [3, 4, 5, 6]
    prepare(study, scenes, "p")
    made = next(prepared_files(study, scenes, "p")).blend
    bpy.ops.wm.open_mainfile(filepath=str(study.out / made))
    assert bpy.context.scene.world.animation_data.action is not None
    assert bpy.context.scene.world.name == world_name(path)


def world_name(path):
    """The World of a file's scene."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.context.scene.world.name
