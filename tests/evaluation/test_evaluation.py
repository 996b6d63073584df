"""The evaluation: light whose answer is known, measured light, a day, and what is written."""

import csv
import json

import colour
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.evaluation import charts, day, report
from spectral_skylight.addon.evaluation.evaluation import BEST, TODAY, evaluate
from spectral_skylight.addon.sky.simulation import PAPER
from spectral_skylight.addon.spectra import bases
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, resample
from spectral_skylight.addon.spectra.light import read_light

ROUNDING = 1e-9
"""Of sums of 81 float64 products and a 3x3 solution."""


@pytest.fixture(scope="module")
def checker():
    return colorchecker()[1]


def by_method(errors):
    return {one.method: one for one in errors}


def test_colorchecker_is_in_the_chart_s_order():
    names, values = colorchecker()
    assert names[0] == "dark skin" and names[17] == "cyan" and values.shape == (24, 81)


def test_light_of_the_basis_leaves_no_error(checker):
    lights = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [5, 1, 2]]) @ bases.rayleigh()
    errors = by_method(evaluate(lights, checker, ["rayleigh"]))
    assert errors["rayleigh"].relative.max() < ROUNDING
    assert errors["rayleigh"].delta_E.max() < 1e-6  # its square root magnifies rounding
    assert errors[BEST].relative.max() < ROUNDING
    assert errors[next(iter(TODAY))].delta_E.max() > 1


def test_today_s_way_is_right_where_it_was_meant_to_be(checker):
    """RGB × RGB holds for the light its albedo was made under, and for every grey."""
    D65 = colour.SDS_ILLUMINANTS["D65"]
    light = resample(D65.wavelengths, D65.values)
    for name in TODAY:
        assert by_method(evaluate(light, checker))[name].relative.max() < ROUNDING
        greys = evaluate(bases.rayleigh(), np.full((1, 81), 0.3))
        assert by_method(greys)[name].relative.max() < ROUNDING


def test_nothing_fits_better_than_least_squares(checker):
    rng = np.random.default_rng(2)
    lights = rng.uniform(0.1, 1.0, (12, 3)) @ bases.rayleigh() * rng.uniform(0.8, 1.2, (12, 81))
    errors = by_method(evaluate(lights, checker))
    # One material, lights of like luminance: the sum of squares is what the fit made smallest.
    grey = np.full((1, 81), 0.5) * np.linspace(0.2, 1, 81)
    squares = {e.method: (e.relative**2).sum() for e in evaluate(lights, grey)}
    assert squares[BEST] <= 1.05 * min(squares.values())
    assert errors[BEST].delta_E.mean() < errors["rayleigh"].delta_E.mean()


def test_a_light_s_size_does_not_count(checker):
    lights = np.stack([*bases.rayleigh(), bases.daylight()[0]])
    one, other = (evaluate(x, checker) for x in (lights, lights * [[1], [1e6], [1e-6], [3]]))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a.delta_E, b.delta_E, atol=1e-6)


def test_a_camera_s_errors_hold_its_picture_of_the_sky_too():
    """A white diffuser shows the sky itself: no error in the basis, some outside it."""
    white = np.ones((1, 81))
    inside = by_method(evaluate(bases.rayleigh(), white, camera="Nikon 5100"))
    assert inside["rayleigh"].relative.max() < ROUNDING
    outside = by_method(evaluate(bases.daylight()[:1], white, camera="Nikon 5100"))
    assert outside["rayleigh"].relative.max() > 1e-3


def test_elevations_are_one_or_one_for_each(checker):
    lights = bases.rayleigh()
    one = by_method(evaluate(lights, checker, sun_elevation=10.0))
    each = by_method(evaluate(lights, checker, sun_elevation=[10.0, 10.0, 10.0]))
    method = "atmosphere, elevation known"
    np.testing.assert_array_equal(one[method].delta_E, each[method].delta_E)
    with pytest.raises(InputError, match="2 elevations for 3 spectra"):
        evaluate(lights, checker, sun_elevation=[1.0, 2.0])


def test_measured_daylight_has_the_known_marks(shared_data, checker):
    """Figures that others found with code of their own, over the ColorChecker."""
    light = read_light(shared_data / "sky/stanford_dicarlo/daylightSpectra.csv")
    errors = by_method(evaluate(light.values, checker, ["rayleigh"]))
    # Design, section 2, and issue 1: 0.54 and at most 0.17, given to two digits.
    assert errors["RGB × RGB in Rec.709"].delta_E.mean() == pytest.approx(0.54, abs=0.005)
    assert 0.15 < errors["rayleigh"].delta_E.mean() < 0.175
    assert errors[BEST].delta_E.mean() < errors["rayleigh"].delta_E.mean()


def test_an_even_sky_lights_a_face_by_what_it_sees():
    """Quadrature over the faces: all of an even sphere is 1; of a half, (1 + cos tilt) / 2."""
    weights = day.face_weights()
    upper = np.arange(weights.shape[1]) < weights.shape[1] // 2
    # The points inside the pixels are 0.6° apart.
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-4)
    expected = (1 + np.cos(np.radians([0, *[45] * 4, *[90] * 4]))) / 2
    np.testing.assert_allclose(weights[:, upper].sum(axis=1), expected, atol=2e-3)


