"""The chart: its figures where they are known, its front, its picture, its command."""

import csv
import json
import sys
from itertools import combinations

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.evaluation import chart, chart_picture, chart_report, speed
from spectral_skylight.addon.evaluation.chart import Row, front, full_skies, rows, whole
from spectral_skylight.addon.evaluation.evaluation import Errors, evaluate
from spectral_skylight.addon.evaluation.light_methods import LIGHT_METHODS
from spectral_skylight.addon.evaluation.light_places import PLACES
from spectral_skylight.addon.evaluation.methods import METHODS, rgb_times_rgb
from spectral_skylight.addon.evaluation.one_light import ways
from spectral_skylight.addon.spectra import bases, illuminants
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def checker():
    return colorchecker()[1]


@pytest.fixture(scope="module")
def skies():
    return full_skies([5.0])


@pytest.fixture(scope="module")
def found(skies, checker):
    """Every row, timed once; with a method that the registry does not hold."""
    further = rgb_times_rgb("in CIE XYZ", lambda: np.eye(3))
    return rows(skies, checker, rounds=1, methods={**METHODS, "in CIE XYZ": further})


def of(found, kind):
    return {row.name: row for row in found if row.kind == kind}


def test_every_method_has_its_row_and_so_has_a_further_one(found):
    materials = of(found, "material")
    assert list(materials) == [*METHODS, "in CIE XYZ"]
    knowing = {name for name, method in LIGHT_METHODS.items() if method.knows_walls}
    assert set(of(found, "light")) == set(LIGHT_METHODS) - knowing
    assert set(of(found, "walls")) == {*knowing, "degree 4, walls ignored"}
    for kind in ("sun", "ground", "glass", "lamp"):
        assert list(of(found, kind)) == list(ways(kind))
    # Two skies: of their faces, their suns, four grounds and three panes for each; and four lamps.
    count = {"walls": 30, "sun": 2, "ground": 8, "glass": 6, "lamp": 4}
    for row in found:
        lights = count.get(row.kind, 18)
        assert row.errors.delta_E.shape == row.errors.relative.shape == (lights, 24)
        assert np.isfinite(row.errors.delta_E).all() and min(row.nanoseconds) > 0


def test_memory_is_what_shading_reads(found):
    """Float32: RGB is 3 numbers, a matrix 9, N bands 3 N a material and N a pixel."""
    expected = {
        "RGB × RGB in Rec.709": (12, 12),
        "rayleigh": (36, 12),
        "six channels, 3x6": (72, 24),
        "16 bands": (192, 64),
        "81 bands": (972, 324),
        "Jakob-Hanika": (972, 12),
    }
    materials = of(found, "material")
    for name, sizes in expected.items():
        assert (materials[name].state_bytes, materials[name].pixel_bytes) == sizes
    assert of(found, "light")["degree 6"].state_bytes == 49 * 12
    assert of(found, "light")["texture 64 × 32"].state_bytes == 64 * 32 * 12
    visibility = of(found, "walls")["visibility, 25 coefficients"]
    assert (visibility.state_bytes, visibility.pixel_bytes) == (300, 100)


def test_full_spectra_are_exact_and_on_the_front(found):
    exact = of(found, "material")["81 bands"]
    assert exact.errors.delta_E.max() < 1e-6  # rounding, magnified by a square root
    assert exact in front(of(found, "material").values())


def test_the_more_is_held_the_nearer(found):
    light, walls = of(found, "light"), of(found, "walls")
    for names in (
        ("degree 0", "degree 1", "degree 2", "degree 4", "degree 6"),
        ("texture 16 × 8", "texture 64 × 32"),
    ):
        errors = [light[name].errors.delta_E.mean() for name in names]
        assert errors == sorted(errors, reverse=True)
    ladder = ["degree 4, walls ignored", "degree 4 × ambient occlusion"]
    # How many coefficients hardly counts where bounces miss: `test_light_methods` has that alone.
    ladder += [f"visibility, 25 coefficients{more}" for more in ("", ", and all bounces")]
    errors = [walls[name].errors.delta_E.mean() for name in ladder]
    assert errors == sorted(errors, reverse=True)


def test_what_a_method_needs_is_known(found):
    materials = of(found, "material")
    needs = {name for name, row in materials.items() if row.needs_more}
    assert {"RGB × RGB in Rec.709, own white", "six channels, 3x6", "4 bands"} <= needs
    assert not {"RGB × RGB in Rec.709", "atmosphere, elevation known", "Otsu"} & needs
    assert {n for n, row in materials.items() if row.is_limit} == {"best diagonal", "best 3x3"}


