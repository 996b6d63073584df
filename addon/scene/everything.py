"""Everything of a scene made spectral at once: measured where chosen, else estimated, else told."""

from __future__ import annotations

import json
from collections.abc import Generator, Mapping
from dataclasses import dataclass

import bpy

from ..progress import Progress
from . import spectral
from .materials import assignment, base_color, eligibility, glass_and_metal, spectral_material
from .world.settings import Settings

LEFT = "spectral_skylight_left"  # on a scene: JSON of names and why they were left alone


@dataclass(frozen=True)
class Everything:
    """What came of it: a result for each material, and (name, reason) of those left alone."""

    results: list[spectral.Result]
    left: list[tuple[str, str]]

    @property
    def estimated(self) -> int:
        """How many have a reflectance that nobody measured."""
        return sum(result.reflectance == base_color.ESTIMATED for result in self.results)

    @property
    def line(self) -> str:
        """How many of which, in one sentence."""
        said = f"{len(self.results)} material(s) spectral, {self.estimated} of them estimated"
        return f"{said}; {len(self.left)} left alone" if self.left else said


def make(
    scene: bpy.types.Scene,
    chosen: Mapping[bpy.types.Material, assignment.Given | str],
    settings: Settings,
    estimate: bool = True,
) -> Generator[Progress, None, Everything]:
    """Make every eligible material of a scene spectral, yielding after each.

    ``chosen``: what materials were given, or why that cannot be read; others keep what they have,
    or with ``estimate`` get a reflectance of their base colour. Raises InputError as
    `spectral.make_spectral` does.
    """
    wanted: dict[bpy.types.Material, assignment.Given] = {}
    left: list[tuple[str, str]] = []
    for material in eligibility.materials_of(scene):
        what = _what(material, chosen.get(material), estimate)
        if isinstance(what, str):
            left.append((material.name, what))
        else:
            wanted[material] = what
    results = []
    if wanted:
        world = spectral.develop(scene, settings)
        told = assignment.apart(wanted)
        _, results = yield from spectral.making_spectral(world, settings=settings, **told)
    scene[LEFT] = json.dumps(left)
    return Everything(results, left)


def _what(
    material: bpy.types.Material, chosen: assignment.Given | str | None, estimate: bool
) -> assignment.Given | str:
    """What a material is to have, or why it is left alone."""
    if chosen is not None:
        return eligibility.unchangeable(material) or chosen
    before = kept(material)
    if before is not None:
        return eligibility.unchangeable(material) or before
    if why := eligibility.reason(material):
        return why
    if not estimate:
        return "no reflectance is chosen for it"
    return assignment.Given(base_color.ESTIMATED, base_color.estimated(material))


def kept(material: bpy.types.Material) -> assignment.Given | None:
    """What was given to a material that is spectral already; None for an estimate and without."""
    if glass_and_metal.pane_node(material) is not None:
        return assignment.Given(*glass_and_metal.pane_of(material))
    managed = spectral_material.managed(material)
    if managed is None or managed.reflectance_name == base_color.ESTIMATED:
        return None
    return assignment.Given(*spectral_material.kept(material), glass_and_metal.metal_of(material))


def left_alone(scene: bpy.types.Scene) -> list[tuple[str, str]]:
    """Names of a scene's materials that `make` left alone, and why; empty before it ran."""
    return [(name, why) for name, why in json.loads(scene.get(LEFT, "[]"))]
