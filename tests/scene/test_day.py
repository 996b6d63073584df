"""A sky that moves through a day: what a file plays, against skies computed for the moment."""

from dataclasses import replace
from functools import partial

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.day import animate, day_world, values
from spectral_skylight.addon.scene.day.moments import find
from spectral_skylight.addon.scene.lights import sun_lamp
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world import capture, hdri
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.scene.world.simulated_sky import SkyPlace
from spectral_skylight.addon.sky.atmosphere import Atmosphere
from spectral_skylight.addon.sky.clear_sky import SCALE, picture
from spectral_skylight.addon.sky.light import FACES
from spectral_skylight.addon.sky.polynomial import evaluate_polynomial
from spectral_skylight.addon.sky.simulation import Quality, simulating
from spectral_skylight.addon.sky.sun_position import sun_position
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.spectra.working_spaces import LUMINANCE
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.ui import view
from spectral_skylight.node_groups import light_probe, sky_irradiance, skylight_surface

PLACE = SkyPlace("2025-06-21", "10:30", "Europe/Berlin", 48.1, 11.6, north=20.0)
DAY = animate.Day(PLACE, "10:30", "12:30", 121)
OPEN = Settings(occlusion="open")


@pytest.fixture(scope="module")
def day():
    """A scene with two paints whose sky moves from 49° to 64°; its materials, and the line."""
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("Mine")
    scene.frame_start, scene.frame_end = 1, 250
    names, rho = colorchecker()
    given = {}
    for k in (5, 14):
        bpy.ops.mesh.primitive_plane_add(location=(3.0 * k, 0.0, 0.0))
        material = bpy.data.materials.new(names[k])
        if material.node_tree is None:
            material.use_nodes = True
        bpy.context.object.data.materials.append(material)
        given[material] = Assignment(names[k], rho[k])
    use_cases.simulate_sky(scene, PLACE, OPEN)
    use_cases.make_spectral(scene, given, OPEN)
    found = run(use_cases.animate(scene, DAY, OPEN))
    return scene, list(given), found.lines[0]


def at(scene, minute):
    """Go to a minute of the day, a frame each; return where the sun stands in the scene."""
    scene.frame_set(1 + minute)
    time = f"{10 + (30 + minute) // 60}:{(30 + minute) % 60:02}"
    elevation, azimuth = sun_position(PLACE.date, time, 48.1, 11.6, PLACE.timezone)
    return elevation, azimuth + PLACE.north


def shown(scene, material, elevation):
    """What a material's nodes make of the World's on `FACES`, in the frame with the sun over +x."""
    world = scene.world
    surface = skylight_surface.find(world)
    node = spectral_material.surface_node(material)
    strength = surface.nodes[skylight_surface.SKY].inputs["Strength"].default_value
    sky = skylight_surface.sky_in(surface)
    light = evaluate_polynomial(list(sky_irradiance.coefficients(sky).values()), FACES)
    matrix = [node.inputs[name].default_value for name in ("Row R", "Row G", "Row B")]
    probe = skylight_surface.part(surface, skylight_surface.PROBE)
    sun = np.array(light_probe.colour(probe, light_probe.SUN))
    h = np.radians(elevation)
    cosines = np.maximum(FACES @ [np.cos(h), 0.0, np.sin(h)], 0.0)
    direct = cosines[:, None] * sun * np.array(node.inputs["Sun"].default_value)
    ground = skylight_surface.part(surface, skylight_surface.GROUND)
    from_below = 0.0
    if ground is not None:
        own = list(sky_irradiance.coefficients(ground).values())
        from_below = evaluate_polynomial(own, FACES) * node.inputs["Ground"].default_value
    return strength * (light @ np.array(matrix).T + direct + from_below)


def found_and_true(scene, materials, elevation):
    """What materials' nodes make of the World's light, what they had to, and what white does."""
    own = animate._new_world(scene, OPEN)
    given = use_cases.given_before(materials)
    true = run(animate.computing(scene, own, PLACE, elevation, given, OPEN))
    own.use_fake_user = False
    bpy.data.worlds.remove(own)
    return [
        (
            shown(scene, material, elevation),
            true.level * true.colours[:, 24 + k],
            true.level * true.white[:, 0],
        )
        for k, material in enumerate(materials)
    ]


