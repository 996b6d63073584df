"""Files dropped on the 3D view, and what lies there under the mouse."""

import json

import bpy
import pytest

from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.ui import (
    under_mouse,
)
from spectral_skylight.tests.ui.stage import error_of, given, material

pytestmark = pytest.mark.blender


def test_dropping_a_file_of_one_column(scene, tmp_path, brick):
    lines = (tmp_path / "brick.csv").read_text().splitlines()
    one = tmp_path / "one.csv"
    one.write_text("\n".join(line.rpartition(",")[0] for line in lines))
    assert bpy.ops.skylight.drop_reflectance(filepath=str(one)) == {"FINISHED"}
    assert given("Wall") == "brick"
    assert bpy.ops.skylight.drop_reflectance(filepath=str(one), object="Roof") == {"FINISHED"}
    assert given("Roof") == "brick"


def test_dropping_a_file_of_many(scene, tmp_path, brick):
    said = error_of(bpy.ops.skylight.drop_reflectance, filepath=brick)
    assert "holds 2 materials" in said and "'brick', 'moss'" in said
    assert "has no path" in error_of(bpy.ops.skylight.drop_reflectance)
    assert bpy.ops.skylight.drop_reflectance(filepath=brick, column="moss") == {"FINISHED"}
    assert given("Wall") == "moss"


def test_dropping_on_an_object_without_a_material_makes_one(scene, brick):
    obj = bpy.data.objects.new("Bare", bpy.data.meshes.new("Bare"))
    scene.collection.objects.link(obj)
    bpy.ops.skylight.drop_reflectance(filepath=brick, column="moss", object="Bare")
    assert obj.material_slots[0].material.name == "moss"
    assert spectral_material.managed(obj.material_slots[0].material).record.reflectance == "moss"


def test_a_glazing_that_is_dropped_is_glass(scene, tmp_path):
    rows = [{"wavelength": x / 1000, "T": 0.6, "Rf": 0.1, "Rb": 0.1} for x in range(380, 781, 5)]
    product = {"name": "Pane", "spectral_data": {"spectral_data": rows}}
    path = tmp_path / "product.json"
    path.write_text(json.dumps(product))
    bpy.ops.skylight.drop_reflectance(filepath=str(path), column="Pane transmittance")
    own = material("Wall").skylight
    assert (own.kind, own.column) == ("GLASS", "Pane transmittance")
    assert material("Wall") in spectral_material.ours()
    bpy.ops.skylight.drop_reflectance(
        filepath=str(path), column="Pane front reflectance", material="Roof"
    )
    assert given("Roof") == "Pane front reflectance"


def test_what_is_under_the_mouse(scene):
    """A plane of two faces with a material each, seen from above."""
    mesh = bpy.data.meshes.new("Floor")
    corners = [(x, y, 0) for x in (0, 1, 2) for y in (0, 1)]
    mesh.from_pydata(corners, [], [(0, 2, 3, 1), (2, 4, 5, 3)])
    for name in ("Wall", "Roof"):
        mesh.materials.append(material(name))
    mesh.polygons[1].material_index = 1
    floor = bpy.data.objects.new("Floor", mesh)
    scene.collection.objects.link(floor)
    bpy.context.view_layer.update()
    assert under_mouse.along(bpy.context, (0.5, 0.5, 5), (0, 0, -1)) == (floor, 0)
    assert under_mouse.along(bpy.context, (1.5, 0.5, 5), (0, 0, -1)) == (floor, 1)
    assert under_mouse.along(bpy.context, (9, 9, 5), (0, 0, -1)) is None
    assert under_mouse.material_in(floor, 1, "new") == material("Roof")
    assert under_mouse.under_mouse(bpy.context, 10, 10) is None  # no view here
