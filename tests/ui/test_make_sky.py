"""A sky of a date and a place by one button: its sun, what is taken over, what is refused."""

import math
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.world import hdri, light_group, panorama, settings
from spectral_skylight.addon.sky.sun_position import sun_position
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.ui import make_sky, panels, place
from spectral_skylight.tests.ui import stage
from spectral_skylight.tests.ui.test_undo import check

pytestmark = pytest.mark.blender

BERLIN = {"timezone": "Europe/Berlin", "latitude": 52.5, "longitude": 13.4}


def choose(scene, **values):
    for name, value in {**BERLIN, **values}.items():
        setattr(scene.skylight_place, name, value)


def light_of(scene):
    return panorama.light_of(scene.world, observer())


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


def test_another_hour_keeps_what_was_set_in_the_world(scene):
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


def test_it_is_one_step_to_undo(scene, brick):
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
    shown = stage.Recorder()
    make_sky.SKYLIGHT_OT_make_sky.draw(SimpleNamespace(layout=shown), bpy.context)
    fields = {each.identifier for each in place.SkylightPlace.bl_rna.properties}
    assert {*shown.properties} == fields - {"rna_type", "name", "taken"}
    scene.world = None
    assert "skylight.make_sky" in stage.drawn(panels.SKYLIGHT_PT_main).operators
    choose(scene)
    bpy.ops.skylight.make_sky()
    assert "skylight.make_sky" in stage.drawn(panels.SKYLIGHT_PT_main).operators


class SunPosition(bpy.types.PropertyGroup):
    """The fields of Blender's add-on Sun Position that are taken over."""

    year: bpy.props.IntProperty(default=2024)
    month: bpy.props.IntProperty(default=1)
    day: bpy.props.IntProperty(default=1)
    day_of_year: bpy.props.IntProperty(default=60)
    use_day_of_year: bpy.props.BoolProperty()
    use_daylight_savings: bpy.props.BoolProperty()
    time: bpy.props.FloatProperty(default=12.0)
    UTC_zone: bpy.props.FloatProperty()
    latitude: bpy.props.FloatProperty()
    longitude: bpy.props.FloatProperty()
    north_offset: bpy.props.FloatProperty(unit="ROTATION")


@pytest.fixture
def sun_position_add_on(scene):
    bpy.utils.register_class(SunPosition)
    bpy.types.Scene.sun_pos_properties = bpy.props.PointerProperty(type=SunPosition)
    yield scene.sun_pos_properties
    del bpy.types.Scene.sun_pos_properties
    bpy.utils.unregister_class(SunPosition)


def test_sun_position_is_taken_over_when_it_has_changed(scene, sun_position_add_on):
    sun, chosen = sun_position_add_on, scene.skylight_place
    choose(scene)
    place.take_over(scene)
    assert chosen.latitude == 52.5  # no place was ever set there
    sun.latitude, sun.longitude, sun.UTC_zone = 35.68, 139.77, 9.0
    sun.use_day_of_year, sun.time, sun.north_offset = True, 15.5, math.radians(20)
    place.take_over(scene)
    found = place.sky_place(chosen)
    assert (found.date, found.time, found.timezone) == ("2024-02-29", "15:30:00", "+9")
    assert (found.latitude, found.longitude) == pytest.approx((35.68, 139.77))
    assert found.north == pytest.approx(20.0)
    chosen.latitude = 10.0
    place.take_over(scene)
    assert chosen.latitude == 10.0
    sun.use_daylight_savings = True
    place.take_over(scene)
    assert chosen.timezone == "+10" and chosen.latitude == pytest.approx(35.68)


class Entity(SimpleNamespace):
    """An entity of an IFC file, as ifcopenshell gives it."""

    def is_a(self):
        return self.kind


def test_the_site_of_an_ifc_project():
    site = Entity(RefLatitude=(52, 30, 36, 0), RefLongitude=(-13, -24, 0, -36_000_000))
    north = Entity(DirectionRatios=(math.sin(0.2), math.cos(0.2)))
    contexts = [
        Entity(kind="IfcGeometricRepresentationSubContext", TrueNorth=None),
        Entity(kind="IfcGeometricRepresentationContext", TrueNorth=north),
    ]
    nowhere = Entity(RefLatitude=None, RefLongitude=None)
    entities = {"IfcSite": [nowhere, site], "IfcGeometricRepresentationContext": contexts}
    found = place.of_project(SimpleNamespace(by_type=entities.get))
    assert found["latitude"] == pytest.approx(52.51)
    assert found["longitude"] == pytest.approx(-13.41)
    assert found["north"] == pytest.approx(math.degrees(0.2))