def rows(materials):
    """What materials make of red, green and blue in red."""
    nodes = [spectral_material.surface_node(material) for material in materials]
    return [list(node.inputs["Row R"].default_value) for node in nodes]


def test_colours_are_those_of_the_sky_of_the_moment(day):
    """At a moment between key skies, on nine faces, by the values that a file plays."""
    scene, materials, _ = day
    elevation, _ = at(scene, 77)
    for each in found_and_true(scene, materials, elevation):
        assert delta_E(*each).max() < 0.3


def test_what_is_seen_is_the_sky_of_the_moment(day):
    """The World as Cycles renders it, against the simulated picture: the sky and where the sun is.

    Two pixels of 0.4° around the sun are left out, for its disc lies in pixels of other sizes.
    """
    scene, _, _ = day
    elevation, azimuth = at(scene, 77)
    sky = hdri.sky_of(scene.world)
    seen, _ = capture.bake(scene.world, hdri.WorldSky(sky.name))
    height = len(seen)
    true = picture(run(animate.over(PLACE, elevation)), height, azimuth, False, observer() * SCALE)
    row, column = np.unravel_index(np.argmax(seen[..., 0]), seen.shape[:2])
    assert row == pytest.approx((90.0 - elevation) / 180.0 * height, abs=1.5)
    assert column == pytest.approx((90.0 + azimuth) / 360.0 % 1.0 * 2 * height, abs=1.5)
    solid = 2 * (np.pi / height) ** 2 * np.cos(np.radians(elevation)) / 2
    disc = (seen - true)[row - 3 : row + 4, column - 3 : column + 4].sum(axis=(0, 1)) * solid
    expected = run(animate.over(PLACE, elevation)).seen_by(observer() * SCALE).direct
    assert disc == pytest.approx(expected, rel=0.02)
    rest = np.ones(seen.shape[:2], bool)
    rest[row - 3 : row + 4, column - 3 : column + 4] = False
    ratio = (seen @ LUMINANCE) / (true @ LUMINANCE)
    assert np.abs(np.median(ratio[rest]) - 1.0) < 0.005
    assert np.percentile(np.abs(ratio[rest] - 1.0), 99) < 0.03


def test_the_sun_is_where_the_lamp_shines(day):
    scene, _, _ = day
    elevation, azimuth = at(scene, 41)
    lamp = sun_lamp.find(scene, sun_lamp.SUN).evaluated_get(bpy.context.evaluated_depsgraph_get())
    towards = np.array(lamp.matrix_world)[:3, 2]
    e, a = np.radians([elevation, 90.0 - azimuth])
    expected = [np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)]
    assert np.degrees(np.arccos(np.clip(towards @ expected, -1.0, 1.0))) < 0.05


def test_the_report_says_how_few_keys_and_what_they_leave(day):
    _, _, line = day
    assert line.startswith("animated 2025-06-21 10:30-12:30 in 121 frames: 3 key skies, at most 0.")
    assert float(line.split("at most ")[1].split()[0]) <= 0.3


def test_a_file_plays_it_with_plain_drivers_alone(day, tmp_path):
    scene, materials, _ = day
    at(scene, 60)
    before = [
        list(spectral_material.surface_node(m).inputs["Row R"].default_value) for m in materials
    ]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "day.blend"), copy=True)
    with bpy.data.libraries.load(str(tmp_path / "day.blend")) as (there, _):
        assert "Day" in there.worlds and "Day Sky" in there.images
    owners = [m.node_tree for m in materials] + list(bpy.data.node_groups)
    owners += [scene.world, scene.world.node_tree]
    curves = [c for o in owners if o.animation_data for c in o.animation_data.drivers]
    assert {c.driver.type for c in curves} == {"AVERAGE"}
    at(scene, 0)
    after = [
        list(spectral_material.surface_node(m).inputs["Row R"].default_value) for m in materials
    ]
    assert before != after
    assert bpy.data.images["Day Sky"].packed_file is not None


