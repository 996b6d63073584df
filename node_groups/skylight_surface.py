"""`Skylight Surface`: a matt surface that the light of one World shines on, as an Emission.

    colour = M E_sky + Ground E_ground + Sun E_sun + Lamp 1 E_1 + Lamp 2 E_2

M is the material's matrix for skylight; Ground, Sun and Lamp are what it reflects of light of one
known spectrum, three numbers each. Where a mesh is baked the first two are what the bake made of
all light but sun and lamps (`baked_light`). Where Cycles traces the light itself, it multiplies it
by Color, RGB by RGB: what the material reflects of the light that falls on it in this scene (Ward
and Eydelberg-Vileshin 2002, DOI 10.2312/EGWR/EGWR02/117-124). A material differs from another by
the values of its group node's inputs alone, so one shader serves all of a World; what that World
has none of is not in it (`Features`). Drivers copy the World's strength and rotation; their target
is also how the group of a World is known. (A custom property that points to the World would do the
same, but in Blender 4.5 each render takes a user off it.)
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import astuple, dataclass
from functools import partial
from typing import Literal

import bpy

from . import baked_light, light_probe, normals, sky_irradiance, spectral_matrix
from . import tree as groups
from .drivers import drive
from .sockets import CYCLES, NORMAL, SHADER, alpha
from .tree import Socket
from .value import Value, combine_xyz, inputs, outputs

KIND = "Skylight Surface"
VERSION = 6
SKY = "Sky"  # the nodes whose Rotation and Strength follow the World
GROUND = "Ground"
PROBE = "Probe"
BAKED = "Baked"
TRACED = "Traced"  # the node whose value is 1 where Cycles traces the light, else 0
OLD = "Visibility"  # in its place before version 4: harmonics of what vertices saw of the sky
ANY = "sun_threshold"  # a number that every World has
LEAST = 1e-6
"""By so much more than the World's strength is baked light multiplied: it is kept over that, and
what lamps and emitters give to it would be lost in a World of strength 0."""
LIGHTS = {
    "Ground": "light from the ground",
    "Sun": "sunlight",
    "Lamp 1": "light of the first kind of lamps",
    "Lamp 2": "light of the second kind of lamps",
}
TINT, COLOR = "Tint", "Color"
IRRADIANCE, REFLECTANCE = "Skylight Irradiance", "Skylight Reflectance"
"""Passes (AOVs) that a view layer may ask for: the sky's irradiance/π, and the material's colour
under a light of (1, 1, 1)."""

INPUTS = (
    *spectral_matrix.ROW_SOCKETS,
    NORMAL,
    alpha("surface"),
    *(
        Socket(name, "Vector", f"RGB that the material reflects of {light}", (0.0, 0.0, 0.0))
        for name, light in LIGHTS.items()
    ),
    Socket(TINT, "Vector", "RGB that baked or traced light is multiplied by", (1.0, 1.0, 1.0)),
    Socket(COLOR, "Vector", "RGB that Cycles multiplies light by where it traces it", (0.8,) * 3),
)
OUTPUTS = (SHADER, CYCLES)


@dataclass(frozen=True)
class Features:
    """What the light of a World is made of, which is what its shader holds.

    ``sky``: "open"; "baked", where vertices have all light but sun and lamps; "dome", live from
    lamps (Eevee; open in Cycles). ``probe``: sun or lamps; a dome needs it. ``ground``: light from
    below on its own. Another value compiles another shader.
    """

    sky: Literal["open", "baked", "dome"] = "open"
    probe: bool = False
    ground: bool = False

    def __str__(self) -> str:
        return " ".join(str(part) for part in astuple(self))


def find(world: bpy.types.World) -> bpy.types.NodeTree | None:
    """The `Skylight Surface` group of this World, None before it has one."""
    return next((tree for tree in groups.of_kind(KIND) if world_of(tree) == world), None)


def world_of(tree: bpy.types.NodeTree) -> bpy.types.World | None:
    """The World whose sky this `Skylight Surface` group holds, None if it is gone."""
    drivers = tree.animation_data.drivers if tree.animation_data else ()
    return next((d.driver.variables[0].targets[0].id for d in drivers), None)


def is_newer(world: bpy.types.World) -> bool:
    """Whether a World's groups were made by newer code than this, which must not touch them."""
    surface = find(world)
    if surface is None:
        return False
    inside = {
        SKY: sky_irradiance.VERSION,
        GROUND: sky_irradiance.VERSION,
        PROBE: light_probe.VERSION,
        BAKED: baked_light.VERSION,
    }
    return groups.is_newer(surface, VERSION) or any(
        groups.is_newer(tree, version)
        for name, version in inside.items()
        if (tree := part(surface, name)) is not None
    )


