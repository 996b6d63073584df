"""What stands in a scene is read alike, however Blender keeps it."""

from dataclasses import replace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress
from spectral_skylight.addon.scene.bake import geometry
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import box, ground

pytestmark = pytest.mark.blender


def test_one_order():
    """Blender hands objects out by their addresses, which are others each time that it starts: in
    whatever order they come, triangles, owners and materials are in one, and so are all rays."""
    faces.empty_scene()
    made_of = [bpy.data.materials.new(name) for name in ("Wood", "Brick", "Steel", "Lawn")]
    ground(40.0, made_of[3])
    for k, name in enumerate(("Shed", "House", "Kiosk")):
        box(name, (4 * k, 0, 1), (2, 1 + k, 2), made_of[k])
    read = progress.run(geometry.reading())
    owners = {name: k for k, name in enumerate(reversed(read.owners))}
    materials = {name: k for k, name in enumerate(reversed(read.materials))}
    was, of = list(read.owners), list(read.materials)
    other = geometry.Read(
        [
            replace(
                one,
                owner=owners[was[one.owner]],
                kinds=np.array([materials[of[kind]] for kind in one.kinds], np.int32),
            )
            for one in reversed(read.placed)
        ],
        owners,
        materials,
        read.shapes,
    )
    one, same = geometry.assembled(read), geometry.assembled(other)
    assert list(other.owners) != list(read.owners)
    assert one.owners == same.owners
    assert one.materials == same.materials
    for name in ("corners", "owner", "instance", "material", "polygon", "solid"):
        np.testing.assert_array_equal(getattr(one, name), getattr(same, name))
