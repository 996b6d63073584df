"""Properties, groups and nodes that somebody changed: panels draw, buttons work, all leaves."""

from dataclasses import fields

import bpy
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.registration import CLASSES
from spectral_skylight.addon.scene.materials import record
from spectral_skylight.addon.scene.world import light_record, settings
from spectral_skylight.addon.ui import last_guard, staleness_handlers
from spectral_skylight.tests.ui import stage

pytestmark = pytest.mark.blender

PANELS = [cls for cls in CLASSES if issubclass(cls, bpy.types.Panel)]


def replace(key, value):
    """Write over every property of this key, wherever it is."""

    def change():
        nodes = [n for m in bpy.data.materials if m.node_tree for n in m.node_tree.nodes]
        groups = (bpy.data.materials, bpy.data.worlds, bpy.data.node_groups, bpy.data.objects)
        found = [owner for each in groups for owner in each] + [*bpy.data.scenes, *nodes]
        found += [*bpy.data.meshes]
        found = [owner for owner in found if key in owner]
        assert found, f"nothing has {key}"
        for owner in found:
            owner[key] = value

    return change


def group(kind, do):
    return lambda: do(next(t for t in bpy.data.node_groups if t.name.startswith(kind)))


def without_sockets(tree):
    for item in [i for i in tree.interface.items_tree if i.item_type == "SOCKET"]:
        tree.interface.remove(item)


def nodeless(kind):
    def change():
        tree = bpy.data.materials["Wall"].node_tree
        for node in [n for n in tree.nodes if n.type == kind]:
            tree.nodes.remove(node)

    return change


CHANGES = {
    "material is a number": replace(tags.MATERIAL, 7),
    "material is text": replace(tags.MATERIAL, "x"),
    "material is empty": replace(tags.MATERIAL, {"a": 1}),
    "material of numbers": replace(tags.MATERIAL, {"reflectance": 1, "extra": 2, "version": "x"}),
    "settings are a list": replace(tags.SETTINGS, "[1,2]"),
    "settings are of other kinds": replace(tags.SETTINGS, '{"sun": 7, "white": "x", "basis": []}'),
    "light is null": replace(tags.LIGHT, "null"),
    "light is of other kinds": replace(tags.LIGHT, '{"errors": 7, "spectrum": ["x"], "degree": 9}'),
    "what outputs remember": replace(tags.OUTPUT_SOURCE, 7),
    "own settings": replace(tags.MATERIAL_SETTINGS, {"name": "x", "cycles.emission_sampling": "x"}),
    "left alone": replace(tags.LEFT_ALONE, '[7, ["a"]]'),
    "comparison": replace(tags.COMPARISON, '{"surface/Row R": "x", "surface/Row G": [1]}'),
    "versions": replace("spectral_skylight_version", "x"),
    "surface removed": group("Skylight Surface", lambda tree: bpy.data.batch_remove([tree])),
    "surface renamed": group("Skylight Surface", lambda tree: setattr(tree, "name", "mine")),
    "surface emptied": group("Skylight Surface", lambda tree: tree.nodes.clear()),
    "surface without sockets": group("Skylight Surface", without_sockets),
    "irradiance emptied": group("Sky Irradiance", lambda tree: tree.nodes.clear()),
    "matrix without sockets": group("Spectral Matrix", without_sockets),
    "no surface node": nodeless("GROUP"),
    "no output": nodeless("OUTPUT_MATERIAL"),
}


@pytest.mark.slow
@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())
def test_what_was_changed_by_hand_breaks_nothing(scene, change, monkeypatch):
    """No panel, handler or button meets what it did not expect, and one click makes all new."""
    monkeypatch.setattr(last_guard, "line", _raise)
    bpy.ops.skylight.make_spectral()
    change()

    def look():
        staleness_handlers.look()
        for panel in PANELS:
            if not hasattr(panel, "poll") or panel.poll(bpy.context):
                assert "a fault of this program" not in stage.drawn(panel).text

    look()
    for operator in (bpy.ops.skylight.update, bpy.ops.skylight.make_spectral):
        if operator.poll():
            operator()
        look()
    if bpy.ops.skylight.remove_all.poll():
        bpy.ops.skylight.remove_all()
    look()
    assert not [m.name for m in bpy.data.materials if tags.MATERIAL in m]


def _raise(error):
    raise AssertionError from error


def test_every_field_that_is_read_back_has_its_kind():
    """One without would be lost, or would be trusted."""
    for cls, kinds, others in (
        (settings.Settings, settings._RIGHT, set()),
        (record.Result, record._RESULT, set()),
        (record.Details, record._DETAILS, {"result"}),
        (light_record.LightRecord, light_record._RIGHT, {"rest"}),
    ):
        assert {field.name for field in fields(cls)} == kinds.keys() | others, cls
