"""A .blend that a full disk cut short never replaces a good one, though Blender calls it saved."""

import random
import re
from pathlib import Path

import bpy
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.files import blend_file, whole_blend
from spectral_skylight.tests import faces, full_disk

pytestmark = pytest.mark.blender

OLD = sorted((Path(__file__).parents[1] / "files").glob("*.blend"))


def save(path, compress):
    """A file of some hundred blocks, and frames if it is compressed."""
    scene = faces.empty_scene()
    image = bpy.data.images.new("noise", 512, 512)
    values = random.Random(1)
    image.pixels = [values.random() for _ in range(4 * 512 * 512)]
    image.pack()
    scene.collection.objects.link(bpy.data.objects.new("one", None))
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=compress, check_existing=False)
    return path


@pytest.mark.parametrize("path", OLD, ids=lambda path: path.stem)
def test_files_of_older_blenders_are_whole(path, tmp_path):
    copy = tmp_path / path.name
    copy.write_bytes(path.read_bytes())
    whole_blend.check(copy)


@pytest.mark.parametrize("compress", (True, False))
def test_a_file_without_its_end_or_a_part_is_not_whole(tmp_path, compress):
    path = save(tmp_path / "a.blend", compress)
    whole_blend.check(path)
    content, cut = path.read_bytes(), tmp_path / "cut.blend"
    ends = [*range(0, len(content), len(content) // 50), *range(len(content) - 40, len(content))]
    holes = [(start, start + 100) for start in range(50, len(content) - 100, len(content) // 50)]
    for first, last in [*((end, len(content)) for end in ends), *holes]:
        cut.write_bytes(content[:first] + content[last:])
        with pytest.raises(OSError, match="the disk may be full"):
            whole_blend.check(cut)
    cut.write_bytes(content + b"\0")
    with pytest.raises(OSError, match="cut short"):
        whole_blend.check(cut)


def library(path):
    """As an asset library is written; not compressed, which Blender itself tells of."""
    with whole_blend.writing_blend(path) as part:
        bpy.data.libraries.write(str(part), set(bpy.data.images))


@pytest.mark.skipif(not full_disk.THERE, reason=full_disk.WHY)
@pytest.mark.parametrize("write", (blend_file.save, library))
def test_on_a_full_disk_the_good_file_stays(tmp_path, write):
    """At ten levels of filling."""
    path = save(tmp_path / "a.blend", compress=True)
    write(path)
    before = path.read_bytes()
    for level in range(10):
        with (
            full_disk.full_after(level * len(before) // 10),
            pytest.raises(InputError, match=re.escape(f"{path}: cannot be written")),
        ):
            write(path)
        assert path.read_bytes() == before
        assert [found.name for found in tmp_path.iterdir()] == ["a.blend"]
    write(path)
    whole_blend.check(path)
