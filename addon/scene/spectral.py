"""The main job inside Blender: a World's sky and reflectances in, spectral materials out.

The panel, the command line and scripts all call these functions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..sky.light import SkyLight, analyse
from ..sky.panorama import from_pixels, read_panorama
from ..spectra.reflectance import reflectance_hash
from ..transfer.matrices import Transfer, transfer
from ..transfer.prediction import predict
from . import materials, sky_light, working_space
from . import settings as world_settings
from . import world as worlds


@dataclass(frozen=True)
class Settings:
    """What made the HDRI's numbers, and the model of skylight: options of `transfer`."""

    basis: str = "rayleigh"
    camera: str | None = None
    white: tuple[float, float, float] | None = None
    sun_elevation: float | None = None

    def transfer(self, light: SkyLight | None = None) -> Transfer:
        """Return the map from reflectances to matrices of the open file's working space.

        ``light``: the sky, whose sun and colour the basis may be chosen by.
        """
        elevation = self.sun_elevation
        if elevation is None and light is not None and light.sun is not None:
            elevation = light.sun.elevation
        return transfer(
            self.basis,
            camera=self.camera,
            white=self.white,
            space=working_space.name(),
            sun_elevation=elevation,
            sky_rgb=None if light is None else light.faces,
        )


@dataclass(frozen=True)
class Result:
    """What one material was given: names, predicted CIEDE2000, and its colour under the sky."""

    material: str
    reflectance: str
    rgb_delta_E: float
    matrix_delta_E: float
    colour: tuple[float, float, float]
    out_of_gamut: bool

    @property
    def line(self) -> str:
        """One line for a person."""
        text = (
            f"{self.material}: {self.reflectance}. RGB is off by ΔE {self.rgb_delta_E:.1f}, "
            f"spectral by {self.matrix_delta_E:.1f}"
        )
        return text + ("; out of gamut: Blender clamps it" if self.out_of_gamut else "")


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
    return worlds.develop(scene, settings.transfer(_analyse(scene.world)).to_working)


def make_spectral(
    world: bpy.types.World | None,
    reflectances: Mapping[bpy.types.Material, tuple[str, NDArray[np.float64]]],
    settings: Settings,
) -> tuple[SkyLight, list[Result]]:
    """Give materials their reflectances (name, values (81,)) under a World's sky.

    Everything is computed and checked before the first material changes. Raises InputError as
    `world.sky_of`, `world.pixels_of`, `sky.panorama.from_pixels`, `materials.apply` and
    `Settings.transfer` do.
    """
    for material in reflectances:
        materials.check_editable(material)
    light = _analyse(world)
    mapping = settings.transfer(light)
    values = np.stack([rho for _, rho in reflectances.values()]) if reflectances else _NONE
    prediction = predict(mapping, values, light.faces)
    world_settings.store(world, _plain(settings))
    sky_light.set_coefficients(world, light.fit.coefficients)
    sky_light.describe(
        world,
        {
            **light.report(),
            "settings": _plain(settings),
            "space": mapping.space,
            "image": worlds.sky_of(world).image.name,
        },
    )
    results = []
    for k, (material, (name, rho)) in enumerate(reflectances.items()):
        result = Result(
            material=material.name,
            reflectance=name,
            rgb_delta_E=float(prediction.rgb[k]),
            matrix_delta_E=float(prediction.matrix[k]),
            colour=tuple(prediction.colour[k]),
            out_of_gamut=bool(prediction.out_of_gamut[k]),
        )
        materials.apply(
            material,
            world,
            mapping.matrices(rho),
            reflectance_name=name,
            reflectance_hash=reflectance_hash(rho),
            extra={**_plain(result), "values": rho.tolist()},
        )
        results.append(result)
    return light, results


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
    kept = {}
    for material in materials.managed_materials(world) if chosen is None else chosen:
        managed = materials.managed(material)
        if managed is None:
            raise InputError(
                f'material "{material.name}"', "has no reflectance yet", "apply one first"
            )
        kept[material] = (managed.reflectance_name, np.array(managed.extra["values"]))
    return make_spectral(world, kept, settings)


_NONE: NDArray[np.float64] = np.empty((0, 81))


def _analyse(world: bpy.types.World | None) -> SkyLight:
    image = worlds.sky_of(world).image
    return analyse(from_pixels(worlds.pixels_of(image), f'image "{image.name}"'))


def _plain(record: Any) -> dict[str, Any]:
    """Return a dataclass as what blend data can hold: no None."""
    return {key: value for key, value in asdict(record).items() if value is not None}
