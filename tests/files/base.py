"""Makes base.blend, from which the files of earlier versions were made: see README.md."""

import sys
from pathlib import Path

import bpy
import numpy as np

from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests import faces

HERE = Path(__file__).parent


def main() -> None:
    """Nine faces in three materials under an uneven sky with a sun, turned, its HDRI packed."""
    sky = faces.smooth_sky(3, 64)
    sky[24, 90] = (9000.0, 8000.0, 6000.0)
    write_panorama(HERE / "sky.exr", sky.astype(np.float16).astype(np.float32))
    scene = faces.empty_scene()
    world = faces.worlds.set_sky(scene, HERE / "sky.exr")
    nodes = world.node_tree.nodes
    nodes["Mapping"].inputs["Rotation"].default_value = (0.0, 0.0, 0.7)
    nodes["Background"].inputs["Strength"].default_value = 1.5
    image = nodes["Environment Texture"].image
    image.pack()
    image.filepath = image.filepath_raw = "//sky.exr"
    obj = faces.add_faces(scene, faces.directions(9))
    obj.data.materials.clear()
    for name in ("Brick", "Tile", "Copper"):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        obj.data.materials.append(material)
    tree = bpy.data.materials["Brick"].node_tree
    noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = 0.0
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], tree.nodes["Principled BSDF"].inputs["Normal"])
    for k, face in enumerate(obj.data.polygons):
        face.material_index = k % 3
    bpy.ops.wm.save_as_mainfile(filepath=str(HERE / "base.blend"), compress=True)
    (HERE / "sky.exr").unlink()
    (HERE / "base.blend1").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
