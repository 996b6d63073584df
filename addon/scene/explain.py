"""Why a material has the color it has: every step from its file to the values in its sockets.

What is told is read from the blend file; what should stand there is planned anew beside it, so that
whatever is old, changed by hand or switched off is found. Nothing in the file changes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...node_groups import skylight_surface, spectral_matrix
from .. import tags
from ..errors import InputError
from ..sky.polynomial import evaluate_polynomial
from ..spectra.reflectance import read_one, split_assignment
from ..spectra.working_spaces import XYZ_to_working
from ..transfer.assignment import Assignment
from ..transfer.prediction import rgb_albedo
from . import out_of_date
from . import plan as planning
from .lights import lighting
from .materials import spectral_material, swatch
from .materials.assigned import assigned
from .materials.spectral_material import Managed
from .world import hdri, light_group, view_transform
from .world.settings import Settings, stored

TOLERANCE = 1e-4
"""Of the largest value: sockets are float32, and the sky is read from the file again."""


@dataclass(frozen=True)
class Step:
    """One step: its ``name``, what came of it in words, and the ``values`` as plain data."""

    name: str
    text: str
    values: Any = None


@dataclass(frozen=True)
class Explanation:
    """The steps of one material in order, and what looks suspicious, a sentence with its cure."""

    material: str
    steps: tuple[Step, ...]
    suspicious: tuple[str, ...]

    @property
    def lines(self) -> list[str]:
        """All of it, a line each."""
        steps = [f"{step.name}: {step.text}" for step in self.steps]
        found = [f"Suspicious: {line}" for line in self.suspicious]
        return [*steps, *(found or ["Suspicious: nothing"])]

    def plain(self) -> dict[str, Any]:
        """Return it as plain data, ready for JSON."""
        return asdict(self)


def explain(scene: bpy.types.Scene, material: bpy.types.Material) -> Explanation:
    """Follow one material of a scene; nothing changes.

    Raises InputError for a material that is not spectral.
    """
    managed, given = spectral_material.managed(material), assigned(material)
    if managed is None or given is None:
        place = f'material "{material.name}"'
        raise InputError(place, "is not spectral", "give it a reflectance, or make all spectral")
    settings = stored(managed.world) or Settings()
    suspicious = list(_wrong_with_material(scene, material, managed))
    steps = [*_of_file(given, suspicious), _reflectance(given)]
    plan = None
    if managed.world is not None:
        try:
            plan = _plan(managed.world, settings)
        except InputError as error:
            suspicious.append(str(error))
    if plan is not None:
        own = next(one for one in plan.materials if one.material == material)
        steps += _of_sky(plan)
        suspicious += [*plan.light.notes, *_wrong_with_world(plan.world)]
        steps += _of_matrix(plan, own, managed, suspicious)
        steps += _of_light(plan, own, managed, suspicious)
    fit, line = view_transform.transform_line(scene)
    steps.append(Step("View", line, scene.view_settings.view_transform))
    if not fit:
        suspicious.append("the view changes colors: judge them with the view transform Standard")
    return Explanation(material.name, tuple(steps), tuple(dict.fromkeys(suspicious)))


def _of_file(given: Assignment, suspicious: list[str]) -> Iterator[Step]:
    """Where the reflectance is from, and whether the file still holds it."""
    if given.estimated:
        yield Step("File", "none: estimated from the base color, not measured")
        return
    if not given.source:
        yield Step("File", f"not known: {given.name} was given by a script or an older version")
        return
    behind = f", behind {given.behind}" if given.behind else ""
    yield Step("File", f"{given.source}{behind}", given.source)
    low, high = given.measured or (380.0, 780.0)
    unit = given.unit or "fraction"
    text = f"read as {unit}, measured from {low:g} to {high:g} nm"
    yield Step("Unit", text, {"unit": unit, "measured": [low, high]})
    path, _ = split_assignment(given.source)
    if given.metal is not None or given.behind:
        return
    if not Path(path).is_file():
        suspicious.append(f"{path} is missing: the material keeps its reflectance")
        return
    try:
        now = read_one(given.source, given.unit or None).values[0]
    except InputError as error:
        suspicious.append(f"the file cannot be read any more: {error}")
        return
    if not np.allclose(now, given.values, atol=1e-9):
        suspicious.append(f"{path} has changed since: apply it again")


def _reflectance(given: Assignment) -> Step:
    """The reflectance as a person sees it: its range, and its color under D65."""
    rgb = rgb_albedo(given.values)
    low, high = float(given.values.min()), float(given.values.max())
    text = f"{given.name}, {low:.3f} to {high:.3f}; linear RGB under D65 {_numbers(rgb)}"
    return Step("Reflectance", text, given.values.tolist())


def _of_sky(plan: planning.Plan) -> Iterator[Step]:
    """The World's light: what it is, its color, its sun, and what is taken for its spectrum."""
    light, settings = plan.light, plan.settings
    yield Step(
        "Sky", f"{light.name}, upward RGB {_numbers(light.faces[0])}", light.faces[0].tolist()
    )
    told, found = settings.sun_elevation, light.sun_elevation(settings.sun_elevation)
    if found is None and light.spectrum is not None:
        text = "not known, and not needed: the sky's spectrum is known"
    elif found is None:
        text = "not known: daytime is assumed"
    else:
        text = f"{found:.1f}°, {'as set' if told is not None else 'found in the HDRI'}"
    yield Step("Sun elevation", text, found)
    numbers = f"camera {settings.camera}" if settings.camera else "colorimetric"
    white = "not white-balanced" if settings.white is None else f"balanced by {settings.white}"
    yield Step("HDRI numbers", f"{numbers}, {white}", settings.plain())
    yield Step("Basis", plan.record.model.removeprefix("sky: "), plan.choice.transfer.basis)


