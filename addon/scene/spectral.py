"""The main job inside Blender: a World's sky and reflectances in, spectral materials out.

The panel, the command line and scripts all call these functions.
"""

from __future__ import annotations

from collections.abc import Collection, Generator, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..sky.light import SkyLight, analyse
from ..sky.panorama import from_pixels, read_panorama
from ..spectra import sensitivities
from ..spectra.reflectance import reflectance_hash
from ..spectra.working_spaces import rec709_to_working
from ..transfer.choice import (
    SIMPLEST,
    Choice,
    choose_with,
    doubt,
    lowest_degree,
    sky_line,
    visibility_line,
)
from ..transfer.matrices import Transfer, transfer
from ..transfer.white import AUTO, estimate_white, settle_white
from . import bake as sky_bake
from . import bounce, lights, materials, openness, optics, sky_light, textures, working_space
from . import settings as world_settings
from . import world as worlds


@dataclass(frozen=True)
class Settings:
    """What made the HDRI's numbers, the model of skylight, and how exact it has to be.

    The first four are options of `transfer`; ``basis`` may be `SIMPLEST` too. With a
    ``tolerance`` [CIEDE2000] each material gets the least model that keeps to it, and the sky the
    lowest degree.
    """

    basis: str = "atmosphere"
    camera: str | None = None
    white: tuple[float, float, float] | None = None
    sun_elevation: float | None = None
    tolerance: float | None = None
    sun: bool = True
    """Whether the HDRI's sun shines on materials, by a lamp."""
    ground: str = AUTO
    """The light from below: one of `transfer.ground.CHOICES`, or the modelled ground where geometry
    lies under the materials, else the HDRI's."""
    occlusion: str = lights.OPEN
    """Shadows of the sky: `lights.OPEN` for none, `lights.DOME`, or `lights.BAKED`."""
    bounce: bool = False
    """Whether baked light holds what one bounce between materials brings."""
    gloss: bool = False
    """Whether materials keep gloss and metal over their measured base."""

    def transfer(self, light: SkyLight | None = None, basis: str | None = None) -> Transfer:
        """Return the map from reflectances to matrices of the open file's working space.

        ``light``: the sky, whose sun and colour the basis may be chosen by. ``basis``: another one
        than the settings', which are `atmosphere` as long as the simplest is not found.
        """
        if basis is None:
            basis = "atmosphere" if self.basis == SIMPLEST else self.basis
        return transfer(
            basis,
            camera=self.camera,
            white=self.white,
            space=working_space.name(),
            sun_elevation=light.sun_elevation(self.sun_elevation) if light else self.sun_elevation,
            sky_rgb=None if light is None else light.faces,
        )

    @property
    def sensors(self) -> NDArray[np.float64]:
        """What made the HDRI's numbers as Blender has them, (3, 81), white balance and all."""
        if self.camera is None:
            S = sensitivities.observer(working_space.name())
        else:
            S = sensitivities.camera(self.camera)
        return S if self.white is None else S / np.array(self.white)[:, None]

    def choose(
        self, light: SkyLight, reflectances: NDArray[np.float64], doubted: str = ""
    ) -> Choice:
        """Return the models of reflectances (m, 81) under a sky; ``doubted``: `choice.doubt`."""
        # A camera's World was developed by one basis already: its materials keep to that.
        basis = "atmosphere" if self.camera and self.basis == SIMPLEST else self.basis
        return choose_with(
            lambda name: self.transfer(light, name),
            basis,
            reflectances,
            light.faces,
            light.sun_elevation(self.sun_elevation),
            self.tolerance,
            light.outside.foreign,
            doubted,
        )


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
    read_panorama(path)
    settings.transfer()
    worlds.set_sky(scene, path, raw=settings.camera is not None)
    return develop(scene, settings)


def develop(scene: bpy.types.Scene, settings: Settings) -> bpy.types.World:
    """Return a scene's World; where its HDRI is a camera's raw, give it one that shows colours.

    Raises InputError as `world.develop` does, and for an unknown camera.
    """
    if settings.camera is None:
        return worlds.develop(scene, np.eye(3))
    return worlds.develop(scene, settings.transfer(_analyse(scene.world, settings)).to_working)


