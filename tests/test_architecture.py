"""The house rules, held by reading every import in the package.

Data goes one way: files → spectra, sky → transfer → scene (with node_groups) → ui, commands.
Pictures are drawn of what spectra, sky and transfer hold, with numpy alone: for panel and commands.
"""

import ast
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest

from spectral_skylight.addon.batch.scenes import NOT_IN_PICTURES
from spectral_skylight.addon.batch.task import SCRIPTS

ROOT = Path(__file__).resolve().parents[1]

BASE = {
    "atomic_file",
    "bar",
    "choices",
    "errors",
    "grouping",
    "progress",
    "source_hash",
    "tags",
    "whole_files",
}
"""Files under all rooms, of Python's own modules alone."""

MAY_IMPORT = {
    **{name: BASE for name in BASE},
    "spectra": BASE,
    "sky": BASE | {"spectra"},
    "transfer": BASE | {"spectra", "sky"},
    "transport": BASE | {"spectra"},
    "evaluation": BASE | {"spectra", "sky", "transfer"},
    "pictures": BASE | {"spectra", "sky", "transfer"},
    "node_groups": set(),
    "scene": BASE | {"spectra", "sky", "transfer", "transport", "pictures", "node_groups"},
    "ui": BASE | {"scene", "spectra", "sky", "transfer", "pictures", "batch"},
    "registration": {"ui", "cli"},
    "cli": BASE | {"commands"},
    "commands": BASE | {"spectra", "sky", "transfer", "evaluation", "pictures", "scene", "batch"},
    "batch": BASE | {"spectra", "sky", "transfer", "scene"},
}
"""Room and the other rooms that it may import from."""

BESIDE_A_PLAN = {path.stem for path in SCRIPTS}
"""A batch's scripts find copies of our own modules beside themselves."""

ON_SCREEN = {"gpu", "gpu_extras"}
"""What draws into a view: without a window nothing of it is imported."""

MODULES_OF = {
    **{name: set() for name in BASE},
    "spectra": {"numpy"},
    "sky": {"numpy", "OpenEXR"},
    "transfer": {"numpy"},
    "transport": {"embreex", "mathutils", "numpy"},
    "evaluation": {"numpy", "colour", "matplotlib", "PIL", "scipy", "tqdm"},
    "pictures": {"numpy"},
    "node_groups": {"bpy"},
    "scene": {"bpy", "bpy_extras", "mathutils", "numpy", *BESIDE_A_PLAN},
    "ui": {"blf", "bpy", "bpy_extras", *ON_SCREEN},
    "registration": {"bpy"},
    "cli": set(),
    "commands": {"numpy"},
    "batch": {"bpy", "cloudpickle", "distributed", "numpy", *BESIDE_A_PLAN},
}
"""Room and the modules from outside, Python's own apart, that it may import."""

LABORATORY = {"colour", "scipy", "matplotlib", "PIL", "tqdm"}
"""What only `evaluation` may need: slow to import, and not there in Blender."""

WHEELS = {"colour", "scipy", "OpenEXR", "embreex"}
"""What only the add-on's zip brings; imported when first needed, never when a file is imported."""


@dataclass(frozen=True)
class Import:
    """One import statement: where it stands, what it names and whether a function holds it."""

    path: Path
    line: int
    module: str
    relative: bool
    late: bool

    def __str__(self):
        return f"{self.path.relative_to(ROOT)}:{self.line} imports {self.module}"


def _for_types(block):
    """Whether a block is for the type checker alone, and never run."""
    return isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"


def imports(path):
    """Every import of a file; relative ones resolved to a path under the root, with dots."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    late = {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.FunctionDef | ast.AsyncFunctionDef) or _for_types(block)
        for node in ast.walk(block)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for name in node.names:
                yield Import(path, node.lineno, name.name, False, id(node) in late)
        elif isinstance(node, ast.ImportFrom):
            if not node.level:
                yield Import(path, node.lineno, node.module, False, id(node) in late)
                continue
            here = path.relative_to(ROOT).parts[: -node.level]
            base = ".".join([*here, *([node.module] if node.module else [])])
            for name in node.names:
                yield Import(path, node.lineno, f"{base}.{name.name}", True, id(node) in late)


def room(parts):
    """The room of a path or dotted name: addon's folders and files, and node_groups."""
    parts = parts[1:] if parts[0] == "addon" else parts
    return parts[0].removesuffix(".py")


FILES = sorted(path for top in ("addon", "node_groups") for path in (ROOT / top).rglob("*.py"))
ALL = [
    found
    for path in FILES
    if path.relative_to(ROOT).parts != ("addon", "__init__.py")
    for found in imports(path)
]


def of_room(found):
    return room(found.path.relative_to(ROOT).parts)