def _plan(world: bpy.types.World, settings: Settings) -> planning.Plan:
    """What all materials under a World should show: the simplest basis is chosen for all."""
    found = {m: assigned(m) for m in spectral_material.managed_materials(world)}
    given = {m: one for m, one in found.items() if one is not None and m.is_editable}
    return planning.make(world, given, settings)


def _of_matrix(
    plan: planning.Plan, own: planning.MaterialPlan, managed: Managed, suspicious: list[str]
) -> Iterator[Step]:
    """The matrix that follows, the one in the sockets, the model and the errors to expect."""
    wanted, result = own.surface.matrix, own.result
    shown = np.array(managed.matrix)
    yield Step("Matrix", f"of {plan.choice.transfer.space}: {_rows(wanted)}", wanted.tolist())
    yield Step("Model", result.line.partition(": ")[2] or result.model, result.model)
    yield Step("Matrix in the sockets", _rows(shown), shown.tolist())
    if not _near(shown, wanted):
        suspicious.append("the sockets hold a different matrix: press Update")


def _of_light(
    plan: planning.Plan, own: planning.MaterialPlan, managed: Managed, suspicious: list[str]
) -> Iterator[Step]:
    """What else shines, what the sockets hold of it, and the color that comes of it all."""
    node = spectral_material.surface_node(own.material)
    assert node is not None  # it is managed
    caption = out_of_date.as_it_is(plan.lights.caption, plan.world)
    for line in (*plan.lights.lines, caption):
        yield Step("Light", line)
    for name, rgb in own.surface.reflected.items():
        held = np.array(node.inputs[name].default_value)
        if name == skylight_surface.COLOR:  # it follows from the light on the material here
            if lighting.is_traced(plan.world):
                yield Step("Color in traced light", _numbers(held), held.tolist())
            continue
        if np.any(rgb) or held.any():
            yield Step(f"Socket {name}", _numbers(held), held.tolist())
        if not _near(held, np.asarray(rgb)):
            suspicious.append(f"socket {name} holds a different value: press Update")
    coefficients = light_group.coefficients_of(plan.world)
    if coefficients is None:
        suspicious.append("the World's light is missing from its node group: press Update")
        return
    E = evaluate_polynomial(coefficients, np.array([[0.0, 0.0, 1.0]]))[0]
    exact = plan.light.faces[0]
    predicted, shown = own.surface.matrix @ exact, np.array(managed.matrix) @ E
    text = f"under the sky alone, level ground: linear RGB {_numbers(predicted)}"
    yield Step("Predicted color", text, predicted.tolist())
    to_Y = np.linalg.inv(XYZ_to_working(plan.choice.transfer.space))[1]
    white = float(to_Y @ plan.choice.transfer.to_working @ exact)
    coded = swatch.shown(tuple(shown.tolist()), white)
    text = f"linear RGB {_numbers(shown)}; over the sky's white {_numbers(np.array(coded))}"
    yield Step("Shown color", text, shown.tolist())
    if (predicted < 0.0).any():
        suspicious.append("the color is out of gamut: Blender clamps a negative part to 0")


def _wrong_with_material(
    scene: bpy.types.Scene, material: bpy.types.Material, managed: Managed
) -> Iterator[str]:
    """What keeps a material from showing what it was given."""
    if tags.SHOWS_RGB in material:
        yield "it shows RGB × RGB: press Back to Spectral"
    if why := out_of_date.colour(material):
        yield f"{why}: press Make Everything Spectral"
    if managed.world is None:
        yield "no World lights it: press Update"
    elif managed.world != scene.world:
        yield f'the World "{managed.world.name}" lights it, not this scene\'s: press Update'
    if not spectral_material.is_shown(material):
        yield "its spectral surface is not connected to the Material Output: apply it again"
    if scene.view_layers and bpy.context.view_layer.material_override is not None:
        yield "the view layer's Material Override shows another material"
    unbaked = set(out_of_date.unbaked(scene))
    if any(obj.name in unbaked and material.name in obj.material_slots for obj in scene.objects):
        yield "objects with it are not baked, or have changed since: bake again"


def _wrong_with_world(world: bpy.types.World) -> Iterator[str]:
    sky = hdri.sky_of(world)
    if sky.background is not None:
        strength = world.node_tree.nodes[sky.background].inputs["Strength"].default_value
        if strength == 0.0:
            yield "the World's Strength is 0"


def _near(held: NDArray, wanted: NDArray) -> bool:
    scale = max(float(np.abs(wanted).max(initial=0.0)), 1e-6)
    return bool(np.abs(held - wanted).max(initial=0.0) <= TOLERANCE * scale)


def _numbers(values: NDArray) -> str:
    return " ".join(f"{value:.4g}" for value in np.asarray(values).ravel())


def _rows(matrix: NDArray) -> str:
    rows = zip(spectral_matrix.ROWS, np.asarray(matrix), strict=True)
    return "; ".join(f"{name} {_numbers(row)}" for name, row in rows)
