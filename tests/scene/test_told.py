"""What is said of a scene: one line a cause, no contradictions, an interior in plain words."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.grouping import grouped
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import out_of_date, use_cases
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.ui import give
from spectral_skylight.tests import buildings, faces

pytestmark = pytest.mark.blender

OPEN = Settings(occlusion="open")


@pytest.fixture
def scene(tmp_path):
    scene = faces.empty_scene()
    faces.light(scene, tmp_path)
    return scene


def paint(name, **values):
    material = bpy.data.materials.new(name)
    nodes.use(material)
    for key, value in values.items():
        material.node_tree.nodes["Principled BSDF"].inputs[
            key.replace("_", " ")
        ].default_value = value
    return material


def test_an_interior_under_the_open_sky_is_said_to_be_too_bright(scene):
    """In a room that sees a tenth of the sky; under the sky itself nothing is said."""
    wall = paint("Wall")
    buildings.ground(4, wall)
    given = {wall: Assignment("grey", np.full(81, 0.5))}
    use_cases.make_spectral(scene, given, OPEN)
    assert light_group.record_of(scene.world).caption == "open sky: no shadows yet"
    for x, y, size in (
        (0, 4, (8, 0.1, 3)),
        (0, -4, (8, 0.1, 3)),
        (4, 0, (0.1, 8, 3)),
        (-4, 0, (0.1, 8, 3)),
    ):
        buildings.box("Side", (x, y, 1.5), size, paint("Side"))
    buildings.box("Ceiling", (0.5, 0, 3), (7, 8, 0.1), paint("Ceiling"))
    bpy.context.view_layer.update()
    use_cases.make_spectral(scene, given, OPEN)
    caption = light_group.record_of(scene.world).caption
    share = int(caption.split("; ")[1].split(" %")[0])
    assert share > 85 and caption.endswith("they are too bright, most of all indoors")
    assert caption in use_cases.light_lines(scene)
    use_cases.make_spectral(scene, given, Settings(occlusion="dome"))
    assert "too bright" not in light_group.record_of(scene.world).caption


def test_what_no_face_shows_is_neither_baked_nor_missed(scene):
    """A slot of a spectral material that no face has: said once, and not called old as well."""
    wall, frame = paint("Wall"), paint("Frame", Metallic=1.0)
    buildings.ground(4, wall)
    door = buildings.box("Door", (0, 0, 1), (1, 0.1, 2), wall)
    door.data.materials.append(frame)
    door.data.polygons.foreach_set("material_index", [1] * len(door.data.polygons))
    settings = Settings(occlusion="baked")
    use_cases.make_spectral(scene, {wall: Assignment("grey", np.full(81, 0.5))}, settings)
    assert out_of_date.look_at_bakes(scene) == ["Ground"]
    lines = run(use_cases.bake(scene, settings, rays=32))
    (line,) = [line for line in lines if "Door" in line]
    assert line == '"Door": not baked, for it has no faces of a spectral material'
    assert "1 object(s) baked" in lines
    assert out_of_date.look_at_bakes(scene) == []


def test_gamut_is_said_beside_an_unknown_error_and_once(scene):
    """Seventeen vivid materials under a sky of lamps: a line for each cause, with the number."""
    image = next(n.image for n in scene.world.node_tree.nodes if n.type == "TEX_ENVIRONMENT")
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    pixels.reshape(-1, 4)[:, :3] *= [4.0, 0.2, 0.02]  # of a colour that no daylight has
    image.pixels.foreach_set(pixels)
    narrow = np.where(abs(np.linspace(380, 780, 81) - 490) < 12, 0.9, 0.001)
    vivid = [paint(f"Vivid {k}") for k in range(17)]
    given = {material: Assignment("narrow", narrow) for material in vivid}
    results = use_cases.make_spectral(scene, given, OPEN).results
    assert all(result.unknown and "error unknown" in result.line for result in results)
    assert all(result.out_of_gamut and "out of gamut" in result.line for result in results)
    (warning, unknown) = give.of_results(results)
    assert (
        warning[0] == "WARNING"
        and "17 materials (Vivid 0, Vivid 1, Vivid 2 …): out of" in warning[1]
    )
    assert (
        unknown[0] == "INFO" and unknown[1].startswith("17 materials") and "unknown" in unknown[1]
    )


def test_emitters_whose_light_is_not_carried_are_named(scene):
    """Under open sky their light reaches nothing spectral; a bake carries it."""
    wall = paint("Wall")
    buildings.ground(4, wall)
    for k in range(5):
        sign = paint(f"Sign {k}", Emission_Strength=5.0)
        sign.node_tree.nodes["Principled BSDF"].inputs["Emission Color"].default_value = (
            1,
            0,
            0,
            1,
        )
        buildings.box("Sign", (0, 0, 1 + k), (1, 0.1, 0.5), sign)
    given = {wall: Assignment("grey", np.full(81, 0.5))}
    for occlusion, count in (("open", 1), ("dome", 1), ("baked", 0)):
        use_cases.make_spectral(scene, given, Settings(occlusion=occlusion))
        found = [w for w in light_group.record_of(scene.world).warnings if "emits light" in w]
        assert len(found) == count
        assert all(line.startswith("5 materials (Sign 0, ") for line in found)


def test_reasons_to_leave_materials_alone_are_grouped(scene):
    for k in range(12):
        glass = paint(f"Glass {k}", Transmission_Weight=1.0)
        buildings.box("Pane", (0, 0, k), (1, 0.1, 1), glass)
    done = run(use_cases.make_everything_spectral(scene, {}, OPEN))
    (line,) = grouped(done.left)
    assert line.startswith("12 materials (Glass 0, ") and "choose a transmittance" in line
