"""What the materials of a scene do with light: what they reflect, let through and send."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.types import NodeSocket as Socket
from numpy.typing import NDArray

from ....node_groups import glazing
from ....node_groups import tree as groups
from ...transfer import glass
from ...transfer.lamps import lamp_spectrum
from ...transfer.matrices import Transfer
from ...transfer.textures import basis
from ...transport.bands import Bands
from ...transport.cells import ANGLES, Matter
from ..blend_data import nodes
from ..materials import base_color, glass_and_metal, material_outputs, spectral_material

CLEAR = {"BSDF_GLASS", "BSDF_REFRACTION"}
GREY = 0.8  # of what has no material, as Blender shows it


@dataclass(frozen=True)
class Optics:
    """What one material does: spectra (81,) but for the ``opacity``, 0 to 1.

    ``transmittance``: of one face at normal incidence where it is a pane, else None; ``faces``: 1
    where a face is the whole pane. ``emission`` is of the part that does not let light pass.
    """

    reflectance: NDArray[np.float64]
    emission: NDArray[np.float64]
    opacity: float = 1.0
    transmittance: NDArray[np.float64] | None = None
    faces: int = 1


def optics_of(material: bpy.types.Material | None, transfer: Transfer) -> Optics:
    """Return what a material does; of one that is not managed by a reflectance restored from its
    base colour, the mean of a texture's."""
    dark = np.zeros(81)
    if material is None:
        return Optics(np.full(81, GREY), dark)
    if glass_and_metal.pane_node(material) is not None:
        pane = glass_and_metal.pane_of(material)
        return Optics(dark, dark, 1.0, pane.values, pane.faces)
    shader = _shader(material)
    emission, opacity, clear = _read(shader, transfer)
    if spectral_material.is_managed(material):
        return Optics(_own(material), emission, opacity)
    if clear is not None:
        tau = np.sqrt(np.clip(clear @ basis(transfer.space), 0.0, 1.0))
        return Optics(dark, emission, opacity, tau, 1)
    return Optics(base_color.estimated(material).values, emission, opacity)


def _own(material: bpy.types.Material) -> NDArray[np.float64]:
    """The reflectance (81,) of a managed material without the pane that it is told to be behind,
    for rays know what they have passed."""
    managed = spectral_material.managed(material)
    if managed is None or not managed.details.values:
        return base_color.estimated(material).values
    if managed.details.behind:
        for other in filter(glass_and_metal.pane_node, bpy.data.materials):
            pane = glass_and_metal.pane_of(other)
            if pane.source == managed.details.behind:
                return np.clip(managed.values / np.maximum(pane.values, 0.02), 0.0, 1.0)
    return managed.values


def matter(
    names: Sequence[str], bands: Bands, transfer: Transfer, strength: float = 1.0
) -> tuple[Matter, list[Optics]]:
    """Return the materials of these full names ("": none) in bands.

    ``strength``: what the World's light is multiplied by where it is seen; so what shines of its
    own is divided by that.
    """
    by_name = {material.name_full: material for material in bpy.data.materials}
    found = [optics_of(by_name.get(name), transfer) for name in names]
    rho = bands.share([each.reflectance for each in found])
    emission = bands.light([each.emission / strength for each in found])
    cosines = (np.arange(ANGLES) + 0.5) / ANGLES
    through = np.zeros((len(found), ANGLES, rho.shape[1]), np.float32)
    mirrored = np.zeros((len(found), ANGLES), np.float32)
    for each, row, back in zip(found, through, mirrored, strict=True):
        if each.transmittance is not None:
            pane = glass.uncoated(each.transmittance, cosines)
            row[:] = bands.share(np.clip(pane.transmittance, 0.0, 1.0) ** (1.0 / each.faces))
            back[:] = np.minimum(
                bands.share(pane.front).mean(axis=1) / each.faces, 1.0 - row.max(axis=1)
            )
    return (
        Matter(
            np.clip(rho, 0.0, 1.0).astype(np.float32),
            emission.astype(np.float32),
            np.array([each.opacity for each in found], np.float32),
            np.array([each.transmittance is not None for each in found], bool),
            through,
            mirrored,
        ),
        found,
    )


