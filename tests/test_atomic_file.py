"""A file is replaced as a whole: what it was, its links and its mode survive what fails."""

import json
import os
import re
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from spectral_skylight.addon import atomic_file, whole_files
from spectral_skylight.addon.atomic_file import part_of, replacing
from spectral_skylight.addon.errors import InputError

POSIX = pytest.mark.skipif(os.name == "nt", reason="Windows has no such modes and links")


def parts(folder):
    return [path.name for path in folder.iterdir() if ".part" in path.name]


def test_a_file_is_replaced_as_a_whole(tmp_path):
    path = tmp_path / "a.exr"
    path.write_bytes(b"old")
    with replacing(path) as part:
        part.write_bytes(b"new")
        assert path.read_bytes() == b"old"
        assert part.suffix == ".exr"  # Blender and OpenEXR look at it
    assert path.read_bytes() == b"new"
    assert parts(tmp_path) == []


def test_what_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replacing(path) as part:
        part.write_text("half")
        1 / 0  # noqa: B018
    assert path.read_text() == "old"
    assert parts(tmp_path) == []


def test_a_writer_that_writes_nothing_is_an_error(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(FileNotFoundError), replacing(path):
        pass
    assert path.read_text() == "old"


@POSIX
def test_the_mode_stays(tmp_path):
    path = tmp_path / "a.txt"
    path.touch()
    path.chmod(0o640)
    whole_files.write_text(path, "new")
    assert path.stat().st_mode & 0o777 == 0o640


@POSIX
def test_a_new_file_has_the_mode_that_any_new_file_has(tmp_path):
    (tmp_path / "any").touch()
    whole_files.write_text(tmp_path / "new", "text")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "any").stat().st_mode


@POSIX
@pytest.mark.parametrize("there", (True, False))
def test_a_link_stays_one(tmp_path, there):
    """Also one of links, and one whose target is yet to be written."""
    target, link, again = tmp_path / "far" / "a.txt", tmp_path / "a.txt", tmp_path / "b.txt"
    target.parent.mkdir()
    if there:
        target.write_text("old")
    link.symlink_to(target)
    again.symlink_to("a.txt")
    whole_files.write_text(again, "new")
    assert again.is_symlink() and link.is_symlink() and target.read_text() == "new"
    assert parts(target.parent) == [] == parts(tmp_path)


@POSIX
def test_what_is_no_regular_file_is_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (pipe, tmp_path):
        with pytest.raises(InputError, match="no regular file"):
            whole_files.write_text(path, "text")
    assert pipe.is_fifo() and parts(tmp_path) == []


def test_what_prevents_it_is_one_line_with_a_cure(tmp_path):
    with pytest.raises(InputError, match=r"none.*cannot be written \(No such file.*choose"):
        whole_files.write_text(tmp_path / "none" / "a.txt", "text")
    with (
        pytest.raises(InputError, match=r"a\.blend: cannot be written \(no room\)"),
        whole_files.writing(tmp_path / "a.blend"),
    ):
        raise RuntimeError("Error: saving\nno room\n")  # as Blender reports


def test_what_a_killed_process_left_is_cleared_by_the_next_file_beside_it(tmp_path):
    """Also what Blender wrote under its own name; what others write, or a person has, stays."""
    code = (
        "import os, pathlib; from spectral_skylight.addon.atomic_file import replacing\n"
        "with replacing(pathlib.Path('a.txt')) as part:\n"
        " part.write_text('half'); part.with_name(part.name + '@').touch(); os.kill(os.getpid(), 9)"
    )
    killed = subprocess.run([sys.executable, "-c", code], cwd=tmp_path)
    assert killed.returncode != 0 and len(parts(tmp_path)) == 2
    (tmp_path / ".mine.part.txt").touch()
    with whole_files.writing(tmp_path / "b.txt") as part:
        whole_files.write_text(tmp_path / "c.txt", "text")  # leaves the other's part alone
        part.write_text("text")
    assert parts(tmp_path) == [".mine.part.txt"]


@pytest.mark.parametrize("name", ["é" * 125 + ".exr", "a" * 240 + ".blend", "a." + "b" * 250])
def test_the_longest_names_can_be_written(tmp_path, name):
    """A part's name is cut where the file's own fills the 255 bytes of a name."""
    part = part_of(tmp_path / name)
    assert len(os.fsencode(part.name)) < 255
    whole_files.write_text(tmp_path / name, "text")
    assert (tmp_path / name).read_text() == "text" and parts(tmp_path) == []


def test_threads_do_not_write_into_one_part(tmp_path):
    found = []
    thread = threading.Thread(target=lambda: found.append(part_of(tmp_path / "a")))
    thread.start()
    thread.join()
    assert found[0] != part_of(tmp_path / "a")


def test_line_ends_stay_and_numbers_that_are_none_become_null(tmp_path):
    whole_files.write_text(tmp_path / "a.txt", "a\r\nb\n")
    assert (tmp_path / "a.txt").read_bytes() == b"a\r\nb\n"
    whole_files.write_json(tmp_path / "a.json", {"a": (1.0, float("nan")), "b": [float("inf")]})
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": [1.0, None], "b": [None]}


def test_it_works_as_a_lone_file(tmp_path):
    """As its copy beside a plan does, in a Blender without the package."""
    lone = tmp_path / "atomic_file.py"
    lone.write_bytes(Path(atomic_file.__file__).read_bytes())
    code = (
        "import pathlib, atomic_file\n"
        "with atomic_file.replacing(pathlib.Path('a')) as part: part.write_text('new')"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
    assert (tmp_path / "a").read_text() == "new"


def test_no_other_file_renames_what_it_wrote():
    """Each way of its own forgot something: a link, a mode, or what was half-written."""
    addon = Path(atomic_file.__file__).parent
    ways = re.compile(r"mkstemp|NamedTemporaryFile|os\.(replace|rename)|\bpart\.(replace|rename)\(")
    found = [p.name for p in addon.rglob("*.py") if ways.search(p.read_text(encoding="utf-8"))]
    assert found == ["atomic_file.py"]
