"""Files of earlier versions (tests/files): they render as they did, and are upgraded in place."""

import json
from pathlib import Path

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import portraits, use_cases
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world.settings import Settings, stored
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.node_groups import skylight_surface, spectral_matrix
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces
from spectral_skylight.tests.lanes import newest

pytestmark = pytest.mark.blender


FILES = Path(__file__).parents[1] / "files"
OLD = ["surface1", pytest.param("surface1_models", marks=newest), "surface2"]
NAMES = ["Brick", "Tile", "Copper"]


def opened(name):
    bpy.ops.wm.open_mainfile(filepath=str(FILES / f"{name}.blend"), load_ui=False)
    return bpy.context.scene


def settings_of(scene):
    return stored(scene.world)


def fresh(basis, **settings):
    """What this version makes of the file that all were made from."""
    scene = opened("base")
    read = read_reflectances(FILES / "paints.csv")
    given = {
        bpy.data.materials[name]: Assignment(read.names[k], read.values[k])
        for k, name in enumerate(NAMES)
    }
    use_cases.make_spectral(scene, given, Settings(basis=basis, **settings))
    return scene


def surface(name):
    return next(
        n for n in bpy.data.materials[name].node_tree.nodes if n.get("spectral_skylight_node")
    )


def test_old_files_are_small():
    assert all(path.stat().st_size < 200_000 for path in FILES.glob("*.blend"))


@pytest.mark.parametrize("name", OLD)
def test_an_old_file_renders_as_it_did_and_like_new_after_an_update(name, tmp_path):
    scene = opened(name)
    kept = json.loads((FILES / "expected.json").read_text())[name]["cycles"]
    np.testing.assert_allclose(faces.seen(scene, tmp_path, 9, "cycles"), kept, rtol=5e-3, atol=1e-4)
    for each in NAMES:  # what panels and pictures ask for
        managed = spectral_material.managed(bpy.data.materials[each])
        assert managed.record.reflectance == each.lower()
        assert managed.details.values
        assert portraits.portrait(bpy.data.materials[each]).draw_curve() is not None
    assert len(portraits.expected()) == 3

    group = skylight_surface.find(scene.world)
    trees = {t.name for t in bpy.data.node_groups}
    identity = group.session_uid
    bump = bpy.data.materials["Brick"].node_tree.nodes["Bump"]
    surface("Tile").inputs["Alpha"].default_value = 1.0
    use_cases.update(scene, settings_of(scene), use_cases.in_scene(scene))
    group = skylight_surface.find(scene.world)
    assert (group.session_uid, group[groups.VERSION]) == (identity, skylight_surface.VERSION)
    assert trees <= {t.name for t in bpy.data.node_groups} | {"Sky Probe"}
    assert not any(".0" in t.name for t in bpy.data.node_groups)
    node = surface("Brick")
    assert node.node_tree == group
    assert node.inputs["Normal"].links[0].from_node == bump
    record = bpy.data.materials["Brick"][tags.MATERIAL]
    assert record["version"] == skylight_surface.VERSION
    now = faces.seen(scene, tmp_path, 9, "cycles")
    found = settings_of(scene)  # those of the file are kept
    scene = fresh(found.basis, occlusion=found.occlusion)
    np.testing.assert_allclose(now, faces.seen(scene, tmp_path, 9, "cycles"), rtol=1e-4, atol=1e-5)


BAKES = ["bake_of_sky", "bake_of_bounce"]


@pytest.mark.parametrize("name", BAKES)
def test_an_old_bake_renders_as_it_did_until_an_update_asks_for_a_new_one(name, tmp_path):
    """What such a bake holds is of no use to the new shader: then the sky is open, and that is
    said. Baked again, the floor sees less sky than an open one, and more light than one bounce."""
    scene = opened(name)
    kept = json.loads((FILES / "expected.json").read_text())
    shown = faces.seen(scene, tmp_path, 4, "cycles")
    np.testing.assert_allclose(shown, kept[name]["cycles"], rtol=5e-3, atol=1e-4)
    settings = settings_of(scene)
    assert settings.occlusion == "baked"
    said = use_cases.update(scene, settings, use_cases.in_scene(scene)).lines
    assert "2 bake(s) of an earlier version hold no bounced light: bake again" in said
    open_sky = faces.seen(scene, tmp_path, 4, "cycles")
    assert run(use_cases.bake(scene, settings))[0] == "2 object(s) baked"
    assert use_cases.update(scene, settings, use_cases.in_scene(scene)).lines == []
    now = faces.seen(scene, tmp_path, 4, "cycles")
    assert (np.array(kept["bake_of_sky"]["cycles"]) < now).all() and (now < 0.97 * open_sky).all()
    # One bounce of two bakers, some 1 % apart; further ones between floor and wall are weaker.
    assert (now > 0.98 * np.array(kept["bake_of_bounce"]["cycles"])).all()


@newest
@pytest.mark.slow
@pytest.mark.parametrize("name", BAKES)
def test_old_bakes_in_eevee(name, tmp_path):
    kept = json.loads((FILES / "expected.json").read_text())[name]["eevee"]
    shown = faces.seen(opened(name), tmp_path, 4)
    np.testing.assert_allclose(shown, kept, rtol=5e-3, atol=1e-3)


@newest
@pytest.mark.slow
def test_old_files_in_eevee(tmp_path):
    kept = json.loads((FILES / "expected.json").read_text())["surface1"]["eevee"]
    scene = opened("surface1")
    shown = faces.seen(scene, tmp_path, 9)
    np.testing.assert_allclose(shown, kept, rtol=5e-3, atol=1e-3)
    use_cases.update(scene, settings_of(scene), use_cases.in_scene(scene))
    now = faces.seen(scene, tmp_path, 9)
    scene = fresh("rayleigh")
    np.testing.assert_allclose(now, faces.seen(scene, tmp_path, 9), rtol=2e-3, atol=1e-3)


@newest
def test_a_file_of_a_newer_version_is_told_and_left_alone(tmp_path):
    scene = opened("surface2")
    before = faces.seen(scene, tmp_path, 9, "cycles")
    newer = skylight_surface.VERSION + 1
    material, group = bpy.data.materials["Brick"], skylight_surface.find(scene.world)
    inside = list(group.nodes)
    group[groups.VERSION] = newer
    with pytest.raises(InputError, match="newer version of this add-on; update the add-on"):
        use_cases.update(scene, settings_of(scene), use_cases.in_scene(scene))
    material[tags.MATERIAL]["version"] = newer
    for change in (spectral_material.check_editable, spectral_material.remove):
        with pytest.raises(InputError, match='"Brick": was made by a newer version'):
            change(material)
    assert list(group.nodes) == inside and group[groups.VERSION] == newer
    np.testing.assert_array_equal(faces.seen(scene, tmp_path, 9, "cycles"), before)
    shared = spectral_matrix.ensure()
    shared[groups.VERSION] = spectral_matrix.VERSION + 1  # appended from a newer file
    assert spectral_matrix.ensure() != shared
