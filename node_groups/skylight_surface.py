"""`Skylight Surface`: a matt surface that the open sky of one World lights, as an Emission.

Sky Irradiance, then Spectral Matrix, then Emission: a material differs from another by the values
of its group node's inputs alone, so one shader serves them all. Drivers copy the World's strength
and rotation; their target is also how the group of a World is known. (A custom property that
points to the World would do the same, but in Blender 4.5 each render takes a user off it.)
"""

from __future__ import annotations

from functools import partial

import bpy

from . import sky_irradiance, spectral_matrix
from . import tree as groups

KIND = "Skylight Surface"
VERSION = 1
SKY = "Sky"  # the node whose Rotation and Strength follow the World


def find(world: bpy.types.World) -> bpy.types.NodeTree | None:
    """The `Skylight Surface` group of this World, None before it has one."""
    return next((tree for tree in groups.of_kind(KIND) if world_of(tree) == world), None)


def world_of(tree: bpy.types.NodeTree) -> bpy.types.World | None:
    """The World whose sky this `Skylight Surface` group holds, None if it is gone."""
    drivers = tree.animation_data.drivers if tree.animation_data else ()
    return next((d.driver.variables[0].targets[0].id for d in drivers), None)


def sky_in(tree: bpy.types.NodeTree) -> bpy.types.NodeTree:
    """The `Sky Irradiance` group inside a `Skylight Surface` group."""
    return tree.nodes[SKY].node_tree


def ensure(
    world: bpy.types.World, strength: str, rotation: str | None, inverse: bool = False
) -> bpy.types.NodeTree:
    """The `Skylight Surface` group of this World, made or updated.

    `strength` and `rotation` are the World's data paths that it follows (None: not turned);
    `inverse` turns the other way. Inputs: Row R, Row G, Row B (the material's matrix; identity by
    default), Normal (world space; unlinked: the shading normal), Alpha (1: opaque). Output: Shader.
    Eevee shows a negative sum, which is a colour out of gamut, as 0.
    """
    tree = find(world)
    old_sky = tree.nodes[SKY].node_tree if tree and SKY in tree.nodes else None
    sky = sky_irradiance.ensure(old_sky)
    tree = groups.ensure(
        tree,
        KIND,
        VERSION,
        [
            *spectral_matrix.row_sockets(),
            ("Normal", "NodeSocketVector", None),
            ("Alpha", "NodeSocketFloat", 1.0),
        ],
        [("Shader", "NodeSocketShader", None)],
        partial(_build, sky=sky, matrix=spectral_matrix.ensure()),
    )
    sky.nodes[sky_irradiance.ROTATE].invert = inverse
    inputs = tree.nodes[SKY].inputs
    _follow(inputs["Strength"], -1, world, strength)
    for axis in range(3):
        if rotation is None:
            inputs["Rotation"].driver_remove("default_value", axis)
            inputs["Rotation"].default_value[axis] = 0.0
        else:
            _follow(inputs["Rotation"], axis, world, f"{rotation}[{axis}]")
    return tree


def _follow(socket: bpy.types.NodeSocket, axis: int, world: bpy.types.World, path: str) -> None:
    socket.driver_remove("default_value", axis)
    driver = socket.driver_add("default_value", axis).driver
    driver.type = "AVERAGE"  # of one value: no expression that Blender might refuse to run
    target = driver.variables.new().targets[0]
    target.id_type = "WORLD"
    target.id = world
    target.data_path = path


def _build(tree: bpy.types.NodeTree, sky: bpy.types.NodeTree, matrix: bpy.types.NodeTree) -> None:
    add = partial(groups.add, tree)
    given = add("NodeGroupInput").outputs
    light = add("ShaderNodeGroup", node_tree=sky, name=SKY, label=SKY)
    tree.links.new(given["Normal"], light.inputs["Normal"])
    reflected = add("ShaderNodeGroup", node_tree=matrix)
    tree.links.new(light.outputs[0], reflected.inputs["Color"])
    for row in spectral_matrix.ROWS:
        tree.links.new(given[row], reflected.inputs[row])
    emission = add("ShaderNodeEmission", reflected.outputs[0])
    clear = add("ShaderNodeBsdfTransparent")
    surface = add("ShaderNodeMixShader", given["Alpha"], clear.outputs[0], emission.outputs[0])
    add("NodeGroupOutput", surface.outputs[0])
    groups.arrange(tree)
