"""All light of a day: what a file plays, against light baked for the moment."""

import subprocess
import sys
from dataclasses import replace
from functools import partial

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import scene_bake, session, storage
from spectral_skylight.addon.scene.day import animate, day_world, key_lights
from spectral_skylight.addon.scene.day.moments import find
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.scene.world.simulated_sky import SkyPlace
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.working_spaces import DEFAULT_SPACE
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transport.radiosity import ENOUGH
from spectral_skylight.node_groups import baked_light, sky_bake
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests.buildings import colours

pytestmark = pytest.mark.slow

PLACE = SkyPlace("2025-06-21", "10:30", "Europe/Berlin", 48.1, 11.6, north=20.0)
DAY = animate.Day(PLACE, "10:30", "12:30", 121)
BAKED = Settings(occlusion="baked")
COARSE = {"rays": 32, "tolerance": 1.0}
FLAT = [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)]
WALL = [(-2, 1, 0), (2, 1, 0), (2, 1, 2), (-2, 1, 2)]


def quad(name, places, k):
    """An object of one quad with a paint of the ColorChecker, and that."""
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(places, [], [(0, 1, 2, 3)])
    mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return material, Assignment(colorchecker()[0][k], colorchecker()[1][k])


def simulated_once(over):
    """Simulate a sky for an elevation, which costs a second, only where it was not yet."""
    known = {}

    def found(place, elevation):
        if elevation not in known:
            known[elevation] = yield from over(place, elevation)
        return known[elevation]

    return found


@pytest.fixture(scope="module")
def day():
    """A red wall on the ground beside a lamp, from 10:30 on a minute each frame, and the line.

    Two key skies, for how well these tell what lies between is told in `test_day`.
    """
    patch = pytest.MonkeyPatch()
    patch.setattr(animate, "find", partial(find, within=100.0))
    patch.setattr(animate, "over", simulated_once(animate.over))
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("Mine")
    given = dict([quad("Floor", FLAT, 18), quad("Wall", WALL, 14)])
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.data.energy, lamp.location = 3e4, (1.5, -1.5, 1.5)
    scene.collection.objects.link(lamp)
    use_cases.simulate_sky(scene, PLACE, BAKED)
    use_cases.make_spectral(scene, given, BAKED)
    run(use_cases.bake(scene, BAKED, **COARSE))
    yield scene, run(use_cases.animate(scene, DAY, BAKED)).lines
    patch.undo()


def played(name, frame):
    """What the corners of an object show in a frame, (c, 4)."""
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
    shown = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())
    return colours(shown.data, baked_light.LIGHT)


def kept(name, attribute):
    """What the corners of an object's bake hold, (c, 3 or 4)."""
    bake = storage.bake_of(bpy.data.objects[name])
    corner = np.empty(len(bake.data.loops), np.int32)
    bake.data.loops.foreach_get("vertex_index", corner)
    return storage.read_attribute(bake, attribute)[corner]


def baked_for(scene, x, of_sky=False):
    """All light of a moment as it is baked, or the sky's: (c, 3) by object, and white (3,)."""
    own = animate._new_world(scene, BAKED)
    given = use_cases.given_before(use_cases.in_scene(scene))
    moments = animate._Moments(scene, own, DAY, DAY.course(), given, BAKED)
    light = run(moments.shining(x, 0.0))
    light = light.of_sky if of_sky else light
    lit, lines = run(session.recalling(scene_bake.lit()[0], light))
    assert lines == []  # no ray is cast again
    shading = run(session.going_round(lit, light, key_lights.Progress(0.0, "")))
    values = dict(run(session.lighting(lit, shading)))
    white = next(iter(moments._known.values())).white[0, 0]
    level = next(iter(moments._known.values())).level
    own.use_fake_user = False
    bpy.data.worlds.remove(own)
    found = {}
    for name, attributes in values.items():
        bake = storage.bake_of(bpy.data.objects[name])
        corner = np.empty(len(bake.data.loops), np.int32)
        bake.data.loops.foreach_get("vertex_index", corner)
        found[name] = attributes[baked_light.LIGHT][corner, :3]
    return found, white * level


def key_frames(scene):
    """The frames of the moments."""
    curves = [c for c in day_world.drivers.curves(scene.world) if tags.BAKED_KEY in c.data_path]
    points = curves[0].keyframe_points
    assert [point.co.y for point in points] == list(range(len(points)))
    return [point.co.x for point in points]


def test_the_report_says_how_many_moments_and_what_they_leave(day):
    scene, lines = day
    line = lines[0]
    count = len(key_frames(scene))
    assert f"2 key skies, {count} baked lights, at most " in line
    mean, of_95 = (float(part.split()[0]) for part in line.split("at most ")[1].split(" between, "))
    assert mean >= 0.0 and of_95 >= 0.0


