"""A mesh with one face for each direction, and the colour that each of them shows in a render."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np

from spectral_skylight.addon.scene.output import render as renderer
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests import exr

PIXELS = 3  # a face is 3 x 3 pixels and its middle is read: no neighbour reaches there


def empty_scene() -> bpy.types.Scene:
    """A new file with one empty scene that renders fast: one sample, nothing bounces.

    Nor does Eevee cast shadows: it prepares them for each sample, lamps or not, and by a processor
    that takes longer than all else that small pictures need.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = renderer.engine_id("eevee")
    scene.eevee.taa_render_samples = 1
    scene.eevee.use_shadows = False
    scene.cycles.samples = 1
    scene.cycles.max_bounces = 0
    scene.cycles.use_denoising = False
    scene.render.filter_size = 0.5
    # Otherwise Eevee rounds a mesh's normals to 10 bits, which alone makes up to 0.15 % here.
    scene.render.use_high_quality_normals = True
    return scene


def smooth_sky(seed: int, height: int = 16) -> np.ndarray:
    """A made-up lat-long sky (h, 2h, 3): bluish and uneven, as bright as 0.1 to 2."""
    rng = np.random.default_rng(seed)
    azimuth = (np.arange(2 * height) + 0.5) / height * np.pi
    elevation = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    turns, phases = rng.integers(1, 4, (4, 1)), rng.uniform(0, 2 * np.pi, (4, 1))
    waves = np.cos(turns * azimuth + phases)[:, None, :] * np.cos(elevation)[:, None]
    shape = np.exp(np.einsum("khw,kc->hwc", waves, rng.uniform(-0.25, 0.25, (4, 3))))
    ground = np.where(elevation < 0, 0.3, 1.0)[:, None, None]
    return (shape * ground * [0.4, 0.6, 1.0]).astype(np.float32)


def light(scene: bpy.types.Scene, folder: Path, seed: int = 1) -> bpy.types.World:
    """Give the scene a World with a made-up sky."""
    path = folder / f"sky{seed}.exr"
    write_panorama(path, smooth_sky(seed))
    world = worlds.set_sky(scene, path)
    world.probe_resolution = "128"  # of what mirrors it; by default 1024, for each picture anew
    return world


def directions(count: int, seed: int = 0) -> np.ndarray:
    """Random normals (count, 3) over the upper hemisphere; those with z < 0.002 are nearly edge-on
    to the camera, and are left out."""
    rng = np.random.default_rng(seed)
    z, azimuth = rng.uniform(0.002, 1.0, count), rng.uniform(0.0, 2.0 * np.pi, count)
    level = np.sqrt(1.0 - z * z)
    return np.stack([level * np.cos(azimuth), level * np.sin(azimuth), z], axis=1)


def add_faces(scene: bpy.types.Scene, normals: np.ndarray) -> bpy.types.Object:
    """One parallelogram for each normal (n, 3), z > 0, that fills a unit square as seen from above.

    A camera above sees them in rows, the first at the top left.
    """
    side = math.ceil(math.sqrt(len(normals)))
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    k = np.arange(len(normals))
    cell = np.stack([k % side, side - 1 - k // side], axis=1)[:, None, :]
    around = corners - 0.5
    height = -np.einsum("nk,ck->nc", normals[:, :2], around) / normals[:, 2:]
    vertices = np.concatenate([cell + corners, height[..., None]], axis=2).reshape(-1, 3)
    mesh = bpy.data.meshes.new("Faces")
    mesh.from_pydata(vertices.tolist(), [], np.arange(4 * len(normals)).reshape(-1, 4).tolist())
    mesh.materials.append(None)
    faces = bpy.data.objects.new("Faces", mesh)
    scene.collection.objects.link(faces)
    watch(scene, (side / 2, side / 2), side)
    scene.render.resolution_x = scene.render.resolution_y = side * PIXELS
    return faces


def watch(scene: bpy.types.Scene, middle: tuple[float, float], width: float) -> None:
    """Put a camera far above that looks straight down on a square."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    camera.location, camera.data.clip_end = (*middle, 1000.0), 2000.0


def picture(scene: bpy.types.Scene, folder: Path, engine: str = "eevee") -> np.ndarray:
    """Render the scene and return its colour channels (h, w, 3 or 4)."""
    path, _ = renderer.render(scene, folder / "picture.exr", engine=engine)
    return exr.picture(path)


def seen(scene: bpy.types.Scene, folder: Path, count: int, engine: str = "eevee") -> np.ndarray:
    """Render `add_faces` and return the colour (count, 3) of the middle pixel of each face."""
    middles = picture(scene, folder, engine)[PIXELS // 2 :: PIXELS, PIXELS // 2 :: PIXELS, :3]
    return middles.reshape(-1, 3)[:count].astype(float)


def chromaticity(rgb: np.ndarray) -> np.ndarray:
    """CIE 1976 u'v' (n, 2) of linear Rec.709 colours (n, 3)."""
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.asarray(to_xyz) @ np.asarray(rgb).T
    total = x + 15 * y + 3 * z
    return np.stack([4 * x / total, 9 * y / total], axis=1)
