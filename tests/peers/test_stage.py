"""The examples' scenes as the peers get them: a closed form that both must find."""

from pathlib import Path

import numpy as np
import pytest

from spectral_skylight.tests.peers.peer import MISSING, PYTHON

pytest.importorskip("bpy", reason="bpy is not installed")
pytestmark = [
    pytest.mark.peers,
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON.exists(), reason=MISSING),
]


@pytest.fixture
def program(monkeypatch):
    """The examples' modules."""
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "examples"))
    import ways_peers

    return ways_peers


def test_a_plane_under_sky_sun_and_lamp_is_what_the_closed_form_says(program, tmp_path):
    """An even sky, a sun at 30° and a lamp 2 m above a plane whose reflectance rises with the
    wavelength: what the plane sends out is the reflectance times all light over pi."""
    import bands
    from geometry import look
    from stage import Lamp, Matter, Stage, Sun, Thing

    rho, one = np.linspace(0.2, 0.6, 81), np.full(81, 1e-3)
    ground = Thing("paint", [[(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]])
    sun = Sun(np.array([np.sqrt(0.75), 0.0, 0.5]), 2.0 * one)
    lamp = Lamp((0.0, 0.0, 2.0), one * np.linspace(0.0, 2.0, 81), 8 * np.pi)
    # Seen from above and small, so that all of it is right under the lamp.
    camera = look((0.0, -0.1, 8.0), (0.0, 0.0, 0.0), 6, 4, 0.02)
    sky = np.broadcast_to(one, (16, 32, 81))
    stage = Stage({"g": ground}, {"paint": Matter(rho)}, sky, camera, sun, {"lamp": lamp})

    class Ready:
        folder = tmp_path

    Ready.stage = stage
    light = one * np.pi + 0.5 * sun.spectrum + lamp.spectrum * lamp.energy / (4 * np.pi) / 4.0
    true = bands.S @ (rho * light / np.pi)
    for way, tolerance in (
        # Noise of 24 pixels of 4,096 paths each, which choose among three lights: 0.45 % seen.
        (program.mitsuba(4096), 0.01),
        # 20 boxes for the spectra, 8 bits for the sky, and an ambient value's noise: 0.03 % seen.
        (program.radiance("medium"), 0.005),
    ):
        (shot,) = way.shots(Ready, False)
        assert shot.picture.shape == (4, 6, 3) and np.all(shot.seconds >= shot.setup)
        np.testing.assert_allclose(shot.picture.mean(axis=(0, 1)), true, rtol=tolerance)
        assert shot.memory > 10 and shot.megabytes > 0