def test_at_a_key_it_is_the_bake_of_that_moment(day):
    """To float32 of the sky; and of sky and lamp at once, though the two are baked apart, but for
    where the light of each ends to go round: `radiosity.ENOUGH` of the mean."""
    scene, _ = day
    frame = key_frames(scene)[-1]
    x = (frame - 1.0) / (DAY.frames - 1)
    sky, all_light = baked_for(scene, x, of_sky=True)[0], baked_for(scene, x)[0]
    for name in ("Floor", "Wall"):
        found, lamp = played(name, frame)[:, :3], kept(name, baked_light.LIGHT)[:, :3]
        np.testing.assert_allclose(found, sky[name] + lamp, rtol=2e-6)
        off = ENOUGH * all_light[name].mean()
        np.testing.assert_allclose(found, all_light[name], rtol=ENOUGH, atol=off)
        assert lamp.max() > 0.1 * sky[name].max()


def test_between_keys_nodes_mix_as_numpy_does(day):
    scene, _ = day
    frames = key_frames(scene)
    for k, share in ((0, 0.25), (len(frames) - 2, 0.8)):
        frame = (1.0 - share) * frames[k] + share * frames[k + 1]
        found = played("Wall", frame)
        level = scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value
        part = scene.world[tags.BAKED_KEY] - k
        assert part == pytest.approx(share, abs=1e-4)
        one, other = (kept("Wall", sky_bake.at_key(baked_light.LIGHT, k + i)) for i in (0, 1))
        steady = kept("Wall", baked_light.LIGHT)
        expected = level * ((1.0 - part) * one + part * other) + steady[:, :3]
        np.testing.assert_allclose(found[:, :3], expected, rtol=2e-6)
        assert (found[:, 3] == baked_light.FLAG).all()


def test_between_keys_it_is_nearly_the_bake_of_that_moment(day):
    """At a quarter between two, where the search has not looked: in the mean over all points."""
    scene, _ = day
    frames = key_frames(scene)
    frame = 0.75 * frames[0] + 0.25 * frames[1]
    true, white = baked_for(scene, (frame - 1.0) / (DAY.frames - 1))
    off = [delta_E(played(name, frame)[:, :3], true[name], white, DEFAULT_SPACE) for name in true]
    assert np.concatenate(off).mean() < key_lights.WITHIN


PLAY = """
import sys, bpy, numpy as np
assert "spectral_skylight" not in sys.modules
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
found = []
for frame in (1, 40, 121):
    bpy.context.scene.frame_set(frame)
    shown = bpy.data.objects["Wall"].evaluated_get(bpy.context.evaluated_depsgraph_get())
    light = shown.data.attributes["skylight_light"].data
    values = np.empty(4 * len(light), np.float32)
    light.foreach_get("color", values)
    found.append(values)
np.save(sys.argv[2], found)
"""


def test_a_blender_without_the_add_on_plays_it(day, tmp_path):
    file, found = tmp_path / "day.blend", tmp_path / "found.npy"
    expected = [played("Wall", frame).ravel() for frame in (1, 40, 121)]
    bpy.ops.wm.save_as_mainfile(filepath=str(file), copy=True)
    command = [sys.executable, "-I", "-c", PLAY, str(file), str(found)]
    subprocess.run(command, check=True, capture_output=True)
    assert np.array_equal(np.load(found), expected)
    assert not np.array_equal(expected[0], expected[2])


def test_whoever_ends_it_has_the_scene_as_before(day, monkeypatch):
    """Also where an object without a bake was given one meanwhile."""
    scene, _ = day
    monkeypatch.setattr(scene_bake, "bake", partial(scene_bake.bake, **COARSE))
    mesh = bpy.data.objects["Wall"].data
    obj = bpy.data.objects.new("New", mesh)
    obj.location.y = 1.0
    scene.collection.objects.link(obj)
    world, before = scene.world, played("Wall", 40)
    bakes = {each.name: storage.bake_of(each) for each in scene_bake.baked()}
    steps = use_cases.animate(scene, replace(DAY, frames=11), BAKED)
    for step in steps:
        if "moments" in step.line and storage.is_lit(obj):
            break
    steps.close()
    assert scene.world == world and not storage.is_lit(obj) and not obj.modifiers
    assert {each.name: storage.bake_of(each) for each in scene_bake.baked()} == bakes
    assert np.array_equal(played("Wall", 40), before)
    assert not [each for each in bpy.data.objects if sky_bake.KIND in each.name and not each.users]
    bpy.data.objects.remove(obj)


def test_a_still_sky_takes_it_away(day):
    scene, _ = day
    use_cases.simulate_sky(scene, PLACE, BAKED)
    mesh = storage.bake_of(bpy.data.objects["Wall"]).data
    names = mesh.attributes.keys()
    assert baked_light.LIGHT in names
    assert not [name for name in names if name[-1].isdigit()]
    assert not any(map(sky_bake.is_day, groups.of_kind(sky_bake.KIND)))
    use_cases.remove_all()
    assert not bpy.data.actions and not bpy.data.node_groups
    assert not any(obj.modifiers for obj in bpy.data.objects)
