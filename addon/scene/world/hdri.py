"""The sky of a World: what of it is followed live, and how its light is read."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

from ....node_groups import day_sky, spectral_matrix
from ....node_groups import tree as groups
from ...errors import InputError
from ...progress import Progress, run
from ..blend_data import nodes, working_space
from . import own_worlds, sky_image

CURE = "connect an equirectangular Environment Texture directly to the World's Background"


@dataclass(frozen=True)
class WorldSky:
    """How a World's light is known.

    ``image``: the HDRI whose pixels are its light; None where they say too little (``why``), and
    the World is baked. What is followed live is not in these pixels: the value of the node
    `background`'s Strength, and the rotation of the node `mapping`: a direction v is looked up
    at R v, R being the XYZ Euler `rotation` [rad], or its inverse where `inverse`. Names are
    None, and the rotation 0, where that is baked too. ``name``: the image's, or the World's.
    """

    name: str
    image: bpy.types.Image | None = None
    why: str = ""
    background: str | None = None
    texture: str | None = None
    mapping: str | None = None
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inverse: bool = False

    @property
    def line(self) -> str:
        """What a person should know of a World that is baked; empty for an HDRI."""
        if self.image is not None:
            return ""
        live = ["Strength"] * bool(self.background) + ["Rotation"] * bool(self.mapping)
        verb = "are" if len(live) > 1 else "is"
        follows = f"; {' and '.join(live)} {verb} updated live" if live else ""
        return f"baked once, for {self.why}: press Update after a change{follows}"


def sky_of(world: bpy.types.World | None) -> WorldSky:
    """How the light of a World is known; nothing is computed yet.

    Read directly are World Output ← Background ← Environment Texture ← [Mapping that only turns] ←
    [Texture Coordinate], and our Spectral Matrix between texture and Background. All other Worlds
    are baked. Raises InputError without a World.
    """
    if world is None:
        raise InputError("the scene", "has no World", "give it one with a sky HDRI")
    found = WorldSky(world.name)
    output = output_of(world)
    if output is None:
        return replace(found, why="it has no nodes")
    background = _feeds(output.inputs["Surface"])
    if background is None or background.type != "BACKGROUND":
        return replace(found, why=f"its output is fed by {_called(background)}")
    if nodes.source(background.inputs["Strength"]) is not None:
        return replace(found, why="its Background's Strength is linked")
    found = replace(found, background=background.name)
    texture = _feeds(background.inputs["Color"])
    if texture is not None and groups.kind_of(texture) == spectral_matrix.KIND:
        texture = _feeds(texture.inputs["Color"])
    if texture is not None and groups.kind_of(texture) == day_sky.KIND:
        mapping, _ = _mapping(texture)
        found = replace(found, mapping=None if mapping is None else mapping.name)
        return replace(found, why="its sky moves through the day")
    if texture is None or texture.type != "TEX_ENVIRONMENT":
        return replace(found, why=f"its Background is fed by {_called(texture)}")
    mapping, why = _mapping(texture)
    if why:
        return replace(found, why=why)
    found = replace(found, texture=texture.name)
    if mapping is not None:
        found = replace(
            found,
            mapping=mapping.name,
            rotation=tuple(mapping.inputs["Rotation"].default_value),
            inverse=mapping.vector_type == "TEXTURE",
        )
    image = texture.image
    if image is None:
        return replace(found, why="its Environment Texture has no image")
    if texture.projection != "EQUIRECTANGULAR":
        return replace(found, why="its texture is a mirror ball")
    if image.source not in {"FILE", "GENERATED"}:
        return replace(found, why=f"its image is a {image.source.lower()}")
    return replace(found, name=image.name, image=image)


def output_of(world: bpy.types.World) -> bpy.types.Node | None:
    """The World Output that Eevee shows, else that of Cycles; None without nodes."""
    tree = world.node_tree
    if tree is None or (bpy.app.version < (5, 0, 0) and not world.use_nodes):
        return None
    return tree.get_output_node("EEVEE") or tree.get_output_node("CYCLES")


def _feeds(socket: bpy.types.NodeSocket) -> bpy.types.Node | None:
    found = nodes.source(socket)
    return None if found is None else found.node


def _called(node: bpy.types.Node | None) -> str:
    return "no texture" if node is None else f'"{node.name}"'


def _mapping(texture: bpy.types.Node) -> tuple[bpy.types.Node | None, str]:
    """The Mapping node before a texture, None without; and why it cannot be followed, if so."""
    found = nodes.source(texture.inputs["Vector"])
    mapping = None
    if found is not None and found.node.type == "MAPPING":
        mapping = found.node
        found = nodes.source(mapping.inputs["Vector"])
        if found is None:
            return None, "its Mapping has no Vector"
        for name, neutral in (("Location", 0.0), ("Scale", 1.0), ("Rotation", None)):
            socket = mapping.inputs.get(name)
            if socket is None or not socket.enabled:  # a Vector mapping has no location
                continue
            if nodes.source(socket) is not None:
                return None, f"its Mapping's {name} is linked"
            if neutral is not None and any(abs(v - neutral) > 1e-6 for v in socket.default_value):
                return None, f"its Mapping has a {name}"
    if found is not None and (found.node.type, found.name) != ("TEX_COORD", "Generated"):
        return None, f'its texture is looked up by "{found.node.name}", {found.name}'
    return mapping, ""


def in_world(sky: WorldSky, direction: np.ndarray) -> np.ndarray:
    """Where in the world a direction (3,) of the HDRI stands as the World is turned now."""
    turn = Euler(sky.rotation, "XYZ").to_matrix()
    turn = turn if sky.inverse else turn.transposed()
    return np.array(turn) @ direction


def value_path(world: bpy.types.World, node: str | None, socket: str) -> str | None:
    """The data path, from a World, of the value of one of its nodes' inputs; None without it."""
    if node is None:
        return None
    return "node_tree." + world.node_tree.nodes[node].inputs[socket].path_from_id("default_value")


