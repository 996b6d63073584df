"""What making materials spectral comes to: all of it computed and checked, nothing written yet."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ..choices import OPEN
from ..progress import Progress, aside, run
from ..sky.light import SkyLight
from ..spectra.working_spaces import rec709_to_working
from ..transfer.assignment import Assignment
from ..transfer.choice import Choice, lowest_degree, sky_line, visibility_line
from ..transfer.unmeasured import expected_change
from ..transfer.white import estimate_white
from . import scene_lighting
from .bake import sky_exposure
from .blend_data import working_space
from .lights.lighting import Lights
from .materials import base_color, glass_and_metal, rgb_comparison, spectral_material
from .materials.record import Details, Result
from .materials.spectral_material import Surface
from .world import hdri, panorama
from .world.light_record import LightRecord
from .world.settings import Settings

NOTICED = 0.05
"""Share of the sky whose lack on a white wall is seen: CIEDE2000 1."""

CHOOSING = Progress(0.0, "models")

Assignments = Mapping[bpy.types.Material, Assignment]


@dataclass(frozen=True, eq=False)
class MaterialPlan:
    """What one material will show.

    ``texture`` (3, 81): what red, green and blue of its base color's texture reflect, None without
    one; ``comparison``: what RGB × RGB would give to its inputs.
    """

    material: bpy.types.Material
    given: Assignment
    surface: Surface
    texture: NDArray[np.float64] | None
    comparison: rgb_comparison.Values

    @property
    def result(self) -> Result:
        """What is reported of it."""
        assert self.surface.details.result is not None
        return self.surface.details.result


@dataclass(frozen=True, eq=False)
class Plan:
    """What is to be written, and all that it was decided by.

    ``light``: the World's sky; ``choice``: the matrices and their predicted errors; ``lights``:
    all that shines; ``towards_sun`` (3,): in the world, None without a sun; ``panes``: what becomes
    glass; ``record``: what is kept of the light.
    """

    world: bpy.types.World
    settings: Settings
    light: SkyLight
    choice: Choice
    lights: Lights
    towards_sun: NDArray[np.float64] | None
    materials: tuple[MaterialPlan, ...]
    panes: Assignments
    record: LightRecord


def check(given: Assignments) -> None:
    """Raise InputError for a material that cannot be changed or shows no metal it is given."""
    for material, one in given.items():
        spectral_material.check_editable(material)
        if one.metal is not None:
            glass_and_metal.check_metal(material)


def make(world: bpy.types.World | None, given: Assignments, settings: Settings) -> Plan:
    """Plan what materials will show, as `making` does."""
    return run(making(world, given, settings))


def making(
    world: bpy.types.World | None, given: Assignments, settings: Settings
) -> Generator[Progress, None, Plan]:
    """Plan what materials will show under a World's sky; no data-block changes.

    Raises InputError as `check`, `panorama.light_of` and `Settings.transfer` do.
    """
    check(given)
    surfaces = {material: one for material, one in given.items() if not one.faces}
    light = yield from panorama.analyzing(world, settings.sensors)
    assert world is not None  # else it had raised
    light, choice = yield from choosing(light, surfaces, settings)
    model = sky_line(choice, light)
    hidden = None
    wanted = settings.tolerance is not None or (settings.shadows == OPEN and not settings.traced)
    if wanted and bpy.context.scene.world == world:
        hidden = yield from sky_exposure.hiding(list(surfaces))
    if settings.tolerance is not None and hidden is not None:
        model += f"; {visibility_line(hidden, settings.tolerance)}"
    reflectances = {material: one.values for material, one in surfaces.items()}
    lights = yield from scene_lighting.finding(
        world, light, choice.transfer, settings, reflectances
    )
    towards_sun = scene_lighting.towards_sun(world, light, settings)
    values = _stacked(surfaces)
    reflected = yield from aside(CHOOSING, lights.reflected, values)
    measuring = yield from aside(CHOOSING, _measuring, choice, light, values)
    materials = []
    for k, (material, one) in enumerate(surfaces.items()):
        materials.append(
            _material(material, one, choice, lights, settings, k, reflected, measuring[k])
        )
        yield CHOOSING
    return Plan(
        world,
        settings,
        light,
        choice,
        lights,
        towards_sun,
        tuple(materials),
        {material: one for material, one in given.items() if one.faces},
        LightRecord.of(
            light.report(),
            caption=_caption(lights, hidden),
            settings=settings.plain(),
            space=choice.transfer.space,
            image=hdri.sky_of(world).name,
            model=model,
            spectrum=_restored(light, choice),
            level=lights.level(towards_sun).tolist(),
        ),
    )


def choosing(
    light: SkyLight, surfaces: Assignments, settings: Settings
) -> Generator[Progress, None, tuple[SkyLight, Choice]]:
    """Find the sky in the lowest degree that keeps to the tolerance, and the models of surfaces.

    Raises InputError as `Settings.transfer` does.
    """
    space = working_space.name()
    return (yield from aside(CHOOSING, _chosen, light, _stacked(surfaces), settings, space))


def _chosen(
    light: SkyLight, reflectances: NDArray[np.float64], settings: Settings, space: str
) -> tuple[SkyLight, Choice]:
    balance = ""
    if settings.white is None:
        transfer = settings.transfer(light, space=space)
        balance = estimate_white(light, transfer, settings.sun_elevation).line
        light = replace(light, signs=(*light.signs, balance)) if balance else light
    choice = settings.choose(light, reflectances, white_is_doubtful=bool(balance), space=space)
    if settings.tolerance is not None:
        to_rec709 = np.linalg.inv(rec709_to_working(choice.transfer.space))
        to_rec709 = to_rec709 @ choice.transfer.to_working
        light = lowest_degree(light, to_rec709, settings.tolerance)
    return light, choice


def _material(
    material: bpy.types.Material,
    given: Assignment,
    choice: Choice,
    lights: Lights,
    settings: Settings,
    k: int,
    reflected: dict[str, NDArray[np.float64]],
    measuring: float,
) -> MaterialPlan:
    """Plan one material, which stands k-th in the choice."""
    prediction = choice.prediction
    assert prediction is not None
    texture = base_color.varied(material, given)
    expected, bound = choice.error(k)
    result = Result(
        material=material.name,
        reflectance=given.name,
        model=choice.models[k],
        rgb_delta_E=float(prediction.rgb[k]),
        matrix_delta_E=expected,
        bound=bound,
        colour=tuple(prediction.colour[k].tolist()),
        out_of_gamut=bool(prediction.out_of_gamut[k]),
        line=choice.line(k, f"{material.name} ({given.name})"),
        unknown=prediction.unknown,
        measuring=float(measuring) if given.estimated and np.isfinite(measuring) else None,
    )
    followed = given.estimated or texture is not None
    details = Details(
        result,
        values=tuple(given.values.tolist()),
        measured=given.measured,
        source=tuple(base_color.source(material)) if followed else None,
        white=lights.white_luminance,
        unit=given.unit,
        file=given.source,
        behind=given.behind,
    )
    surface = Surface(
        choice.matrices[k],
        given.name,
        given.hash,
        details,
        reflected={light: rgb[k] for light, rgb in reflected.items()},
        gloss=settings.gloss or given.metal is not None,
        textured=texture is not None,
    )
    comparison = dict(rgb_comparison.surface(lights, given.values))
    if texture is not None:
        comparison |= rgb_comparison.texture(lights, texture, given.values)
    return MaterialPlan(material, given, surface, texture, comparison)


def _measuring(
    choice: Choice, light: SkyLight, reflectances: NDArray[np.float64]
) -> NDArray[np.float64]:
    """By how much a measurement would change each of these (m, 81), NaN where nothing is known."""
    if choice.prediction is None or not choice.prediction.known:
        return np.full(len(reflectances), np.nan)
    return expected_change(choice.transfer, reflectances, light.faces)


def _caption(lights: Lights, hidden: float | None) -> str:
    """What a picture must say, of an interior under the open sky too.

    ``hidden``: the share of the sky that geometry keeps from the materials, None where unknown.
    """
    if lights.occlusion != OPEN or lights.traced or hidden is None or hidden < NOTICED:
        return lights.caption
    share = f"{100 * hidden:.0f} % of the sky is hidden from these materials and still lights them"
    return f"{lights.caption}; {share}: they are too bright, most of all indoors"


def _stacked(surfaces: Assignments) -> NDArray[np.float64]:
    """The reflectances of surfaces, (m, 81)."""
    return np.array([one.values for one in surfaces.values()]).reshape(-1, 81)


def _restored(light: SkyLight, choice: Choice) -> list[float]:
    """The spectrum (81,) of the sky's light on level ground, as pictures show it."""
    transfer = choice.transfer
    return (transfer.restoration @ transfer.unbalanced(light.faces[0])).tolist()
