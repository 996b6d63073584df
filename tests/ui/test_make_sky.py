"""A sky of a date and a place by one button: its sun, what is taken over, what is refused."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import choices
from spectral_skylight.addon.scene.world import (
    hdri,
    light_group,
    panorama,
    settings,
    simulated_sky,
)
from spectral_skylight.addon.sky import simulation
from spectral_skylight.addon.sky.sun_position import sun_position
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.ui import make_sky, panels, place, preview_cache, refine_sky, where
from spectral_skylight.tests.sky.test_all_weather import epw, row
from spectral_skylight.tests.ui import stage
from spectral_skylight.tests.ui.test_undo import check

pytestmark = pytest.mark.blender

BERLIN = {"timezone": "Europe/Berlin", "latitude": 52.5, "longitude": 13.4}


def choose(scene, **values):
    for name, value in {**BERLIN, **values}.items():
        setattr(scene.skylight_place, name, value)


def light_of(scene):
    return panorama.light_of(scene.world, observer())


@pytest.fixture
def quick(monkeypatch):
    """A reference that takes no minute, and a preview that takes no second, small."""
    for name, ways in (("preview", 64), ("reference", 128)):
        rough = simulation.Quality(once=(24, 9), more=(8, 5), ways=ways, shells=20)
        monkeypatch.setitem(simulation.QUALITIES, name, rough)
    monkeypatch.setattr(simulated_sky, "HEIGHT", 64)


def test_the_sky_of_a_summer_noon(scene, brick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    numbers = scene.world.skylight  # of the HDRI before: they say nothing about this sky
    numbers.camera, numbers.sun_told, numbers.white_balanced = "Nikon 5100", True, True
    before = stage.matrix()
    choose(scene, time=13.25, north=30.0)
    bpy.ops.skylight.make_sky()
    elevation, azimuth = sun_position("2025-06-21", "13:15", 52.5, 13.4, "Europe/Berlin")
    found = settings.stored(scene.world)
    assert (found.camera, found.white, found.sun_elevation) == (None, None, None)
    image = hdri.sky_of(scene.world).image
    assert image.packed_file and image.name == "Sky 2025-06-21 13:15"
    light = light_of(scene)
    assert light.known_elevation == pytest.approx(elevation)
    # Half a pixel of 512 rows, and true north 30° clockwise from +Y.
    assert light.sun.elevation == pytest.approx(elevation, abs=0.18)
    assert (90.0 - light.sun.azimuth) % 360 == pytest.approx((azimuth + 30.0) % 360, abs=0.36)
    # Some 80,000 lx of a clear summer noon's sun, over pi and 10,000 cd/m^2.
    assert 1.8 < light.sun.irradiance @ [0.2126, 0.7152, 0.0722] < 3.5
    assert not light.sun.clipped
    assert np.abs(stage.matrix() - before).max() > 1e-4
    assert light_group.record_of(scene.world).image == image.name


def test_twilight_is_known_without_a_sun(scene):
    choose(scene, time=21.95)
    bpy.ops.skylight.make_sky()
    light = light_of(scene)
    assert light.sun is None
    assert -6.0 < light.known_elevation < 0.0
    assert light.sun_elevation() == light.known_elevation
    scene.world.node_tree.nodes["Mapping"].inputs["Rotation"].default_value[0] = 0.3
    assert light_of(scene).known_elevation is None  # a tilted sky's horizon is not the scene's


def test_another_hour_keeps_what_was_set_in_the_world(scene, quick):
    own = scene.world
    choose(scene, time=9.0)
    bpy.ops.skylight.make_sky()
    world = scene.world
    assert world != own
    world.skylight.exposure = 1.0
    world.skylight.occlusion = "open"
    choose(scene, time=10.0)
    bpy.ops.skylight.make_sky()
    assert scene.world == world and world.skylight.occlusion == "open"
    assert world.skylight.exposure == pytest.approx(1.0)
    skies = [image.name for image in bpy.data.images if image.name.startswith("Sky ")]
    assert skies == ["Sky 2025-06-21 10:00"] and world.name == skies[0]
    choose(scene, time=10.0, haze=0.1)
    bpy.ops.skylight.make_sky()
    assert hdri.sky_of(world).name == world.name == skies[0]
    other = bpy.data.scenes.new("Other")
    other.world = world
    choose(scene, time=11.0)
    bpy.ops.skylight.make_sky()
    assert scene.world != world and hdri.sky_of(world).name == "Sky 2025-06-21 10:00"


def test_it_is_in_the_file(scene, tmp_path):
    choose(scene, time=9.0)
    bpy.ops.skylight.make_sky()
    before = panorama.pixels_of(hdri.sky_of(scene.world).image)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    after = panorama.pixels_of(hdri.sky_of(bpy.context.scene.world).image)
    assert after.max() > 65504  # the sun's disc, which half floats would cut
    np.testing.assert_array_equal(after, before)


def test_it_is_one_step_to_undo(scene, brick, quick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    choose(scene)
    check(lambda *how: bpy.ops.skylight.make_sky(*how))
    choose(bpy.context.scene, time=15.0)  # undo has made it anew
    check(lambda *how: bpy.ops.skylight.make_sky(*how))


@pytest.mark.parametrize(
    ("values", "part"),
    [
        ({"time": 1.0}, "Time: the sun is 1.* below the horizon; skies are simulated down to -6°"),
        ({"month": 2, "day": 30}, "Date: '2025-02-30 12:00:00' is not a date"),
        ({"month": 2, "day": 29}, "Date: 2025 is no leap year"),
        ({"month": 3, "day": 30, "time": 2.5}, "Time: there is no 02:30:00 on 2025-03-30"),
        ({"month": 10, "day": 26, "time": 2.5}, "Time: 02:30:00 comes twice on 2025-10-26"),
        ({"timezone": "Middle/Earth"}, "Time Zone: 'Middle/Earth' is unknown"),
    ],
)
def test_what_is_refused(scene, values, part):
    choose(scene, **values)
    line = stage.error_of(bpy.ops.skylight.make_sky)
    before, _, after = part.partition(".*")
    assert before in line and after in line
    assert not any(image.name.startswith("Sky ") for image in bpy.data.images)


def test_the_dialog_shows_every_field(scene):
    shown = set()
    for weather in choices.WEATHERS:
        choose(scene, weather=weather)
        recorder = stage.Recorder()
        make_sky.SKYLIGHT_OT_make_sky.draw(SimpleNamespace(layout=recorder), bpy.context)
        assert ("epw" in recorder.properties, "cie" in recorder.properties) == (
            weather == "epw",
            weather == "cie",
        )
        shown |= {*recorder.properties}
    fields = {each.identifier for each in place.SkylightPlace.bl_rna.properties}
    assert shown == fields - {"rna_type", "name", "taken"}
    scene.world = None
    assert "skylight.make_sky" in stage.drawn(panels.SKYLIGHT_PT_main).operators


def test_a_city_gives_place_and_zone_until_one_types_another(scene):
    chosen = scene.skylight_place
    chosen.city = "munchen"
    assert chosen.city == "München, Germany" and chosen.timezone == "Europe/Berlin"
    assert (chosen.latitude, chosen.longitude) == pytest.approx((48.14, 11.58))
    chosen.latitude = 48.141  # the same city
    assert chosen.city == "München, Germany"
    chosen.latitude = 47.0
    assert chosen.city == "" and chosen.longitude == pytest.approx(11.58)
    chosen.city = "Entenhausen"
    assert chosen.city == "" and chosen.latitude == 47.0
    assert where._cities(chosen, bpy.context, "reykjav") == ["Reykjavík, Iceland"]


def test_what_is_a_number_can_be_keyed(scene):
    chosen = scene.skylight_place
    numbers = [
        each.identifier
        for each in chosen.bl_rna.properties
        if each.type in ("INT", "FLOAT", "ENUM")
    ]
    assert len(numbers) == 12
    for name in numbers:
        assert chosen.keyframe_insert(name, frame=1), name
    chosen.time = 18.0
    chosen.keyframe_insert("time", frame=13)
    scene.frame_set(7)
    assert place.sky_place(chosen).time == "15:00:00"


def test_an_overcast_sky_by_the_panel(scene, quick):
    choose(scene, weather="cie", cie="1")
    bpy.ops.skylight.make_sky()
    light = light_of(scene)
    assert light.sun is None  # it has no disc
    # Three times as bright in the zenith as on the horizon, whichever azimuth.
    luminance = light.sky @ [0.2126, 0.7152, 0.0722]
    assert luminance[0].mean() / luminance[len(luminance) // 2 - 1].mean() > 2.7
    assert any("CIE standard sky 1, overcast" in note for note in light.notes)
    text = stage.drawn(panels.SKYLIGHT_PT_main).text
    assert "Date and Place" in text and "Sun Paths" in text


def test_the_hour_of_a_weather_file_by_the_panel(scene, tmp_path, quick):
    path = epw(tmp_path / "a.epw", [row(15, 700, 120)])
    chosen = scene.skylight_place
    choose(scene, weather="epw", time=14.5, city="Berlin")
    assert "no file is chosen" in stage.error_of(bpy.ops.skylight.make_sky)
    chosen.epw = str(path)
    assert (chosen.city, chosen.timezone) == ("", "+1")
    assert (chosen.latitude, chosen.longitude) == pytest.approx((47.4, 8.6))
    chosen.latitude = 10.0  # the file's holds
    bpy.ops.skylight.make_sky()
    elevation, _ = sun_position("2025-06-21", "14:30", 47.4, 8.6, "+1")
    light = light_of(scene)
    assert light.known_elevation == pytest.approx(elevation)
    assert any("direct 700 and diffuse 120 W/m²" in note for note in light.notes)
    chosen.time = 3.0
    assert "has no hour 4" in stage.error_of(bpy.ops.skylight.make_sky)


def test_the_suns_paths_are_in_the_panel(scene, quick):
    choose(scene, city="Berlin")
    bpy.ops.skylight.make_sky()
    preview_cache.clear()
    stage.drawn(panels.SKYLIGHT_PT_main)
    preview_cache.draw_wanted()
    (key,) = preview_cache._names
    assert key[0].date == "2025-06-21" and key[1] == "Berlin, Germany"
    assert len(preview_cache.pixels(key)) == 480 * 480 * 4
    scene.skylight_place.month = 2
    scene.skylight_place.day = 30
    stage.drawn(panels.SKYLIGHT_PT_main)
    preview_cache.draw_wanted()
    assert "Date: '2025-02-30" in stage.drawn(panels.SKYLIGHT_PT_main).text
    preview_cache.clear()


def test_the_view_is_exposed_for_it_until_a_person_does(scene, quick, tmp_path):
    view = scene.view_settings
    choose(scene, time=13.25)
    bpy.ops.skylight.make_sky()
    # A white wall that faces some 100,000 lx, over pi and 10,000 cd/m^2, is 2^1.7.
    assert view.exposure == pytest.approx(-1.7, abs=0.3)
    noon, level = view.exposure, light_of(scene).faces[0]
    choose(scene, time=20.5)
    bpy.ops.skylight.make_sky()
    assert noon + 1.0 < view.exposure < 3.0  # the sun is still there
    choose(scene, time=13.25)
    bpy.ops.skylight.make_sky()
    assert view.exposure == noon
    np.testing.assert_array_equal(light_of(scene).faces[0], level)
    scene.world.skylight.exposure = -1.0  # the sky itself, by a person
    bpy.ops.skylight.make_sky()
    assert view.exposure == pytest.approx(noon + 1.0)
    view.exposure = 0.25
    bpy.ops.skylight.make_sky()
    assert view.exposure == 0.25
    view.exposure = 0.0
    bpy.ops.skylight.make_sky()
    assert view.exposure == pytest.approx(noon + 1.0)
    bpy.ops.skylight.remove_all()
    assert view.exposure == 0.0


def made(scene):
    return simulated_sky.made_of(hdri.sky_of(scene.world).image)


def test_a_refined_sky_is_the_same_sky(scene, brick, quick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    assert not bpy.ops.skylight.refine_sky.poll()  # an HDRI
    choose(scene, haze=0.1)
    bpy.ops.skylight.make_sky()
    before, light = made(scene), light_of(scene)
    assert before[1] == "preview" and before[0].haze == pytest.approx(0.1)
    choose(scene, time=8.0)  # typed, and not simulated
    bpy.ops.skylight.refine_sky()
    after = made(scene)
    assert after == (before[0], "reference")
    assert hdri.sky_of(scene.world).name == "Sky 2025-06-21 12:00"
    found = light_of(scene)
    assert found.known_elevation == light.known_elevation
    # Of some percent of noise.
    np.testing.assert_allclose(found.faces[0], light.faces[0], rtol=0.1)
    assert (found.faces[0] != light.faces[0]).all()
    assert not bpy.ops.skylight.refine_sky.poll()


def test_refining_goes_on_between_events(scene, quick, monkeypatch):
    monkeypatch.setattr(refine_sky.follow, "busy", lambda window: False)
    choose(scene)

    def begin():
        bpy.ops.skylight.make_sky()
        refine_sky.begin(scene)
        assert not bpy.ops.skylight.refine_sky.poll()
        assert "skylight.stop_refining" in stage.drawn(panels.SKYLIGHT_PT_main).operators

    begin()
    while refine_sky.work() is not None:
        assert refine_sky._tick() is not None
    assert refine_sky._tick() is None and made(scene)[1] == "reference"
    choose(scene, time=10.0)
    begin()
    refine_sky._tick()
    bpy.ops.skylight.stop_refining()
    assert refine_sky._tick() is None and made(scene)[1] == "preview"
    begin()
    choose(scene, time=11.0)
    bpy.ops.skylight.make_sky()  # meanwhile
    while refine_sky.work() is not None:
        refine_sky._tick()
    assert made(scene)[0].time == "11:00:00" and made(scene)[1] == "preview"
    assert "not refined" in stage.drawn(panels.SKYLIGHT_PT_main).text
    begin()
    assert "not refined" not in stage.drawn(panels.SKYLIGHT_PT_main).text
    refine_sky.drop()
