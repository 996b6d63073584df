"""The command line's contracts: outputs, exit codes, one-line errors, nothing half-written."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.tests import exr

X = np.arange(380, 781, 20)


@pytest.fixture
def csv(tmp_path):
    path = tmp_path / "paint.csv"
    red = 0.05 + 0.8 / (1 + np.exp((600 - X) / 10))
    rows = [f"{x},{r:.6f},0.5" for x, r in zip(X, red, strict=True)]
    path.write_text("\n".join(["wavelength_nm,red,grey", *rows]), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def sky(tmp_path_factory):
    path = tmp_path_factory.mktemp("sky") / "sky.exr"
    assert cli.main(["sky", "--sun-elevation", "30", "--width", "128", "--out", str(path)]) == 0
    return path


def run(capsys, *arguments):
    code = cli.main([str(argument) for argument in arguments])
    out, err = capsys.readouterr()
    return code, out, err


def test_matrix_prints_json_in_column_order(capsys, csv):
    code, out, _ = run(capsys, "matrix", csv, csv, "--json")
    result = json.loads(out)
    assert code == 0
    assert [m["name"] for m in result["materials"]] == ["red", "grey", "red", "grey"]
    assert result["basis"] == "atmosphere" and result["space"] == "Linear Rec.709"
    np.testing.assert_allclose(result["materials"][1]["matrix"], 0.5 * np.eye(3), atol=1e-12)


def test_matrix_of_a_balanced_sky(capsys, csv):
    plain = json.loads(run(capsys, "matrix", csv, "--json")[1])["materials"][0]["matrix"]
    white = "0.5,1,2"
    balanced = json.loads(run(capsys, "matrix", csv, "--white", white, "--json")[1])
    D = np.diag([2, 1, 0.5])
    np.testing.assert_allclose(
        balanced["materials"][0]["matrix"], D @ plain @ np.linalg.inv(D), atol=1e-12
    )


def test_matrix_predicts_under_a_sky(capsys, csv, sky):
    for options in (["--sky", sky], ["--sky-rgb", "0.2,0.35,0.7"]):
        red, grey = json.loads(run(capsys, "matrix", csv, *options, "--json")[1])["materials"]
        assert red["predicted_delta_E"]["rgb"] > 2 * red["predicted_delta_E"]["matrix"]
        assert grey["predicted_delta_E"]["rgb"] < 1e-6  # RGB times RGB is right for grey
        assert not red["out_of_gamut"]


def test_matrix_for_people(capsys, csv, sky):
    code, out, err = run(capsys, "matrix", csv, "--sky", sky)
    assert code == 0 and "3x3, ΔE 0." in out and "RGB × RGB " in out
    assert "read as fraction" in err


def test_matrix_with_a_tolerance_takes_the_least_model(capsys, csv, sky):
    command = ("matrix", csv, "--sky", sky, "--tolerance")
    for options, models, basis in (
        ([], ["3x3", "scalar"], "rayleigh"),  # the sky knows its spectra: red is off by 0.3
        ([0.2], ["3x3", "scalar"], "own spectrum"),
        ([60], ["scalar", "scalar"], "rayleigh"),
        ([60, "--basis", "daylight"], ["scalar", "scalar"], "daylight"),
    ):
        found = json.loads(run(capsys, *command, *options, "--json")[1])
        assert [m["model"] for m in found["materials"]] == models and found["basis"] == basis
    M = np.array(found["materials"][0]["matrix"])
    np.testing.assert_allclose(M, M[0, 0] * np.eye(3), atol=1e-12)


def test_a_sky_of_no_sky_s_colour_is_unknown(capsys, csv):
    found = json.loads(run(capsys, "matrix", csv, "--sky-rgb", "0.1,1,0.1", "--json")[1])
    red = found["materials"][0]
    assert "predicted_delta_E" not in red and "not a color of skylight" in red["unknown"]


@pytest.mark.parametrize("rgb", ["nan,1,1", "1,inf,1"])
def test_a_sky_rgb_that_is_none_is_refused(capsys, csv, rgb):
    code, out, err = run(capsys, "matrix", csv, "--sky-rgb", rgb, "--json")
    assert code == 2 and not out and err.startswith("spectral-skylight: --sky-rgb: is not finite")


def test_the_simplest_basis_says_the_tolerance_it_keeps_to(capsys, csv):
    command = ("matrix", csv, "--sky-rgb", "0.2,0.35,0.7", "--basis", "simplest", "--json")
    assert json.loads(run(capsys, *command)[1])["tolerance"] == 0.5


def test_evaluate_names_the_matplotlib_that_it_misses(tmp_path):
    """In a process of its own: colour-science looks for it once, when it is imported."""
    missing = tmp_path / "matplotlib"
    missing.mkdir()
    (missing / "__init__.py").write_text("raise ImportError")
    start = "from spectral_skylight.addon.cli import main; raise SystemExit(main(sys.argv[1:]))"
    found = subprocess.run(
        [sys.executable, "-c", f"import sys; {start}", "evaluate", "--out", tmp_path / "out"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path[1:]])},
        capture_output=True,
        text=True,
    )
    assert found.returncode == 2 and found.stderr.count("\n") == 1
    assert "matplotlib: is needed to draw figures" in found.stderr


def test_predictions_are_of_one_basis(capsys, csv):
    command = ("evaluate", "--predicted", "--daylight", csv, "--basis", "rayleigh", "daylight")
    code, _, err = run(capsys, *command)
    assert code == 2 and "--basis: more than one with --predicted; give one" in err


def test_sky_writes_rgb_and_spectrum(capsys, tmp_path):
    rgb, spectral = tmp_path / "sky.exr", tmp_path / "spectral.exr"
    code, *_ = run(
        capsys, "sky", "--sun-elevation", 20, "--width", 32, "--out", rgb, "--spectral", spectral
    )
    assert code == 0
    channels = exr.planes(spectral)
    names = sorted(channels)
    assert len(names) == 81 and names[0] == "S0.380,000000nm" and names[-1] == "S0.780,000000nm"
    radiance = np.stack([channels[name] for name in names], axis=-1)
    seen = radiance @ transfer().S_out.T * 683.002 / 1e4
    np.testing.assert_allclose(read_panorama(rgb).rgb, np.maximum(seen, 0), rtol=1e-4, atol=1e-5)


def test_irradiance_undoes_white_balance(capsys, tmp_path, sky):
    white = np.array([0.8, 1.0, 1.3])
    balanced = tmp_path / "balanced.exr"
    write_panorama(balanced, read_panorama(sky).rgb / white)
    results = []
    for name, options in ((sky, []), (balanced, ["--white", "0.8,1,1.3"])):
        out = tmp_path / "E.exr"
        code, text, _ = run(capsys, "irradiance", name, "--out", out, "--json", *options)
        assert code == 0
        results.append((json.loads(text), read_panorama(out).rgb))
    (plain, E), (undone, E_undone) = results
    np.testing.assert_allclose(E_undone, E, rtol=1e-5)
    np.testing.assert_allclose(undone["coefficients"], plain["coefficients"], atol=1e-5)
    assert E.shape == (32, 64, 3) and len(plain["exponents"]) == (plain["degree"] + 1) ** 2


WRONG = {
    "unknown command": (["paint"], "invalid choice"),
    "no file": (["matrix"], "required"),
    "missing file": (["matrix", "none.csv", "--json"], "none.csv"),
    "unknown basis": (["matrix", "CSV", "--basis", "fourier"], "rayleigh"),
    "chart into a file": (["chart", "--out", "CSV"], "cannot be created as a folder"),
    "tolerance without end": (["matrix", "CSV", "--tolerance", "inf"], "above 0"),
    "tolerance of nothing": (["matrix", "CSV", "--tolerance", "0"], "above 0"),
    "unknown space": (["matrix", "CSV", "--space", "sRGB"], "ACEScg"),
    "unknown camera": (["matrix", "CSV", "--camera", "Brownie"], "Nikon 5100"),
    "white of two numbers": (["matrix", "CSV", "--white", "1,2"], "R,G,B"),
    "white with zero": (["matrix", "CSV", "--white", "1,0,2"], "above 0"),
    "missing sky": (["matrix", "CSV", "--sky", "none.exr"], "none.exr"),
    "sun too low": (["sky", "--sun-elevation", "-20", "--out", "OUT"], "-6 to 90"),
    "sky to nowhere": (["sky", "--sun-elevation", "20"], "--out"),
    "odd width": (["irradiance", "SKY", "--out", "OUT", "--width", "7"], "even"),
    "no sky": (["irradiance", "CSV", "--out", "OUT"], "paint.csv"),
    "folder that is not there": (
        ["sky", "--sun-elevation", "20", "--width", "16", "--out", "none/OUT"],
        "none",
    ),
    "assignment without =": (
        ["apply", "a.blend", "--assign", "wall", "--out", "OUT"],
        "--assign: 'wall' is not NAME=VALUE",
    ),
}


@pytest.mark.parametrize(("arguments", "part"), WRONG.values(), ids=WRONG.keys())
def test_wrong_usage_and_bad_input_are_one_line_and_code_2(
    capsys, tmp_path, csv, sky, arguments, part
):
    out = tmp_path / "out.exr"
    names = {
        "CSV": str(csv),
        "SKY": str(sky),
        "OUT": str(out),
        "none/OUT": str(tmp_path / "none/x"),
    }
    before = sorted(tmp_path.iterdir())
    code, printed, error = run(capsys, *(names.get(a, a) for a in arguments))
    assert code == 2 and printed == ""
    assert error.count("\n") == 1 and part in error
    assert sorted(tmp_path.iterdir()) == before  # nothing half-written


def test_help_is_no_error(capsys):
    assert run(capsys, "--help")[0] == 0
    for command in ("matrix", "sky", "irradiance", "apply", "render", "evaluate", "chart"):
        code, out, _ = run(capsys, command, "--help")
        assert code == 0 and "usage" in out
