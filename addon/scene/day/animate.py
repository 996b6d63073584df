"""Letting a scene's sky, and all that it lights, move through a day or a year."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import tags
from ...choices import BAKED, DOME, OPEN
from ...errors import InputError, parameter
from ...progress import Progress, aside, mapped
from ...sky.sun_course import SAMPLES, Course, through_day, through_year
from .. import plan as planning
from ..bake import scene_bake
from ..bake.kept_bakes import KeptBakes
from ..bake.light import SceneLight, shining_of
from ..lights import lighting
from ..plan import Assignments, Plan
from ..world import hdri, light_group, own_worlds, sky_image
from ..world.settings import Settings, store
from ..world.simulated_sky import SkyPlace
from ..write import write
from . import day_world, key_lights, played_lights, values
from .key_lights import KeyLights
from .moments import LEAST, KeySkies, Moment, find

if TYPE_CHECKING:
    from ...sky.simulation import SimulatedSky

HEIGHT = 256
"""[pixels] of the skies that light is planned by; what is seen is drawn from the simulation."""

YEAR = "year"

MOST_FRAMES = 100_000


@dataclass(frozen=True)
class Day:
    """What a sky is to move through: the place's date from a time to another, in so many frames.

    ``until``: `YEAR` moves through the days of the date's year, each at ``first``.
    """

    place: SkyPlace
    first: str = "06:00"
    until: str = "20:00"
    frames: int = 240

    def course(self) -> Course:
        """Return the sun's way; raises InputError as `sun_course` does, and for too few frames."""
        if not 2 <= self.frames <= MOST_FRAMES:
            cure = f"give 2 to {MOST_FRAMES}"
            raise InputError(parameter("frames"), f"{self.frames} frame(s)", cure)
        place = self.place
        if place.weather != "clear":
            cure = "choose a clear sky, or a simulated sky for each hour in a study"
            raise InputError(parameter("weather"), "only clear skies move through a day", cure)
        where = place.latitude, place.longitude, place.timezone
        if self.until == YEAR:
            year = place.date[:4]
            return through_year(int(year) if year.isdigit() else 0, self.first, *where)
        return through_day(place.date, self.first, self.until, *where)

    def plain(self) -> dict[str, Any]:
        """Return it as plain data that JSON holds."""
        return asdict(self)

    @classmethod
    def from_plain(cls, found: dict[str, Any]) -> Day:
        """Read what `plain` returned; raises TypeError for anything else."""
        return cls(**{**found, "place": SkyPlace(**found["place"])})


def day_of(world: bpy.types.World | None) -> Day | None:
    """Return what a World moves through, None where its sky stands still."""
    found = day_world.kept_of(world).get("day")
    try:
        return Day.from_plain(found) if isinstance(found, dict) else None
    except TypeError:
        return None  # overwritten by hand, or by a newer version


def animating(
    scene: bpy.types.Scene, day: Day, given: Assignments, settings: Settings
) -> Generator[Progress, None, tuple[Plan, list[str]]]:
    """Let a scene's sky move through a day, with materials under it and, where settings ask for
    it, all light that is baked; return the plan of its highest sun, and lines to read.

    Everything is computed before anything changes. Raises InputError as `Day.course` and
    `plan.make` do; the scene is untouched then.
    """
    course = day.course()
    lines = []
    if settings.shadows == DOME:
        settings = replace(settings, occlusion=OPEN)
        lines.append("animated under the open sky: live shadows hold the light of one moment")
    if settings.traced:
        settings = replace(settings, occlusion=OPEN)
        lines.append("animated under the open sky: traced light has the colors of one moment")
    if settings.shadows == BAKED:
        settings = replace(settings, occlusion=BAKED)  # it does not follow each change by itself
    low, high = course.range
    low = min(low, 90.0 - LEAST)
    high = max(high, low + LEAST)
    before = scene.world
    if before is not None:
        kept, before.use_fake_user = before.use_fake_user, True
    world, span = _new_world(scene, settings), _own_range(scene, before)
    bakes = None
    done = False
    try:
        moments = _Moments(scene, world, day, course, given, settings)
        share = 0.3 if settings.shadows == BAKED else 0.9
        found = yield from mapped(
            find(low, high, moments.at), lambda p: replace(p, done=share * p.done / 0.9)
        )
        lights = None
        if settings.shadows == BAKED:
            bakes = KeptBakes()
            lights, said = yield from mapped(
                _baking(moments, found, settings), lambda p: replace(p, done=0.3 + 0.6 * p.done)
            )
            lines += said
        yield Progress(0.9, "keyframes")
        _write(scene, world, found)
        frames = np.array([scene.frame_start, scene.frame_start + day.frames - 1])
        day_world.install(world, course, found, frames, day.place.north)
        line = _line(course, found, lights, day)
        kept_day = {"day": day.plain(), "range": span, "line": line, "keys": len(found.keys)}
        if lights is not None:
            played_lights.install(world, lights, frames)
            kept_day["baked"] = lights.brightest
        day_world.keep(world, **kept_day)
        scene.frame_end = int(frames[1])
        if (record := light_group.record_of(world)) is not None:
            light_group.keep_record(world, replace(record, image=hdri.sky_of(world).name))
        scene.frame_set(scene.frame_current)
        done = True
    finally:
        world.use_fake_user = False
        if not done:
            scene.world = before
        if bakes is not None:
            bakes.let_go() if done else bakes.give_back()
        if before is not None:
            before.use_fake_user = kept
        own_worlds.remove_unused()
    return max(found.keys, key=lambda k: k.elevation).plan, [line, *lines]


