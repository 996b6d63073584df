"""A scene as plain data, and building it in Blender from what each colour is to be there."""

from dataclasses import dataclass, field
from typing import Protocol

import bpy
import numpy as np
from geometry import Camera
from mathutils import Matrix, Vector
from scenes import place_camera

SUN_ANGLE = np.radians(0.533)


@dataclass(frozen=True)
class Matter:
    """What a surface is made of, by spectra on the 81 wavelengths; matt unless more is given."""

    reflectance: np.ndarray | None = None
    """(81,), or (h, w, 81) for a texture over each quad, row 0 at the bottom."""
    roughness: float | None = None
    """Of a clear coat over the reflectance, or of a metal; None: matt."""
    ior: float = 1.5
    metal: tuple[np.ndarray, np.ndarray] | None = None
    """Refractive index and extinction, (81,) each."""
    transmittance: np.ndarray | None = None
    """(81,) of a thin pane seen straight on, its reflections included."""
    sample: np.ndarray | None = None
    """(81,), what was measured of a texture's material; None: nothing."""
    behind: str | None = None
    """The pane's matter through which all its light comes; None: it stands outdoors."""

    @property
    def measured(self) -> np.ndarray | None:
        """The reflectance (81,) that a user has a file of, None without."""
        if self.reflectance is not None and self.reflectance.ndim == 1:
            return self.reflectance
        return self.sample


@dataclass(frozen=True)
class Thing:
    """Quads (corners counter-clockwise from outside), or a ball (centre, radius)."""

    matter: str
    quads: list = field(default_factory=list)
    ball: tuple | None = None


@dataclass(frozen=True)
class Lamp:
    """A ball that shines: ``spectrum`` (81,) is its light where a lamp of colour 1 gives 1."""

    location: tuple[float, float, float]
    spectrum: np.ndarray
    energy: float
    radius: float = 0.1


@dataclass(frozen=True)
class Sun:
    """Direction to the sun (3,), and its irradiance across the rays (81,)."""

    direction: np.ndarray
    spectrum: np.ndarray


@dataclass(frozen=True)
class Stage:
    """A scene: ``sky`` (h, 2h, 81) radiance; ``bounces`` between matt surfaces, 0 for none."""

    things: dict[str, Thing]
    matter: dict[str, Matter]
    sky: np.ndarray
    camera: Camera
    sun: Sun | None = None
    lamps: dict[str, Lamp] = field(default_factory=dict)
    bounces: int = 0


class Palette(Protocol):
    """What three numbers stand for in one render: three wavelengths, or red, green and blue."""

    def of(self, spectra: np.ndarray) -> np.ndarray:
        """Return reflectances or transmittances (..., 81) as colours (..., 3)."""

    def sun(self, sun: Sun) -> np.ndarray:
        """Return the sun's irradiance (3,)."""

    def lamp(self, lamp: Lamp) -> np.ndarray:
        """Return the colour (3,) of a lamp."""

    def sky(self, sky: np.ndarray) -> np.ndarray:
        """Return the radiance (h, 2h, 3) of a sky."""

    def metal(self, tree: bpy.types.NodeTree, matter: Matter) -> bpy.types.Node:
        """Return a metal's shader."""


def build(stage: Stage, palette: Palette, sky: str | None = None) -> None:
    """Make the stage the open file's only scene; ``sky``: an HDRI to be its World instead."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    materials = {name: _material(name, m, palette) for name, m in stage.matter.items()}
    for name, thing in stage.things.items():
        mesh = _ball(*thing.ball) if thing.ball else _quads(thing.quads)
        mesh.name = name
        mesh.materials.append(materials[thing.matter])
        scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    if stage.sun is not None and sky is None:  # else it is in the HDRI
        light = _light(scene, "sun", "SUN", palette.sun(stage.sun), 1.0)
        light.data.angle = SUN_ANGLE
        light.rotation_euler = Vector(stage.sun.direction).to_track_quat("Z", "Y").to_euler()
    for name, lamp in stage.lamps.items():
        light = _light(scene, name, "POINT", palette.lamp(lamp), lamp.energy)
        light.location, light.data.shadow_soft_size = lamp.location, lamp.radius
    scene.world = _world(image("sky", palette.sky(stage.sky)) if sky is None else _loaded(sky))
    place_camera(scene, stage.camera)


def image(name: str, pixels: np.ndarray) -> bpy.types.Image:
    """Return a picture of linear values (h, w, 3), row 0 at the top as a sky has it."""
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(name, width, height, float_buffer=True)
    made.colorspace_settings.name = "Linear Rec.709"
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = pixels[::-1]
    made.pixels.foreach_set(rgba.ravel())
    made.pack()
    return made


def _loaded(path: str) -> bpy.types.Image:
    return bpy.data.images.load(path)


def node_tree(owner) -> bpy.types.NodeTree:
    """Return the nodes of a new material or World, which Blender 4.5 makes when told to."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    return owner.node_tree


