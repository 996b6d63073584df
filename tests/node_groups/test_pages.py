"""The page of each node group says what the builder makes: version, sockets, types and defaults."""

import ast
import importlib
import re
from pathlib import Path

import bpy
import pytest

from spectral_skylight.node_groups import gloss, sky_irradiance, skylight_surface
from spectral_skylight.node_groups import tree as groups

pytestmark = pytest.mark.blender

FOLDER = Path(groups.__file__).parent
PAGES = sorted(path.stem for path in FOLDER.glob("*.md") if path.stem != "README")
# What a cell says of groups that lack a socket.
LEFT_OUT = re.compile(r"\(not of \*(.*?)\*\)|^of \*(.*?)\* alone")


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


def rows(page, heading, kind):
    """Name, type and, of inputs, default of each socket in one of a page's tables."""
    found = []
    lines = iter((FOLDER / f"{page}.md").read_text(encoding="utf-8").splitlines())
    for line in lines:
        if line.startswith(f"| {heading} |"):
            next(lines)
            break
    for line in lines:
        if not line.startswith("|"):
            break
        names, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        said = LEFT_OUT.search(cells[-1])
        without, alone = said.groups() if said else (None, None)
        if without == kind or (alone and alone != kind):
            continue
        found += [
            (name, *cells[: 2 if heading == "Input" else 1])
            for name in re.findall("`(.*?)`", names)
        ]
    return found


def sockets(tree, in_out):
    for item in tree.interface.items_tree:
        if item.item_type == "SOCKET" and item.in_out == in_out:
            yield item


def number(text):
    return ast.literal_eval(text) if text != "–" else None


@pytest.mark.parametrize("page", PAGES)
def test_the_page_says_what_is_built(page):
    bpy.ops.wm.read_homefile(use_empty=True)
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    for tree in built(page):
        kind = tree[groups.KIND]
        assert f"`{kind}` version {tree[groups.VERSION]}" in text
        for heading, in_out in (("Input", "INPUT"), ("Output", "OUTPUT")):
            told = rows(page, heading, kind)
            made = list(sockets(tree, in_out))
            assert sorted(name for name, *_ in told) == sorted(item.name for item in made)
            by_name = {item.name: item for item in made}
            for name, type_name, *default in told:
                socket = by_name[name]
                assert socket.socket_type == f"NodeSocket{type_name}", name
                if default and (value := number(default[0])) is not None:
                    given = socket.default_value
                    given = tuple(given) if isinstance(value, tuple) else given
                    assert given == pytest.approx(value), name
                elif hasattr(socket, "default_value") and type_name in ("Vector", "Float", "Int"):
                    given = socket.default_value
                    assert not any(given) if type_name == "Vector" else given == 0, name


def test_every_builder_has_its_page():
    builders = {
        path.stem
        for path in FOLDER.glob("*.py")
        if "\nVERSION = " in path.read_text("utf-8") and path.stem != "tree"
    }
    assert {*PAGES} == builders
    index = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert [page for page in PAGES if f"({page}.md)" not in index] == []
