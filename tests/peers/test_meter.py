"""The light meter beside Radiance: daylight factors of one room, with all that goes round in it."""

import time

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.meter import places as meters
from spectral_skylight.addon.scene.meter.room import GROUND
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import shown
from spectral_skylight.tests.peers.peer import MISSING, PYTHON, ask
from spectral_skylight.tests.transport.test_meter import room
from spectral_skylight.tests.ui.stage import write_sky

pytestmark = [
    pytest.mark.peers,
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON.exists(), reason=MISSING),
]

GRAY = 0.5

OPTIONS = "-ab 8 -ad 8192 -as 0 -aa 0 -lr -10 -lw 1e-6"
"""Of `rtrace`: eight bounces leave 0.5^9 of the light out, and nothing is interpolated."""


def test_daylight_factors_are_radiances(tmp_path):
    triangles = room(1, (1.0, 1.0), (3.0, 2.0))
    faces.empty_scene()
    gray = bpy.data.materials.new("Gray")
    if bpy.app.version < (5, 0, 0):
        gray.use_nodes = True
    shader = next(n for n in gray.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (GRAY, GRAY, GRAY, 1.0)
    corners = triangles.reshape(-1, 3)
    shown("Room", corners.tolist(), np.arange(len(corners)).reshape(-1, 3).tolist(), gray)
    use_cases.set_sky(bpy.context.scene, write_sky(tmp_path / "sky.exr"), Settings())
    places = meters.rectangle((0.0, 0.0, 4.0, 4.0), 0.85, 1.0, 1.0)
    began = time.perf_counter()
    ours = run(use_cases.surveying(bpy.context.scene, Settings(), places))
    seconds = time.perf_counter() - began
    theirs = ask(
        "radiance_meter.py",
        {
            "triangles": triangles.tolist(),
            "reflectance": GRAY,
            "ground": GROUND,
            "points": np.concatenate([places.points, places.normals], axis=1).tolist(),
            "options": OPTIONS,
        },
    )
    ratio = ours.daylight_factor / theirs["factors"]
    print(
        f"daylight factors {100 * ours.daylight_factor.min():.2f} to "
        f"{100 * ours.daylight_factor.max():.2f} %, ours / Radiance's {ratio.mean():.3f} "
        f"({ratio.min():.3f} to {ratio.max():.3f}); {seconds:.1f} s, two skies; "
        f"Radiance {float(theirs['seconds']):.1f} s"
    )
    # 5 % are asked for; what is left is the noise of both.
    np.testing.assert_allclose(ratio, 1.0, atol=0.05)
    assert ratio.mean() == pytest.approx(1.0, abs=0.02)
