"""A plan on a real Flamenco 3, where environment variables point to one.

SKYLIGHT_FLAMENCO is the Manager's address, SKYLIGHT_FLAMENCO_SHARED a folder that this machine and
the workers share under one path. The Manager knows the job type, and a worker is awake.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

import pytest

from spectral_skylight.addon.batch.flamenco import submit
from spectral_skylight.tests.batch.small_plan import copy_plan, files, small_plan

MANAGER = os.environ.get("SKYLIGHT_FLAMENCO", "")
SHARED = os.environ.get("SKYLIGHT_FLAMENCO_SHARED", "")
PATIENCE = float(os.environ.get("SKYLIGHT_FLAMENCO_PATIENCE", "600"))

pytestmark = [
    pytest.mark.blender,
    pytest.mark.slow,
    pytest.mark.skipif(
        not (MANAGER and SHARED),
        reason="no Flamenco: SKYLIGHT_FLAMENCO and SKYLIGHT_FLAMENCO_SHARED are not set",
    ),
]


def test_a_real_farm_renders_a_plan(tmp_path):
    """Whole and as here; byte for byte only with the same build of Blender."""
    here = small_plan(tmp_path / "here", cameras=3)
    script = here.with_name("render_task.py")
    subprocess.run([sys.executable, script, "--", here], check=True, capture_output=True)
    with tempfile.TemporaryDirectory(dir=SHARED) as folder:
        there = copy_plan(here, Path(folder) / "plan")
        page = submit.submit(MANAGER, submit.job_of(there, 3))
        job = f"{MANAGER.rstrip('/')}/api/v3/jobs/{page.rpartition('/')[2]}"
        end = time.monotonic() + PATIENCE
        while (status := json.load(urllib.request.urlopen(job, timeout=30))["status"]) in (
            "queued", "active", "under-construction",
        ):  # fmt: skip
            assert time.monotonic() < end, f"{page} is {status}"
            time.sleep(2)
        assert status == "completed", page
        assert files(there).keys() == files(here).keys()
        if os.environ.get("SKYLIGHT_FLAMENCO_SAME_BLENDER"):
            assert files(there) == files(here)