def make_spectral(
    world: bpy.types.World | None,
    reflectances: Mapping[bpy.types.Material, tuple[str, NDArray[np.float64]]],
    settings: Settings,
    metals: Mapping[bpy.types.Material, tuple[NDArray[np.float64], NDArray[np.float64]]]
    | None = None,
    measured: Mapping[bpy.types.Material, tuple[float, float]] | None = None,
) -> tuple[SkyLight, list[Result]]:
    """Give materials their reflectances (name, values (81,)) under a World's sky.

    ``metals``: n and k (81,) of those whose reflectance is a metal's; they keep their gloss.
    ``measured``: from where to where [nm] reflectances were measured, kept for those who look.
    Everything is computed and checked before the first material changes. Raises InputError as
    `world.sky_of`, `world.pixels_of`, `sky.panorama.from_pixels`, `materials.apply` and
    `Settings.transfer` do.
    """
    for material in reflectances:
        materials.check_editable(material)
    light = _analyse(world, settings)
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
        hidden = openness.hidden_share(bpy.context.scene, list(reflectances))
        model += "" if hidden is None else f"; {visibility_line(hidden, settings.tolerance)}"
    found = _lights(world, light, choice.transfer, settings, reflectances)
    world_settings.store(world, _plain(settings))
    lights.install(world, found)
    description = {
        **light.report(),
        "caption": found.caption,
        "settings": _plain(settings),
        "space": choice.transfer.space,
        "image": worlds.sky_of(world).image.name,
        "model": model,
        "spectrum": _restored(light, choice.transfer),
    }
    prediction = choice.prediction
    assert prediction is not None
    results = []
    reflected = found.reflected(values)
    textured = {
        material: varied
        for material, (name, rho) in reflectances.items()
        if (varied := textures.varied(material, name, rho)) is not None
    }
    for k, (material, (name, rho)) in enumerate(reflectances.items()):
        metal = (metals or {}).get(material) or optics.metal_of(material)
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
        materials.apply(
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
            },
            reflected={
                **{name: rgb[k] for name, rgb in reflected.items()},
                **found.bounced(material.name_full, rho),
            },
            gloss=settings.gloss or metal is not None,
            textured=material in textured,
        )
        if metal is not None:
            optics.keep_metal(material, *metal)
        if material in textured:
            materials.set_texture(material, textures.values(found, textured[material]))
        results.append(result)
    for material in set(materials.managed_materials(world)) - set(reflectances):
        managed = materials.managed(material)
        assert managed is not None
        name, rho = _kept(material)
        given = {**found.reflected(rho), **found.bounced(material.name_full, rho)}
        materials.update(material, managed.matrix, given)
        if (varied := textures.varied(material, name, rho)) is not None:
            materials.set_texture(material, textures.values(found, varied))
    warned = lights.refresh(world)
    if found.features.bounce and bounce.is_stale(_towards_sun(world, light, settings)):
        warned.append("the sun has moved since its bounce was baked: bake again")
    for material in reflectances:
        if missing := materials.look_of(material).left_out:
            warned.append(f"{material.name}: not shown while it is spectral: {', '.join(missing)}")
    warned += optics.refresh(lights.scenes_of(world), light, choice.transfer)
    sky_light.describe(world, {**description, "lights": [*found.lines, *warned]})
    return light, results


def _lights(
    world: bpy.types.World,
    light: SkyLight,
    transfer: Transfer,
    settings: Settings,
    reflectances: Mapping[bpy.types.Material, tuple[str, NDArray[np.float64]]],
) -> lights.Lights:
    """Return the lights of a World, its ground chosen."""
    scene = next(iter(lights.scenes_of(world)), None)
    known = {m: rho for m, (_, rho) in reflectances.items()}
    for material in materials.managed_materials(world):
        if material not in known:
            known[material] = _kept(material)[1]
    ground, reflectance = settings.ground, None
    baked = settings.occlusion == lights.BAKED
    if ground == AUTO and (baked or scene is None):
        ground = "hdri"  # of which a bake knows how much geometry hides
    elif ground in (AUTO, "modelled") and scene is not None:
        covered, below = openness.ground_below(scene, list(known))
        reflectance = known.get(below) if below is not None else None
        if ground == AUTO:
            ground = "modelled" if covered else "hdri"
    return lights.find(
        light,
        transfer,
        scene,
        np.array(list(known.values())).reshape(-1, 81),
        with_sun=settings.sun,
        ground=ground,
        ground_reflectance=reflectance,
        occlusion=settings.occlusion,
        neighbours=_neighbours(known) if baked and settings.bounce else None,
    )


