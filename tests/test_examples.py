"""The main job as a user starts it, from nothing to pictures and report."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from spectral_skylight.tests import exr

pytest.importorskip("bpy", reason="bpy is not installed")

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
MAIN_JOB = EXAMPLES / "main_job.py"
LIT = "sun", "courtyard", "street", "gloss", "glass"
"""One of each kind: what the five others build and judge is built and judged in these, too."""


@pytest.mark.slow
def test_main_job(tmp_path):
    subprocess.run([sys.executable, str(MAIN_JOB), "--out", str(tmp_path)], check=True)
    for scene in ("checker", "building"):
        assert (tmp_path / f"{scene}.png").is_file()
        for kind in ("rgb", "spectral", "reference"):
            for form in ("exr", "png"):
                assert (tmp_path / f"{scene}_{kind}.{form}").stat().st_size > 1000
    report = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert len(report["patches"]) == 24
    patches = {patch["patch"]: patch for patch in report["patches"]}
    # Its red is negative in Rec.709: said, and not to be had by any matrix in a clamping shader.
    assert "cyan" in report["out_of_gamut"] and patches["cyan"]["reference_rgb"][0] < 0
    inside = [patch for name, patch in patches.items() if name not in report["out_of_gamut"]]
    # Under a single-scattered sky the basis is exact to the third scattering, and the polynomial
    # leaves under 1 %: 0.2 CIEDE2000 leaves room for both (0.12 seen).
    assert max(patch["delta_E_spectral"] for patch in inside) < 0.2
    assert report["mean_ratio"] > 2
    # Judged with every bounce: ours is nearer than RGB × RGB in our light.
    building = report["building"]
    assert building["spectral"]["mean"] < building["rgb"]["mean"]
    assert building["noise"]["mean"] < 0.25


@pytest.mark.slow
def test_main_job_says_what_is_wrong_with_a_sky(tmp_path):
    process = subprocess.run(
        [sys.executable, str(MAIN_JOB), "--sky", str(MAIN_JOB), "--out", str(tmp_path)],
        capture_output=True,
        text=True,
    )
    assert process.returncode == 2 and "examples/run: " in process.stderr.splitlines()[-1]


@pytest.fixture(scope="module")
def lit(tmp_path_factory):
    """All lit examples, small and noisy, in one process: Eevee compiles its shaders once."""
    out = tmp_path_factory.mktemp("lit")
    options = ["--samples", "8", "--width", "48", "--out", str(out)]
    subprocess.run([sys.executable, str(EXAMPLES / "lit.py"), *LIT, *options], check=True)
    return out


@pytest.mark.slow
@pytest.mark.parametrize("name", LIT)
def test_lit_example(name, lit):
    """That it runs, and that the report says what it should."""
    out = lit / name
    for picture in (name, "rgb", "eevee", "rgb_same", "spectral", "reference"):
        assert (out / f"{picture}.png").stat().st_size > 500  # burnt out, they are small
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    beside = report["beside"].values()
    for errors in (*(report[way] for way in ("spectral", "rgb_same", "rgb", "eevee")), *beside):
        for error in errors["delta_E"], errors["colour"]:
            assert 0 <= error["mean"] <= error["worst"] and error["p95"] <= error["worst"]
    assert set(report["seconds"]) >= {"scene", "spectral", "eevee", "referee"}
    if name == "courtyard":  # shadows baked, live and not at all
        ours, live, none = (each["delta_E"]["mean"] for each in (report["spectral"], *beside))
        assert ours < live < none
    referee = report["referee"]
    # Of 16 samples; a wrong scene is off by tens.
    assert 0 < referee["noise"]["mean"] < 6 and 0 < referee["rgb_noise"]["mean"] < 6
    assert report["pixels"]["judged"] > 100 and report["blender"]
    # Between walls light bounces; where nothing stands beside, it does not.
    if name in ("courtyard", "street", "glass"):
        assert referee["bounced"] > 0.1
    if name == "gloss":
        assert referee["bounced"] < 0.01


@pytest.mark.slow
def test_the_example_house(tmp_path):
    """The panel's first minute: both pictures, and light that changes more than noise does."""
    house = [sys.executable, str(EXAMPLES / "house.py"), "--width", "60", "--samples", "8"]
    subprocess.run([*house, "--out", str(tmp_path)], check=True)
    today, ours = (exr.picture(tmp_path / f"{name}.exr") for name in ("eevee", "spectral"))
    assert today.shape == ours.shape and (tmp_path / "house.png").stat().st_size > 1000
    sky = slice(0, 2)  # above the chimney
    assert ours[sky, :, :3] == pytest.approx(today[sky, :, :3], rel=1e-3, abs=1e-3)
    change = abs(ours[16:, :, :3] - today[16:, :, :3]).mean() / today[16:, :, :3].mean()
    assert 0.02 < change < 0.5
