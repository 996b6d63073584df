"""Ordinary architecture is baked: whatever shows a managed material."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import progress
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import fine_mesh, instance_proxies, scene_bake
from spectral_skylight.addon.scene.output import render as renders
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.node_groups import baked_light
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import exr, faces
from spectral_skylight.tests.buildings import (
    as_bytes,
    box,
    colours,
    flags,
    ground,
    material,
    shown,
    sky_share,
)

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def instancing(made_of):
    """A Geometry Nodes group that puts a cube on each point."""
    tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    given = groups.add(tree, "NodeGroupInput")
    cube = groups.add(tree, "GeometryNodeMeshCube")
    set_material = groups.add(tree, "GeometryNodeSetMaterial", cube.outputs[0])
    set_material.inputs["Material"].default_value = made_of
    points = groups.add(tree, "GeometryNodeInstanceOnPoints", given.outputs[0])
    tree.links.new(set_material.outputs[0], points.inputs["Instance"])
    groups.add(tree, "NodeGroupOutput", points.outputs[0])
    return tree


def test_ordinary_architecture():
    """Whatever shows a managed material is baked; what cannot be ends in a line, not a crash."""
    faces.empty_scene()
    made_of = material()
    linked = bpy.context.scene.collection.objects.link
    house = box("House", (0, 0, 1.01), (2, 2, 2), made_of)
    twin = bpy.data.objects.new("Twin", house.data)
    twin.location, twin.scale = (40, 0, 0), (-1, 1, 1)
    roof = shown("Roof over the twin", [(36, -4, 4), (44, -4, 4), (44, 4, 4), (36, 4, 4)],
                 [(3, 2, 1, 0)], made_of)  # fmt: skip
    linked(twin)
    rows = shown("Rows", [(0, 30, 1), (5, 30, 1), (10, 30, 1)], [(0, 1, 2)], made_of)
    rows.modifiers.new("Instances", "NODES").node_group = instancing(made_of)
    around = [(0, 50, 0), (4, 50, 0), (4, 54, 0), (2, 51, 0), (0, 54, 0)]
    concave = shown("Concave", around, [(0, 1, 2, 3, 4)], made_of)
    smooth = box("Smooth", (-20, 0, 1), (2, 2, 2), made_of)
    smooth.data.shade_smooth()
    smooth.modifiers.new("Subdivision", "SUBSURF").levels = 2
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "Hi", 0.1
    text.materials.append(made_of)
    sign = bpy.data.objects.new("Sign", text)
    sign.location.x = -40
    linked(sign)
    shown("Nothing", [(0, 0, 0)], [], made_of)
    flattened = box("Flattened", (60, 0, 0), (1, 1, 1), made_of)
    flattened.scale.z = 0.0
    collapsed = shown("Collapsed", [(70, 0, 3)] * 3, [(0, 1, 2)], made_of)
    bpy.context.view_layer.update()
    before = {obj.name: as_bytes(obj.data) for obj in bpy.data.objects if obj.type == "MESH"}
    lines = progress.run(scene_bake.bake(rays=256))
    assert lines[-1].endswith("object(s) baked")
    assert any('"Nothing"' in line for line in lines)
    assert any('"Flattened"' in line for line in lines)
    assert len(lines) <= 4, lines
    baked = [house, twin, roof, rows, concave, smooth, sign]
    assert set(scene_bake.baked()) >= set(baked)
    assert collapsed in scene_bake.baked() or any('"Collapsed"' in line for line in lines)
    for obj in baked:
        if obj.type == "MESH":
            assert np.all(flags(obj)), obj.name
    assert {name: as_bytes(bpy.data.objects[name].data) for name in before} == before
    stale = set(scene_bake.stale())
    assert not stale & set(baked)
    # An open roof sees all of the sky, an open wall half of it: 256 rays err by less than 1 %.
    share, normals = sky_share(house)
    assert share[normals[:, 2] > 0.9].mean() == pytest.approx(1.0, abs=0.01)
    assert share[np.abs(normals[:, 2]) < 0.1].mean() == pytest.approx(0.5, abs=0.01)
    # The twin shares the mesh, mirrored; it has a roof of its own over it.
    share, normals = sky_share(twin)
    assert share[normals[:, 2] > 0.9].mean() < 0.3
    share, normals = sky_share(rows)  # three instances, made real for their corners
    assert share[normals[:, 2] > 0.9].mean() == pytest.approx(1.0, abs=0.01)
    share, _ = sky_share(concave)
    np.testing.assert_allclose(share, 1.0, atol=0.01)
    # Subdivision has kept the smooth normals, and with them the steady light.
    share, normals = sky_share(smooth)
    # Its flat facets hide what their smooth normals would see along them, some 5 % of the sky.
    np.testing.assert_allclose(share, (1 + normals[:, 2]) / 2, atol=0.06)


def collection(name, *objects):
    """A collection that is in no scene, of objects that leave theirs."""
    found = bpy.data.collections.new(name)
    for obj in objects:
        for other in obj.users_collection:
            other.objects.unlink(obj)
        found.objects.link(obj)
    return found


def empty(name, shows, **settings):
    """An Empty in the scene that instances a collection."""
    obj = bpy.data.objects.new(name, None)
    obj.instance_type, obj.instance_collection = "COLLECTION", shows
    for key, value in settings.items():
        setattr(obj, key, value)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def shown_places():
    """What a picture shows: material, place and size of each mesh, sorted."""
    found = []
    for each in bpy.context.evaluated_depsgraph_get().object_instances:
        data = each.object.data
        if each.object.type != "MESH" or not data.polygons or each.object.hide_render:
            continue
        area = sum(face.area for face in data.polygons)  # no subdivision changes it, nor its middle
        middle = sum((f.area * f.center for f in data.polygons), 0 * data.polygons[0].center) / area
        middle = each.matrix_world @ middle
        name = each.object.material_slots[0].material.name
        found.append((name, *(round(x, 2) + 0.0 for x in middle), round(area, 2)))
    return sorted(found)


def everything():
    """What a user has: names by kind, and what Empties instance."""
    kinds = ("objects", "meshes", "collections", "node_groups")
    names = {kind: sorted(each.name for each in getattr(bpy.data, kind)) for kind in kinds}
    return names, {o.name: o.instance_collection for o in bpy.data.objects}


def test_instances_of_collections_each_see_their_own_sky():
    """Nested, mirrored, with an offset, a lamp, a hidden cutter and a material on the object."""
    faces.empty_scene()
    made_of, other = material(), bpy.data.materials.new("Not spectral")
    house = box("House", (0, 0, 1.01), (2, 2, 2), other)
    house.material_slots[0].link = "OBJECT"
    house.material_slots[0].material = made_of
    cutter = box("Cutter", (0, 0, 1), (9, 9, 9), made_of)
    cutter.hide_render = cutter.hide_viewport = True
    shed = box("Shed", (0, 4, 0.5), (1, 1, 1), made_of)
    plain = box("Plain", (0, -4, 0.5), (1, 1, 1), other)
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    inner = collection("Inner", shed, plain)
    nested = empty("Nested", inner, location=(1, 0, 0))
    estate = collection("Estate", house, cutter, lamp, nested)
    estate.instance_offset = (0.5, 0, 0)
    free = empty("Free", estate)
    roofed = empty("Roofed", estate, location=(40, 0, 0), scale=(-1, 1, 1))
    shown("Roof", [(30, -9, 4), (50, -9, 4), (50, 9, 4), (30, 9, 4)], [(3, 2, 1, 0)], made_of)
    bpy.context.view_layer.update()
    before, picture = everything(), shown_places()
    meshes = {mesh.name: mesh for mesh in bpy.data.meshes}
    bytes_before = {name: as_bytes(mesh) for name, mesh in meshes.items()}
    assert {obj.name for obj in scene_bake.targets()} == {"Free", "Roofed", "Roof"}
    assert progress.run(scene_bake.bake(rays=64)) == ["5 object(s) baked"]
    there = {root.name: instance_proxies.stand_ins(root) for root in (free, roofed)}
    for each in (*there["Free"], *there["Roofed"]):
        assert np.all(flags(each)), each.name
    # A roof over one of them.
    up = {}
    for name, each in there.items():
        share, normals = sky_share(next(o for o in each if "House" in o.name))
        up[name] = share[normals[:, 2] > 0.9].mean()
    assert up["Free"] == pytest.approx(1.0, abs=0.02) and up["Roofed"] < 0.3
    # The picture shows the same: other instances stay, the cutter hidden, the lamp lit.
    scene_bake.remove()
    assert shown_places() == picture
    progress.run(scene_bake.bake(rays=64))
    assert shown_places() == picture
    lamps = [i for i in bpy.context.evaluated_depsgraph_get().object_instances
             if i.object.type == "LIGHT"]  # fmt: skip
    assert len(lamps) == 2
    assert scene_bake.stale() == []
    # What moves, with its Empty or in the collection, is told; what is added shows.
    moved = next(o for o in instance_proxies.stand_ins(free) if "House" in o.name)
    for obj, axis in ((free, 1), (house, 2)):
        obj.location[axis] += 0.3
        bpy.context.view_layer.update()
        assert moved in scene_bake.stale()
        obj.location[axis] -= 0.3
    more = box("More", (0, 9, 1), (1, 1, 1), made_of)
    for each in more.users_collection:
        each.objects.unlink(more)
    estate.objects.link(more)
    bpy.context.view_layer.update()
    assert {free, roofed} <= set(scene_bake.stale())
    progress.run(scene_bake.bake([free], rays=64))
    assert len(instance_proxies.stand_ins(free)) == 3
    estate.objects.unlink(more)
    bpy.data.objects.remove(more)
    bpy.data.meshes.remove(bpy.data.meshes["More"])
    scene_bake.remove()
    assert everything() == before
    assert {name: as_bytes(mesh) for name, mesh in meshes.items()} == bytes_before
    # Whoever ends the work has the instances back.
    work = scene_bake.bake([free], rays=64)
    next(work)
    work.close()
    assert everything() == before


def test_instances_by_geometry_nodes_bring_their_materials():
    """The instancing object has no spectral material of its own."""
    faces.empty_scene()
    made_of = material()
    rows = shown("Rows", [(0, 0, 1), (5, 0, 1), (10, 0, 1)], [], bpy.data.materials.new("None"))
    rows.data.materials.clear()
    rows.modifiers.new("Instances", "NODES").node_group = instancing(made_of)
    shown("Roof", [(8, -9, 4), (50, -9, 4), (50, 9, 4), (8, 9, 4)], [(3, 2, 1, 0)], made_of)
    assert progress.run(scene_bake.bake(rays=64)) == ["2 object(s) baked"]
    assert np.all(flags(rows)) and scene_bake.stale() == []
    share, normals = sky_share(rows)
    mesh = rows.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    x = np.array([mesh.vertices[loop.vertex_index].co.x for loop in mesh.loops])
    up = normals[:, 2] > 0.9
    assert share[up & (x < 6)].mean() > 0.9
    assert share[up & (x > 6)].mean() < 0.4


def test_glass_and_what_casts_no_shadow_let_the_sky_through():
    faces.empty_scene()
    made_of = material()
    floor = ground(1, made_of)
    glass = bpy.data.materials.new("Glass")
    if bpy.app.version < (5, 0, 0):
        glass.use_nodes = True
    glass.node_tree.nodes["Principled BSDF"].inputs["Transmission Weight"].default_value = 1.0
    cover = shown("Cover", [(-9, -9, 1), (9, -9, 1), (9, 9, 1), (-9, 9, 1)], [(0, 1, 2, 3)], glass)

    def share():
        progress.run(scene_bake.bake([floor], rays=64, changed_only=False))
        return sky_share(floor)[0].mean()

    assert share() == pytest.approx(1.0, abs=0.01)
    cover.material_slots[0].material = None
    assert share() < 0.1
    cover.visible_shadow = False
    assert share() == pytest.approx(1.0, abs=0.01)
    cover.visible_shadow, cover.hide_render = True, True
    assert share() == pytest.approx(1.0, abs=0.01)


def test_the_foot_of_a_wall_casts_no_shadow_inside_out():
    """Points of the floor under a house are in the dark; the floor beside it must not be."""
    faces.empty_scene()
    made_of = material()
    floor = ground(20, made_of)
    box("House", (0.13, 0.07, 1), (4, 4, 2), made_of)
    progress.run(scene_bake.bake([floor], rays=256))
    mesh = floor.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    fine = fine_mesh.read(mesh)
    share = colours(mesh, baked_light.LIGHT)[:, 0]
    middles = fine.mean(fine.places[fine.point])
    beside = (np.abs(middles[:, 1]) < 1.5) & (middles[:, 0] > 2.2) & (middles[:, 0] < 2.6)
    assert np.count_nonzero(beside) > 3
    # A long wall hides half the sky from its foot, this short one less.
    assert np.all(fine.mean(share)[beside] > 0.49)


def test_a_single_wall_has_light_on_its_back(tmp_path):
    """Under a canopy, and as the instance of a collection in the open, beside numpy."""
    scene = faces.empty_scene()
    sky = np.zeros((32, 64, 3), np.float32)
    sky[:16] = 0.4, 0.6, 1.0
    write_panorama(tmp_path / "sky.exr", sky)
    use_cases.set_sky(scene, tmp_path / "sky.exr", Settings())
    paint = bpy.data.materials.new("Paint")
    wall = shown("Wall", [(2, 0, 0), (-2, 0, 0), (-2, 0, 2), (2, 0, 2)], [(0, 1, 2, 3)], paint)
    around = [(-20, -4, 3), (5, -4, 3), (5, 0, 3), (-20, 0, 3)]
    shown("Canopy", around, [(3, 2, 1, 0)], bpy.data.materials.new("Plain"))
    twin = bpy.data.objects.new("Twin", wall.data)
    empty("Free", collection("Walls", twin), location=(60, 0, 0))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.data.clip_end = "ORTHO", 2, 200
    camera.rotation_euler = (np.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = 8
    settings = Settings(ground="none", occlusion="baked", tolerance=None)
    use_cases.make_spectral(scene, {paint: Assignment("half", np.full(81, 0.5))}, settings)
    assert progress.run(scene_bake.bake(rays=1024))[-1] == "2 object(s) baked"
    use_cases.update(scene, settings)
    seen = []
    for x in (0.0, 60.0):
        camera.location = x, -30, 1
        path, _ = renders.render(scene, tmp_path / f"{x}.exr", engine="eevee")
        seen.append(exr.picture(path)[..., :3].mean(axis=(0, 1)))
    # Upright, half of the sky is seen; of that the canopy hides what is numbered here.
    up, along = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (400, 800)), indexing="ij")
    z, azimuth = up.ravel(), np.pi * along.ravel()  # of the half in front of the back
    y = np.sqrt(1 - z**2) * np.sin(azimuth)
    x = np.sqrt(1 - z**2) * np.cos(azimuth)
    far = 2.0 / z  # from the middle of the wall, 2 m under it
    hidden = (y * far < 4) & (x * far > -20) & (x * far < 5)
    part = (y * ~hidden).sum() / y.sum()
    np.testing.assert_allclose(seen[1], 0.5 * 0.5 * np.array([0.4, 0.6, 1.0]), rtol=0.02)
    # Over the wall's height the canopy is nearer and farther: of its middle, 3 %.
    np.testing.assert_allclose(seen[0], part * seen[1], rtol=0.05)
