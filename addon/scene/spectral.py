"""The main job inside Blender: a World's sky and reflectances in, spectral materials out.

The panel, the command line and scripts all call these functions.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..progress import Progress, run
from ..sky.light import SkyLight
from ..spectra.reflectance import reflectance_hash
from ..spectra.working_spaces import rec709_to_working
from ..transfer.choice import doubt, lowest_degree, sky_line, visibility_line
from ..transfer.matrices import Transfer
from ..transfer.white import AUTO, estimate_white, settle_white
from . import scene_lighting
from .bake import interreflection, sky_exposure
from .lights import lighting
from .materials import (
    base_color,
    glass_and_metal,
    merge_groups,
    rgb_comparison,
    saved_settings,
    spectral_material,
    swatch,
)
from .world import hdri as worlds
from .world import light_group, panorama, view_transform
from .world.settings import Settings, store

Metals = Mapping[bpy.types.Material, tuple[NDArray[np.float64], NDArray[np.float64]]]
Glazings = Mapping[bpy.types.Material, tuple[str, NDArray[np.float64], int]]


@dataclass(frozen=True)
class Result:
    """What one material was given, and what is predicted of it under the sky.

    ``model``: one of `choice.MODELS`; expected CIEDE2000 of today's way and of the model, and the
    model's to count on (``bound``), NaN where unknown; ``line``: all that in words.
    """

    material: str
    reflectance: str
    model: str
    rgb_delta_E: float
    matrix_delta_E: float
    bound: float
    colour: tuple[float, float, float]
    out_of_gamut: bool
    line: str


def set_sky(scene: bpy.types.Scene, path: str | Path, settings: Settings) -> bpy.types.World:
    """Light a scene by an HDRI file, developed where it is a camera's raw.

    Raises InputError for a file that is no sky (the scene is untouched) and for wrong settings.
    """
    settings.transfer()
    worlds.set_sky(scene, path, raw=settings.camera is not None)
    return develop(scene, settings)


def develop(scene: bpy.types.Scene, settings: Settings) -> bpy.types.World:
    """Return a scene's World; where its HDRI is a camera's raw, give it one that shows colours.

    Raises InputError as `hdri.develop` does, and for an unknown camera.
    """
    if settings.camera is None:
        return worlds.develop(scene, np.eye(3))
    return worlds.develop(scene, settings.transfer(analysed(scene.world, settings)).to_working)


def make_spectral(
    world: bpy.types.World | None,
    reflectances: Mapping[bpy.types.Material, tuple[str, NDArray[np.float64]]],
    settings: Settings,
    metals: Metals | None = None,
    measured: Mapping[bpy.types.Material, tuple[float, float]] | None = None,
    glazings: Glazings | None = None,
) -> tuple[SkyLight, list[Result]]:
    """Give materials their reflectances (name, values (81,)) under a World's sky.

    ``metals``: n and k (81,) of those whose reflectance is a metal's; they keep their gloss.
    ``measured``: from where to where [nm] reflectances were measured, kept for those who look.
    ``glazings``: what becomes glass, as `glass_and_metal.glaze` has it: name, transmittance, faces.
    Everything is computed and checked before the first material changes. Raises InputError as
    `panorama.light_of`, `spectral_material.apply` and `Settings.transfer` do.
    """
    return run(making_spectral(world, reflectances, settings, metals, measured, glazings))


def making_spectral(
    world: bpy.types.World | None,
    reflectances: Mapping[bpy.types.Material, tuple[str, NDArray[np.float64]]],
    settings: Settings,
    metals: Metals | None = None,
    measured: Mapping[bpy.types.Material, tuple[float, float]] | None = None,
    glazings: Glazings | None = None,
) -> Generator[Progress, None, tuple[SkyLight, list[Result]]]:
    """Do as `make_spectral` does, yielding after each material.

    Whoever closes the generator leaves those before it whole, lit and described.
    """
    for material in (*reflectances, *(metals or ()), *(glazings or ())):
        spectral_material.check_editable(material)
    for material in metals or ():
        glass_and_metal.check_metal(material)
    light = analysed(world, settings)
    values = np.stack([rho for _, rho in reflectances.values()]) if reflectances else _NONE
    tint = ""
    if settings.white is None:
        tint = estimate_white(light, settings.transfer(light), settings.sun_elevation).line
        light = replace(light, signs=(*light.signs, tint)) if tint else light
    choice = settings.choose(light, values, doubt(light, tinted=bool(tint)))
    if settings.tolerance is not None:
        to_rec709 = np.linalg.inv(rec709_to_working(choice.transfer.space))
        to_rec709 = to_rec709 @ choice.transfer.to_working
        light = lowest_degree(light, to_rec709, settings.tolerance)
    model = sky_line(choice, light)
    if settings.tolerance is not None and bpy.context.scene.world == world:
        hidden = sky_exposure.hidden_share(bpy.context.scene, list(reflectances))
        model += "" if hidden is None else f"; {visibility_line(hidden, settings.tolerance)}"
    given = {material: rho for material, (_, rho) in reflectances.items()}
    found = scene_lighting.find(world, light, choice.transfer, settings, given)
    yield Progress(0.0, "the sky")
    rgb_comparison.show(False)
    sun = scene_lighting.towards_sun(world, light, settings)
    store(world, _plain(settings))
    if reflectances or spectral_material.managed_materials(world):
        lighting.install(world, found)  # glass alone needs no lamps
    description = {
        **light.report(),
        "caption": found.caption,
        "settings": _plain(settings),
        "space": choice.transfer.space,
        "image": worlds.sky_of(world).name,
        "model": model,
        "spectrum": _restored(light, choice.transfer),
        "level": found.level(sun).tolist(),
    }
    prediction = choice.prediction
    assert prediction is not None
    results = []
    group = light_group.ensure(world)
    white = found.white_luminance
    reflected = found.reflected(values)
    textured = {
        material: varied
        for material, (name, rho) in reflectances.items()
        if (varied := base_color.varied(material, name, rho)) is not None
    }
    try:
        for k, (material, (name, rho)) in enumerate(reflectances.items()):
            metal = (metals or {}).get(material) or _metal(material, rho)
            if metal is None and glass_and_metal.metal_of(material) is not None:
                spectral_material.remove(material, stays=group)  # with the metal's colours
            expected, bound = choice.error(k)
            result = Result(
                material=material.name,
                reflectance=name,
                model=choice.models[k],
                rgb_delta_E=float(prediction.rgb[k]),
                matrix_delta_E=expected,
                bound=bound,
                colour=tuple(prediction.colour[k]),
                out_of_gamut=bool(prediction.out_of_gamut[k]),
                line=choice.line(k, f"{material.name} ({name})"),
            )
            spectral_material.apply(
                material,
                world,
                choice.matrices[k],
                reflectance_name=name,
                reflectance_hash=reflectance_hash(rho),
                extra={
                    **_plain(result),
                    "unknown": prediction.unknown,
                    "values": rho.tolist(),
                    "measured": (measured or {}).get(material) or _measured(material, rho),
                    "source": base_color.source(material)
                    if material in textured or name == base_color.ESTIMATED
                    else None,
                    "white": white,
                },
                reflected={
                    **{name: rgb[k] for name, rgb in reflected.items()},
                    **found.bounced(material.name_full, rho),
                },
                gloss=settings.gloss or metal is not None,
                textured=material in textured,
                group=group,
            )
            if metal is not None:
                glass_and_metal.keep_metal(material, *metal)
            if material in textured:
                spectral_material.set_texture(
                    material, base_color.values(found, textured[material])
                )
            saved_settings.show_colour(material, swatch.shown(result.colour, white))
            rgb_comparison.keep(material, rgb_comparison.surface(found, material.name_full, rho))
            if material in textured:
                rgb_comparison.keep(material, rgb_comparison.texture(found, textured[material]))
            results.append(result)
            yield Progress((k + 1) / len(reflectances), material.name)
        for material, pane in (glazings or {}).items():
            glass_and_metal.glaze(material, *pane)
    finally:
        warned = _relight(world, found, list(reflectances)[: len(results)])
        if found.features.bounce and interreflection.is_stale(sun):
            warned.append("the sun has moved since its bounce was baked: bake again")
        warned += glass_and_metal.refresh(lighting.scenes_of(world), light, choice.transfer)
        for scene in lighting.scenes_of(world):
            warned += view_transform.refresh(scene, description["level"])
        light_group.describe(world, {**description, "lights": [*found.lines, *warned]})
        merge_groups.merge()
    return light, results


def _relight(
    world: bpy.types.World, found: lighting.Lights, fresh: list[bpy.types.Material]
) -> list[str]:
    """Let what a World already lit follow its new light, all but the fresh; return warnings."""
    lines = []
    for material in set(spectral_material.managed_materials(world)) - set(fresh):
        try:
            spectral_material.check_editable(material)
        except InputError as error:
            lines.append(f"skipped: {error}")
            continue
        managed = spectral_material.managed(material)
        assert managed is not None
        name, rho = spectral_material.kept(material)
        given = {**found.reflected(rho), **found.bounced(material.name_full, rho)}
        spectral_material.update(material, managed.matrix, given)
        if (varied := base_color.varied(material, name, rho)) is not None:
            spectral_material.set_texture(material, base_color.values(found, varied))
    lines += lighting.refresh(world)
    return lines + [
        f"{material.name}: not shown while it is spectral: {', '.join(missing)}"
        for material in fresh
        if (missing := spectral_material.look_of(material).left_out)
    ]


def _restored(light: SkyLight, transfer: Transfer) -> list[float]:
    """Return the spectrum (81,) of the sky's light on level ground, as pictures show it."""
    return (transfer.restoration @ transfer.unbalanced(light.faces[0])).tolist()


