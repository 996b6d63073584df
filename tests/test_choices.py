"""What users choose from stands once: one entry more, and every place that shows it has it."""

import json
import subprocess
import sys
import textwrap

import numpy as np
import pytest

from spectral_skylight.addon import choices
from spectral_skylight.addon.sky import simulation
from spectral_skylight.addon.spectra import bases, checks, grid, working_spaces
from spectral_skylight.addon.transfer import choice, ground

ENTER = """
import sys
from spectral_skylight.addon import choices
from spectral_skylight.addon.choices import Entry

choices.BASES["clouds"] = Entry("Clouds", "Light as clouds scatter it")
choices.OCCLUSIONS["fog"] = Entry("Foggy", "Fog hides the sky")
"""
"""One entry each; the function of the basis is that basis."""

FUNCTION = """
import numpy as np
from spectral_skylight.addon.spectra import bases
from spectral_skylight.addon.spectra.grid import WAVELENGTHS

bases.clouds = lambda: (WAVELENGTHS / 550.0) ** -np.arange(3)[:, None]
"""


def run(code, *arguments):
    """What a new Python prints that runs code with more choices; all modules are read anew."""
    code = textwrap.dedent(ENTER + code)
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


CLI = """
from spectral_skylight.addon import cli
sys.exit(cli.main(sys.argv[1:]))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A measured paint, and two spectra of light."""
    folder = tmp_path_factory.mktemp("choices")
    nm = grid.WAVELENGTHS
    paint = [f"{x:g},{0.1 if x < 600 else 0.7}" for x in nm]
    (folder / "paint.csv").write_text("\n".join(["nm,red", *paint]))
    light = [f"{x:g},{(x / 550) ** -3:.5f},{(x / 550) ** -1:.5f}" for x in nm]
    (folder / "light.csv").write_text("\n".join(["nm,blue,pale", *light]))
    return folder


@pytest.mark.parametrize("command", (("matrix",), ("apply",)))
def test_the_command_lines_help_has_a_new_basis(command):
    said = " ".join(run(CLI, *command, "--help").split())
    assert "clouds: Light as clouds scatter it" in said


def test_the_command_line_takes_a_new_basis(folder):
    found = json.loads(
        run(FUNCTION + CLI, "matrix", folder / "paint.csv", "--basis", "clouds", "--json")
    )
    assert found["basis"] == "clouds"
    assert np.all(np.isfinite(found["materials"][0]["matrix"]))


def test_evaluate_has_a_new_basis(folder):
    pytest.importorskip("matplotlib")
    command = ("evaluate", "--daylight", folder / "light.csv", "--out", folder / "out", "--json")
    methods = json.loads(run(FUNCTION + CLI, *command))["methods"]
    errors = {method["method"]: method["delta_E"]["mean"] for method in methods}
    assert 0.0 < errors["clouds"] < 1.0 < errors["RGB × RGB in Rec.709"]


CHART = """
import json
from spectral_skylight.addon.evaluation.chart import material_rows
from spectral_skylight.addon.evaluation.methods import METHODS, Sky

few = {name: method for name, method in METHODS.items() if name in ("clouds", "rayleigh")}
skies = [Sky((WAVELENGTHS / 550.0) ** -2.5 * np.ones((2, 1)), 30.0)]
found = material_rows("material", skies, np.full((1, 81), 0.5), few, rounds=1)
print(json.dumps({row.name: row.errors.delta_E.mean() for row in found}))
"""


def test_the_chart_has_a_new_basis():
    found = json.loads(run(FUNCTION + CHART))
    assert list(found) == ["rayleigh", "clouds"]
    assert max(found.values()) < 1e-6  # a gray material is no basis's problem