class _Moments:
    """The skies of a course, each simulated once, and what they light."""

    def __init__(
        self,
        scene: bpy.types.Scene,
        world: bpy.types.World,
        day: Day,
        course: Course,
        given: Assignments,
        settings: Settings,
    ) -> None:
        self.scene, self.world, self.day, self.course = scene, world, day, course
        self._what = given, settings
        self._known: dict[float, Moment] = {}

    def at(self, elevation: float) -> Generator[Progress, None, Moment]:
        """The moment of an elevation [degrees]."""
        if elevation not in self._known:
            work = computing(self.scene, self.world, self.day.place, elevation, *self._what)
            self._known[elevation] = yield from work
        return self._known[elevation]

    def shining(self, x: float, lowest: float) -> Generator[Progress, None, SceneLight]:
        """What shines on the scene at a moment of the course, from 0 to 1; not under ``lowest``."""
        place = np.array([x])
        elevation = max(float(self.course.elevation.at(place)[0]), lowest)
        moment = yield from self.at(elevation)
        node = self.world.node_tree.nodes[hdri.sky_of(self.world).mapping]
        turn = day_world.turned(self.course.azimuth.at(place), self.day.place.north)
        node.inputs["Rotation"].default_value[2] = turn[0]
        try:
            return (yield from shining_of(self.world, moment.plan.lights, self.scene))
        finally:
            node.inputs["Rotation"].default_value[2] = 0.0


def _baking(
    moments: _Moments, found: KeySkies, settings: Settings
) -> Generator[Progress, None, tuple[KeyLights | None, list[str]]]:
    """Bake what has no light or an old one, and find the moments whose light stands for all."""
    course, level = moments.course, day_world.level_of(found)
    low = found.keys[0].elevation
    samples = np.linspace(0.0, 1.0, SAMPLES)
    highest = float(samples[np.argmax(course.elevation.at(samples))])
    old = yield from scene_bake.finding_stale()
    lines: list[str] = []
    if any(map(scene_bake.is_waiting, old)):
        noon = yield from moments.shining(highest, low)
        work = scene_bake.bake(old, light=noon, changed_only=False, error=settings.tolerance)
        lines = yield from mapped(work, lambda p: replace(p, done=0.4 * p.done))
    objects, said = scene_bake.lit()
    if not objects:
        return None, [*lines, *said]

    def at(x: float) -> Generator[Progress, None, tuple[SceneLight, float]]:
        light = yield from moments.shining(x, low)
        height = max(float(course.elevation.at(np.array([x]))[0]), low)
        return light, float(level.at(np.array([height]))[0])

    parts = key_lights.marks(course, low, moments.day.frames)
    lights = yield from mapped(
        key_lights.finding(objects, at, parts, moments.day.frames),
        lambda p: replace(p, done=0.4 + 0.6 * p.done),
    )
    if lights.size > key_lights.BIG:
        said.append(
            f"baked light of {len(lights.at)} moments takes {lights.size / 1e6:.0f} MB of the file"
        )
    return lights, [*lines, *said]