@pytest.fixture(scope="module")
def paper_day():
    return day.simulate_day(
        "2025-03-20", 35.68, 139.77, "+9", step=120, atmosphere=PAPER, orders=2, cached=False
    )


def test_the_day_runs_from_sunrise_to_sunset(paper_day):
    assert np.all(paper_day.elevations >= 0) and paper_day.hours[0] == 6.0
    assert paper_day.hours[-1] == 16.0  # sunset is at 17:53
    assert paper_day.light.shape == (6, 9, 81) and np.all(paper_day.light > 0)
    east, west = (day.FACE_NAMES.index(f"vertical {side}") for side in "EW")
    morning = paper_day.light[1].sum(axis=-1)
    assert morning[east] > morning[west]


def test_the_paper_s_claims_hold_under_its_own_sky(paper_day, checker):
    """Tachi's text: under 0.01 from 12 to 16; better by high sun and on horizontal faces."""
    lights = paper_day.light.reshape(-1, 81)
    found = report.claims(paper_day, evaluate(lights, checker, ["rayleigh"]), checker)
    assert found["first_material_up_12_to_16_max"] < 0.01
    assert found["mean_high_sun"] < found["mean_low_sun"]
    assert found["mean_face_up"] < found["mean_faces_vertical"]
    assert 10 < found["times_smaller_than_rgb"]["median"] < 100


def test_a_day_without_sun_is_refused():
    with pytest.raises(InputError, match="no sun rises"):
        day.simulate_day("2025-12-21", 80.0, 0.0)
    with pytest.raises(InputError, match="step"):
        day.simulate_day("2025-12-21", 0.0, 0.0, step=1)


@pytest.fixture
def light_file(tmp_path):
    path = tmp_path / "light.csv"
    rows = np.column_stack([WAVELENGTHS, *bases.rayleigh(), bases.daylight()[0]])
    lines = [",".join(f"{x:.8g}" for x in row) for row in rows]
    path.write_text("\n".join(["nm,a,b,c,d", *lines]), encoding="utf-8")
    return path


def test_the_command_writes_figures_and_json(tmp_path, light_file, capsys):
    pytest.importorskip("matplotlib")
    out = tmp_path / "out"
    arguments = ["evaluate", "--daylight", str(light_file), "--out", str(out), "--json"]
    assert cli.main([*arguments, "--basis", "rayleigh", f"measured {light_file}"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert (result["spectra"], result["materials"]) == (4, 24)
    methods = {method["method"]: method for method in result["methods"]}
    assert set(methods) == {*TODAY, "rayleigh", "measured light.csv", BEST}
    for method in methods.values():
        for measure in ("delta_E", "relative_error"):
            assert 0 <= method[measure]["mean"] <= method[measure]["max"]
            assert method[measure]["p95"] <= method[measure]["max"]
    assert (out / "daylight.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (out / "daylight.svg").read_text(encoding="utf-8")
    with (out / "daylight.csv").open(encoding="utf-8") as handle:
        rows = list(csv.DictReader(handle))
    assert [row["method"] for row in rows] == [m["method"] for m in result["methods"]]


def test_the_figures_are_the_same_bytes_each_time(tmp_path, light_file):
    pytest.importorskip("matplotlib")
    rho, light = colorchecker()[1], read_light(light_file)
    for folder in "ab":
        report.report_light(tmp_path / folder, light, rho, ["rayleigh"])
    for one in (tmp_path / "a").iterdir():
        assert one.read_bytes() == (tmp_path / "b" / one.name).read_bytes(), one.name


def test_without_matplotlib_one_line_names_the_cure(tmp_path, light_file, monkeypatch, capsys):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    assert cli.main(["evaluate", "--daylight", str(light_file), "--out", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert "pip install matplotlib" in message and message.count("\n") == 1


@pytest.mark.slow
def test_a_whole_day_is_written(tmp_path, checker):
    pytest.importorskip("matplotlib")
    names = colorchecker()[0]
    place = ("2025-03-20", 35.68, 139.77, "+9")
    result = report.report_day(tmp_path, place, (names, checker), ["rayleigh"], step=180)
    stems = {"figure1", "figure2", "table_paper", "table_full"}
    expected = {f"{stem}{suffix}" for stem in stems for suffix in (".png", ".svg", ".csv")}
    assert {path.name for path in tmp_path.iterdir()} == expected
    assert set(result["skies"]) == set(report.AIRS)
    with (tmp_path / "table_full.csv").open(encoding="utf-8") as handle:
        rows = list(csv.DictReader(handle))
    hours = len(result["skies"]["full atmosphere"]["hours"])
    assert len(rows) == hours * 9 * 24
    assert charts.FACE_NAMES[0] == rows[0]["face"] == "up"
