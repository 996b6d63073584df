"""What tests of more than one way to render a plan share."""

import os
import subprocess
import sys

import pytest


@pytest.fixture(scope="session")
def elsewhere(tmp_path_factory):
    """The environment of a machine that has Blender and Dask, but not this package."""
    shadow = tmp_path_factory.mktemp("shadow")
    (shadow / "spectral_skylight.py").write_text("raise ImportError('is not on this machine')\n")
    environment = {**os.environ, "PYTHONPATH": str(shadow)}
    gone = subprocess.run(
        [sys.executable, "-c", "import spectral_skylight"], env=environment, capture_output=True
    )
    assert b"is not on this machine" in gone.stderr
    return environment