def part(tree: bpy.types.NodeTree, name: str) -> bpy.types.NodeTree | None:
    """The group inside a `Skylight Surface` group that is its `SKY`, `GROUND`, `PROBE` or
    `BAKED`; None where it has none."""
    node = tree.nodes.get(name)
    return None if node is None else node.node_tree


def sky_in(tree: bpy.types.NodeTree) -> bpy.types.NodeTree:
    """The `Sky Irradiance` group inside a `Skylight Surface` group."""
    return tree.nodes[SKY].node_tree


def features_of(tree: bpy.types.NodeTree) -> Features:
    """What a `Skylight Surface` group holds."""
    sky = "baked" if BAKED in tree.nodes or OLD in tree.nodes else "open"
    if PROBE in tree.nodes and tree.nodes[PROBE].outputs["Sky"].is_linked:
        sky = "dome"
    return Features(sky, PROBE in tree.nodes, GROUND in tree.nodes)  # type: ignore[arg-type]


def trace(tree: bpy.types.NodeTree, on: bool) -> None:
    """Let Cycles trace the light of a `Skylight Surface` group, or show that of its World."""
    if is_traced(tree) != on:  # a value that is written makes Blender draw anew
        tree.nodes[TRACED].outputs[0].default_value = float(on)


def is_traced(tree: bpy.types.NodeTree) -> bool:
    """Whether Cycles traces the light of a `Skylight Surface` group."""
    return TRACED in tree.nodes and tree.nodes[TRACED].outputs[0].default_value > 0.5


def ensure(
    world: bpy.types.World,
    strength: str | None,
    rotation: str | None,
    inverse: bool = False,
    features: Features | None = None,
    steady: Collection[str] = (),
) -> bpy.types.NodeTree:
    """The `Skylight Surface` group of this World, made or updated.

    `strength` and `rotation` are the World's data paths that it follows (None: 1, and not turned);
    `inverse` turns the other way; `features`: None leaves what there is; `steady`: the parts whose
    light is not multiplied by the strength. The two outputs differ in the light of sun and lamps,
    which each engine has in its own way. Eevee shows a negative sum,
    which is a colour out of gamut, as 0.
    """
    tree = find(world)
    old = {name: part(tree, name) for name in (SKY, GROUND, PROBE, BAKED, OLD)} if tree else {}
    if features is None:
        features = features_of(tree) if tree else Features()
    traced = tree is not None and is_traced(tree)
    sky = sky_irradiance.ensure(old.get(SKY))
    parts = {SKY: sky}
    dome = features.sky == "dome"
    if features.ground:
        parts[GROUND] = sky_irradiance.ensure(
            old.get(GROUND), sky_irradiance.GROUND, sky_irradiance.GROUND_DEGREE
        )
    if features.probe or dome:
        parts[PROBE] = light_probe.ensure(old.get(PROBE))
    if features.sky == "baked":
        parts[BAKED] = baked_light.ensure(old.get(BAKED))
    tree = groups.ensure(
        tree,
        KIND,
        VERSION,
        INPUTS,
        OUTPUTS,
        partial(_build, parts=parts, matrix=spectral_matrix.ensure(), dome=dome),
        variant=str(features),
    )
    trace(tree, traced)
    for name, inside in parts.items():
        node = tree.nodes[name]
        at = node.inputs["Strength"], "default_value", world
        if strength is None or name in steady:
            drive(*at, ANY, factor=0.0, offset=1.0)  # by which the World is known all the same
        else:
            drive(*at, strength, offset=LEAST if name == BAKED else 0.0)
        if "Rotation" not in node.inputs:
            continue
        if sky_irradiance.ROTATE in inside.nodes:
            inside.nodes[sky_irradiance.ROTATE].invert = inverse
        for axis in range(3):
            if rotation is None:
                node.inputs["Rotation"].driver_remove("default_value", axis)
                node.inputs["Rotation"].default_value[axis] = 0.0
            else:
                drive(node.inputs["Rotation"], "default_value", world, f"{rotation}[{axis}]", axis)
    for name in old.keys() - parts.keys():
        unused = old[name]
        if unused is not None and unused.users == 0:
            bpy.data.node_groups.remove(unused)
    return tree


