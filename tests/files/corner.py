"""Makes corner.blend, from which the files of earlier bakes were made: see README.md."""

import sys
from pathlib import Path

import bpy

from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests import faces

HERE = Path(__file__).parent
FLOOR = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)]
WALL = [(3, 4, 0), (3, -2, 0), (3, -2, 6), (3, 4, 6)]
PLAIN = [(-90, -90, -9), (90, -90, -9), (90, 90, -9), (-90, 90, -9)]
"""So wide that what stands on it is small, and baked in few points."""


def main() -> None:
    """A brick floor seen from above, beside a copper wall that hides sky and sends light back."""
    write_panorama(HERE / "sky.exr", faces.smooth_sky(3))
    scene = faces.empty_scene()
    world = faces.worlds.set_sky(scene, HERE / "sky.exr")
    image = world.node_tree.nodes["Environment Texture"].image
    image.pack()
    image.filepath = image.filepath_raw = "//sky.exr"
    for name, corners in (("Brick", FLOOR), ("Copper", WALL), ("Plain", PLAIN)):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(corners, [], [[0, 1, 2, 3]])
        mesh.materials.append(bpy.data.materials.new(name))
        mesh.materials[0].use_nodes = True
        scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    faces.watch(scene, (1.0, 1.0), 2.0)
    scene.render.resolution_x = scene.render.resolution_y = 2 * faces.PIXELS
    bpy.ops.wm.save_as_mainfile(filepath=str(HERE / "corner.blend"), compress=True)
    (HERE / "sky.exr").unlink()
    (HERE / "corner.blend1").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
