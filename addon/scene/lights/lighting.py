"""The lights of a World: what its sky, ground, sun and lamps give to materials, and their lamps."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import light_probe, skylight_surface
from ....node_groups.skylight_surface import COLOR, Features
from ...choices import BAKED, DOME, OPEN
from ...grouping import grouped
from ...sky.direct_sun import SunLight, restored_sun
from ...sky.dome import Dome, dome
from ...sky.irradiance import fit_coefficients
from ...sky.light import SkyLight
from ...sky.polynomial import HIGHEST_DEGREE, evaluate_polynomial, raised
from ...spectra.illuminants import D65
from ...spectra.working_spaces import XYZ_to_working
from ...transfer.ground import GroundLight, ground_light, is_grey, split
from ...transfer.matrices import OWN, Transfer
from ...transfer.prefilter import balanced_rgb, prefiltered
from ..world import light_group, sky_sampling, view_transform
from . import dome_lamps, light_linking, sun_lamp
from . import user_lamps as own_lamps
from .user_lamps import Lamps

BAKED_LIGHT = "all light is baked"
TRACED_LIGHT = "Cycles traces the light; Eevee shows the open sky"


@dataclass(frozen=True)
class Lights:
    """What shines on a World's materials, found before anything changes.

    ``coefficients``: of the sky's irradiance without the ground's; ``spectra``: those of the lights
    in `skylight_surface.LIGHTS` that there are, (81,) each; ``traced``: whether Cycles traces all
    light itself.
    """

    light: SkyLight
    transfer: Transfer
    coefficients: NDArray[np.float64]
    occlusion: str = OPEN
    sun: SunLight | None = None
    ground: GroundLight | None = None
    lamps: Lamps | None = None
    dome: Dome | None = None
    spectra: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    traced: bool = False

    @property
    def features(self) -> Features:
        """What the World's shader has to hold."""
        return Features(
            self.occlusion,  # type: ignore[arg-type]
            probe=self.sun is not None or self.lamps is not None or self.dome is not None,
            ground=self.ground is not None,
        )

    @property
    def lines(self) -> list[str]:
        """What is put beside the sky, a sentence each."""
        lines = []
        if self.transfer.basis == OWN:
            lines.append("matrices from this sky's own spectrum")
        if self.sun is not None:
            lines.append(self.sun.line)
        if self.ground is None:
            lines.append("light from below: the HDRI's own ground, which is gray")
        else:
            lines.append(self.ground.line)
        if self.lamps is not None and self.lamps.classes.line:
            lines.append(f"Eevee supports two lamp spectra: {self.lamps.classes.line}")
        if self.traced and self.lamps is not None:
            others = own_lamps.in_other_colours(self.lamps, self.transfer)
            why = "Cycles traces its own color, not that of its spectrum"
            lines += grouped(((name, why) for name in others), "lamp")
        if self.dome is not None:
            lines.append(
                f"sky shadows from {len(self.dome.numbers)} soft sun lamps, only in Eevee "
                f"(error {100 * self.dome.left:.1f} %); Cycles shows the whole sky"
            )
        return lines

    @property
    def caption(self) -> str:
        """What a picture must say as long as not all light is in it."""
        shadows = {
            OPEN: TRACED_LIGHT if self.traced else "open sky: no shadows yet",
            BAKED: BAKED_LIGHT,
            DOME: "the sky's shadows are live",
        }[self.occlusion]
        if self.light.sun is None:
            return shadows
        if self.sun is not None:
            return shadows.replace("no shadows yet", "no shadows but the sun's yet")
        share = f"{100 * self.light.sun_share:.0f} % of this sky's light"
        if self.traced:
            return f"{shadows}; the sun ({share}) shines in Cycles all the same"
        return f"{shadows}; the sun ({share}) is not on your materials"

    @property
    def with_sun(self) -> Lights:
        """The same with the HDRI's sun, whether a lamp has its light or not."""
        if self.light.sun is None or self.sun is not None:
            return self
        transfer = self.transfer
        sun = restored_sun(self.light.sun, self.light, transfer.S_in, transfer.white)
        return replace(self, sun=sun)

    def level(self, towards_sun: NDArray[np.float64] | None) -> NDArray[np.float64]:
        """Return the RGB of a white, level face in the open, (3,), sun and sky, as materials are.

        ``towards_sun`` (3,): where the sun stands in the world, None without one that shines.
        """
        white = self.transfer.to_working @ self.light.faces[0]
        if self.sun is not None and towards_sun is not None:
            sun = balanced_rgb(self.sun.spectrum, self.transfer)
            white = white + max(0.0, float(towards_sun[2])) * sun
        return white

    @property
    def white_luminance(self) -> float:
        """The luminance of a white, level face in the open under the sky alone."""
        to_Y = np.linalg.inv(XYZ_to_working(self.transfer.space))[1]
        return float(to_Y @ self.transfer.to_working @ self.light.faces[0])

    def reflected(self, rho: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Return what reflectances (m, 81) make of each light, (m, 3).

        Of a lamp with its colour, which lies nowhere else; its brightness is the probe's.
        """
        found = {
            name: prefiltered(rho, spectrum, self.transfer.space)
            for name, spectrum in self.spectra.items()
        }
        for name in ("Lamp 1", "Lamp 2"):
            if name in found:
                found[name] = found[name] * balanced_rgb(self.spectra[name], self.transfer)
        # As long as nobody knows the light on a material.
        found[COLOR] = prefiltered(rho, D65(), self.transfer.space)
        if self.lamps is not None and self.sun is None:
            # Cycles lights by one colour a material, see `sun_lamp.set_cycles_colour`.
            found["Sun"] = prefiltered(rho, self.spectra["Lamp 1"], self.transfer.space)
        return found

    def tint(self, colours: NDArray[np.float64], rho: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return by what a reflectance's (81,) light is multiplied to be another colour's, (m, 3).

        ``colours`` (m, 3): what those are under the open sky, as `under_sky` gives them.
        """
        own = self.under_sky(self.transfer.matrices(rho))
        return colours / np.where(np.abs(own) < 1e-6, 1.0, own)

    def under_sky(self, matrices: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the colours (..., 3) of matrices (..., 3, 3) on level ground under the sky."""
        return matrices @ self.light.faces[0]


def find(
    light: SkyLight,
    transfer: Transfer,
    *,
    lamps: Lamps | None = None,
    with_sun: bool = True,
    ground: str | NDArray[np.float64] = "hdri",
    occlusion: str = OPEN,
    traced: bool = False,
) -> Lights:
    """Return the lights of a sky beside a scene's ``lamps``, computed and checked.

    ``ground``: one of `transfer.ground.CHOICES`, or the reflectance (81,) of a modelled one, which
    is grey's else; ``occlusion``: `OPEN`, `BAKED` or `DOME`; ``traced``: whether Cycles traces all
    light itself. Raises InputError for an unknown ground.
    """
    spectra = {}
    sun = None
    if light.sun is not None and with_sun:
        sun = restored_sun(light.sun, light, transfer.S_in, transfer.white)
        spectra["Sun"] = sun.spectrum
    below = None
    # Without shadows the light of a grey ground is one with the sky's.
    if not isinstance(ground, str):
        below = ground_light("modelled", light, transfer, sun, ground)
    elif ground != "hdri" or occlusion != OPEN or not is_grey(light, transfer):
        below = ground_light(ground, light, transfer, sun)
    if below is not None:
        spectra["Ground"] = below.spectrum
    if lamps is not None:
        for k, spectrum in enumerate(lamps.classes.spectra):
            spectra[f"Lamp {k + 1}"] = spectrum
    return Lights(
        light,
        transfer,
        light.fit.coefficients if below is None else _sky_alone(light, transfer, below),
        occlusion,
        sun,
        below,
        lamps,
        dome(light.sky) if occlusion == DOME else None,
        spectra,
        traced,
    )


def _sky_alone(light: SkyLight, transfer: Transfer, ground: GroundLight) -> NDArray[np.float64]:
    """Return the sky's polynomial: that of all light less the ground's.

    So their sum is as near as one polynomial comes, although the sky alone has a hard horizon.
    """
    white = prefiltered(np.ones(81), ground.spectrum, transfer.space)
    from_ground = ground.coefficients * white @ np.linalg.inv(transfer.to_working).T
    total = light.fit.coefficients
    if ground.choice != "hdri":
        upper, lower = split(np.ones_like(light.sky))
        below = evaluate_polynomial(from_ground, [[0.0, 0.0, -1.0]])[0]
        panorama = light.sky * upper + lower * below.astype(np.float32)
        total = fit_coefficients(panorama, max(light.fit.degree, 4)).coefficients
    return raised(total, HIGHEST_DEGREE) - raised(from_ground, HIGHEST_DEGREE)


def install(world: bpy.types.World, lights: Lights) -> None:
    """Put lights into the World's group and its lamps into all scenes that it lights."""
    light_group.ensure(world, lights.features)
    light_group.set_coefficients(world, lights.coefficients)
    if lights.ground is not None:
        light_group.set_ground(world, lights.ground.coefficients)
    rgb = np.zeros(3)
    if lights.sun is not None:
        rgb = balanced_rgb(lights.sun.spectrum, lights.transfer)
    if lights.features.probe:
        light_group.set_probe(world, light_probe.SUN, rgb)
    if lights.dome is not None:
        for name, colour in zip(
            (light_probe.GREEN, light_probe.BLUE), lights.dome.colours, strict=True
        ):
            light_group.set_probe(world, name, colour)
    for scene in scenes_of(world):
        if lights.sun is not None:
            sun = lights.light.sun
            assert sun is not None
            there = lights.transfer.to_working @ sun.irradiance
            clipped = np.maximum(rgb - there, 0.0) if lights.sun.clipped else None
            sky = float(lights.light.sky.max())
            sun_lamp.place(scene, sun.direction, rgb, sky, clipped)
        else:
            sun_lamp.remove(scene, (sun_lamp.SUN,))
        if lights.lamps is not None:
            own_lamps.place(scene, lights.lamps, lights.transfer)
        else:
            sun_lamp.remove(scene, (own_lamps.TWIN,))
        if lights.dome is not None:
            dome_lamps.place(scene, lights.dome)
        else:
            sun_lamp.remove(scene, (dome_lamps.DOME,))
    trace(world, lights.traced)
    if lights.traced:
        sky_sampling.own(world, lights.light.sun is not None)


def is_traced(world: bpy.types.World) -> bool:
    """Whether Cycles traces the light of a World's materials itself."""
    surface = skylight_surface.find(world)
    return surface is not None and skylight_surface.is_traced(surface)


def show_baked(world: bpy.types.World | None) -> None:
    """Let Cycles show what is baked where a World's materials do, if it traces it till then."""
    if world is None or not is_traced(world):
        return
    surface = skylight_surface.find(world)
    if surface is not None and skylight_surface.features_of(surface).sky == BAKED:
        trace(world, False)


def trace(world: bpy.types.World, on: bool) -> None:
    """Let Cycles trace the light of a World's materials itself, or show what they hold of it."""
    light_group.trace(world, on)
    for scene in scenes_of(world):
        sun_lamp.trace(scene, on)
    if not on:
        sky_sampling.release(world)


def refresh(world: bpy.types.World) -> list[str]:
    """Let the lamps shine on all objects that now have managed materials; return warnings."""
    lines = []
    for scene in scenes_of(world):
        if light_linking.find(scene) is None:
            continue
        light_linking.ensure(scene)
        burnt = light_linking.mixed(scene)
        lines += grouped([(obj.name, _no_lamps(names)) for obj, names in burnt.items()], "object")
    return lines


def _no_lamps(names: list[str]) -> str:
    """Why an object with materials of these names beside spectral ones gets no sun."""
    called = " and ".join(name or "faces without a material" for name in names[:2])
    more = f" and {len(names) - 2} more" if names[2:] else ""
    return (
        f"no sun and no lamps, for they would overexpose {called}{more}, not spectral: make all "
        "its materials spectral, or separate it by material"
    )


def remove(world: bpy.types.World) -> None:
    """Take our lamps out of all scenes of a World."""
    for scene in scenes_of(world):
        clear(scene)
    sun_lamp.release_threshold(world)
    sky_sampling.release(world)


def clear(scene: bpy.types.Scene) -> None:
    """Take our lamps out of a scene, and our white off its view."""
    sun_lamp.remove(scene, (sun_lamp.SUN, own_lamps.TWIN, dome_lamps.DOME, sun_lamp.TURN))
    view_transform.give_back(scene)


def scenes_of(world: bpy.types.World) -> list[bpy.types.Scene]:
    """The scenes that a World lights."""
    return [scene for scene in bpy.data.scenes if scene.world == world]