def row(name, nanoseconds, error, told=()):
    errors = Errors(name, np.full((1, 1), error), np.full((1, 1), error))
    return Row("material", name, "3x3", told, errors, (nanoseconds, nanoseconds), 0.0, 36, 12)


def test_materials_in_measured_light(skies, checker, monkeypatch, tmp_path):
    """As `evaluate` has it for the same spectra; what needs the sun's elevation only with one."""
    monkeypatch.setattr(chart, "cases", lambda _: {})
    spectra = 7.0 * illuminants.daylight([5000.0, 6500.0, 9000.0])
    elevation = "atmosphere, elevation known"
    some = {name: METHODS[name] for name in ("RGB × RGB in Rec.709", "atmosphere", elevation)}
    options = {"rounds": 1, "methods": some, "light_methods": {}}
    found = rows(skies, checker, measured=chart.measured_skies(spectra), **options)
    assert [row.name for row in found if row.kind == "material"] == [*some][:2]
    expected = {errors.method: errors for errors in evaluate(spectra, checker)}
    for row in found:
        np.testing.assert_allclose(row.errors.delta_E, expected[row.name].delta_E)
    found = rows(skies, checker, measured=chart.measured_skies(spectra, 40.0), **options)
    assert [row.name for row in found if row.kind == "material"] == [*some]


def test_the_front_holds_what_nothing_beats():
    some = [
        row("fast", 1.0, 2.0),
        row("beaten", 2.0, 2.5),
        row("hardly faster than the next", 9.0, 0.6),
        row("near", 10.0, 0.5),
        row("slow and no nearer", 50.0, 0.5),
        row("limit", 0.5, 0.1, ("truth",)),
        row("exact", 100.0, 0.0),
    ]
    expected = ["fast", "near", "exact"]
    assert [one.name for one in front(some)] == expected
    assert [one.name for one in front(reversed(some))] == expected
    assert front([]) == []


def test_light_and_material_together(skies, checker):
    """Both errors are in it: less than their sum, and more than the material's alone."""
    today = METHODS["RGB × RGB in Rec.709"]
    eevee = whole(LIGHT_METHODS["Eevee's own world light"], today, skies, checker)
    fine = whole(LIGHT_METHODS["texture 64 × 32"], today, skies, checker)
    matrix = METHODS["atmosphere, elevation known"]
    ours = whole(LIGHT_METHODS["degree 6"], matrix, skies, checker)
    assert ours.delta_E.mean() < 0.5 * fine.delta_E.mean() < 0.5 * eevee.delta_E.mean()
    # All of the light's spectrum, but for what pixels of 3.8° miss at the horizon.
    exact = METHODS["best 3x3"]
    assert whole(LIGHT_METHODS["degree 6"], exact, skies, checker).relative.mean() < 0.02


def test_light_is_the_same_from_spectra_and_from_the_picture(skies):
    """Two quadratures over one sky: they part by what they miss at the edges of faces."""
    for one in skies:
        spectral = one.sky.lights @ chart.observer().T
        seen = PLACES["open"].irradiance(one.dome)
        np.testing.assert_allclose(seen, spectral, rtol=0.01)
        assert spectral[0] @ chart.LUMINANCE == pytest.approx(1.0)


def test_tasks_that_differ_in_their_numbers_alone_take_the_same_time():
    state, pixels = np.ones((3, 3)), np.ones((3, 5))
    tasks = {name: (np.matmul, k * state, pixels) for k, name in enumerate("ab")}
    times = speed.nanoseconds({**tasks, "c": (np.matmul, np.ones((3, 6)), np.ones((6, 5)))}, 2)
    assert times["a"] == times["b"] and set(times) == {"a", "b", "c"}


def test_names_are_inside_the_picture_and_over_none(found, monkeypatch, tmp_path):
    figures = []
    monkeypatch.setattr(chart_picture, "write", lambda figure, stem: figures.append(figure) or [])
    strip = {"Diffuse": (1.0, "light"), "Skylight Surface": (1.1, "light")}
    chart_picture.draw(tmp_path / "chart", found, strip, ["caption"])
    (figure,) = figures
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    renderer = FigureCanvasAgg(figure).get_renderer()
    named = 0
    for axis in figure.axes[:2]:
        boxes = {text.get_text(): text.get_window_extent(renderer) for text in axis.texts}
        named += len(boxes)
        inside = axis.get_window_extent(renderer)
        for name, box in boxes.items():
            assert inside.x0 <= box.x0 and box.x1 <= inside.x1, name
            assert inside.y0 <= box.y0 and box.y1 <= inside.y1, name
        for (one, first), (other, second) in combinations(boxes.items(), 2):
            assert not first.overlaps(second), f"{one} over {other}"
    drawn = [kind for kinds in chart_picture._PANELS.values() for kind in kinds]
    assert named == sum(row.kind in drawn for row in found)


