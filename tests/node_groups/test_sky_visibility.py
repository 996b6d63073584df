"""`Sky Visibility` shows the products of harmonics that numpy computes, in Eevee and Cycles."""

import math

import bpy
import mathutils
import numpy as np
import pytest

from spectral_skylight.addon.sky.harmonics import KEYS, rotate
from spectral_skylight.node_groups import sky_visibility
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]

COUNT = 64
PLACE = (130.0, -70.0, 2.0)  # where the faces were baked
ANGLE = 0.7  # [rad]: every order turns by another angle


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    """Faces whose attributes are random, under a material that shows one output of the group."""
    scene = faces.empty_scene()
    rng = np.random.default_rng(0)
    shown = faces.add_faces(scene, np.tile([0.0, 0.0, 1.0], (COUNT, 1)))
    values = rng.uniform(-0.3, 0.3, (11, COUNT, 4))
    values[0, :, 3] = 2.0  # the constant harmonic keeps sums positive: Emission shows no others
    values[5, :, 3] = values[7, :, 3] = 2.0
    values[4] = rng.uniform(0.1, 0.9, (COUNT, 4))
    shown.location = PLACE
    bpy.context.view_layer.update()
    values[4, :, 1] = sky_visibility.mark(shown.matrix_world)
    scene.camera.location += shown.location
    values[9, :, 2] = 1.0
    for number in range(10):
        _store(shown.data, sky_visibility.attribute(number), values[number])
    values[10, :, :3] = rng.uniform(0.0, 0.1, (COUNT, 3))
    values[10, :, 3] = 77.0
    _store(shown.data, sky_visibility.EXACT, values[10])
    material = bpy.data.materials.new("Shown")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    tree = sky_visibility.ensure(bounce=True)
    node = groups.add(material.node_tree, "ShaderNodeGroup", node_tree=tree)
    emission = groups.add(material.node_tree, "ShaderNodeEmission")
    groups.add(material.node_tree, "ShaderNodeOutputMaterial", emission.outputs[0])
    shown.material_slots[0].material = material
    sky, first = rng.uniform(-0.1, 0.1, (16, 3)), rng.uniform(-0.1, 0.1, (9, 3))
    sky[0] = first[0] = (1.0, 1.5, 2.0)
    named = dict(zip(KEYS, sky.tolist(), strict=True))
    sky_visibility.set_coefficients(tree, named, dict(zip(KEYS, first.tolist(), strict=False)))
    folder = tmp_path_factory.mktemp("visibility")

    def show(output, engine="eevee"):
        material.node_tree.links.new(node.outputs[output], emission.inputs[0])
        return faces.seen(scene, folder, COUNT, engine)

    return node, values, sky, first, show


def _store(mesh, name, values):
    attribute = mesh.attributes.new(name, "FLOAT_COLOR", "CORNER")
    attribute.data.foreach_set("color", np.repeat(values, 4, axis=0).astype(np.float32).ravel())


def _harmonics(values, places):
    columns = [
        values[place[0], :, place[1]] for key in KEYS if (place := places.get(key)) is not None
    ]
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_pixels_are_the_products_of_harmonics(stage, engine):
    node, values, sky, first, show = stage
    # Eevee's half floats round by up to 0.05 %; Cycles' sums are float32.
    near = {"rtol": 1e-3 if engine == "eevee" else 1e-5, "atol": 1e-5}
    node.inputs["Strength"].default_value = 0.5
    node.inputs["Rotation"].default_value = (0.0, 0.0, ANGLE)
    transfer = _harmonics(values, sky_visibility.PLACES)
    assert transfer.shape == (COUNT, 16)
    expected = 0.5 * rotate(transfer, ANGLE) @ sky
    np.testing.assert_allclose(show("Irradiance", engine), expected, **near)
    for way, places in enumerate(sky_visibility.BOUNCES):
        bounced = 0.5 * rotate(_harmonics(values, places), ANGLE) @ first
        np.testing.assert_allclose(show(f"Bounce {way + 1}", engine), bounced, **near)
        sun = values[4, :, 2 + way]
        np.testing.assert_allclose(show(f"Bounce {way + 1} Sun", engine)[:, 0], sun, **near)
    np.testing.assert_allclose(show("Ground", engine)[:, 0], values[4, :, 0], **near)


def test_baked_at_its_place_alone(stage):
    """A moved object and an instance elsewhere fall back to the open sky."""
    *_, show = stage
    shown = bpy.data.objects["Faces"]
    camera = bpy.context.scene.camera
    elsewhere = (0.0, 0.0, 0.0)
    for engine in ("eevee", "cycles"):
        for place, flag in ((elsewhere, 0.0), ((*PLACE[:2], 2.1), 0.0), (PLACE, 1.0)):
            camera.location += mathutils.Vector(place) - shown.location
            shown.location = place
            np.testing.assert_array_equal(show("Baked", engine), flag)
            assert (show("Bounce 1", engine).max() > 0.0) == flag


def test_the_exact_part_counts_for_its_sky_and_turn_alone(stage):
    node, values, sky, _, show = stage
    node.inputs["Strength"].default_value = 1.0
    node.inputs["Rotation"].default_value = (0.0, 0.0, ANGLE)
    plain = rotate(_harmonics(values, sky_visibility.PLACES), ANGLE) @ sky
    for key, angle, part in ((76, ANGLE, 0), (77, ANGLE, 1), (77, ANGLE + 0.1, 0), (-1, ANGLE, 0)):
        sky_visibility.set_exact(node.node_tree, key, (math.cos(angle), math.sin(angle)))
        seen = show("Irradiance")
        np.testing.assert_allclose(seen, plain + part * values[10, :, :3], rtol=1e-3)


def test_the_world_turns_as_the_mapping_node_does():
    """A turn by the Mapping's angle moves a transfer's lobe by as much: V(d) meets L(R d)."""
    east = np.zeros(16)
    east[KEYS.index((1, 1))] = 1.0
    turned = rotate(east, math.pi / 2)
    assert turned[KEYS.index((1, -1))] == pytest.approx(1.0)
    assert turned[KEYS.index((1, 1))] == pytest.approx(0.0, abs=1e-12)


def test_without_attributes_nothing_is_there(stage):
    """A missing attribute reads 0 with alpha 1: neither flag nor bounce may come of that."""
    *_, show = stage
    shown = bpy.data.objects["Faces"]
    mesh = shown.data
    shown.data = bare = mesh.copy()
    for attribute in [a.name for a in bare.attributes if a.name.startswith("skylight_")]:
        bare.attributes.remove(bare.attributes[attribute])
    for output in ("Baked", "Bounce 1", "Bounce 2 Sun"):
        np.testing.assert_array_equal(show(output), 0.0)
    shown.data = mesh


def test_ensure_keeps_coefficients_also_as_another_variant():
    tree = sky_visibility.ensure()
    sky_visibility.set_coefficients(tree, {(2, -1): (1.0, 2.0, 3.0)})
    assert sky_visibility.ensure(tree) == tree
    assert sky_visibility.ensure(tree, bounce=True) == tree
    assert sky_visibility.coefficients(tree)[2, -1] == (1.0, 2.0, 3.0)
    assert len(sky_visibility.coefficients(tree)) == 16
    bpy.data.node_groups.remove(tree)