def _shader(material: bpy.types.Material) -> Socket | None:
    outputs = material_outputs.before(material)
    return material_outputs.source_before(material.node_tree, outputs[0]) if outputs else None


def _read(
    shader: Socket | None, transfer: Transfer
) -> tuple[NDArray[np.float64], float, NDArray[np.float64] | None]:
    """Return what a shader sends (81,) where it stops light, its opacity, which is how often it
    does, and its colour (3,) where it is clear."""
    dark = np.zeros(81)
    if shader is None:
        return dark, 1.0, None
    node = shader.node
    if node.type in ("MIX_SHADER", "ADD_SHADER"):
        inputs = node.inputs[1:3] if node.type == "MIX_SHADER" else node.inputs[:2]
        parts = [_read(nodes.source(each), transfer) for each in inputs]
        factor = _value(node.inputs[0], 0.5) if node.type == "MIX_SHADER" else 0.5
        shares = np.array([1.0 - factor, factor])
        stops = shares * [p[1] for p in parts]
        sent, opacity = stops[0] * parts[0][0] + stops[1] * parts[1][0], float(stops.sum())
        clear = parts[int(factor > 0.5)][2]
        if node.type == "ADD_SHADER":
            sent, opacity, clear = 2.0 * sent, min(1.0, 2.0 * opacity), None
        return sent / max(opacity, 1e-6), opacity, clear
    if node.type == "BSDF_TRANSPARENT":
        return dark, 1.0 - float(np.mean(node.inputs["Color"].default_value[:3])), None
    if node.type == "EMISSION":
        return _sent(node.inputs["Color"], node.inputs["Strength"], transfer), 1.0, None
    emission, opacity = dark, 1.0
    if (strength := node.inputs.get("Emission Strength")) is not None:
        emission = _sent(node.inputs["Emission Color"], strength, transfer)
    if (alpha := node.inputs.get("Alpha")) is not None:
        opacity = _alpha(alpha)
    weight = node.inputs.get("Transmission Weight")
    glassy = weight is not None and _value(weight, 0.0) > 0.5
    if node.type in CLEAR or glassy or groups.kind_of(node) == glazing.KIND:
        colour = node.inputs.get("Base Color") or node.inputs.get("Color")
        rgb = np.ones(3) if colour is None else np.array(colour.default_value[:3])
        return emission, opacity, rgb
    return emission, opacity, None


def _sent(colour: Socket, strength: Socket, transfer: Transfer) -> NDArray[np.float64]:
    """The spectrum (81,) of a radiance; a linked colour counts by its value or its image's mean."""
    size = _value(strength, 1.0)
    rgb = np.array(colour.default_value[:3], float)
    if (found := nodes.source(colour)) is not None:
        mean = base_color.mean_colour(found)
        rgb = rgb if mean is None else mean
    rgb = np.maximum(rgb, 0.0) * size
    if not rgb.any():
        return np.zeros(81)
    spectrum = lamp_spectrum(rgb * transfer.neutral, transfer.space)
    seen = transfer.S_out @ spectrum / transfer.neutral
    return spectrum * (rgb.sum() / max(float(seen.sum()), 1e-12))


def _alpha(socket: Socket) -> float:
    source = nodes.source(socket)
    image = getattr(source.node, "image", None) if source is not None else None
    if image is None or not image.size[0] or image.channels < 4:
        return _value(socket, 1.0)
    pixels = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    return float(pixels.reshape(-1, image.channels)[:, 3].mean())


def _value(socket: Socket, linked: float) -> float:
    if not socket.is_linked:
        return float(socket.default_value)
    source = nodes.source(socket)
    if source is None or source.node.type != "VALUE":
        return linked
    return float(source.default_value)