@pytest.fixture
def basis_file(tmp_path):
    path = tmp_path / "light.csv"
    table = np.column_stack([WAVELENGTHS, *bases.rayleigh()])
    lines = [",".join(f"{x:.8g}" for x in line) for line in table]
    path.write_text("\n".join(["nm,a,b,c", *lines]), encoding="utf-8")
    return path


def test_the_command_writes_picture_and_tables(tmp_path, basis_file, capsys):
    out = tmp_path / "out"
    arguments = ["chart", "--out", out, "--skies", 30, "--eevee", 0, "--rounds", 1, "--json"]
    arguments += ["--basis", f"measured {basis_file}"]
    assert cli.main([str(argument) for argument in arguments]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["sun_elevations"] == [30.0] and result["materials"] == 24
    assert {"date", "processor", "cores", "system", "python", "numpy"} <= result["made"].keys()
    names = [method["method"] for method in result["methods"]]
    assert "measured light.csv" in names and set(METHODS) <= set(names)
    assert result["eevee"] == []
    assert {path.name for path in out.iterdir()} == {"chart.png", "chart.svg", "chart.csv"}
    assert (out / "chart.png").read_bytes().startswith(b"\x89PNG")
    text = (out / "chart.svg").read_text(encoding="utf-8")
    assert "<svg" in text and "Pareto front" in text and "measured light.csv" in text
    with (out / "chart.csv").open(encoding="utf-8") as handle:
        table = list(csv.DictReader(handle))
    assert [line["method"] for line in table] == names
    on_front = {line["method"] for line in table if line["on_front"] == "True"}
    assert on_front == {name for some in result["fronts"].values() for name in some}


def test_what_eevee_costs_stands_beside_what_it_shows(tmp_path, found, skies, checker):
    costs = {
        name: {"ratio": ratio, "ms_wall": 1.0}
        for name, ratio in (("Diffuse", 1.0), ("Emission", 0.9), ("Skylight Surface", 1.1))
    }
    result = chart_report.report_chart(tmp_path, found, skies, checker, costs, "5.0")
    diffuse, emission, ours = result["eevee"]
    assert ours["mean_delta_E"] < diffuse["mean_delta_E"] and emission["mean_delta_E"] is None
    with (tmp_path / "eevee.csv").open(encoding="utf-8") as handle:
        table = list(csv.DictReader(handle))
    assert [line["material"] for line in table] == [*costs] and table[1]["mean_delta_E"] == ""
    assert "Blender 5.0" in (tmp_path / "chart.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "part"),
    [
        (["--rounds", "0"], "--rounds"),
        (["--eevee", "-1"], "--eevee"),
        (["--skies", "95"], "--sun-elevation"),
        (["--skies", "high"], "--skies"),
        (["--daylight", "none.csv"], "none.csv"),
        (["--sun-elevation", "10"], "--daylight"),
        (["--reflectances", "none.csv"], "none.csv"),
        (["--basis", "fourier", "--skies", "30"], "--basis"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, capsys, options, part):
    assert cli.main(["chart", "--out", str(tmp_path / "out"), *options]) == 2
    error = capsys.readouterr().err
    assert part in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_without_matplotlib_it_is_said_at_once(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert cli.main(["chart", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "pip install matplotlib" in error and error.count("\n") == 1


def test_stopped_it_leaves_nothing(tmp_path, monkeypatch, capsys):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(chart, "full_skies", lambda *_: [])
    monkeypatch.setattr(chart, "rows", stop)
    assert cli.main(["chart", "--out", str(tmp_path / "out")]) == 1
    assert "stopped" in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_without_blender_the_rest_is_charted(tmp_path, monkeypatch, capsys):
    given = []

    def report(out, found, skies, rho, costs, blender):
        given.append((costs, blender))
        return {"methods": [], "eevee": [], "files": []}

    monkeypatch.setitem(sys.modules, "spectral_skylight.addon.scene.output.eevee_cost", None)
    monkeypatch.delattr("spectral_skylight.addon.scene.output.eevee_cost", raising=False)
    monkeypatch.setattr(chart, "full_skies", lambda *_: [])
    monkeypatch.setattr(chart, "rows", lambda *_, **__: [])
    monkeypatch.setattr(chart_report, "report_chart", report)
    assert cli.main(["chart", "--out", str(tmp_path)]) == 0
    assert "Eevee is not measured" in capsys.readouterr().err
    assert given == [({}, None)]
