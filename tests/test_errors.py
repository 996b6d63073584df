"""Errors name parameters: the command line shows options, the panel labels, a study its keys."""

import argparse
import ast
import pickle
import re
from pathlib import Path

import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.batch import study
from spectral_skylight.addon.errors import InputError, parameter
from spectral_skylight.addon.spectra import bases, grid

ROOT = Path(__file__).resolve().parents[1]
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")


@pytest.fixture
def wrong():
    """What the atmosphere's basis says of a sun beyond the zenith."""
    with pytest.raises(InputError) as caught:
        bases.atmosphere(sun_elevation=91.0)
    return caught.value


def test_a_script_reads_the_name_in_words(wrong):
    assert str(wrong) == "sun elevation: 91°; give -90 to 90 degrees"
    assert wrong.problem == "91°"


def test_an_error_can_travel(wrong):
    """As from a worker of a farm to the machine that started it."""
    again = pickle.loads(pickle.dumps(wrong))
    assert type(again) is InputError and str(again) == str(wrong)
    assert again.told(str.upper) == "SUN_ELEVATION: 91°; give -90 to 90 degrees"


def test_an_error_is_one_line_and_leaves_other_text_alone():
    error = InputError("a\nb.csv", f"‹x y› {parameter('unit')}", f"set {parameter('white')}\nso")
    assert error.told(lambda name: f"<{name}>") == "a b.csv: ‹x y› <unit>; set <white> so"


@pytest.fixture
def paint(tmp_path):
    """A paint whose numbers may be percent or fractions."""
    path = tmp_path / "paint.csv"
    path.write_text("\n".join(["nm,red", *(f"{x:g},1.5" for x in grid.WAVELENGTHS)]))
    return path


def test_the_command_line_shows_options(paint, capsys):
    assert cli.main(["matrix", str(paint), "--unit", "fraction", "--sun-elevation", "91"]) == 2
    assert cli.main(["matrix", str(paint)]) == 2
    assert cli.main(["matrix", str(paint), "--unit", "percent", "--sun-elevation", "91"]) == 2
    *_, unit, elevation = capsys.readouterr().err.splitlines()
    assert "give --unit percent or fraction" in unit
    assert elevation.endswith("--sun-elevation: 91°; give -90 to 90 degrees")


def test_a_study_shows_its_keys(tmp_path):
    (tmp_path / "a.blend").touch()
    place = 'latitude = 48.1\nlongitude = 11.6\ntimezone = "Middle/Earth"\nnorth = 0\n'
    (tmp_path / "study.toml").write_text(
        'out = "out"\nscenes = "a.blend"\ncameras = "all"\n'
        f'[[skies]]\ndate = 2025-06-21\ntimes = "12:00"\n{place}'
    )
    with pytest.raises(InputError) as caught:
        study.read_study(tmp_path / "study.toml")
    assert str(caught.value).endswith(
        "study.toml, skies 1, \"timezone\": 'Middle/Earth' is unknown; "
        "give a name such as Europe/Berlin, or hours such as +2"
    )


def test_the_batch_command_shows_keys_and_options(capsys, monkeypatch, tmp_path):
    """Of one run: what the study says wrong is its key's, the command's own is an option."""
    for name, shown in (("basis", '"basis"'), ("blender", "--blender")):

        def fail(path, name=name):
            raise InputError(parameter(name), "will not do", "give another")

        monkeypatch.setattr(study, "read_study", fail)
        assert cli.main(["batch", "plan", str(tmp_path / "study.toml")]) == 2
        assert capsys.readouterr().err == f"spectral-skylight: {shown}: will not do; give another\n"


@pytest.mark.blender
def test_the_panel_shows_labels():
    pytest.importorskip("bpy")
    import spectral_skylight
    from spectral_skylight.addon.ui import labels

    spectral_skylight.register()
    try:
        error = InputError(parameter("white"), "is no color", f"or change {parameter('unit')}")
        assert labels.told(error) == "Neutral Light: is no color; or change Unit"
        assert labels.label("latitude") == "Latitude"  # of a study
        assert labels.label("number_of_moons") == "Number Of Moons"
    finally:
        spectral_skylight.unregister()


def documented(tree):
    """The docstrings of a module: of itself, its functions and classes, and under its values."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            yield node.value


def options(parser):
    """All options of a parser and those under it."""
    for action in parser._actions:
        yield from action.option_strings
        if isinstance(action, argparse._SubParsersAction):
            for under in action.choices.values():
                yield from options(under)


def test_no_room_speaks_command_line():
    """Only commands name their options: scripts and the panel have none.

    Docstrings may, for they are read beside the code. So may a string that is nothing but an
    option: it is an argument, of another process or of a parser, unless an error is made of it.
    """
    ours, wrong = set(options(cli._parser([]))), []
    assert {"--sun-elevation", "--unit", "--blender"} <= ours
    for path in sorted((ROOT / "addon").rglob("*.py")):
        if path.relative_to(ROOT).parts[1] in ("commands", "cli.py"):
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        allowed = {id(node) for node in documented(tree)}
        blamed = {
            id(node)
            for call in ast.walk(tree)
            if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "InputError"
            for node in ast.walk(call)
        }
        for node in ast.walk(tree):
            if not isinstance(node, ast.Constant) or not isinstance(node.value, str):
                continue
            named = set(OPTION.findall(node.value))
            if id(node) in blamed:
                bad = named
            else:
                lone = OPTION.fullmatch(node.value) is not None
                bad = named & ours if id(node) not in allowed and not lone else set()
            if bad:
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno}: {node.value}")
    assert wrong == []
