"""Places that Blender's Sun Position and an IFC project know are taken over."""

import math
from types import SimpleNamespace

import bpy
import pytest

from spectral_skylight.addon.ui import place
from spectral_skylight.tests.ui.test_make_sky import choose

pytestmark = pytest.mark.blender


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