def principled(tree: bpy.types.NodeTree, colour, roughness: float | None, ior: float = 1.5):
    """Return a tree's Principled BSDF, told to be as it is given; without roughness it is matt."""
    shader = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*np.asarray(colour).tolist(), 1.0)
    shader.inputs["IOR"].default_value = ior
    shader.inputs["Roughness"].default_value = 1.0 if roughness is None else roughness
    if roughness is None:
        shader.inputs["Specular IOR Level"].default_value = 0.0
    return shader


def _material(name: str, matter: Matter, palette: Palette) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    tree = node_tree(material)
    if matter.metal is not None:
        shader = palette.metal(tree, matter)
    elif matter.transmittance is not None:
        shader = _pane(tree, palette.of(matter.transmittance), matter.ior)
    elif matter.reflectance.ndim == 3:
        shader = principled(tree, (1, 1, 1), matter.roughness, matter.ior)
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image(name, palette.of(matter.reflectance)[::-1])
        texture.image.use_half_precision = False
        texture.interpolation = "Closest"  # as RGB and as a spectrum the same, at every pixel
        tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    else:
        shader = principled(tree, palette.of(matter.reflectance), matter.roughness, matter.ior)
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def _pane(tree: bpy.types.NodeTree, colour: np.ndarray, ior: float) -> bpy.types.Node:
    """Return thin glass: both faces mirror their share, the rest goes straight on, tinted."""
    one_face = ((ior - 1) / (ior + 1)) ** 2
    mirrored = 2 * one_face / (1 + one_face)
    # The Fresnel node turns the index round where a face is seen from behind, as if inside glass;
    # a thin pane is the same from both sides.
    behind = tree.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"]
    fresnel = tree.nodes.new("ShaderNodeFresnel")
    side = tree.nodes.new("ShaderNodeMath")
    side.operation = "MULTIPLY_ADD"
    tree.links.new(behind, side.inputs[0])
    side.inputs[1].default_value, side.inputs[2].default_value = 1 / ior - ior, ior
    tree.links.new(side.outputs[0], fresnel.inputs["IOR"])
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    clear.inputs["Color"].default_value = (*(colour / (1 - mirrored)).tolist(), 1.0)
    mirror = tree.nodes.new("ShaderNodeBsdfGlossy")
    mirror.inputs["Roughness"].default_value = 0.0
    mirror.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    # 2 F / (1 + F), the light going to and fro between the faces.
    twice, more, both = (tree.nodes.new("ShaderNodeMath") for _ in range(3))
    for node, operation, value in ((twice, "MULTIPLY", 2.0), (more, "ADD", 1.0)):
        node.operation, node.inputs[1].default_value = operation, value
        tree.links.new(fresnel.outputs[0], node.inputs[0])
    both.operation = "DIVIDE"
    tree.links.new(twice.outputs[0], both.inputs[0])
    tree.links.new(more.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], mix.inputs[0])
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(mirror.outputs[0], mix.inputs[2])
    return mix


def _quads(quads: list) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new("quads")
    corners = [corner for quad in quads for corner in quad]
    mesh.from_pydata(corners, [], np.arange(len(corners)).reshape(-1, 4).tolist())
    uv = mesh.uv_layers.new(name="UVMap").data
    uv.foreach_set("uv", np.tile([0.0, 0, 1, 0, 1, 1, 0, 1], len(quads)))
    return mesh


def _ball(centre: tuple, radius: float) -> bpy.types.Mesh:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=radius)
    ball = bpy.context.object
    mesh = ball.data
    bpy.data.objects.remove(ball)
    mesh.transform(Matrix.Translation(centre))
    mesh.shade_smooth()
    return mesh


def _light(scene, name: str, kind: str, colour, energy: float) -> bpy.types.Object:
    data = bpy.data.lights.new(name, kind)
    data.color, data.energy = np.asarray(colour).tolist(), energy
    light = bpy.data.objects.new(name, data)
    scene.collection.objects.link(light)
    return light


def _world(sky: bpy.types.Image) -> bpy.types.World:
    world = bpy.data.worlds.new("World")
    tree = node_tree(world)
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = sky
    background = next((n for n in tree.nodes if n.type == "BACKGROUND"), None)
    if background is None:
        background = tree.nodes.new("ShaderNodeBackground")
        output = tree.nodes.new("ShaderNodeOutputWorld")
        tree.links.new(background.outputs[0], output.inputs["Surface"])
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    return world