def set_sky(scene: bpy.types.Scene, path: str | Path, raw: bool = False) -> bpy.types.World:
    """Light a scene by an HDRI file and return its World, as `setting_sky` does."""
    return run(setting_sky(scene, path, raw))


def setting_sky(
    scene: bpy.types.Scene, path: str | Path, raw: bool = False
) -> Generator[Progress, None, bpy.types.World]:
    """Light a scene by an HDRI file and return its World.

    The scene's World is kept where its image shows that file already. Otherwise the scene gets a
    new one; the user's own is never edited, and `own_worlds.give_back` brings it back. A ``raw``
    file's numbers are a camera's: Blender must not convert them, so a newly loaded image is tagged
    Non-Color. Raises InputError if the file is no sky, as `sky.panorama.read_panorama` does.
    """
    path = Path(path).resolve()
    shown = None if scene.world is None else sky_of(scene.world).image
    image = yield from sky_image.loading(path, raw, shown)
    return scene.world if image == shown else show(scene, image)


def show(scene: bpy.types.Scene, image: bpy.types.Image) -> bpy.types.World:
    """Light a scene by an image, in a new World of ours, and return that."""
    new = _new_world(image)
    own_worlds.take_place(new, scene.world)
    scene.world = new
    return new


def develop(scene: bpy.types.Scene, matrix) -> bpy.types.World:
    """Show a camera's raw sky in the working space: RGB times ``matrix`` (3, 3) in the background.

    The scene gets a copy of its World with that matrix, unless its World has one already; the
    user's own is never edited, and an identity changes nothing. Raises InputError where `sky_of`
    does, for a World whose light is not that of one texture, and for an image that Blender converts
    between colour spaces.
    """
    identity = np.allclose(matrix, np.eye(3), atol=1e-9)
    if identity and _matrix_node(scene.world) is None:
        return scene.world
    sky = sky_of(scene.world)
    image = scene.world.node_tree.nodes[sky.texture].image if sky.texture else None
    if image is None:
        raise InputError(
            f'World "{scene.world.name}"', f"does not show raw camera RGB: {sky.why}", CURE
        )
    tag = image.colorspace_settings
    if not (identity or tag.is_data or tag.name == working_space.name()):
        raise InputError(
            f'image "{image.name}"',
            f"is raw camera RGB with the Color Space {tag.name}",
            "set its Color Space to Non-Color",
        )
    scene.world = _with_matrix(scene.world, matrix)
    return scene.world


def strength(world: bpy.types.World | None) -> float:
    """Return what a World multiplies its sky by; 1 where no value says."""
    background = sky_of(world).background
    if world is None or background is None:
        return 1.0
    return float(world.node_tree.nodes[background].inputs["Strength"].default_value)


def undevelop(world: bpy.types.World) -> None:
    """Take the matrix of `develop` off a World: its Background shows the texture's own numbers."""
    node = _matrix_node(world)
    if node is None:
        return
    tree = world.node_tree
    texture = nodes.source(node.inputs["Color"])
    for link in list(node.outputs[0].links):
        if texture is not None:
            tree.links.new(texture, link.to_socket)
    tree.nodes.remove(node)


def _new_world(image: bpy.types.Image) -> bpy.types.World:
    world = bpy.data.worlds.new(Path(image.name).stem)  # as a person knows the sky
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
    if background is None:
        return None
    found = nodes.source(world.node_tree.nodes[background].inputs["Color"])
    if found is None or groups.kind_of(found.node) != spectral_matrix.KIND:
        return None
    return found.node


def _with_matrix(world: bpy.types.World, matrix) -> bpy.types.World:
    """The World, or a copy of it where it has none yet, with this matrix before its Background."""
    node = _matrix_node(world)
    if node is None:
        sky, before = sky_of(world), world
        world = before.copy()
        own_worlds.take_place(world, before)
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
