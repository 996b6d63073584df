"""Glass and metal: what lets light through or mirrors it, by RGB that hold under one World's sky.

A pane tints what is seen through it. What lies behind it is lit through it by numbers of its own
(the product of transmittance and reflectance), so the lamps of the light probe pass through panes.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import glazing, gloss
from ....node_groups import tree as groups
from ... import tags
from ...errors import InputError
from ...grouping import grouped
from ...sky.light import SkyLight
from ...spectra.illuminants import D65
from ...transfer.assignment import Assignment
from ...transfer.matrices import Transfer
from ...transfer.metals import tints
from ...transfer.prefilter import prefiltered
from ..blend_data import drivers, kept, nodes
from ..lights import light_linking
from . import material_outputs, rgb_comparison, saved_settings, shader_rewrite, spectral_material


def glaze(material: bpy.types.Material, pane: Assignment) -> None:
    """Make a material glass; its color comes by `refresh`.

    Roughness and relief of the old shader stay on what is mirrored. `spectral_material.remove`
    takes it off again. Raises InputError for a linked or overridden material.
    """
    spectral_material.check_editable(material)
    node = pane_node(material)
    if node is None or not node.outputs[0].is_linked:
        spectral_material.remove(material)
        outputs = material_outputs.remember(material)
        tree = material.node_tree
        before = nodes.source(outputs[0].inputs["Surface"])
        node = groups.add(tree, "ShaderNodeGroup", node_tree=glazing.ensure(), label=glazing.KIND)
        node[tags.NODE] = "glass"
        node.location = outputs[0].location.x - 40, outputs[0].location.y + 260
        for key in ("Roughness", "Normal"):
            if before is not None and key in before.node.inputs:
                drivers.take(material, before.node.inputs[key], node.inputs[key])
        for output in outputs:
            tree.links.new(node.outputs[0], output.inputs["Surface"])
    node.inputs["Faces"].default_value = float(pane.faces)
    saved_settings.own(material, saved_settings.GLASS)
    material[tags.MATERIAL] = {
        **kept.mapping(material, tags.MATERIAL),
        "id": glazing.KIND,
        "reflectance": pane.name,
        "values": pane.values.tolist(),
        "unit": pane.unit,
        "file": pane.source,
    }


def pane_node(material: bpy.types.Material | None) -> bpy.types.Node | None:
    """The `Spectral Glazing` node of a material that is glass of ours, None for another."""
    if material is None or tags.MATERIAL not in material or material.node_tree is None:
        return None
    if not _transmittance(material):
        return None
    return next((n for n in material.node_tree.nodes if n.get(tags.NODE) == "glass"), None)


def _transmittance(material: bpy.types.Material) -> tuple[float, ...]:
    """What `glaze` kept, empty where that is not whole."""
    found = kept.mapping(material, tags.MATERIAL)
    values = found.get("values")
    whole = kept.are_numbers(values, 81) and isinstance(found.get("reflectance"), str)
    return tuple(values) if whole and values is not None else ()


def pane_of(material: bpy.types.Material) -> Assignment:
    """What `glaze` made a material of."""
    node, record = pane_node(material), kept.mapping(material, tags.MATERIAL)
    assert node is not None
    return Assignment(
        record["reflectance"],
        np.array(_transmittance(material)),
        faces=round(node.inputs["Faces"].default_value),
        unit=record.get("unit", ""),
        source=record.get("file", ""),
    )


def keep_metal(material: bpy.types.Material, n: Iterable[float], k: Iterable[float]) -> None:
    """Keep with a managed material the n and k, (81,) each, that its metal has."""
    material[tags.METAL] = [*map(float, n), *map(float, k)]


def check_metal(material: bpy.types.Material) -> None:
    """Raise InputError for a material that shows no metal."""
    if not spectral_material.look_of(material).metal:
        raise InputError(
            f'material "{material.name}"',
            "is not metallic",
            "set its Metallic to 1 or connect a texture to it",
        )


def metal_of(material: bpy.types.Material) -> tuple[NDArray, NDArray] | None:
    """What `keep_metal` kept, None without."""
    if tags.METAL not in material:
        return None
    values = kept.numbers(material, tags.METAL, 2 * 81)
    return (np.array(values[:81]), np.array(values[81:])) if values else None


def refresh(scenes: Iterable[bpy.types.Scene], light: SkyLight, transfer: Transfer) -> list[str]:
    """Colour glass and metal by a sky, and let the lamps of scenes through panes; warnings."""
    sky = transfer.restoration @ transfer.unbalanced(light.faces.mean(axis=0))
    for material in [m for m in bpy.data.materials if m.is_editable]:
        if (metal := metal_of(material)) is not None:
            shader_rewrite.set_metal(material, *tints(*metal, sky, transfer.space))
            plain = zip(gloss.METAL_COLOURS, tints(*metal, D65(), transfer.space), strict=True)
            rgb_comparison.keep(material, {("gloss", name): (*rgb, 1.0) for name, rgb in plain})
        elif (node := pane_node(material)) is not None:
            tau = np.array(_transmittance(material))
            tint, plain_tint = (
                (*np.clip(prefiltered(tau, spectrum, transfer.space), 0.0, 1.0).tolist(), 1.0)
                for spectrum in (sky, D65())
            )
            node.inputs["Transmittance"].default_value = tint
            rgb_comparison.keep(material, {("glass", "Transmittance"): plain_tint})
    return [line for scene in scenes for line in pass_through(scene)]


def pass_through(scene: bpy.types.Scene) -> list[str]:
    """Let our lamps in a scene shine through its panes, up to date; return warnings."""
    glass, parts = set(), []
    for obj in scene.objects:
        panes = [pane_node(slot.material) is not None for slot in obj.material_slots]
        if all(panes) and panes:
            glass.add(obj)
        elif any(panes):
            parts.append(obj.name)
    light_linking.block(scene, glass)
    shade = "glass and frame in one object shade the sun; separate them by material"
    lamps = any(obj.type == "LIGHT" and tags.LAMP in obj for obj in scene.objects)
    return grouped([(name, shade) for name in parts], "object") if lamps else []
