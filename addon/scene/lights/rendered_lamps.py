"""Which of the user's lamps shine in a render, where, and with what of their nodes.

What shines is what a render's view layers show: neither lamps of excluded collections nor those
that are switched off in renders, but those that collections and modifiers instance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ... import tags
from ..blend_data import drivers, nodes


@dataclass(frozen=True)
class RenderedLamp:
    """A lamp in one place.

    ``through``: the Empties whose collections it is instanced by, the outermost first;
    ``matrix`` (4, 4): where it stands; ``fixed``: where a modifier or particles put it, which
    nothing of ours can follow; ``everywhere``: not in some rendered view layers alone.
    """

    lamp: bpy.types.Object
    through: tuple[bpy.types.Object, ...]
    matrix: NDArray[np.float64]
    fixed: bool = False
    everywhere: bool = True

    @property
    def name(self) -> str:
        """What people know it by."""
        return " in ".join(obj.name for obj in (self.lamp, *reversed(self.through)))


def of_scene(scene: bpy.types.Scene) -> list[RenderedLamp]:
    """The user's lamps that light diffuse surfaces in a scene's renders.

    Of the active scene alone is known what modifiers and particles instance.
    """
    found = [
        RenderedLamp(lamp, through, np.array(matrix), everywhere=everywhere)
        for obj, everywhere in _rendered(scene).items()
        for lamp, through, matrix in _lamps_of(obj, obj.matrix_world, ())
    ]
    if scene == bpy.context.scene:
        for each in bpy.context.evaluated_depsgraph_get().object_instances:
            if not each.is_instance or each.object.type != "LIGHT":
                continue
            lamp, by = each.object.original, each.parent.original
            if by.instance_type != "COLLECTION" and _shines(lamp) and not by.hide_render:
                found.append(RenderedLamp(lamp, (), np.array(each.matrix_world), True))
    return found


def followed(twin: bpy.types.Object) -> bpy.types.Object | None:
    """The user's lamp that a lamp of ours follows, None for the sun's and the dome's."""
    if tags.LAMP not in twin:
        return None
    return next((c.target for c in twin.constraints if c.type == "COPY_TRANSFORMS"), None)


def _rendered(scene: bpy.types.Scene) -> dict[bpy.types.Object, bool]:
    """The objects that renders show, in the order of the scene, and whether all view layers do."""
    layers = [layer for layer in scene.view_layers if layer.use] or list(scene.view_layers)
    for layer in layers:
        if layer.layer_collection is None:
            layer.update()  # of a scene that a script has made and no window has shown
    shown = [set(_in_layer(layer.layer_collection)) for layer in layers]
    return {
        obj: all(obj in each for each in shown)
        for obj in scene.objects
        if not obj.hide_render and any(obj in each for each in shown)
    }


def _in_layer(within: bpy.types.LayerCollection) -> Iterator[bpy.types.Object]:
    if within.collection.hide_render:
        return
    if not within.exclude:
        yield from within.collection.objects
    for child in within.children:
        yield from _in_layer(child)


def _in_collection(collection: bpy.types.Collection) -> Iterator[bpy.types.Object]:
    if collection.hide_render:
        return
    yield from (obj for obj in collection.objects if not obj.hide_render)
    for child in collection.children:
        yield from _in_collection(child)


def _lamps_of(
    obj: bpy.types.Object, matrix: Matrix, through: tuple[bpy.types.Object, ...]
) -> Iterator[tuple[bpy.types.Object, tuple[bpy.types.Object, ...], Matrix]]:
    """A lamp itself, or those that an Empty instances, those of Empties inside too."""
    if obj.type == "LIGHT":
        if _shines(obj):
            yield obj, through, matrix
        return
    if obj.instance_type != "COLLECTION" or obj.instance_collection is None or obj in through:
        return
    inside = matrix @ Matrix.Translation(-obj.instance_collection.instance_offset)
    for part in dict.fromkeys(_in_collection(obj.instance_collection)):
        yield from _lamps_of(part, inside @ part.matrix_world, (*through, obj))


def _shines(lamp: bpy.types.Object) -> bool:
    """Whether a lamp is the user's and gives light to diffuse surfaces."""
    light = lamp.data
    portal = getattr(getattr(light, "cycles", None), "is_portal", False)
    if tags.LAMP in lamp or (portal and light.type == "AREA"):
        return False
    # Cycles goes by the object's ray visibility, Eevee by the lamp's own factor.
    seen = lamp.visible_diffuse and light.diffuse_factor > 0.0
    return bool(seen and light.energy > 0.0 and nodes_of(light).factor.any())


@dataclass(frozen=True)
class LampNodes:
    """What a lamp's nodes make of its light, as Cycles has it.

    ``factor`` (3,): by which its color is multiplied; ``kelvin``: of the black body that they hold,
    0 without; ``left_out``: what of them cannot be carried, empty where all is.
    """

    factor: NDArray[np.float64]
    kelvin: float = 0.0
    left_out: str = ""


def nodes_of(light: bpy.types.Light) -> LampNodes:
    """What a lamp's nodes say: an Emission of one color, or of a black body, and its strength."""
    plain = np.ones(3)
    if not light.use_nodes or light.node_tree is None:
        return LampNodes(plain)
    output = next((n for n in light.node_tree.nodes if n.type == "OUTPUT_LIGHT"), None)
    shader = None if output is None else nodes.source(output.inputs["Surface"])
    if shader is None:
        return LampNodes(np.zeros(3))
    emission = shader.node
    if emission.type != "EMISSION":
        return LampNodes(plain, left_out=f'"{emission.name}"')
    color, strength = emission.inputs["Color"], emission.inputs["Strength"]
    if drivers.moves(color) or drivers.moves(strength):
        return LampNodes(plain, left_out="an animated Emission")
    size = nodes.source(strength)
    if size is not None and size.node.type != "VALUE":
        return LampNodes(plain, left_out=f'"{size.node.name}"')
    factor = plain * max(0.0, (strength if size is None else size).default_value)
    tint = nodes.source(color)
    if tint is None or tint.node.type == "RGB":
        rgb = np.array((color if tint is None else tint).default_value[:3], dtype=float)
        return LampNodes(factor * np.maximum(rgb, 0.0))
    if tint.node.type == "BLACKBODY" and nodes.source(tint.node.inputs[0]) is None:
        return LampNodes(factor, kelvin=float(tint.node.inputs[0].default_value))
    return LampNodes(factor, left_out=f'"{tint.node.name}"')
