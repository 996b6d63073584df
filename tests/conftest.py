"""What several rooms' tests share."""

import os
import sys
from pathlib import Path

import pytest
from hypothesis import settings

# How long an example takes says what else the machine does.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

OPTIONAL = {"bpy", "dask", "distributed", "matplotlib", "psutil", "pvlib", "quickjs"}
"""What the numbers alone do without."""

_exit_status = 0


class Module(pytest.Module):
    """A file of tests, skipped as a whole where something optional that it imports is missing."""

    def collect(self):
        try:
            return super().collect()
        except self.CollectError as error:
            cause = error.__cause__
            if isinstance(cause, ModuleNotFoundError) and cause.name in OPTIONAL:
                pytest.skip(f"{cause.name} is not installed", allow_module_level=True)
            raise


def pytest_pycollect_makemodule(module_path, parent):
    """Make the modules of this folder such ones."""
    return Module.from_parent(parent, path=module_path)


def pytest_sessionfinish(exitstatus):
    """Keep the status for `pytest_unconfigure`, which is not told it."""
    global _exit_status
    _exit_status = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure():
    """Leave at once where bpy was used: before 5.0 it can crash at interpreter exit."""
    if "bpy" in sys.modules:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_exit_status)


@pytest.fixture(scope="session", autouse=True)
def cache_of_its_own(tmp_path_factory):
    """Keep simulated skies for this run only: neither the user's old ones nor new ones for them."""
    before = os.environ.get("SPECTRAL_SKYLIGHT_CACHE")
    os.environ["SPECTRAL_SKYLIGHT_CACHE"] = str(tmp_path_factory.mktemp("cache"))
    yield
    os.environ.pop("SPECTRAL_SKYLIGHT_CACHE")
    if before is not None:
        os.environ["SPECTRAL_SKYLIGHT_CACHE"] = before


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The measured skies, reflectances and cameras beside the repository; skips without them."""
    path = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not path.is_dir():
        pytest.skip(f"no measured data at {path}")
    return path


@pytest.fixture(scope="module")
def addon():
    """The add-on enabled, and disabled again."""
    import spectral_skylight

    spectral_skylight.register()
    yield spectral_skylight
    spectral_skylight.unregister()
