"""What a picture is off by without some of its light, where that is known otherwise."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.bake import passes
from spectral_skylight.addon.scene.bake.camera_share import Eye, weights
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.left_out import left_out
from spectral_skylight.addon.transport.probed import seen_along
from spectral_skylight.tests import faces
from spectral_skylight.tests.transport.rooms import DARK, SKY, box, matter, radiosity, solved

TO_XYZ = np.array([[0.95], [1.0], [1.09]]) * np.full(COUNT, 1.0 / COUNT)
"""From even light in bands to D65's XYZ."""


def grey(light):
    """A grey of 0.5 in so much of the light of its white, (3,)."""
    return np.full(3, 0.5 * light)


def test_a_closed_room_without_its_bounces():
    """Half of its light has bounced, and no sky is there: half as bright, or black."""
    room = radiosity(box(inwards=True), matter([0.5], 1.0), cells=300, rays=64)
    solved(room)
    patches = room.space.cells.patches
    found = left_out(room, DARK, TO_XYZ, np.ones(patches))
    for error, light in ((found.without_bounces, 0.5), (found.open_sky, 0.0)):
        np.testing.assert_allclose(error, delta_E(grey(light), grey(1.0), np.ones(3)), rtol=0.01)
    expected = delta_E(grey(0.5), grey(1.0), np.ones(3)), delta_E(grey(0), grey(1.0), np.ones(3))
    assert found.line == "without bounces ΔE {:.2g}, under the open sky {:.2g}".format(*expected)
    # Where nothing of it is seen there is nothing to say.
    nothing = left_out(room, DARK, TO_XYZ, np.zeros(patches))
    assert nothing.line == ""


def test_under_the_open_sky_nothing_is_off():
    ground = np.array([[(-9, -9, 0), (9, -9, 0), (9, 9, 0)], [(-9, -9, 0), (9, 9, 0), (-9, 9, 0)]])
    found = radiosity(ground.astype(float), matter([0.5]), solid=False, cells=100, rays=256)
    solved(found, SKY)
    off = left_out(found, SKY, TO_XYZ, np.ones(found.space.cells.patches))
    # 256 rays, and cells of the sphere on its horizon.
    assert off.without_bounces.max() < 0.01 and off.open_sky.max() < 0.2


def test_a_tolerance_is_the_change_of_light_that_it_allows():
    """`passes.PER_DELTA_E` against CIEDE2000, on white and on middle grey."""
    for reflectance in (1.0, 0.3):
        darker = reflectance * (1.0 - passes.PER_DELTA_E) * np.ones(3)
        error = delta_E(darker, reflectance * np.ones(3), np.ones(3))
        assert error == pytest.approx(1.0, abs=0.05)


def test_what_the_camera_sees_counts_by_its_solid_angle():
    """A square of 2 x 2 before the camera, one behind it and one that looks away."""
    faces.empty_scene()
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (10.0, 0.0, 5.0)  # it looks down
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.context.view_layer.update()
    square = [[(-1, -1, 0), (1, -1, 0), (1, 1, 0)], [(-1, -1, 0), (1, 1, 0), (-1, 1, 0)]]
    seen = np.array(square, float)
    corners = np.concatenate([seen, np.add(seen, [0, 0, 9]), np.add(seen[:, ::-1], [2.5, 0, 0])])
    space = radiosity(corners, matter([0.5]), solid=False, cells=1500, rays=1).space
    eye = Eye.of(scene, np.array([10.0, 0.0, 0.0]))
    found = weights(space, eye)
    exact = 4.0 * np.arcsin(1.0 / (1.0 + 5.0**2))  # of a square of half side 1 in 5 m
    assert found.sum() == pytest.approx(exact, rel=0.01)
    assert not found[space.cells.triangle[space.cells.first] >= 2].any()
    np.testing.assert_allclose(weights(space, None).sum(), 12.0, rtol=1e-5)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 4.0
    scene.render.resolution_x, scene.render.resolution_y = 200, 100  # 4 wide, 2 high
    bpy.context.view_layer.update()
    flat = Eye.of(scene, np.array([10.0, 0.0, 0.0]))
    np.testing.assert_allclose(weights(space, flat).sum(), 4.0, rtol=1e-5)
    starts, ways = flat.looking(1000)
    np.testing.assert_allclose(ways, np.broadcast_to([0.0, 0.0, -1.0], ways.shape), atol=1e-6)
    # Half of the picture, and an eighth of it what looks away.
    assert len(seen_along(space, starts, ways).at) == pytest.approx(
        625, abs=25
    )  # with what looks away
    camera.data.type = "PANO"
    assert Eye.of(scene, np.zeros(3)) is None
    scene.camera = None
    assert Eye.of(scene, np.zeros(3)) is None
