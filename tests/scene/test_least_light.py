"""Which light a tolerance asks for, from what is predicted of the whole picture."""

import math
from dataclasses import replace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.choices import BAKED, OPEN
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import out_of_date, use_cases
from spectral_skylight.addon.scene.bake import scene_bake, session
from spectral_skylight.addon.scene.bake.least_light import (
    AT_MOST,
    MOST,
    PATCHES,
    LeastLight,
    least_light,
)
from spectral_skylight.addon.scene.bake.sounding import Sounding
from spectral_skylight.addon.scene.use_cases import light
from spectral_skylight.addon.scene.world.settings import Settings, stored
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.tests import faces
from spectral_skylight.tests.lanes import newest

NOISE = {64: 1.6, 256: 0.8, 1024: 0.4}


def found(models=0.0, open_sky=12.0, patches=0.0):
    return Sounding(models, 5.0, open_sky, NOISE, patches)


def test_the_cheapest_light_whose_bound_keeps_to_the_tolerance_is_chosen():
    assert least_light(found(open_sky=0.5), 1.0).light == OPEN
    for tolerance, rays in ((2.5, 64), (1.25, 256), (0.85, 1024), (0.45, 4096)):
        for patches in (0.0, 0.1, 3.0):
            chosen = least_light(found(patches=patches), tolerance)
            # Where first patches are too rough, more rays between them are none the better.
            if patches == 3.0 and rays > 64:
                assert not chosen.coarse and chosen.rays == rays
            assert chosen.light == BAKED and chosen.rays >= rays
            assert chosen.expected < chosen.bound <= tolerance
    assert [least_light(found(patches=0.1), t).coarse for t in (2.5, 1.25)] == [True, True]
    # Without patches between which light is exact, a first light is none.
    assert least_light(found(patches=3.0), 2.5).rays == 256
    # Nothing keeps to it: all that there is, and it is said how far off that is.
    none = least_light(found(), 1e-4)
    assert none.rays == MOST and not none.coarse and none.bound > 1e-4


def test_the_error_of_few_patches_and_that_of_few_rays_add_up():
    """As the root of the sum of squares: they are independent."""
    chosen = least_light(found(patches=0.6), 2.5)
    assert (chosen.rays, chosen.coarse) == (64, True)
    assert chosen.expected == pytest.approx(math.hypot(1.6, 0.6))
    assert chosen.bound == pytest.approx(math.hypot(AT_MOST[BAKED] * 1.6, PATCHES * 0.6))


def test_matrices_take_their_part_of_the_tolerance():
    """As the root of the sum of squares, and half of it stays for light in any case."""
    assert least_light(found(models=0.6), 1.2).rays == 256  # 256 have 1 at most, and 1.04 are left
    chosen = least_light(found(models=0.6), 1.1)
    assert chosen.rays == 1024  # and here 0.92
    assert chosen.expected == pytest.approx(math.hypot(0.6, 0.4)) and chosen.models == 0.6
    assert least_light(found(models=9.0), 2.5).rays == 256
    assert least_light(found(), 2.5).line == (
        "all bounces, 64 rays: expected ΔE 1.6, at most 2 in 19 of 20; "
        "without bounces ΔE 5, under the open sky 12"
    )


def box(scene, name, material, low, high, inwards=False):
    x, y, z = zip(low, high, strict=True)
    corners = [(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    if inwards:  # without its lid
        quads = [quad[::-1] for quad in quads if quad != (4, 5, 7, 6)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], quads)
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))


@newest  # what it decides by is numpy alone
@pytest.mark.blender
def test_a_box_in_the_open_needs_no_bake_and_a_court_needs_every_bounce(tmp_path):
    scene = faces.empty_scene()
    faces.light(scene, tmp_path)
    paint = bpy.data.materials.new("paint")
    box(scene, "box", paint, (-1, -1, 0), (1, 1, 2))
    given = {paint: Assignment("paint", np.full(81, 0.6))}
    settings = Settings(tolerance=2.0, ground="none")
    lines = run(use_cases.making_spectral_with_all_light(scene, given, settings)).lines
    assert lines[-1].startswith("open sky: expected ΔE 0")
    assert stored(scene.world).shadows == OPEN and not scene_bake.baked()
    assert not out_of_date.look_at_bakes(scene)
    # Where nothing has changed nothing is written, which Blender would tell of as a change.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(light, "write", None)
        assert run(use_cases.following(scene, stored(scene.world))) == lines[-1:]
    # As many rays may collect light between a bake's first patches as between all.
    enough = LeastLight(BAKED, 256, True, *[0.0] * 5)
    run(scene_bake.bake(changed_only=False, error=2.0, least=enough))
    assert [len(each) for each in session._last[0].collected.patterns] == [64, 256]
    assert session._last[0].coarse and session.holds(enough)
    assert not session.holds(replace(enough, coarse=False))
    # It is judged anew when something is built around it.
    box(scene, "court", paint, (-3, -3, -0.01), (3, 3, 5), inwards=True)
    lines = run(use_cases.all_light(scene, stored(scene.world)))
    assert "all bounces, " in lines[-1] and "without bounces ΔE" in lines[-1]
    assert stored(scene.world).shadows == BAKED and len(scene_bake.baked()) == 2
    # Another light asks for no ray; a finer tolerance does.
    assert not session.holds(least_light(found(), 1e-4))
    # What a person asks for stays.
    for asked in ("baked", OPEN):
        use_cases.make_spectral(scene, given, Settings(tolerance=2.0, occlusion=asked))
        assert stored(scene.world).shadows == asked
