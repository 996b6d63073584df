"""The scene in Blender: RGB × RGB as today, and our materials.

python -m spectral_skylight.tests.peers.blender_render request.json answer.npz
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.output import render as renderer
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces


def add_patches(face: dict[str, Any], materials: list[bpy.types.Material]) -> None:
    """Put the 24 patches into the scene, their middle at the origin."""
    right, up = np.array(face["right"]), np.array(face["up"])
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    for k, material in enumerate(materials):
        middle = (k % 6 - 2.5) * right + (1.5 - k // 6) * up
        points = middle + corners[:, :1] * right + corners[:, 1:] * up
        mesh = bpy.data.meshes.new(material.name)
        mesh.from_pydata(points.tolist(), [], [(0, 1, 2, 3)])
        mesh.materials.append(material)
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(material.name, mesh))


def look_at(scene: bpy.types.Scene, face: dict[str, Any], pixels: int) -> None:
    """Let the camera see the 6 x 4 patches and no more."""
    faces.watch(scene, (0.0, 0.0), 6.0)
    right, up, normal = (np.array(face[name]) for name in ("right", "up", "normal"))
    axes = np.stack([right, up, normal, 10.0 * normal], axis=1)
    scene.camera.matrix_world = Matrix([*axes.tolist(), [0.0, 0.0, 0.0, 1.0]])
    scene.render.resolution_x, scene.render.resolution_y = 6 * pixels, 4 * pixels


def diffuse(name: str, colour: np.ndarray) -> bpy.types.Material:
    """Return a plain diffuse material."""
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader = groups.add(tree, "ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*colour.tolist(), 1.0)
    groups.add(tree, "ShaderNodeOutputMaterial", shader.outputs[0])
    return material


def build(request: dict[str, Any], face: dict[str, Any]) -> bpy.types.Scene:
    """Return the scene with one face, in today's materials or in ours."""
    scene = faces.empty_scene()
    scene.eevee.use_shadows = True
    worlds.set_sky(scene, request["file"])
    names, rho = colorchecker()
    materials = [diffuse(n, c) for n, c in zip(names, rgb_albedo(rho), strict=True)]
    add_patches(face, materials)
    look_at(scene, face, request["pixels"])
    scene.cycles.use_adaptive_sampling = False
    if request["basis"] is not None:
        settings = Settings(basis=request["basis"], sun_elevation=request["sun_elevation"])
        given = [Assignment(name, values) for name, values in zip(names, rho, strict=True)]
        use_cases.make_spectral(scene, dict(zip(materials, given, strict=True)), settings)
    return scene


def timed(scene: bpy.types.Scene) -> float:
    """Render and return the seconds."""
    start = time.perf_counter()
    bpy.ops.render.render(scene=scene.name)
    return time.perf_counter() - start


def main(request: str, answer: str) -> None:
    """Write pictures (faces, rows, columns, 3), and seconds.

    ``seconds``: of all pictures once everything is loaded; ``start_seconds``: of loading.
    """
    asked = json.loads(Path(request).read_text())
    pictures, seconds = [], np.zeros(2)
    with tempfile.TemporaryDirectory() as folder:
        for face in asked["faces"]:
            scene = build(asked, face)
            scene.render.engine = renderer.engine_id(asked["engine"])
            scene.render.use_persistent_data = True
            scene.cycles.samples = scene.eevee.taa_render_samples = asked["samples"]
            first, again = timed(scene), timed(scene)
            seconds += again, max(first - again, 0.0)
            pictures.append(faces.picture(scene, Path(folder), asked["engine"])[..., :3])
    np.savez(answer, pictures=pictures, seconds=seconds[0], start_seconds=seconds[1])


if __name__ == "__main__":
    main(*sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # before 5.0 Blender can crash at interpreter exit