def _build(
    tree: bpy.types.NodeTree,
    parts: dict[str, bpy.types.NodeTree],
    matrix: bpy.types.NodeTree,
    dome: bool,
) -> None:
    add = partial(groups.add, tree)
    given = inputs(tree)

    def light(name: str) -> dict[str, Value]:
        node = add("ShaderNodeGroup", node_tree=parts[name], name=name, label=name)
        if "Normal" in node.inputs:
            tree.links.new(given["Normal"].socket, node.inputs["Normal"])
        return outputs(node)

    def choice(factor: Value, without: Value, where: Value) -> Value:
        node = add("ShaderNodeMix", factor, without, where, data_type="VECTOR", clamp_factor=True)
        return Value(next(socket for socket in node.outputs if socket.enabled))

    def reflected(sky: Value, rows: Iterable[str]) -> Value:
        linked = {own: given[row] for own, row in zip(spectral_matrix.ROWS, rows, strict=True)}
        node = add("ShaderNodeGroup", node_tree=matrix, into={"Color": sky, **linked})
        return Value(node.outputs[0])

    probe = light(PROBE) if PROBE in parts else None
    sky = light(SKY)["Irradiance"]
    ground = light(GROUND)["Irradiance"] if GROUND in parts else None
    baked = light(BAKED) if BAKED in parts else None
    own = spectral_matrix.ROWS
    even = combine_xyz(*(given[row].dot((1.0, 1.0, 1.0)) for row in own))

    def lit_by_sky(sky: Value) -> Value:
        colour = reflected(sky, own)
        return colour if ground is None else given["Ground"].multiply_add(ground, colour)

    both = lit_by_sky(sky)  # in both engines
    if baked:
        both = choice(baked["Baked"], both, baked["Light"] * given[TINT])
        sky = choice(baked["Baked"], sky, baked["Light"] / even)
    live = probe["Sky"] if probe and dome else None
    add("ShaderNodeOutputAOV", sky if live is None else live, aov_name=IRRADIANCE)
    add("ShaderNodeOutputAOV", even, aov_name=REFLECTANCE)
    colours = {"Shader": both if live is None else lit_by_sky(live), "Cycles": both}
    if probe:
        lit = given["Sun"].multiply_add(probe["Sun"], colours["Shader"])
        for name in ("Lamp 1", "Lamp 2"):
            lit = given[name] * probe[name] + lit
        colours["Shader"] = lit
    shaders = [add("ShaderNodeEmission", colour).outputs[0] for colour in colours.values()]
    normal = normals.build(tree, given["Normal"])

    def diffuse(colour: Value) -> bpy.types.NodeSocket:
        return add("ShaderNodeBsdfDiffuse", colour, 0.0, into={"Normal": normal}).outputs[0]

    if probe:
        # The lamps are that much too strong for Cycles, which drowns all else in this Diffuse.
        faint = diffuse(given["Sun"] * ((1.0 / light_probe.CYCLES_STRENGTH,) * 3))
        shaders[1] = add("ShaderNodeAddShader", faint, shaders[1]).outputs[0]
    traced = add("ShaderNodeValue", name=TRACED, label=TRACED).outputs[0]
    white = (1.0, 1.0, 1.0)  # of which no surface sends more
    own = diffuse((given[COLOR] * given[TINT]).minimum(white))
    shaders[1] = add("ShaderNodeMixShader", traced, shaders[1], own).outputs[0]
    clear = add("ShaderNodeBsdfTransparent").outputs[0]
    mixed = [add("ShaderNodeMixShader", given["Alpha"], clear, shader) for shader in shaders]
    add("NodeGroupOutput", *(node.outputs[0] for node in mixed))
