"""How much of the sky geometry hides, against form factors that are known."""

import bpy
import pytest

from spectral_skylight.addon.scene.bake.sky_exposure import hidden_share

pytestmark = pytest.mark.blender

CHANCE = 0.04
"""Of 4,096 rays from 64 places: a standard error of some 0.015."""


@pytest.fixture
def floor():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.data.materials.new("Floor")


def box(corners, faces, name, material=None):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    if material:
        mesh.materials.append(material)
    shown = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(shown)
    return shown


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


def square(material):
    """One large face: places lie all over it."""
    return box(SQUARE, [(0, 1, 2, 3)], "Floor", material)


def walls():
    top = [(x, y, 1) for x, y, _ in SQUARE]
    return box(SQUARE + top, [(k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4)], "Walls")


def test_an_open_floor_sees_the_whole_sky(floor):
    square(floor)
    assert hidden_share(bpy.context.scene, [floor]) == 0.0


def test_a_courtyard_as_deep_as_wide(floor):
    """Opposite faces of a cube exchange 0.1998 of their light (J. R. Howell, form factor C-11)."""
    square(floor)
    walls()
    assert hidden_share(bpy.context.scene, [floor]) == pytest.approx(1 - 0.1998, abs=CHANCE)


def test_turned_scaled_and_instanced(floor):
    """The courtyard ten times as large, mirrored and turned, as an instance of a collection."""
    square(floor)
    walls()
    group = bpy.data.collections.new("Courtyard")
    for shown in list(bpy.context.scene.collection.objects):
        bpy.context.scene.collection.objects.unlink(shown)
        group.objects.link(shown)
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", group
    empty.scale, empty.rotation_euler, empty.location = (-10, 10, 10), (0, 0, 0.6), (3, 4, 5)
    bpy.context.scene.collection.objects.link(empty)
    assert hidden_share(bpy.context.scene, [floor]) == pytest.approx(1 - 0.1998, abs=CHANCE)


def test_only_faces_of_the_material_count_and_none_is_none(floor):
    square(floor)
    assert hidden_share(bpy.context.scene, [bpy.data.materials.new("Other")]) is None
    assert hidden_share(bpy.context.scene, []) is None