def test_bad_input_changes_nothing(day):
    scene, _, _ = day
    world = scene.world
    for change, line in (
        ({"frames": 0}, "0 frame"),
        ({"place": replace(PLACE, weather="cie")}, "only clear skies"),
        ({"first": "13:00"}, "12:30 is not later than 13:00"),
        ({"place": SkyPlace("2025-12-21", "12:00", "UTC", 85.0, 0.0)}, "below the horizon"),
    ):
        with pytest.raises(InputError, match=line):
            run(use_cases.animate(scene, animate.Day(**{**vars(DAY), **change}), OPEN))
        assert scene.world == world and tags.DAY in world


def test_rgb_is_not_compared_while_the_sky_moves(day):
    """Drivers would take its numbers back, and what is kept of both would be ours."""
    assert "sky moves" in view.nothing_to_compare()


def test_another_material_moves_too_and_nothing_of_the_first_day_stays(day, monkeypatch):
    """Coarsely, for how well keys tell what lies between is told above."""
    monkeypatch.setattr(animate, "find", partial(find, within=100.0))
    scene, materials, _ = day
    names, rho = colorchecker()
    bpy.ops.mesh.primitive_plane_add(location=(0.0, 9.0, 0.0))
    material = bpy.data.materials.new("New")
    if material.node_tree is None:
        material.use_nodes = True
    bpy.context.object.data.materials.append(material)
    use_cases.make_spectral(scene, {material: Assignment(names[2], rho[2])}, OPEN)
    moving = [m.node_tree.animation_data.drivers for m in (*materials, material)]
    assert len({len(each) for each in moving}) == 1
    targets = {d.driver.variables[0].targets[0].id for each in moving for d in each}
    assert targets == {scene.world}
    assert (scene.frame_start, scene.frame_end) == (1, 121)


def coarse(place, elevation):
    """A grainy sky of an elevation: its grain is in the truth too, and changes smoothly."""
    quality = Quality(once=(24, 13), more=(10, 7), ways=32, shells=16)
    air = Atmosphere(haze=place.haze, ozone=place.ozone, ground=place.ground)
    return simulating(elevation, air, quality=quality)


def test_a_day_goes_through_sunrise(day, monkeypatch):
    """There the light of the sun comes and goes, and with it parts of the shader; what surfaces
    show is judged at moments that the search did not look at."""
    scene, materials, _ = day
    monkeypatch.setattr(animate, "over", coarse)
    found = run(
        use_cases.animate(scene, replace(DAY, first="05:17", until="05:23", frames=41), OPEN)
    )
    assert float(found.lines[0].split("at most ")[1].split()[0]) <= 0.3
    surface = skylight_surface.find(scene.world)
    probe = skylight_surface.part(surface, skylight_surface.PROBE)
    driven = {each.data_path for each in probe.animation_data.drivers}
    assert driven == {'nodes["Sun"].inputs[0].default_value'}
    shine = []
    for frame in (1, 41):
        scene.frame_set(frame)
        shine.append(light_probe.colour(probe, light_probe.SUN))
    assert shine[0] == (0.0, 0.0, 0.0) and min(shine[1]) > 0.0
    assert scene.world["spectral_skylight_sun_elevation"] > 0.27
    heights = []
    for frame in (8, 33):
        scene.frame_set(frame)
        heights.append(float(scene.world[tags.SUN_ELEVATION]))
        apart = [delta_E(*each).max() for each in found_and_true(scene, materials, heights[-1])]
        assert max(apart) < 0.3
    assert heights[0] < -0.1 and 0.1 < heights[1]


def test_remove_all_removes_it_whole(day):
    """Last, for it is gone then."""
    scene, materials, _ = day
    use_cases.remove_all()
    assert scene.world.name == "Mine"
    assert (scene.frame_start, scene.frame_end) == (1, 250)
    assert not any(day_world.is_day(world) for world in bpy.data.worlds)
    for owner in (*(m.node_tree for m in materials), *bpy.data.objects, *bpy.data.worlds):
        assert owner.animation_data is None or not len(owner.animation_data.drivers)
    assert not bpy.data.actions and not bpy.data.node_groups
    assert not list(values._animated())
    assert not [image for image in bpy.data.images if image.users]