PANEL = """
import json
import os
import bpy
import spectral_skylight

spectral_skylight.register()
world = bpy.context.scene.world or bpy.data.worlds.new("World")
shown = {}
for name in ("basis", "occlusion"):
    items = world.skylight.bl_rna.properties[name].enum_items
    shown[name] = [[item.identifier, item.name, item.description] for item in items]
world.skylight.basis, world.skylight.occlusion = "clouds", "fog"
print(json.dumps([shown, world.skylight.basis, world.skylight.occlusion]), flush=True)
os._exit(0)  # bpy before 5.0 can crash at exit
"""


@pytest.mark.blender
def test_the_panel_has_a_new_basis_and_occlusion():
    pytest.importorskip("bpy")
    shown, *chosen = json.loads(run(PANEL).splitlines()[-1])
    assert chosen == ["clouds", "fog"]
    assert ["clouds", "Clouds", "Light as clouds scatter it"] in shown["basis"]
    assert ["fog", "Foggy", "Fog hides the sky"] in shown["occlusion"]
    assert shown["basis"][0][0] == choices.SIMPLEST


def test_the_command_line_has_a_new_occlusion():
    said = " ".join(run(CLI, "apply", "--help").split())
    assert "{auto,open,dome,baked,traced,fog}" in said and "fog: Fog hides the sky" in said
    parse = """
    from spectral_skylight.addon import cli
    options = ["apply", "a.blend", "--out", "b.blend", "--occlusion", "fog"]
    print(cli._parser([]).parse_args(options).occlusion)
    """
    assert run(textwrap.dedent(parse)).split() == ["fog"]


STUDY = """
from spectral_skylight.addon.batch import study
found = study.read_study(sys.argv[1])
print(found.settings["occlusion"], found.settings["basis"])
print(study.KEYS["occlusion"])
print(study.KEYS["basis"])
"""


def test_a_study_has_a_new_occlusion_and_basis(folder):
    (folder / "a.blend").touch()
    text = 'out = "out"\nscenes = "a.blend"\ncameras = "all"\nocclusion = "fog"\nbasis = "clouds"\n'
    sky = '[[skies]]\ndate = 2025-06-21\ntimes = ["12:00"]\nlatitude = 48\nlongitude = 11\n'
    (folder / "study.toml").write_text(f"{text}{sky}timezone = 1\nnorth = 0\n")
    assert run(STUDY, folder / "study.toml").splitlines() == [
        "fog clouds",
        "auto, open, dome, baked, traced or fog",
        "simplest, rayleigh, daylight, atmosphere or clouds; atmosphere",
    ]


def test_each_choice_says_what_it_is():
    """In the panel and in help, as Blender writes tooltips: without a full stop."""
    tables = {k: v for k, v in vars(choices).items() if k.isupper() and isinstance(v, dict)}
    assert {"BASES", "OCCLUSIONS", "GROUNDS", "ENGINES", "SPACES", "QUALITIES"} <= tables.keys()
    for table in tables.values():
        assert len({one.label for one in table.values()}) == len(table) > 1
        for one in table.values():
            assert one.label and one.description and not one.description.endswith(".")


def test_the_rooms_know_what_can_be_chosen():
    assert all(callable(getattr(bases, name)) for name in choices.BASES)
    assert choices.BASIS in choices.BASES
    assert set(choice.CANDIDATES) <= set(choices.BASES)
    assert list(choices.SPACES) == list(working_spaces.WORKING_SPACES)
    assert list(choices.QUALITIES) == list(simulation.QUALITIES)
    assert tuple(choices.UNITS) == checks.UNITS
    assert {"auto", *ground.CHOICES} == set(choices.GROUNDS)


@pytest.mark.blender
def test_blender_has_the_engines():
    pytest.importorskip("bpy")
    from spectral_skylight.addon.scene.output import render_task

    assert list(render_task.engines()) == list(choices.ENGINES)


def test_choices_as_a_sentence():
    assert choices.listed(["a"]) == "a"
    assert choices.listed(["a", "b"]) == "a or b"
    assert choices.listed(iter("abc")) == "a, b or c"
