"""The two scenes as blend files, as an architect would have modelled them: plain base colours."""

from pathlib import Path

import bpy
import numpy as np
from geometry import (
    BUILDING_CAMERA,
    CHECKER_CAMERA,
    SAMPLES,
    SPHERE_RADIUS,
    Camera,
    building,
    sphere_centres,
)
from mathutils import Matrix


def save_checker(
    path: Path, names: list[str], base_colours: np.ndarray, exposure: float, sunlit: bool
) -> None:
    """Save 24 spheres in the materials ``names`` (24) of base colours (24, 3)."""
    _new_file(CHECKER_CAMERA, exposure, sunlit)
    mesh = _sphere_mesh()
    for name, colour, centre in zip(names, base_colours, sphere_centres(), strict=True):
        ball = bpy.data.objects.new(name, mesh)
        ball.location = centre
        bpy.context.collection.objects.link(ball)
        # One mesh for all: the material is the object's.
        ball.material_slots[0].link = "OBJECT"
        ball.material_slots[0].material = _material(name, colour)
    _save(path)


def save_building(
    path: Path, names: list[str], base_colours: np.ndarray, exposure: float, sunlit: bool
) -> None:
    """Save the building, its parts' materials ``names`` in the order of `building`."""
    _new_file(BUILDING_CAMERA, exposure, sunlit)
    for name, colour, polygons in zip(names, base_colours, building().values(), strict=True):
        corners = [corner for polygon in polygons for corner in polygon]
        ends = np.cumsum([len(polygon) for polygon in polygons])
        faces = [list(range(end - len(p), end)) for p, end in zip(polygons, ends, strict=True)]
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(corners, [], faces)
        mesh.materials.append(_material(name, colour))
        bpy.context.collection.objects.link(bpy.data.objects.new(name, mesh))
    _save(path)


def _new_file(camera: Camera, exposure: float, sunlit: bool) -> None:
    """Begin a file; ``sunlit``: whether the sky may have a sun that casts shadows."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.preferences.filepaths.save_version = 0
    scene = bpy.context.scene
    eevee = "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE"
    scene.render.engine = eevee
    scene.eevee.taa_render_samples = SAMPLES
    # Eevee prepares shadows for each sample, lamps or not: by a processor more than half the time.
    scene.eevee.use_shadows = sunlit
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.exposure = exposure
    scene.world = bpy.data.worlds.new("Grey")
    scene.world.probe_resolution = "128"  # nothing here mirrors the World
    place_camera(scene, camera)


def _sphere_mesh() -> bpy.types.Mesh:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=SPHERE_RADIUS)
    ball = bpy.context.object
    mesh = ball.data
    bpy.data.objects.remove(ball)
    mesh.shade_smooth()
    mesh.materials.append(None)
    return mesh


def _material(name: str, colour: np.ndarray) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*colour.tolist(), 1.0)
    return material


def _save(path: Path) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)


def place_camera(scene: bpy.types.Scene, camera: Camera) -> None:
    """Give a scene a camera and its picture's size."""
    data = bpy.data.cameras.new("Camera")
    if camera.orthographic:
        data.type, data.ortho_scale = "ORTHO", camera.scale
    else:
        data.lens = data.sensor_width / camera.scale
    view = bpy.data.objects.new("Camera", data)
    axes = np.stack([camera.right, camera.up, camera.back, camera.location], axis=1)
    view.matrix_world = Matrix([*axes.tolist(), [0, 0, 0, 1]])
    scene.collection.objects.link(view)
    scene.camera = view
    scene.render.resolution_x, scene.render.resolution_y = camera.width, camera.height
    scene.render.filter_size = 1.0
