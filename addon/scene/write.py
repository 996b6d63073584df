"""Writing a plan into the blend file: lights first, then each material, then what was found."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace

import bpy

from ..choices import AUTO, BAKED
from ..errors import InputError
from ..grouping import grouped
from ..progress import Progress
from .bake import scene_bake, traced_colors
from .bake.light import shining_of
from .lights import lighting
from .materials import (
    base_color,
    eligibility,
    glass_and_metal,
    merge_groups,
    rgb_comparison,
    saved_settings,
    spectral_material,
    swatch,
)
from .materials.assigned import assigned
from .materials.record import Result
from .plan import MaterialPlan, Plan
from .world import light_group, settings, view_transform


def write(plan: Plan) -> Generator[Progress, None, list[Result]]:
    """Write a plan, yielding after each material.

    Whoever closes the generator leaves those before it whole, lit and described.
    """
    yield Progress(0.0, "the sky")
    rgb_comparison.show(rgb_comparison.SPECTRAL)
    settings.store(plan.world, plan.settings)
    if plan.materials or spectral_material.managed_materials(plan.world):
        lighting.install(plan.world, plan.lights)  # glass alone needs no lamps
    group = light_group.ensure(plan.world)
    written: list[MaterialPlan] = []
    try:
        for one in plan.materials:
            _write_material(plan, one, group)
            written.append(one)
            yield Progress(len(written) / len(plan.materials), one.material.name)
        for material, pane in plan.panes.items():
            glass_and_metal.glaze(material, pane)
    finally:
        _finish(plan, [one.material for one in written])
    yield from _coloring(plan)
    return [one.result for one in written]


def _write_material(plan: Plan, one: MaterialPlan, group: bpy.types.NodeTree) -> None:
    material = one.material
    if one.given.metal is None and glass_and_metal.metal_of(material) is not None:
        spectral_material.remove(material, stays=group)  # with the metal's colors
    spectral_material.apply(material, plan.world, one.surface, group)
    if one.given.metal is not None:
        glass_and_metal.keep_metal(material, *one.given.metal)
    if one.texture is not None:
        values = base_color.values(plan.lights, one.texture, one.given.values)
        spectral_material.set_texture(material, values)
    shown = swatch.shown(one.result.colour, plan.lights.white_luminance)
    saved_settings.show_colour(material, shown)
    rgb_comparison.keep(material, one.comparison)


def _finish(plan: Plan, fresh: list[bpy.types.Material]) -> None:
    """Let everything else under the World follow its light, and keep what was found."""
    world, scenes = plan.world, lighting.scenes_of(plan.world)
    warnings = _follow(plan, fresh) + _of_lamps(plan)
    warnings += lighting.refresh(world)
    warnings += _not_shown(fresh) + _not_lit(plan) + _not_traced(plan)
    warnings += glass_and_metal.refresh(scenes, plan.light, plan.choice.transfer)
    for scene in scenes:
        warnings += view_transform.refresh(scene, plan.record.level)
    record = replace(
        plan.record, lights=tuple(plan.lights.lines), warnings=tuple(dict.fromkeys(warnings))
    )
    light_group.keep_record(world, record)
    merge_groups.merge()


def relighting(plan: Plan) -> Generator[Progress, None, list[str]]:
    """Cast a plan's light on what is baked in the active scene; returns lines to say."""
    scene = bpy.context.scene
    if plan.lights.occlusion != BAKED or scene.world != plan.world or not scene_bake.baked():
        return []
    shining = yield from shining_of(plan.world, plan.lights, scene)
    return (yield from scene_bake.relighting(shining))


def _coloring(plan: Plan) -> Generator[Progress, None, None]:
    """Give materials whose light Cycles traces their colors in that light, in the active scene."""
    scene = bpy.context.scene
    if not plan.lights.traced or scene.world != plan.world:
        return
    shining = yield from shining_of(plan.world, plan.lights.with_sun, scene)
    colors = yield from traced_colors.finding(shining, plan.lights.transfer.space)
    for material in spectral_material.managed_materials(plan.world):
        if material.name_full in colors and material.is_editable:
            spectral_material.set_color(material, colors[material.name_full])


def _follow(plan: Plan, fresh: list[bpy.types.Material]) -> list[str]:
    """Give materials that the World lit before what they reflect of its new light."""
    lines = []
    lights = plan.lights
    for material in set(spectral_material.managed_materials(plan.world)) - set(fresh):
        try:
            spectral_material.check_editable(material)
        except InputError as error:
            lines.append(f"skipped: {error}")
            continue
        managed, given = spectral_material.managed(material), assigned(material)
        assert managed is not None
        if given is None:
            continue  # of the first version, which kept no values
        spectral_material.update(material, managed.matrix, lights.reflected(given.values))
        if (texture := base_color.varied(material, given)) is not None:
            values = base_color.values(lights, texture, given.values)
            spectral_material.set_texture(material, values)
    return lines


def _of_lamps(plan: Plan) -> list[str]:
    """Lines on what of lamps is not carried over."""
    lamps = plan.lights.lamps
    if lamps is None:
        return []
    linking = [(one.lamp.name, one.lamp.light_linking) for one in lamps.shining]
    linked = [name for name, own in linking if own.receiver_collection or own.blocker_collection]
    if plan.lights.occlusion != BAKED or not linked:
        return list(lamps.left_out)
    why = "its light linking holds for direct light; what surfaces reflect of it goes everywhere"
    return [*lamps.left_out, *grouped(((name, why) for name in linked), "lamp")]


def _not_shown(fresh: list[bpy.types.Material]) -> list[str]:
    """Lines on materials of whose look something is not carried over."""
    missing = [(material.name, spectral_material.look_of(material).left_out) for material in fresh]
    return grouped(
        (name, f"not shown while spectral: {', '.join(parts)}") for name, parts in missing if parts
    )


def _not_lit(plan: Plan) -> list[str]:
    """Lines on materials whose light reaches nothing spectral, for only a bake carries it."""
    if plan.lights.occlusion == BAKED or plan.lights.traced:
        return []
    shown = (m for scene in lighting.scenes_of(plan.world) for m in eligibility.materials_of(scene))
    why = "emits light that reaches spectral materials only with all light (baked)"
    return grouped((m.name, why) for m in dict.fromkeys(shown) if eligibility.emits(m))


def _not_traced(plan: Plan) -> list[str]:
    """A line on a ground that is chosen where Cycles traces the HDRI."""
    if not plan.settings.traced or plan.settings.ground in (AUTO, "hdri"):
        return []
    return ["traced light from below is the HDRI's, not that of the chosen ground"]
