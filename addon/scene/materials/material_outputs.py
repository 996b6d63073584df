"""The Material Outputs that we take over: what fed each before us, kept to be given back."""

from __future__ import annotations

import bpy

from ....node_groups import tree as groups
from ... import tags
from ..blend_data import kept, nodes

ENGINES = ("EEVEE", "CYCLES")


def before(material: bpy.types.Material) -> list[bpy.types.Node]:
    """The outputs that the engines showed before us; none of a material without nodes."""
    if material.node_tree is None or without_nodes(material):
        return []
    return [node for node in shown(material.node_tree) if tags.NODE not in node]


def without_nodes(material: bpy.types.Material) -> bool:
    """Whether a material has no nodes but ours: Blender 4.5 shows its viewport colour then."""
    if tags.MATERIAL in material:
        return bool(kept.mapping(material, tags.MATERIAL).get("without_nodes"))
    return bpy.app.version < (5, 0, 0) and not material.use_nodes


def shown(tree: bpy.types.NodeTree) -> list[bpy.types.Node]:
    """The outputs that the engines show: one for both, or one each."""
    found = (tree.get_output_node(engine) for engine in ENGINES)
    return list(dict.fromkeys(node for node in found if node is not None and node.id_data == tree))


def remember(material: bpy.types.Material) -> list[bpy.types.Node]:
    """Keep what `remove` needs to give a material back; return its outputs, still as they were.

    One that has none, or in Blender 4.5 no nodes, is given them.
    """
    bare = without_nodes(material)
    nodes.use(material)
    material[tags.MATERIAL] = {"without_nodes": bare}
    tree = material.node_tree
    outputs = shown(tree)
    if not outputs:
        outputs = [groups.add(tree, "ShaderNodeOutputMaterial")]
        outputs[0][tags.NODE] = "output"
    for number, output in enumerate(outputs):
        surface = output.inputs["Surface"]
        output[tags.OUTPUT] = number
        if surface.is_linked:
            link = surface.links[0]
            memory = kept.mapping(link.from_node, tags.OUTPUT_SOURCE)
            memory[str(number)] = [link.from_socket.identifier, str(int(link.is_muted))]
            link.from_node[tags.OUTPUT_SOURCE] = memory
    return outputs


def _memory(source: bpy.types.Node, number: str) -> list[str]:
    """What a node remembers of an output that it fed: its socket's identifier, and if muted."""
    found = kept.mapping(source, tags.OUTPUT_SOURCE).get(number)
    return list(found or ()) if kept.are_texts(found) and len(found or ()) == 2 else []


def source_before(tree: bpy.types.NodeTree, output: bpy.types.Node) -> bpy.types.NodeSocket | None:
    """What feeds an output, or fed it before we did."""
    number = str(output.get(tags.OUTPUT))
    for source in tree.nodes:
        if found := _memory(source, number):
            identifier = found[0]
            return next((s for s in source.outputs if s.identifier == identifier), None)
    return nodes.source(output.inputs["Surface"])


def _plug_back(tree: bpy.types.NodeTree, surface: bpy.types.NodeSocket, number: str) -> None:
    for source in tree.nodes:
        if not (found := _memory(source, number)):
            continue
        identifier, muted = found
        for socket in source.outputs:
            if socket.identifier == identifier:
                tree.links.new(socket, surface).is_muted = muted == "1"
                return


def give_back(tree: bpy.types.NodeTree) -> None:
    """Plug into each output what fed it before us; one that a user has plugged since keeps that."""
    for output in [n for n in tree.nodes if tags.OUTPUT in n]:
        surface = output.inputs["Surface"]
        number = str(output[tags.OUTPUT])
        lost = not surface.is_linked
        if lost or tags.NODE in surface.links[0].from_node:
            for link in list(surface.links):
                tree.links.remove(link)
            _plug_back(tree, surface, number)
        del output[tags.OUTPUT]


def forget(tree: bpy.types.NodeTree) -> None:
    """Take off what `remember` kept on the nodes that fed outputs."""
    for source in [n for n in tree.nodes if tags.OUTPUT_SOURCE in n]:
        del source[tags.OUTPUT_SOURCE]