def test_every_room_has_its_rule():
    assert {of_room(found) for found in ALL} <= MAY_IMPORT.keys()
    assert MAY_IMPORT.keys() == MODULES_OF.keys()
    assert len(ALL) > 100  # the walk sees the house


@pytest.mark.parametrize("name", MAY_IMPORT)
def test_data_goes_one_way(name):
    wrong = [
        str(found)
        for found in ALL
        if found.relative and of_room(found) == name
        if room(found.module.split(".")) not in MAY_IMPORT[name] | {name}
    ]
    assert wrong == []


@pytest.mark.parametrize("name", MODULES_OF)
def test_rooms_use_only_their_modules(name):
    allowed = MODULES_OF[name] | sys.stdlib_module_names
    wrong = [
        str(found)
        for found in ALL
        if not found.relative and of_room(found) == name
        if found.module.split(".")[0] not in allowed
    ]
    assert wrong == []


def test_only_the_laboratory_needs_more_than_blender_has():
    assert [name for name, modules in MODULES_OF.items() if modules & LABORATORY] == ["evaluation"]


def test_wheels_and_the_screen_are_imported_when_first_needed():
    wrong = [str(f) for f in ALL if f.module.split(".")[0] in WHEELS | ON_SCREEN and not f.late]
    assert wrong == []


def test_panel_and_commands_import_other_rooms_when_first_needed():
    """Registration imports all of ui: what ui imports at once would come along; so with help."""
    wrong = [
        str(found)
        for found in ALL
        if found.relative
        and not found.late
        and of_room(found) in ("ui", "registration", "commands")
        if room(found.module.split(".")) not in BASE | {"ui", "commands"}
    ]
    assert wrong == []


def test_the_package_names_itself_nowhere():
    """Blender installs it as `bl_ext.….spectral_skylight`: an absolute import would miss it."""
    assert [str(found) for found in ALL if found.module.startswith("spectral_skylight")] == []


def test_the_root_imports_nothing_before_it_is_asked():
    found = list(imports(ROOT / "__init__.py"))
    assert found
    assert [str(one) for one in found if not one.late] == []


def test_relative_imports_stay_inside_the_package():
    for path in FILES:
        depth = len(path.relative_to(ROOT).parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                assert node.level <= depth, f"{path}:{node.lineno}"


def test_relative_imports_lead_somewhere():
    wrong = []
    for found in ALL:
        parent, name = ROOT.joinpath(*found.module.split(".")[:-1]), found.module.split(".")[-1]
        if found.relative and not (
            parent.with_suffix(".py").is_file()
            or (parent / name).is_dir()
            or (parent / f"{name}.py").is_file()
            or name in (parent / "__init__.py").read_text(encoding="utf-8")
        ):
            wrong.append(str(found))
    assert wrong == []


def test_pip_installs_every_package_with_its_data():
    """A folder that the list forgets is missing only where it is installed, not in a checkout."""
    setup = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    listed, data = setup["setuptools"]["packages"], setup["setuptools"]["package-data"]
    folders = {path.parent.relative_to(ROOT) for path in FILES} | {Path()}
    names = {".".join(["spectral_skylight", *folder.parts]): folder for folder in folders}
    assert sorted(listed) == sorted(names)
    for name, folder in names.items():
        files = [] if folder == Path() else [*(ROOT / folder).iterdir()]
        held = [f for f in files if f.is_file() and f.suffix not in (".py", ".pyc", ".md")]
        found = [f.name for f in held if not any(f.match(each) for each in data.get(name, ()))]
        assert found == [], name


def test_the_batch_hashes_every_room_that_it_reaches():
    """Pictures are made anew after any change that may show, so no room in reach is left out."""
    reached, left = set(), {"batch", "node_groups"}
    while left:
        reached |= left
        near = {room(f.module.split(".")) for f in ALL if f.relative and of_room(f) in left}
        left = near - reached
    assert {"spectra", "sky", "transfer", "scene"} <= reached
    assert not reached & {name.removesuffix(".py") for name in NOT_IN_PICTURES}


def test_the_packages_of_the_scene_are_in_layers():
    """No package imports, by whatever way, one that imports it."""

    def package(parts):
        return parts[2].removesuffix(".py")

    below = {}
    for found in ALL:
        module = found.module.split(".")
        if found.relative and of_room(found) == room(module) == "scene":
            here = package(found.path.relative_to(ROOT).parts)
            below.setdefault(here, set()).update({package(module)} - {here})
    while remaining := {name: lower & below.keys() for name, lower in below.items()}:
        ground = {name for name, lower in remaining.items() if not lower}
        assert ground, f"a circle among {sorted(remaining)}"
        for name in ground:
            del below[name]
