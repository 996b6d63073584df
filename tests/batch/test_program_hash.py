"""Pictures are made anew when any file that decides them has changed, and only then."""

import shutil
from pathlib import Path

import pytest

from spectral_skylight.addon import source_hash
from spectral_skylight.addon.batch.scenes import NOT_IN_PICTURES, files_hash
from spectral_skylight.addon.spectra import cache

PACKAGE = Path(__file__).resolve().parents[2]
IGNORED = shutil.ignore_patterns("__pycache__", ".*")


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A copy of the package."""
    root = tmp_path_factory.mktemp("package")
    for top in ("addon", "node_groups"):
        shutil.copytree(PACKAGE / top, root / top, ignore=IGNORED)
    return root


def kinds(root):
    """A file of each folder and ending, but for documents."""
    files = (path for top in ("addon", "node_groups") for path in sorted((root / top).rglob("*.*")))
    return {(path.parent, path.suffix): path for path in files if path.suffix != ".md"}.values()


def room(root, path):
    top, *rest = path.relative_to(root).parts
    return rest[0] if top == "addon" else top


def test_a_copy_elsewhere_is_the_same_program(root):
    assert files_hash(root) == files_hash(PACKAGE)


def test_each_kind_of_file_that_decides_a_picture_counts(root):
    before, counted = files_hash(root), set()
    for path in kinds(root):
        kept = path.read_bytes()
        path.write_bytes(kept + b"\n")
        changed = files_hash(root) != before
        path.write_bytes(kept)
        assert changed == (room(root, path) not in NOT_IN_PICTURES), path
        counted |= {path.relative_to(root).as_posix()} if changed else set()
    assert files_hash(root) == before
    # The walk has seen a table, a sub-package of readers, the scene's rooms and the shaders.
    folders = {str(Path(name).parent) for name in counted}
    assert "addon/spectra/ensemble.npz" in counted
    assert {"addon/spectra/formats", "addon/scene/materials", "node_groups"} <= folders


def test_files_that_come_go_or_move_count(root):
    before = files_hash(root)
    new = root / "addon" / "sky" / "tables" / "moon.json"
    new.parent.mkdir()
    new.write_text("{}")
    there = files_hash(root)
    moved = new.rename(new.with_name("sun.json"))
    assert len({before, there, files_hash(root)}) == 3
    moved.unlink()
    new.parent.rmdir()
    assert files_hash(root) == before


def test_what_python_and_editors_leave_does_not_count(root):
    before = files_hash(root)
    for name in ("addon/sky/__pycache__/sun.pyc", "addon/sky/.sun.py.swp", "addon/sky/NOTES.md"):
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).write_bytes(b"new")
    assert files_hash(root) == before


def test_kept_results_are_of_this_code_with_its_tables(root, monkeypatch):
    """A sky and a library in the cache too: a changed table makes another place."""
    monkeypatch.setattr(source_hash.source_hash, "__kwdefaults__", {"root": root})
    code = root / "addon" / "spectra"
    before = cache.place("sky", {"sun": 30.0}, code)
    table = code / "ensemble.npz"
    kept = table.read_bytes()
    table.write_bytes(kept + b"\0")
    assert cache.place("sky", {"sun": 30.0}, code) != before
    table.write_bytes(kept)
    assert cache.place("sky", {"sun": 30.0}, code) == before
