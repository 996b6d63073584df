"""Glass, metal and what lies behind glass, chosen as in the panel and applied as a reflectance."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.materials import glass_and_metal, spectral_material
from spectral_skylight.addon.ui import panels
from spectral_skylight.tests.ui.stage import (
    drawn,
    error_of,
    given,
    links,
    material,
    matrix,
    select,
)

pytestmark = pytest.mark.blender

GRID = range(380, 781, 20)


@pytest.fixture
def gold(tmp_path):
    """n and k of a metal."""
    file = tmp_path / "gold.csv"
    rows = [f"{nm},{1.4 if nm < 520 else 0.3},{1.9 if nm < 520 else 3.0}\n" for nm in GRID]
    file.write_text("nm,n,k\n" + "".join(rows))
    return str(file)


@pytest.fixture
def pane(tmp_path):
    """The transmittance of a green glass."""
    file = tmp_path / "pane.csv"
    file.write_text("nm,green\n" + "".join(f"{x},{0.8 - 0.4 * (x > 600)}\n" for x in GRID))
    return str(file)


def test_glass(scene, pane):
    before = links()
    choice = material().skylight
    choice.kind = "GLASS"
    choice.filepath = pane
    shown = drawn(panels.SKYLIGHT_PT_material)
    assert "pane" in shown.properties and "behind" not in shown.properties
    choice.pane = "BLOCK"
    bpy.ops.skylight.apply()
    pane = glass_and_metal.pane_of(material())
    name, transmittance, faces = pane.name, pane.values, pane.faces
    assert (name, faces) == ("green", 2)
    assert transmittance[[0, -1]] == pytest.approx([0.8, 0.4])
    assert "As glass: green" in drawn(panels.SKYLIGHT_PT_material).text
    assert "Wall: green" in drawn(panels.SKYLIGHT_PT_all).text
    bpy.ops.skylight.update()
    bpy.ops.skylight.make_spectral()  # which leaves it glass, and makes the roof spectral
    assert glass_and_metal.pane_node(material()) is not None and given("Roof") is not None
    assert use_cases.left_alone(scene) == []
    bpy.ops.skylight.remove()
    assert links() == before and glass_and_metal.pane_node(material()) is None


def test_glass_alone_brings_no_lamps(scene, pane):
    """Nothing is there for them to shine on, and they would burn out all else."""
    objects = len(bpy.data.objects)
    for name in ("Wall", "Roof"):
        bpy.ops.skylight.choose_reflectance(material=name, filepath=pane, kind="GLASS")
    bpy.ops.skylight.make_spectral()
    tint = (
        material()
        .node_tree.nodes[glass_and_metal.pane_node(material()).name]
        .inputs["Transmittance"]
    )
    assert tint.default_value[0] < 0.6 < tint.default_value[2] < 0.81  # green to blue passes
    assert len(bpy.data.objects) == objects
    bpy.ops.skylight.update()
    bpy.ops.skylight.remove_all()
    assert len(bpy.data.objects) == objects
    surfaces = [tree for tree in bpy.data.node_groups if tree.name.startswith("Skylight Surface")]
    assert not any(tree.users for tree in surfaces)  # Blender saves none without


def test_a_metal(scene, gold, brick):
    assert "is not metallic" in error_of(bpy.ops.skylight.apply, filepath=gold, kind="METAL")
    material().node_tree.nodes["Principled BSDF"].inputs["Metallic"].default_value = 1.0
    bpy.ops.skylight.make_spectral()
    assert use_cases.left_alone(scene) == [("Wall", "is a metal: choose a file with its n and k")]
    bpy.ops.skylight.choose_reflectance(filepath=gold, kind="METAL")
    shown = drawn(panels.SKYLIGHT_PT_material)
    assert "column" not in shown.properties and material().skylight.problem == ""
    bpy.ops.skylight.make_spectral()
    n, k = glass_and_metal.metal_of(material())
    assert (n[0], k[0], n[-1], k[-1]) == pytest.approx((1.4, 1.9, 0.3, 3.0))
    assert use_cases.left_alone(scene) == [] and given() == "gold"
    kept = matrix()
    bpy.ops.skylight.make_spectral()
    assert matrix() == pytest.approx(kept)
    material().skylight.filepath = "/nowhere.csv"
    assert "nowhere.csv" in material().skylight.problem
    bpy.ops.skylight.apply(filepath=brick, column="moss")
    assert glass_and_metal.metal_of(material()) is None and given() == "moss"  # a metal no more


def test_behind_glass(scene, brick, pane):
    bpy.ops.skylight.apply(filepath=brick, column="moss")
    free = np.array(spectral_material.managed(material()).details.values)
    material().skylight.behind = pane
    bpy.ops.skylight.apply()
    found = spectral_material.managed(material())
    assert found.record.reflectance == "moss behind green"
    tau = np.interp(np.arange(380, 781, 5), GRID, [0.8 - 0.4 * (x > 600) for x in GRID])
    # Monotone cubics and straight lines differ beside a step, 600 to 620 nm.
    assert np.abs(found.details.values - free * tau)[:44] == pytest.approx(0, abs=1e-6)
    assert np.abs(found.details.values - free * tau)[50:] == pytest.approx(0, abs=1e-6)
    assert "not applied yet" not in drawn(panels.SKYLIGHT_PT_material).text
    bpy.ops.skylight.update()
    assert given() == "moss behind green"
    select("Wall", "Roof")
    bpy.ops.skylight.apply_selected(filepath=brick, column="brick", behind=pane)
    assert (given("Wall"), given("Roof")) == ("brick behind green",) * 2
    assert material("Roof").skylight.behind == pane
