"""`Baked Light` shows the colours that a bake has left, of the side that is seen."""

import bpy
import numpy as np
import pytest

from spectral_skylight.node_groups import baked_light
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]

COUNT = 16


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    """Faces with random colours before and behind, under a material that shows one output."""
    scene = faces.empty_scene()
    rng = np.random.default_rng(0)
    shown = faces.add_faces(scene, np.tile([0.0, 0.0, 1.0], (COUNT, 1)))
    values = rng.uniform(0.1, 3.0, (2, COUNT, 4))
    values[..., 3] = baked_light.FLAG
    values[0, 3, 3] = values[1, 5, 3] = 0.0
    for name, each in zip((baked_light.LIGHT, baked_light.BEHIND), values, strict=True):
        attribute = shown.data.attributes.new(name, "FLOAT_COLOR", "CORNER")
        attribute.data.foreach_set("color", np.repeat(each, 4, axis=0).astype(np.float32).ravel())
    material = bpy.data.materials.new("Shown")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    node = groups.add(material.node_tree, "ShaderNodeGroup", node_tree=baked_light.ensure())
    emission = groups.add(material.node_tree, "ShaderNodeEmission")
    groups.add(material.node_tree, "ShaderNodeOutputMaterial", emission.outputs[0])
    shown.material_slots[0].material = material
    folder = tmp_path_factory.mktemp("baked")

    def show(output, engine="eevee"):
        material.node_tree.links.new(node.outputs[output], emission.inputs[0])
        return faces.seen(scene, folder, COUNT, engine)

    return node, shown, values, show


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_pixels_are_the_colours_of_the_side_that_is_seen(stage, engine):
    node, shown, values, show = stage
    node.inputs["Strength"].default_value = 1.5
    for side in (0, 1):
        np.testing.assert_allclose(show("Light", engine), 1.5 * values[side, :, :3], rtol=2e-3)
        flags = values[side, :, 3:] == baked_light.FLAG
        np.testing.assert_allclose(show("Baked", engine), np.repeat(flags, 3, axis=1), atol=1e-3)
        shown.data.flip_normals()
        shown.data.update()


def test_without_attributes_nothing_is_baked(stage):
    """A missing attribute reads 0 with alpha 1: no flag may come of that."""
    _, shown, _, show = stage
    mesh = shown.data
    shown.data = bare = mesh.copy()
    for name in (baked_light.LIGHT, baked_light.BEHIND):
        bare.attributes.remove(bare.attributes[name])
    np.testing.assert_array_equal(show("Baked"), 0.0)
    shown.data = mesh
