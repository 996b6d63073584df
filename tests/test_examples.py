"""The main job as a user starts it, from nothing to pictures and report."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="bpy is not installed")

MAIN_JOB = Path(__file__).resolve().parents[1] / "examples" / "main_job.py"


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