def _metal(material: bpy.types.Material, rho: NDArray[np.float64]) -> Any:
    """Return n and k of the metal whose reflectance a material has already, None for another."""
    managed = spectral_material.managed(material)
    if managed is None or managed.reflectance_hash != reflectance_hash(rho):
        return None
    return glass_and_metal.metal_of(material)


def _measured(material: bpy.types.Material, rho: NDArray[np.float64]) -> tuple[float, float] | None:
    """Return from where to where [nm] the reflectance that a material has already was measured."""
    managed = spectral_material.managed(material)
    if managed is None or managed.reflectance_hash != reflectance_hash(rho):
        return None
    return managed.extra.get("measured")


def with_estimated_white(world: bpy.types.World | None, settings: Settings) -> tuple[Settings, str]:
    """Return settings with the white balance that a World's sky seems to have, and a line on it."""
    light = analysed(world, settings)
    white, line = settle_white(
        AUTO, lambda: estimate_white(light, settings.transfer(light), settings.sun_elevation)
    )
    return replace(settings, white=white), line


def in_scene(scene: bpy.types.Scene) -> list[bpy.types.Material]:
    """Return the managed materials on a scene's objects or under its World, each once."""
    found = [
        m for m in spectral_material.materials_of(scene.objects) if spectral_material.is_managed(m)
    ]
    under = spectral_material.managed_materials(scene.world) if scene.world else []
    return list(dict.fromkeys([*found, *under]))


def update(
    world: bpy.types.World | None,
    settings: Settings,
    chosen: Iterable[bpy.types.Material] | None = None,
) -> tuple[SkyLight, list[Result]]:
    """Bring managed materials (None: all under this World's sky) up to date with the World.

    Their reflectances come from the blend file itself. Raises as `make_spectral` does.
    """
    chosen = spectral_material.managed_materials(world) if chosen is None else chosen
    return make_spectral(world, {each: spectral_material.kept(each) for each in chosen}, settings)


_NONE: NDArray[np.float64] = np.empty((0, 81))


def analysed(world: bpy.types.World | None, settings: Settings) -> SkyLight:
    """Return what a World's sky is; raises InputError as `make_spectral` does for it."""
    return panorama.light_of(world, settings.sensors)


def _plain(record: Any) -> dict[str, Any]:
    """Return a dataclass as what blend data can hold: no None."""
    return {key: value for key, value in asdict(record).items() if value is not None}
