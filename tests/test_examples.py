"""The main job as a user starts it, from nothing to pictures and report."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="bpy is not installed")

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
MAIN_JOB = EXAMPLES / "main_job.py"
LIT = "sun", "courtyard", "bounce", "dusk", "texture", "gloss", "glass"


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


@pytest.mark.slow
def test_main_job_says_what_is_wrong_with_a_sky(tmp_path):
    process = subprocess.run(
        [sys.executable, str(MAIN_JOB), "--sky", str(MAIN_JOB), "--out", str(tmp_path)],
        capture_output=True,
        text=True,
    )
    assert process.returncode == 2 and "examples/run: " in process.stderr.splitlines()[-1]


@pytest.mark.slow
@pytest.mark.parametrize("name", LIT)
def test_lit_example(name, tmp_path):
    """Small and noisy: that it runs, and that the report says what it should."""
    options = ["--samples", "16", "--width", "48", "--out", str(tmp_path)]
    subprocess.run([sys.executable, str(EXAMPLES / "lit.py"), name, *options], check=True)
    out = tmp_path / name
    for picture in (name, "rgb", "eevee", "rgb_same", "spectral", "reference"):
        assert (out / f"{picture}.png").stat().st_size > 500  # burnt out, they are small
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    for way in ("spectral", "rgb_same", "rgb", "eevee"):
        for error in report[way]["delta_E"], report[way]["colour"]:
            assert 0 <= error["mean"] <= error["worst"] and error["p95"] <= error["worst"]
    assert set(report["seconds"]) >= {"scene", "spectral", "eevee", "referee"}
    if name == "courtyard":  # shadows baked, live and not at all
        baked, live, none = (
            each["delta_E"]["mean"] for each in (report["spectral"], *report["beside"].values())
        )
        assert baked < live < none
    assert 0 < report["referee"]["noise"]["mean"] < 3  # of 32 samples; a wrong scene is off by tens
    assert report["pixels"]["judged"] > 100 and report["blender"]
