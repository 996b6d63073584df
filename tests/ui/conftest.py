"""A small scene under a small sky."""

import pytest


@pytest.fixture
def scene(addon, tmp_path):
    """Two cubes with the materials Wall and Roof, the first active, under an HDRI; brick.csv."""
    import bpy

    from spectral_skylight.addon.scene.world import hdri as worlds
    from spectral_skylight.tests.ui import stage

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    for name in ("Roof", "Wall"):
        material = bpy.data.materials.new(name)
        mesh = bpy.data.meshes.new(name)
        mesh.materials.append(material)
        obj = bpy.data.objects.new(name, mesh)
        scene.collection.objects.link(obj)
        if bpy.app.version < (5, 0, 0):
            material.use_nodes = True
    bpy.context.view_layer.update()  # or it does not know of its objects yet
    stage.select("Wall")
    stage.write_sky(tmp_path / "sky.exr")
    (tmp_path / "brick.csv").write_text(stage.BRICK)
    worlds.set_sky(scene, tmp_path / "sky.exr")  # nothing is analysed yet
    return scene


@pytest.fixture
def brick(tmp_path, scene):
    """A CSV with the columns brick and moss, as the operators take it."""
    return str(tmp_path / "brick.csv")
