"""A scene as plain data, and building it in Blender from what each colour is to be there."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import bpy
import numpy as np
from geometry import Camera
from mathutils import Matrix, Vector

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
    emission: np.ndarray | None = None
    """(81,) radiance of what shines; it reflects nothing."""
    unmanaged: bool = False
    """Whether its material is left as it is: what it sends to others counts, itself does not."""

    @property
    def measured(self) -> np.ndarray | None:
        """The reflectance (81,) that a user has a file of, None without."""
        if self.reflectance is not None and self.reflectance.ndim == 1:
            return self.reflectance
        return self.sample


@dataclass(frozen=True)
class Thing:
    """Polygons (corners counter-clockwise from outside), or a ball (centre, radius).

    A texture lies on each quad.
    """

    matter: str
    polygons: list = field(default_factory=list)
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
    """A scene under a sky (h, 2h, 81) of radiance."""

    things: dict[str, Thing]
    matter: dict[str, Matter]
    sky: np.ndarray
    camera: Camera
    sun: Sun | None = None
    lamps: dict[str, Lamp] = field(default_factory=dict)

    def lights(self) -> dict[str, np.ndarray]:
        """Return the spectrum (81,) of each light, by the name of its light group.

        Of the sky it is the mean over all directions.
        """
        lights = {"sky": self.sky.reshape(-1, self.sky.shape[-1]).mean(axis=0)}
        if self.sun is not None:
            lights["sun"] = self.sun.spectrum
        shining = {n: m.emission for n, m in self.matter.items() if m.emission is not None}
        return lights | {n: lamp.spectrum for n, lamp in self.lamps.items()} | shining


class Palette(Protocol):
    """What three numbers stand for in one render: three wavelengths, or red, green and blue."""

    def of(self, spectra: np.ndarray) -> np.ndarray:
        """Return reflectances or transmittances (..., 81) as colours (..., 3)."""

    def light(self, spectrum: np.ndarray) -> np.ndarray:
        """Return the colour (3,) of the sun's, a lamp's or a shining surface's light (81,)."""

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
        mesh = _ball(*thing.ball) if thing.ball else _polygons(thing.polygons)
        mesh.name = name
        mesh.materials.append(materials[thing.matter])
        thing_object = bpy.data.objects.new(name, mesh)
        scene.collection.objects.link(thing_object)
        if stage.matter[thing.matter].emission is not None:
            _in_group(thing_object, thing.matter)
    if stage.sun is not None and sky is None:  # else it is in the HDRI
        light = _light(scene, "sun", "SUN", palette.light(stage.sun.spectrum), 1.0)
        light.data.angle = SUN_ANGLE
        light.rotation_euler = Vector(stage.sun.direction).to_track_quat("Z", "Y").to_euler()
    for name, lamp in stage.lamps.items():
        light = _light(scene, name, "POINT", palette.light(lamp.spectrum), lamp.energy)
        light.location, light.data.shadow_soft_size = lamp.location, lamp.radius
    scene.world = _world(image("sky", palette.sky(stage.sky)) if sky is None else _loaded(sky))
    _in_group(scene.world, "sky")
    _place_camera(scene, stage.camera)


def save(path: Path, samples: int, exposure: float = 0.0, shadows: bool = True) -> None:
    """Save the open scene as an architect has it: Eevee, base colours, lamps, an HDRI.

    Without ``shadows`` no lamp or sun may be there: Eevee prepares them for each sample, lamps or
    not, which takes a processor more than half of the time.
    """
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE"
    scene.eevee.taa_render_samples = samples
    scene.eevee.light_threshold = 1e-4  # else Eevee drops lamps as faint as dusk
    scene.eevee.use_shadows = shadows
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.exposure = exposure
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)


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
    elif matter.emission is not None:
        shader = tree.nodes.new("ShaderNodeEmission")
        shader.inputs["Color"].default_value = (*palette.light(matter.emission).tolist(), 1.0)
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
    """Return thin glass: both faces mirror their share, the rest goes straight on, tinted by the
    way that it has through the glass (Beer's law), which is longer aslant."""
    one_face = ((ior - 1) / (ior + 1)) ** 2
    mirrored = 2 * one_face / (1 + one_face)

    def maths(operation: str, *values):
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, values, strict=False):
            if isinstance(value, bpy.types.NodeSocket):
                tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node.outputs[0]

    # The Fresnel node turns the index round where a face is seen from behind, as if inside glass;
    # a thin pane is the same from both sides.
    geometry = tree.nodes.new("ShaderNodeNewGeometry").outputs
    fresnel = tree.nodes.new("ShaderNodeFresnel")
    side = maths("MULTIPLY_ADD", geometry["Backfacing"], 1 / ior - ior, ior)
    tree.links.new(side, fresnel.inputs["IOR"])
    along = tree.nodes.new("ShaderNodeVectorMath")
    along.operation = "DOT_PRODUCT"
    tree.links.new(geometry["Normal"], along.inputs[0])
    tree.links.new(geometry["Incoming"], along.inputs[1])
    squared = maths("POWER", maths("ABSOLUTE", along.outputs["Value"]), 2.0)
    # 1 / cosine inside by Snell's law, sin² = (1 - cos²) / ior².
    inside = maths("MULTIPLY_ADD", squared, 1 / ior**2, 1 - 1 / ior**2)
    path = maths("POWER", inside, -0.5)
    tint = tree.nodes.new("ShaderNodeCombineXYZ")
    for socket, value in zip(tint.inputs, (colour / (1 - mirrored)).tolist(), strict=True):
        tree.links.new(maths("POWER", value, path), socket)
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    tree.links.new(tint.outputs[0], clear.inputs["Color"])
    mirror = tree.nodes.new("ShaderNodeBsdfGlossy")
    mirror.inputs["Roughness"].default_value = 0.0
    mirror.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    # 2 F / (1 + F), the light going to and fro between the faces.
    one = fresnel.outputs[0]
    both = maths("DIVIDE", maths("MULTIPLY", one, 2.0), maths("ADD", one, 1.0))
    tree.links.new(both, mix.inputs[0])
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(mirror.outputs[0], mix.inputs[2])
    return mix


def _polygons(polygons: list) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new("polygons")
    ends = np.cumsum([len(polygon) for polygon in polygons])
    faces = [list(range(end - len(p), end)) for p, end in zip(polygons, ends, strict=True)]
    mesh.from_pydata([corner for polygon in polygons for corner in polygon], [], faces)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    uv = np.concatenate([square[: len(polygon)] for polygon in polygons])
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.ravel())
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
    _in_group(light, name)
    return light


def _in_group(owner, name: str) -> None:
    """Give what shines a light group of a name; only Cycles knows them."""
    layer = bpy.context.view_layer
    if name not in layer.lightgroups:
        layer.lightgroups.add(name=name)
    owner.lightgroup = name


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


def _place_camera(scene: bpy.types.Scene, camera: Camera) -> None:
    """Give a scene a camera and its picture's size."""
    data = bpy.data.cameras.new("Camera")
    if camera.orthographic:
        data.type, data.ortho_scale = "ORTHO", camera.scale
    else:
        data.lens = data.sensor_width / camera.scale
    data.clip_end = 1000.0
    view = bpy.data.objects.new("Camera", data)
    axes = np.stack([camera.right, camera.up, camera.back, camera.location], axis=1)
    view.matrix_world = Matrix([*axes.tolist(), [0, 0, 0, 1]])
    scene.collection.objects.link(view)
    scene.camera = view
    scene.render.resolution_x, scene.render.resolution_y = camera.width, camera.height
    scene.render.filter_size = 1.0
