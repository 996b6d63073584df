"""Managed materials from other files and copies of all kinds: linked, appended, overridden."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.lights import light_linking, sun_lamp
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.scene.world.settings import Settings, stored
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.node_groups import gloss, skylight_surface
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces
from spectral_skylight.tests.lanes import newest

pytestmark = pytest.mark.blender


SETTINGS = Settings(basis="rayleigh", gloss=True)
BRICK = Assignment("brick", np.interp(WAVELENGTHS, [400, 560, 620, 700], [0.06, 0.1, 0.4, 0.55]))


def sky(path, seed):
    """A sky with a sun, other light for another seed."""
    rgb = faces.smooth_sky(seed, 64)
    rgb[24, 20 + 10 * seed] = (9000.0, 8000.0, 6000.0)
    write_panorama(path, rgb)
    return path


def house(folder, seed=1, name="Brick"):
    """A scene of one spectral wall under a sky."""
    scene = faces.empty_scene()
    worlds.set_sky(scene, sky(folder / f"sky{seed}.exr", seed))
    material = bpy.data.materials.new(name)
    nodes.use(material)
    obj = faces.add_faces(scene, faces.directions(4))
    obj.data.materials[0] = material
    obj.name = "Wall"
    tree = material.node_tree
    tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(bump.outputs[0], tree.nodes["Principled BSDF"].inputs["Normal"])
    use_cases.make_spectral(scene, {material: BRICK}, SETTINGS)
    return scene


def save(folder, name):
    path = folder / name
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return str(path)


def take(path, link, **wanted):
    """Append or link datablocks by name; return the first."""
    with bpy.data.libraries.load(path, link=link) as (_, into):
        for kind, names in wanted.items():
            setattr(into, kind, names)
    return next(iter(getattr(into, kind)))


def update(scene):
    return use_cases.update(scene, SETTINGS)


def doubles():
    """Names of our groups that there is more than one of."""
    kinds = [tree[groups.KIND] for tree in bpy.data.node_groups if groups.KIND in tree]
    return {kind for kind in kinds if kinds.count(kind) > 1}


def surface(material):
    return next(n for n in material.node_tree.nodes if n.get("spectral_skylight_node") == "surface")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("library")
    house(folder, 1, "Theirs")
    return save(folder, "library.blend")


@pytest.mark.parametrize("kind", ["material", "object"])
def test_an_appended_material_follows_the_world_here(library, tmp_path, kind):
    scene = house(tmp_path, 2)
    world = scene.world
    if kind == "object":
        obj = take(library, False, objects=["Wall"])
        scene.collection.objects.link(obj)
        theirs = obj.active_material
    else:
        theirs = take(library, False, materials=["Theirs"])
        wall = bpy.data.objects["Wall"].copy()
        scene.collection.objects.link(wall)
        wall.material_slots[0].link = "OBJECT"
        wall.material_slots[0].material = theirs
    managed = spectral_material.managed(theirs)
    assert managed.record.reflectance == "brick" and managed.world not in (None, world)
    assert skylight_surface.KIND in doubles()
    bump = theirs.node_tree.nodes["Bump"]
    update(scene)
    assert spectral_material.managed(theirs).world == world
    assert doubles() == set()
    ours = bpy.data.materials["Brick"]
    for role in ("surface", "gloss"):
        one, other = (
            next(n for n in m.node_tree.nodes if n.get("spectral_skylight_node") == role)
            for m in (ours, theirs)
        )
        assert one.node_tree == other.node_tree
        for a, b in zip(one.inputs, other.inputs, strict=True):
            assert a.name == b.name and a.is_linked == b.is_linked
            if hasattr(a, "default_value"):
                np.testing.assert_array_equal(a.default_value, b.default_value)
    assert surface(theirs).inputs["Normal"].links[0].from_node == bump
    path = save(tmp_path, "both.blend")
    bpy.ops.wm.open_mainfile(filepath=path)
    assert len(bpy.data.worlds) == 1  # what only the old drivers held is gone
    theirs = bpy.data.materials["Theirs"]
    spectral_material.remove(theirs)
    links = theirs.node_tree.nodes["Material Output"].inputs["Surface"].links
    assert links[0].from_node.type == "BSDF_PRINCIPLED"
    assert not any(n.type == "GROUP" for n in theirs.node_tree.nodes)
    assert spectral_material.is_managed(bpy.data.materials["Brick"])


def test_linked_and_overridden_materials_are_skipped(library, tmp_path):
    """Also where the scene's World is the library's own, with all that it lights there."""
    scene = house(tmp_path, 2)
    obj = take(library, True, objects=["Wall"])
    scene.collection.objects.link(obj)
    theirs = obj.active_material
    assert spectral_material.is_managed(theirs) and theirs in use_cases.in_scene(scene)
    before = [list(s.default_value) for s in surface(theirs).inputs if s.type == "VECTOR"]
    with pytest.raises(InputError, match='"Theirs": is linked from'):
        use_cases.update(scene, SETTINGS, [theirs])
    update(scene)
    scene.world = take(library, True, worlds=["sky1"])
    ours = bpy.data.materials["Brick"]
    use_cases.make_spectral(scene, {ours: BRICK}, SETTINGS)
    assert spectral_material.managed(ours).world == scene.world
    assert surface(ours).node_tree.library is None
    after = [list(s.default_value) for s in surface(theirs).inputs if s.type == "VECTOR"]
    assert after == before
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type = "COLLECTION"
    bpy.data.collections.new("Theirs").objects.link(obj)
    instance.instance_collection = bpy.data.collections["Theirs"]
    scene.collection.objects.link(instance)
    update(scene)
    assert sun_lamp.find(scene, sun_lamp.SUN) is not None
    assert instance in list(light_linking.find(scene).objects)  # the sun shines on it too
    path = save(tmp_path, "linking.blend")
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    assert stored(scene.world).basis == "rayleigh"  # though nothing is saved on a linked World
    update(scene)


@newest
def test_a_linked_object_with_a_material_of_this_file(library, tmp_path):
    scene = house(tmp_path, 2)
    obj = take(library, True, objects=["Wall"])
    scene.collection.objects.link(obj)
    override = obj.override_create(remap_local_usages=True)
    override.material_slots[0].link = "OBJECT"
    override.material_slots[0].material = own = bpy.data.materials.new("Own")
    nodes.use(own)
    use_cases.make_spectral(scene, {own: BRICK}, SETTINGS)
    assert override in list(light_linking.find(scene).objects)
    spectral_material.remove(own)
    assert not spectral_material.is_managed(own)


@newest
def test_made_local_it_is_this_files_own(library, tmp_path):
    scene = house(tmp_path, 2)
    obj = take(library, True, objects=["Wall"])
    scene.collection.objects.link(obj)
    obj.make_local()
    mesh = obj.data.make_local()
    local = mesh.materials[0].make_local()
    mesh.materials[0] = local
    assert local.library is None and spectral_material.is_managed(local)
    update(scene)
    assert spectral_material.managed(local).world == scene.world
    assert all(n.node_tree.library is None for n in local.node_tree.nodes if n.type == "GROUP")
    spectral_material.remove(local)
    assert not spectral_material.is_managed(local)


def test_copies_stand_alone(tmp_path):
    scene = house(tmp_path, 2)
    ours = bpy.data.materials["Brick"]
    twin = ours.copy()
    bpy.data.objects["Wall"].copy().data.materials.append(twin)
    scene.collection.objects.link(bpy.data.objects["Wall.001"])  # linked data
    update(scene)
    group = surface(ours).node_tree
    assert surface(twin).node_tree == group
    spectral_material.remove(ours)
    assert spectral_material.is_managed(twin) and skylight_surface.find(scene.world) == group
    assert gloss.GLOSS in {t.get(groups.KIND) for t in bpy.data.node_groups}
    use_cases.make_spectral(scene, {ours: BRICK}, SETTINGS)
    bpy.data.orphans_purge(do_recursive=True)
    update(scene)
    assert surface(ours).node_tree == surface(twin).node_tree == group
    for material in (ours, twin):
        spectral_material.remove(material)
    assert list(bpy.data.node_groups) == []
    assert sun_lamp.find(scene, sun_lamp.SUN) is None


def test_a_full_copy_of_a_scene_has_light_of_its_own(tmp_path):
    scene = house(tmp_path, 2)
    world, obj = scene.world, bpy.data.objects["Wall"]
    bpy.ops.scene.new(type="FULL_COPY")
    copy = bpy.context.scene
    assert copy != scene and copy.world != world
    there = next(o for o in copy.objects if o.type == "MESH")
    if there.active_material == obj.active_material:  # as the preferences have it
        there.data.materials[0] = obj.active_material.copy()
    update(copy)
    for one, wall in ((scene, obj), (copy, there)):
        managed = spectral_material.managed(wall.active_material)
        assert managed.world == one.world
        lamps = [o for o in one.objects if o.get(tags.LAMP) == sun_lamp.SUN]
        assert len(lamps) == 1
        assert list(light_linking.find(one).objects) == [wall]
    copy.world.node_tree.nodes["Environment Texture"].image = bpy.data.images.load(
        str(sky(tmp_path / "sky3.exr", 3))
    )
    before = np.array(spectral_material.managed(obj.active_material).matrix)
    update(copy)
    np.testing.assert_array_equal(spectral_material.managed(obj.active_material).matrix, before)
    for wall in (there, obj):
        spectral_material.remove(wall.active_material)
    assert list(bpy.data.node_groups) == []
