"""A plan holds all that will be written, and making one changes no data-block."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import plan, use_cases, write
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.materials.assigned import assigned
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.tests import faces
from spectral_skylight.tests.scene.test_materials import dump

pytestmark = pytest.mark.blender

SETTINGS = Settings(basis="simplest", tolerance=0.5, gloss=True)
NK = np.full(81, 0.3), np.linspace(2.0, 5.0, 81)


LOOKED_AT = ("cycles", "cycles_visibility")
"""What Blender 4.5 makes when somebody looks for it."""


def plain(value):
    """A custom property's value; as text it would bear its address in memory."""
    for name in ("to_dict", "to_list"):
        if hasattr(value, name):
            return getattr(value, name)()
    return value


def everything():
    """All data-blocks of the file: names, users, custom properties, and of trees all there is."""
    found = {}
    for collection in (getattr(bpy.data, p.identifier) for p in bpy.data.bl_rna.properties):
        if not isinstance(collection, bpy.types.bpy_prop_collection):
            continue
        for block in collection:
            own = {key: plain(value) for key, value in block.items() if key not in LOOKED_AT}
            key = type(block).__name__, block.name_full
            found[key] = block.users, own
            if isinstance(block, bpy.types.Material | bpy.types.World | bpy.types.NodeTree):
                tree = dump(block)
                del tree["custom properties"]  # which are compared as values above
                found[key] += (tree,)
    return found


@pytest.fixture
def scene(tmp_path):
    """A wall, a pane, a handle and a textured floor under a sky with its sun."""
    scene = faces.empty_scene()
    rgb = faces.smooth_sky(3, 64)
    rgb[24, 50] = (9000.0, 8000.0, 6000.0)
    write_panorama(tmp_path / "sky.exr", rgb)
    use_cases.set_sky(scene, tmp_path / "sky.exr", SETTINGS)
    mesh = faces.add_faces(scene, faces.directions(4)).data
    mesh.materials.clear()
    for name in ("Wall", "Pane", "Handle", "Floor"):
        material = bpy.data.materials.new(name)
        nodes.use(material)
        mesh.materials.append(material)
    shader = bpy.data.materials["Handle"].node_tree.nodes["Principled BSDF"]
    shader.inputs["Metallic"].default_value = 1.0
    floor = bpy.data.materials["Floor"].node_tree
    image = floor.nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.new("Tiles", 4, 4)
    floor.links.new(image.outputs[0], floor.nodes["Principled BSDF"].inputs["Base Color"])
    return scene


def given():
    grey = np.full(81, 0.3)
    return {
        bpy.data.materials["Wall"]: Assignment("grey", grey, source="paint.csv:grey"),
        bpy.data.materials["Pane"]: Assignment("clear", 2 * grey, faces=2),
        bpy.data.materials["Handle"]: Assignment("gold", 2 * grey, metal=NK),
        bpy.data.materials["Floor"]: Assignment("tiles", grey),
    }


def test_a_plan_changes_no_data_block(scene):
    before = everything()
    made = plan.make(scene.world, given(), SETTINGS)
    assert everything() == before
    assert [one.material.name for one in made.materials] == ["Wall", "Handle", "Floor"]
    assert [material.name for material in made.panes] == ["Pane"]
    assert made.materials[2].texture is not None and made.lights.sun is not None
    run(write.write(made))
    assert everything() != before
    # A second plan, of what is spectral by now, writes nothing either.
    after = everything()
    plan.make(scene.world, given(), SETTINGS)
    assert everything() == after


def test_what_is_written_is_what_was_planned_and_is_read_back(scene):
    made = plan.make(scene.world, given(), SETTINGS)
    run(write.write(made))
    for one in made.materials:
        managed = spectral_material.managed(one.material)
        np.testing.assert_allclose(managed.matrix, one.surface.matrix, atol=1e-6)  # float32
        assert managed.details == one.surface.details
    for material, one in given().items():
        back = assigned(material)
        np.testing.assert_array_equal(back.values, one.values)
        assert (back.name, back.faces, back.source) == (one.name, one.faces, one.source)
        assert (back.metal is None) == (one.metal is None)


def test_what_cannot_be_is_found_before_anything_changes(scene):
    before = everything()
    wall = bpy.data.materials["Wall"]
    with pytest.raises(InputError, match="is not metallic"):
        plan.make(scene.world, {wall: Assignment("gold", np.full(81, 0.5), metal=NK)}, SETTINGS)
    with pytest.raises(InputError, match="has no World"):
        plan.make(None, given(), SETTINGS)
    assert everything() == before