def _own_range(scene: bpy.types.Scene, before: bpy.types.World | None) -> list[int]:
    """The frames that a scene had before it was animated."""
    own = day_world.kept_of(before).get("range")
    return own if isinstance(own, list) else [scene.frame_start, scene.frame_end]


def _line(course: Course, found: KeySkies, lights: KeyLights | None, day: Day) -> str:
    count, error = len(found.keys), max(found.error, found.sky_error)
    if lights is None:
        return (
            f"animated {course.line} in {day.frames} frames: {count} key skies, "
            f"at most {error:.2f} ΔE between"
        )
    return (
        f"animated {course.line} in {day.frames} frames: {count} key skies, {len(lights.at)} baked "
        f"lights, at most {max(error, lights.error):.2f} ΔE between, {lights.most:.2f} for 95 %"
    )


def _new_world(scene: bpy.types.Scene, settings: Settings) -> bpy.types.World:
    """A World of ours for a day, which lights nothing yet."""
    before = scene.world
    empty = bpy.data.images.new("Day", 4, 2, float_buffer=True)
    try:
        world = hdri.show(scene, empty)
        store(world, settings)
        world[tags.SUN_ELEVATION] = 0.0
        world.use_fake_user = True
        return world
    finally:
        scene.world = before


def over(place: SkyPlace, elevation: float) -> Generator[Progress, None, SimulatedSky]:
    """Simulate the clear sky of a place for an elevation [degrees]; raises as `simulate`."""
    from ...sky.atmosphere import Atmosphere
    from ...sky.simulation import simulating

    air = Atmosphere(haze=place.haze, ozone=place.ozone, ground=place.ground)
    return (yield from simulating(elevation, air))


def computing(
    scene: bpy.types.Scene,
    world: bpy.types.World,
    place: SkyPlace,
    elevation: float,
    given: Assignments,
    settings: Settings,
) -> Generator[Progress, None, Moment]:
    """Simulate a sky, and plan what materials show under it, in a frame with the sun over +x."""
    from ...sky.clear_sky import SCALE, header_of, picture
    from ...spectra.sensitivities import observer

    sky = yield from over(place, elevation)
    view = 90.0, elevation > 0.0

    def drawn() -> tuple[NDArray[np.float32], dict[str, Any]]:
        return picture(sky, HEIGHT, *view, observer() * SCALE), header_of(sky, *view)

    rgb, header = yield from aside(Progress(0.0, "sky"), drawn)
    image = sky_image.simulated(f"Sky of {place.date}", rgb, header, {}, elevation)
    texture = world.node_tree.nodes[hdri.sky_of(world).texture]
    old, texture.image = texture.image, image
    if old is not None and old.users == 0:
        bpy.data.images.remove(old)
    before, scene.world = scene.world, world
    try:
        plan = planning.make(world, given, settings)
        # Nor until it is baked: traced light has the colors of one moment.
        still = replace(plan, lights=replace(plan.lights, traced=False))
        return Moment.of(elevation, sky, still)
    finally:
        scene.world = before


def _write(scene: bpy.types.Scene, world: bpy.types.World, found: KeySkies) -> None:
    """Write each moment's light in turn, and let all that differed follow.

    Downwards, for what a light that is missing would make of materials stays as it was last; then
    again the one with most lights, which the shader is left to hold.
    """
    scene.world = world
    day_world.stop_unused()

    def parts(moment: Moment) -> tuple[bool, bool, float]:
        features = moment.plan.lights.features
        return features.probe, features.ground, moment.elevation

    gathered: dict[float, dict[values.Place, float]] = {}
    for moment in [*reversed(found.moments), max(found.moments, key=parts)]:
        for _ in write(moment.plan):
            pass
        given = [m.material for m in moment.plan.materials] + list(moment.plan.panes)
        gathered[moment.elevation] = values.gather(world, lighting.scenes_of(world), given)
    all_of = found.moments
    sunny = [k for k, one in enumerate(all_of) if one.plan.lights.sun is not None] or [0]
    nearest = [min(sunny, key=lambda one: abs(one - k)) for k in range(len(all_of))]
    values.drive_all(
        world,
        [one.elevation for one in all_of],
        [one.level for one in all_of],
        np.array([all_of[k].even for k in nearest]),
        [gathered[one.elevation] for one in all_of],
    )
