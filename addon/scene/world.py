"""The sky of a World: which HDRI lights it, how it is turned, and its pixels."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

from ...node_groups import spectral_matrix
from ...node_groups import tree as groups
from ..errors import InputError
from . import nodes, working_space

CURE = "plug an equirectangular Environment Texture straight into the World's Background"


@dataclass(frozen=True)
class WorldSky:
    """The HDRI of a World and what its nodes do with it.

    A direction v is looked up in the image at R v, R being the XYZ Euler `rotation` [rad], or its
    inverse where `inverse`; what is found there counts `strength` times. The names are those
    of the World's nodes; `mapping` is None without a Mapping node.
    """

    image: bpy.types.Image
    rotation: tuple[float, float, float]
    inverse: bool
    strength: float
    background: str
    texture: str
    mapping: str | None


def sky_of(world: bpy.types.World | None) -> WorldSky:
    """The HDRI that lights a World.

    Read are World Output ← Background ← Environment Texture ← [Mapping] ← [Texture Coordinate],
    and our Spectral Matrix between texture and Background. Raises InputError for anything else.
    """
    if world is None:
        raise InputError("the scene", "has no World", "give it one with a sky HDRI")
    place = f'World "{world.name}"'
    tree = world.node_tree
    if tree is None or (bpy.app.version < (5, 0, 0) and not world.use_nodes):
        raise InputError(place, "uses no nodes, so no HDRI", CURE)
    output = tree.get_output_node("ALL")
    background = _expect(
        place, output and output.inputs["Surface"], "BACKGROUND", "the World Output", "a Background"
    )
    colour = nodes.source(background.inputs["Color"])
    if colour is not None and groups.kind_of(colour.node) == spectral_matrix.KIND:
        background_colour = colour.node.inputs["Color"]
    else:
        background_colour = background.inputs["Color"]
    texture = _expect(
        place, background_colour, "TEX_ENVIRONMENT", "the Background", "an Environment Texture"
    )
    if nodes.source(background.inputs["Strength"]) is not None:
        raise InputError(place, "the Background's Strength is linked", "set it as a value")
    if texture.projection != "EQUIRECTANGULAR":
        raise InputError(place, "its texture is a mirror ball", "use an equirectangular HDRI")
    if texture.image is None:
        raise InputError(place, "its Environment Texture has no image", "open a sky HDRI in it")
    mapping = _mapping(place, texture)
    return WorldSky(
        image=texture.image,
        rotation=tuple(mapping.inputs["Rotation"].default_value) if mapping else (0.0, 0.0, 0.0),
        inverse=mapping is not None and mapping.vector_type == "TEXTURE",
        strength=background.inputs["Strength"].default_value,
        background=background.name,
        texture=texture.name,
        mapping=mapping.name if mapping else None,
    )


def _expect(place, socket, node_type: str, whose: str, wanted: str) -> bpy.types.Node:
    found = nodes.source(socket) if socket else None
    if found is None or found.node.type != node_type:
        what = f'the node "{found.node.name}"' if found else "nothing"
        raise InputError(place, f"{whose} is fed by {what}, not by {wanted}", CURE)
    return found.node


def _mapping(place: str, texture: bpy.types.Node) -> bpy.types.Node | None:
    """The Mapping node before a texture, None without one; raises where it does more than turn."""
    found = nodes.source(texture.inputs["Vector"])
    mapping = None
    if found is not None and found.node.type == "MAPPING":
        mapping = found.node
        found = nodes.source(mapping.inputs["Vector"])
        if found is None:
            raise InputError(
                place, "its Mapping has no Vector", "link Texture Coordinate Generated"
            )
        for name, neutral in (("Location", 0.0), ("Scale", 1.0), ("Rotation", None)):
            socket = mapping.inputs.get(name)
            if socket is None or not socket.enabled:  # a Vector mapping has no location
                continue
            if nodes.source(socket) is not None:
                raise InputError(place, f"its Mapping's {name} is linked", "set it as a value")
            if neutral is not None and any(abs(v - neutral) > 1e-6 for v in socket.default_value):
                raise InputError(place, f"its Mapping has a {name}", f"set {name} to {neutral:g}")
    if found is not None and (found.node.type, found.name) != ("TEX_COORD", "Generated"):
        raise InputError(
            place,
            f'its texture is looked up by "{found.node.name}", {found.name}',
            "use Texture Coordinate Generated, with at most a Mapping between",
        )
    return mapping


def in_world(sky: WorldSky, direction: np.ndarray) -> np.ndarray:
    """Where in the world a direction (3,) of the HDRI stands as the World is turned now."""
    turn = Euler(sky.rotation, "XYZ").to_matrix()
    turn = turn if sky.inverse else turn.transposed()
    return np.array(turn) @ direction


def value_path(world: bpy.types.World, node: str, socket: str) -> str:
    """The data path, from a World, of the value of one of its nodes' inputs."""
    return "node_tree." + world.node_tree.nodes[node].inputs[socket].path_from_id("default_value")