def _neighbours(
    known: Mapping[bpy.types.Material, NDArray[np.float64]],
) -> dict[str, NDArray[np.float64]]:
    """Return of each material's name what its two kinds of neighbours reflect, (2, 81)."""
    rho = {material.name_full: values for material, values in known.items()}
    dark = np.zeros(81)
    return {
        name: np.stack(
            [
                rho.get(by.first, dark),
                sum((part * rho.get(other, dark) for other, part in by.others.items()), dark),
            ]
        )
        for name, by in bounce.neighbours().items()
    }


def _restored(light: SkyLight, transfer: Transfer) -> list[float]:
    """Return the spectrum (81,) of the sky's light on level ground, as pictures show it."""
    return (transfer.restoration @ transfer.unbalanced(light.faces[0])).tolist()


def _kept(material: bpy.types.Material) -> tuple[str, NDArray[np.float64]]:
    """Return the reflectance that a managed material was given; InputError for another."""
    managed = materials.managed(material)
    if managed is None:
        raise InputError(f'material "{material.name}"', "has no reflectance yet", "apply one first")
    return managed.reflectance_name, np.array(managed.extra["values"])


def _measured(material: bpy.types.Material, rho: NDArray[np.float64]) -> tuple[float, float] | None:
    """Return from where to where [nm] the reflectance that a material has already was measured."""
    managed = materials.managed(material)
    if managed is None or managed.reflectance_hash != reflectance_hash(rho):
        return None
    return managed.extra.get("measured")


def bake(
    world: bpy.types.World,
    settings: Settings,
    objects: Collection[bpy.types.Object] | None = None,
    **options: Any,
) -> Generator[sky_bake.Progress, None, list[str]]:
    """Bake what objects see of the sky, and bounces where wanted, yielding how far it is.

    Of the active scene, None for all its managed objects; ``options`` as `bake.bake` has them.
    Returns lines to say; `update` then lights it.
    """
    lines = []
    work = sky_bake.bake(objects, **options)
    share = 0.7 if settings.bounce else 1.0
    while True:
        try:
            progress = next(work)
        except StopIteration as end:
            lines += end.value
            break
        yield sky_bake.Progress(share * progress.done, progress.line)
    if settings.bounce:
        for done in bounce.bounce(_towards_sun(world, _analyse(world, settings), settings)):
            yield sky_bake.Progress(share + (1.0 - share) * done, "one bounce")
    return lines


def _towards_sun(
    world: bpy.types.World, light: SkyLight, settings: Settings
) -> NDArray[np.float64] | None:
    """Return where a World's sun stands, (3,), None without one that shines."""
    sun = light.sun if settings.sun else None
    return None if sun is None else worlds.in_world(worlds.sky_of(world), sun.direction)


def with_estimated_white(world: bpy.types.World | None, settings: Settings) -> tuple[Settings, str]:
    """Return settings with the white balance that a World's sky seems to have, and a line on it."""
    light = _analyse(world, settings)
    white, line = settle_white(
        AUTO, lambda: estimate_white(light, settings.transfer(light), settings.sun_elevation)
    )
    return replace(settings, white=white), line


def in_scene(scene: bpy.types.Scene) -> list[bpy.types.Material]:
    """Return the managed materials on a scene's objects or under its World, each once."""
    found = [m for m in materials.materials_of(scene.objects) if materials.is_managed(m)]
    under = materials.managed_materials(scene.world) if scene.world else []
    return list(dict.fromkeys([*found, *under]))


def update(
    world: bpy.types.World | None,
    settings: Settings,
    chosen: Iterable[bpy.types.Material] | None = None,
) -> tuple[SkyLight, list[Result]]:
    """Bring managed materials (None: all under this World's sky) up to date with the World.

    Their reflectances come from the blend file itself. Raises as `make_spectral` does.
    """
    chosen = materials.managed_materials(world) if chosen is None else chosen
    return make_spectral(world, {material: _kept(material) for material in chosen}, settings)


_NONE: NDArray[np.float64] = np.empty((0, 81))


def _analyse(world: bpy.types.World | None, settings: Settings) -> SkyLight:
    image = worlds.sky_of(world).image
    panorama = from_pixels(worlds.pixels_of(image), f'image "{image.name}"')
    return analyse(panorama, S_in=settings.sensors)


def _plain(record: Any) -> dict[str, Any]:
    """Return a dataclass as what blend data can hold: no None."""
    return {key: value for key, value in asdict(record).items() if value is not None}
