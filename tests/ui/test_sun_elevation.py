"""A sky without its sun: the panel can tell how high it stood, and materials follow."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.ui import panels, properties
from spectral_skylight.tests.ui import stage

pytestmark = pytest.mark.blender


def test_a_low_suns_elevation_can_be_told(scene, brick, tmp_path):
    stage.write_sky(tmp_path / "dusk.exr", sun=0)
    bpy.ops.skylight.load_sky(filepath=str(tmp_path / "dusk.exr"))
    numbers = scene.world.skylight
    numbers.basis = "atmosphere"
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    by_day = stage.matrix()
    assert "sun_elevation" not in stage.drawn(panels.SKYLIGHT_PT_numbers).properties

    numbers.sun_told = True
    numbers.sun_elevation = 2.0
    assert "sun_elevation" in stage.drawn(panels.SKYLIGHT_PT_numbers).properties
    assert properties.settings_of(scene.world).sun_elevation == 2.0
    bpy.ops.skylight.update()
    assert np.abs(stage.matrix() - by_day).max() > 1e-4

    numbers.sun_told = False
    bpy.ops.skylight.update()
    assert stage.matrix() == pytest.approx(by_day, abs=1e-7)