def pixels_of(image: bpy.types.Image) -> np.ndarray:
    """The pixels of an HDRI as float32 RGB (h, w, 3), top row first, in the file's working space.

    Blender has then applied the image's colour space (none for Non-Color); packed, external
    and linked images give the same. Raises InputError for a missing file, a sequence, movie or
    tiled image, and for 8 bits a channel.
    """
    place = f'image "{image.name}"'
    if image.source not in {"FILE", "GENERATED"}:
        raise InputError(place, f"is a {image.source.lower()}", "use a single HDRI image")
    width, height = image.size  # asking makes Blender load the file
    if width == 0 or height == 0:
        file = bpy.path.abspath(image.filepath, library=image.library)
        raise InputError(place, f'cannot be read from "{file}"', "restore or pack the file")
    if not image.is_float:
        raise InputError(place, "has 8 bits a channel", "use an .exr or .hdr, which holds light")
    pixels = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)[::-1]
    if image.channels == 1:
        pixels = np.repeat(pixels, 3, axis=2)
    return np.ascontiguousarray(pixels[:, :, :3])


def set_sky(scene: bpy.types.Scene, path: str | Path, raw: bool = False) -> bpy.types.World:
    """Light a scene by an HDRI file and return its World.

    The scene's World is kept where its image is that file already. Otherwise the scene gets a new
    one; the user's own is never edited. A ``raw`` file's numbers are a camera's: Blender must not
    convert them, so a newly loaded image is tagged Non-Color. Raises InputError if the file
    cannot be read as an image.
    """
    path = Path(path).resolve()
    scene.world = scene.world if _shows(scene.world, path) else _new_world(path, raw)
    return scene.world


def develop(scene: bpy.types.Scene, matrix) -> bpy.types.World:
    """Show a camera's raw sky in the working space: RGB times ``matrix`` (3, 3) in the background.

    The scene gets a copy of its World with that matrix, unless its World has one already; the
    user's own is never edited, and an identity changes nothing. Raises InputError where `sky_of`
    does, and for an image that Blender converts between colour spaces.
    """
    identity = np.allclose(matrix, np.eye(3), atol=1e-9)
    if identity and _matrix_node(scene.world) is None:
        return scene.world
    image = sky_of(scene.world).image
    tag = image.colorspace_settings
    if not (identity or tag.is_data or tag.name == working_space.name()):
        raise InputError(
            f'image "{image.name}"',
            f"a camera's raw numbers, but tagged {tag.name}",
            "set its Color Space to Non-Color",
        )
    scene.world = _with_matrix(scene.world, matrix)
    return scene.world


def _shows(world: bpy.types.World | None, path: Path) -> bool:
    try:
        image = sky_of(world).image
    except InputError:
        return False
    file = bpy.path.abspath(image.filepath, library=image.library)
    return image.source == "FILE" and bool(file) and Path(file).resolve() == path


def _new_world(path: Path, raw: bool) -> bpy.types.World:
    try:
        image = bpy.data.images.load(str(path), check_existing=True)
    except RuntimeError as error:
        raise InputError(path, "cannot be read as an image", "give an .exr or .hdr sky") from error
    if raw and image.users == 0:
        image.colorspace_settings.name = "Non-Color"
    world = bpy.data.worlds.new("Skylight")
    nodes.use(world)
    tree = world.node_tree
    tree.nodes.clear()
    coordinate = groups.add(tree, "ShaderNodeTexCoord")
    mapping = groups.add(tree, "ShaderNodeMapping", coordinate.outputs["Generated"])
    texture = groups.add(tree, "ShaderNodeTexEnvironment", mapping.outputs[0], image=image)
    background = groups.add(tree, "ShaderNodeBackground", texture.outputs[0])
    groups.add(tree, "ShaderNodeOutputWorld", background.outputs[0])
    groups.arrange(tree)
    return world


def _matrix_node(world: bpy.types.World) -> bpy.types.Node | None:
    """The Spectral Matrix node that feeds a World's Background, None without."""
    background = sky_of(world).background
    found = nodes.source(world.node_tree.nodes[background].inputs["Color"])
    if found is None or groups.kind_of(found.node) != spectral_matrix.KIND:
        return None
    return found.node


def _with_matrix(world: bpy.types.World, matrix) -> bpy.types.World:
    """The World, or a copy of it where it has none yet, with this matrix before its Background."""
    node = _matrix_node(world)
    if node is None:
        sky = sky_of(world)
        world = world.copy()
        tree = world.node_tree
        texture, background = tree.nodes[sky.texture], tree.nodes[sky.background]
        node = groups.add(
            tree, "ShaderNodeGroup", node_tree=spectral_matrix.ensure(), name="Spectral Matrix"
        )
        node.location = (background.location.x - 40, background.location.y - 160)
        tree.links.new(texture.outputs[0], node.inputs["Color"])
        tree.links.new(node.outputs[0], background.inputs["Color"])
    spectral_matrix.set_matrix(node, matrix)
    return world
