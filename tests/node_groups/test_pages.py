"""The page of each group has its version, and each socket with type, default and tooltip."""

import ast
import importlib
from pathlib import Path

import bpy
import pytest

from spectral_skylight.node_groups import gloss, sky_irradiance, skylight_surface
from spectral_skylight.node_groups import tree as groups

pytestmark = pytest.mark.blender

FOLDER = Path(groups.__file__).parent
PAGES = sorted(path.stem for path in FOLDER.glob("*.md") if path.stem != "README")


def built(page):
    """The groups that a page's builder makes."""
    if page == "gloss":
        return [gloss.ensure(kind) for kind in gloss.KINDS]
    if page == "sky_irradiance":
        return [
            sky_irradiance.ensure(),
            sky_irradiance.ensure(None, sky_irradiance.GROUND, sky_irradiance.GROUND_DEGREE),
        ]
    if page == "skylight_surface":
        world = bpy.data.worlds.new("World")
        return [skylight_surface.ensure(world, "sun_threshold", None)]
    return [importlib.import_module(f"spectral_skylight.node_groups.{page}").ensure()]


def table(page, heading):
    """The rows of one of a page's tables, each by the headings of its columns."""
    lines = iter((FOLDER / f"{page}.md").read_text(encoding="utf-8").splitlines())
    titles = next(cells(line) for line in lines if line.startswith(f"| {heading} |"))
    next(lines)
    rows = []
    for line in lines:
        if not line.startswith("|"):
            break
        rows.append(dict(zip(titles, cells(line), strict=True)))
    return rows


def cells(line):
    return [cell.strip() for cell in line.strip("|").split("|")]


def sockets(tree, in_out):
    return {
        item.name: item
        for item in tree.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == in_out
    }


@pytest.mark.parametrize("page", PAGES)
def test_the_page_says_what_is_built(page):
    bpy.ops.wm.read_homefile(use_empty=True)
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    for tree in built(page):
        kind = tree[groups.KIND]
        assert f"`{kind}` version {tree[groups.VERSION]}" in text
        for heading, in_out in (("Input", "INPUT"), ("Output", "OUTPUT")):
            rows = [
                row
                for row in table(page, heading)
                if row.get("Groups", "all") == "all" or kind in row["Groups"].split(", ")
            ]
            made = sockets(tree, in_out)
            assert [row[heading].strip("`") for row in rows] == list(made)
            for row, socket in zip(rows, made.values(), strict=True):
                assert f"NodeSocket{row['Type']}" == socket.socket_type, socket.name
                assert row["Meaning"] == socket.description, socket.name
                if in_out == "INPUT":
                    assert_default(row["Default"], socket)


def assert_default(cell, socket):
    """A dash is nothing, or 0 in each channel."""
    value = getattr(socket, "default_value", None)
    value = tuple(value) if hasattr(value, "__len__") else value
    if cell != "–":
        assert value == pytest.approx(ast.literal_eval(cell)), socket.name
    elif value is not None:
        assert not any(value) if isinstance(value, tuple) else value == 0, socket.name


@pytest.mark.parametrize("page", PAGES)
def test_each_socket_has_a_tooltip_as_blenders_are(page):
    """A sentence that starts with a capital or a number; Blender sets the full stop itself."""
    bpy.ops.wm.read_homefile(use_empty=True)
    for tree in built(page):
        for item in tree.interface.items_tree:
            text = item.description
            assert text and text == text.strip() and (text[0].isupper() or text[0].isdigit())
            assert not text.endswith(".") and "  " not in text
            assert not any(word in text.lower() for word in ("colour", "neighbour", "grey"))
        bpy.data.node_groups.remove(tree)


def test_every_builder_has_its_page():
    builders = {
        path.stem
        for path in FOLDER.glob("*.py")
        if "\nVERSION = " in path.read_text("utf-8") and path.stem != "tree"
    }
    assert {*PAGES} == builders
    index = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert [page for page in PAGES if f"({page}.md)" not in index] == []
