"""What of an old shader stays when its material turns spectral: texture, gloss, relief, alpha.

The old nodes are only read and linked from. Beside them come our own: a Spectral Texture before the
surface, a Spectral Gloss (or metal) after it for each Principled, and a copy of the Mix and Add
Shaders above. What else is mixed in there (Glossy, Glass, Emission, Transparent) is linked to as it
is, for that is light that needs no spectrum, or whose RGB is the user's.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import bpy
from bpy.types import Node
from bpy.types import NodeSocket as Socket

from ....node_groups import gloss, spectral_texture
from ....node_groups import tree as groups
from ... import tags
from ..blend_data import drivers, kept, nodes

MATT = "matt"
BASES = {
    "BSDF_PRINCIPLED",
    "BSDF_DIFFUSE",
    "BSDF_SHEEN",
    "BSDF_TOON",
    "EEVEE_SPECULAR",
    "SUBSURFACE_SCATTERING",
    "GROUP",
}
METALS = {"BSDF_GLOSSY", "BSDF_METALLIC"}
GLASSES = {"BSDF_GLASS", "BSDF_REFRACTION"}
COLOURS = ("Base Color", "Color")

# Where our metal's inputs are called otherwise by the Glossy and the Metallic BSDF.
NAMES = {
    "BSDF_GLOSSY": {"Anisotropic": "Anisotropy", "Anisotropic Rotation": "Rotation"},
    "BSDF_METALLIC": {
        "Anisotropic": "Anisotropy",
        "Anisotropic Rotation": "Rotation",
        "Metal Edge": "Edge Tint",
    },
    "BSDF_PRINCIPLED": {"Metal Edge": "Specular Tint"},
}
LEFT_OUT = (
    "Subsurface Weight",
    "Sheen Weight",
    "Transmission Weight",
    "Thin Film Thickness",
    "Diffuse Roughness",
)


@dataclass(frozen=True)
class Look:
    """What an old shader looks like: to be used at once, for it holds nodes.

    ``shader``: as given; ``targets``: the nodes in it that ours stand for; ``kind``: `MATT` or one
    of `gloss.KINDS`; ``colour``: what feeds its base colour, None for the value ``rgb`` (3,)
    [linear, working space]; ``left_out``: what of it a spectral surface does not show; ``glass``:
    rather a glazing.
    """

    shader: Socket | None
    targets: tuple[Node, ...] = ()
    kind: str = MATT
    colour: Socket | None = None
    rgb: tuple[float, ...] = (0.8, 0.8, 0.8)
    left_out: tuple[str, ...] = ()
    glass: bool = False

    @property
    def metal(self) -> bool:
        """Whether it shows metal somewhere."""
        return self.kind in (gloss.METAL, gloss.MIXED)


def read(shader: Socket | None) -> Look:
    """Read the shader that feeds an output (`nodes.source`), None if none does."""
    mixed = list(nodes.leaves(shader))
    targets = tuple(n for n in mixed if n.type in BASES)
    targets = targets or tuple(n for n in mixed if n.type in METALS)
    glass = any(n.type in GLASSES or shows(n, "Transmission Weight") for n in mixed)
    if not targets:
        return Look(shader, glass=glass)
    main = targets[0]
    colour = colour_input(main)
    return Look(
        shader,
        targets,
        _kind(main),
        _fed_by(colour),
        tuple(colour.default_value)[:3] if colour is not None else (0.8, 0.8, 0.8),
        tuple(dict.fromkeys([*(t for node in targets for t in _left_out(node)), *_other(targets)])),
        glass and not any(n.type == "BSDF_DIFFUSE" for n in targets),
    )


def dress(
    material: bpy.types.Material,
    surface: Node,
    look: Look,
    kind: str | None = None,
    textured: bool = False,
) -> dict[str, Socket]:
    """Give a surface node the look of an old shader; return what to plug in for each engine.

    ``surface``: a new node of ours, with outputs "Shader" and "Cycles", inputs as
    `spectral_texture.OUTPUTS`, Normal and Alpha. ``kind``: another than the look's; `MATT` shows
    nothing but base, relief and alpha. ``textured``: the base colour's texture feeds the surface
    through a `Spectral Texture`, whose values the caller writes. Old values that are animated or
    driven are followed by drivers; others are copied.
    """
    tree = material.node_tree
    take = partial(drivers.take, material)
    normal = next((n for node in look.targets if (n := _normal(node)) is not None), None)
    if normal is None and look.shader is not None:
        normal = next((n for node in nodes.leaves(look.shader) if (n := _normal(node))), None)
    if normal is not None:
        take(normal, surface.inputs["Normal"])
    if textured and look.colour is not None:
        texture = _add(tree, "ShaderNodeGroup", "texture", node_tree=spectral_texture.ensure())
        texture.location = surface.location.x - 200, surface.location.y
        tree.links.new(look.colour, texture.inputs["Color"])
        for name in spectral_texture.OUTPUTS:
            tree.links.new(texture.outputs[name], surface.inputs[name])
    if kind == MATT or not look.targets:
        _opaque_as(take, look.shader, surface.inputs["Alpha"])
        return tops(tree, surface)

    dressed = {}
    for k, node in enumerate(look.targets):
        dressed[node] = _dress_leaf(
            material, surface, node, (kind or _kind(node)) if k == 0 else _kind(node)
        )

    def rebuilt(shader: Socket | None, name: str) -> Socket | None:
        if shader is None or (shader.node not in dressed and shader.node.type not in nodes.MIXES):
            return shader
        if shader.node in dressed:
            return dressed[shader.node][name]
        node = _add(tree, shader.node.bl_idname, "mix")
        node.location = surface.location.x + 220, surface.location.y
        parts = nodes.MIXES[shader.node.type]
        for k, (old, new) in enumerate(zip(shader.node.inputs, node.inputs, strict=True)):
            if k not in parts:
                take(old, new)
            elif (part := rebuilt(nodes.source(old), name)) is not None:
                tree.links.new(part, new)
        return node.outputs[0]

    for name in gloss.OUTPUTS:
        top = rebuilt(look.shader, name)
        assert top is not None
        if top.node != surface:
            top.node[tags.NODE_OUTPUT] = " ".join(
                filter(None, (top.node.get(tags.NODE_OUTPUT), name))
            )
    return tops(tree, surface)


def tops(tree: bpy.types.NodeTree, surface: Node) -> dict[str, Socket]:
    """What of a dressed surface is plugged into the outputs: a socket for "Shader" and "Cycles"."""
    found = {name: surface.outputs.get(name) for name in gloss.OUTPUTS}
    for node in tree.nodes:
        for name in kept.text(node, tags.NODE_OUTPUT).split():
            found[name] = node.outputs.get(name) or next(iter(node.outputs), None)
    return {name: socket for name, socket in found.items() if socket is not None}


def texture_node(material: bpy.types.Material) -> Node | None:
    """The `Spectral Texture` node that `dress` made, None without."""
    return next((n for n in material.node_tree.nodes if n.get(tags.NODE) == "texture"), None)


def set_metal(material: bpy.types.Material, facing: Sequence[float], edge: Sequence[float]) -> bool:
    """Write what a material's metal reflects, RGB where faced and the tint at 82° (F82).

    A texture that fed it is unplugged. False if the material shows no metal.
    """
    found = [n for n in material.node_tree.nodes if n.get(tags.NODE) == "gloss"]
    found = [n for n in found if "Metal Color" in n.inputs]
    for node in found:
        for name, rgb in zip(gloss.METAL_COLOURS, (facing, edge), strict=True):
            for link in list(node.inputs[name].links):
                material.node_tree.links.remove(link)
            node.inputs[name].default_value = (*(float(part) for part in rgb), 1.0)
    return bool(found)


def _dress_leaf(
    material: bpy.types.Material, surface: Node, old: Node, kind: str
) -> dict[str, Socket]:
    tree = material.node_tree
    take = partial(drivers.take, material)
    if kind == MATT:
        alpha = old.inputs.get("Alpha")
        if alpha is None or not (
            alpha.is_linked or drivers.moves(alpha) or alpha.default_value < 1
        ):
            return {name: surface.outputs[name] for name in gloss.OUTPUTS}
        kind = gloss.GLOSS  # for its alpha
    node = _add(tree, "ShaderNodeGroup", "gloss", node_tree=gloss.ensure(kind), label=kind)
    node.location = surface.location.x + 200, surface.location.y
    for output, base in gloss.OUTPUTS.items():
        if base in node.inputs:
            tree.links.new(surface.outputs[output], node.inputs[base])
    names = NAMES.get(old.type)  # None: its Roughness is that of a diffuse surface
    for new in node.inputs:
        source = old.inputs.get(names.get(new.name, new.name)) if names is not None else None
        if new.name == "Metal Color":
            source = colour_input(old)
        elif new.name == "Normal":
            source = _normal(old)
        if source is not None:
            take(source, new)
    return {name: node.outputs[name] for name in gloss.OUTPUTS}


def _kind(node: Node) -> str:
    if node.type in METALS:
        return gloss.METAL
    if node.type != "BSDF_PRINCIPLED":
        return MATT
    metallic = node.inputs["Metallic"]
    if _fed_by(metallic) or drivers.moves(metallic) or 0 < metallic.default_value < 1:
        return gloss.MIXED
    if metallic.default_value >= 1:
        return gloss.METAL
    shown = ("Specular IOR Level", "Coat Weight", "Emission Strength")
    return gloss.GLOSS if any(shows(node, name) for name in shown) else MATT


def shows(node: Node, name: str) -> bool:
    """Whether a shader has an input that is over 0, or fed, or moves."""
    socket = node.inputs.get(name)
    if socket is None:
        return False
    return _fed_by(socket) is not None or drivers.moves(socket) or socket.default_value > 0


def _left_out(node: Node) -> Iterator[str]:
    if node.type == "GROUP":
        yield f'what the group "{node.node_tree.name if node.node_tree else node.name}" adds'
    elif node.type in BASES - {"BSDF_PRINCIPLED", "BSDF_DIFFUSE"}:
        yield f"what {node.bl_label} adds to a diffuse surface"
    yield from (name.removesuffix(" Weight").lower() for name in LEFT_OUT if shows(node, name))
    if _fed_by(node.inputs.get("Tangent")) is not None:
        yield "tangent"
    if node.type == "BSDF_DIFFUSE" and shows(node, "Roughness"):
        yield "diffuse roughness"
    if _kind(node) in (gloss.METAL, gloss.MIXED) and _fed_by(colour_input(node)) is not None:
        yield "the spectrum of a metal's texture"


def _other(targets: Sequence[Node]) -> Iterator[str]:
    """What is lost of several matt colours that are mixed: one reflectance stands for all."""
    matt = [node for node in targets if _kind(node) != gloss.METAL]
    sockets = [socket for node in matt if (socket := colour_input(node)) is not None]
    colours = {_fed_by(s) or tuple(round(part, 4) for part in s.default_value) for s in sockets}
    if len(colours) > 1:
        yield f"{len(colours) - 1} more base color(s) that are mixed in"


def colour_input(node: Node) -> Socket | None:
    """A shader's base colour, None where it has none by that name."""
    return next((node.inputs[name] for name in COLOURS if name in node.inputs), None)


def _normal(node: Node) -> Socket | None:
    """A shader's Normal input if something feeds it."""
    normal = node.inputs.get("Normal")
    return None if _fed_by(normal) is None else normal


def _fed_by(socket: Socket | None) -> Socket | None:
    """What is linked to an input, None if nothing is or the link is muted."""
    if socket is None or not socket.is_linked or socket.links[0].is_muted:
        return None
    return socket.links[0].from_socket


def _opaque_as(take, shader: Socket | None, alpha: Socket) -> None:
    """Take over the Alpha of a shader, or the factor that mixes it over a Transparent BSDF."""
    if shader is None:
        return
    opacity = shader.node.inputs.get("Alpha")
    if shader.node.type == "MIX_SHADER":
        below = nodes.source(shader.node.inputs[1])
        clear = below is not None and below.node.type == "BSDF_TRANSPARENT"
        opacity = shader.node.inputs[0] if clear else None
    if opacity is not None:
        take(opacity, alpha)


def _add(tree: bpy.types.NodeTree, kind: str, role: str, **settings) -> Node:
    node = groups.add(tree, kind, **settings)
    node[tags.NODE] = role
    return node
