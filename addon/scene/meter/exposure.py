"""Hours of sun and sky view factors on all surfaces of the open scene.

On the cells of the geometry that a bake has, by the same rays: what is hidden in renders, what
casts no shadow and panes of glass hide nothing.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, parameter
from ...pictures.false_colour import Scale, false_colour, rounded
from ...pictures.png_file import write_png
from ...progress import Progress, mapped
from ...sky.solar_position import solar_position
from ...transport.cells import Cells, levels_for
from ...transport.exposure import sky_view, sun_hours
from ...transport.rays import Caster
from ..bake import geometry, layout
from ..bake.light import Light
from ..bake.patches import PATCHES
from ..output import render_task
from .metered_picture import rays_of

RAYS = 512
"""From each cell for its sky view factor: within 0.01 of closed forms."""

LIFT = 2e-5
"""Of the scene's size, by which places lie over their faces."""

NAMES = {"sun_hours": ("Sun Hours", "h"), "sky_view": ("Sky View Factor", "1")}
"""What is known of each cell: label and unit."""


@dataclass(frozen=True)
class SunTimes:
    """From when to when suns are asked for, and every how many minutes one.

    ``date``, ``first``, ``last`` (24:00 too), ``latitude``, ``longitude`` and ``timezone`` as
    `sky.sun_course.through_day` takes them; ``north`` [degrees] clockwise from +Y.
    """

    date: str
    first: str
    last: str
    timezone: str
    latitude: float
    longitude: float
    north: float = 0.0
    minutes: float = 5.0

    def suns(self) -> tuple[NDArray[np.float64], float]:
        """Return where suns stand in the scene, (k, 3), in the middles of times of so many hours.

        Raises InputError as `sun_course.through_day` does, and for minutes that make no steps.
        """
        from ...sky.sun_course import span

        if not 0.1 <= self.minutes <= 60.0:
            raise InputError(parameter("minutes"), f"{self.minutes:g}", "give 0.1 to 60")
        start, end = span(self.date, self.first, self.last, self.timezone)
        count = max(1, round((end - start) / (60.0 * self.minutes)))
        at = start + (np.arange(count) + 0.5) / count * (end - start)
        elevation, azimuth = solar_position(at, self.latitude, self.longitude)
        if elevation.max() <= 0.0:
            problem = f"the sun stays {-elevation.max():.1f}° below the horizon"
            raise InputError(parameter("date"), problem, "give another day or time")
        e, a = np.radians(elevation), np.radians(90.0 - azimuth - self.north)
        ways = np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)], axis=1)
        return ways, (end - start) / 3600.0 / count


@dataclass(frozen=True, eq=False)
class Exposure:
    """What was found of cells (n,): ``values`` by `NAMES`, NaN in something solid.

    ``corners`` (n, 3, 3) are relative to ``origin``; ``owner`` (n,) is a number among ``owners``.
    """

    cells: Cells
    origin: NDArray[np.float64]
    owner: NDArray[np.int32]
    owners: list[str]
    values: dict[str, NDArray[np.float64]]
    caster: Caster

    def table(self) -> str:
        """Return a row for each object as CSV: area, and mean, least and most of both, by area."""
        head: list[object] = ["object", "area_m2"]
        for name in self.values:
            head += [f"{name}_mean", f"{name}_min", f"{name}_max"]
        rows: list[list[object]] = [head]
        scale = bpy.context.scene.unit_settings.scale_length
        for number, owner in enumerate(self.owners):
            own = (self.owner == number) & np.isfinite(self.values["sky_view"])
            if not own.any():
                continue
            area = self.cells.areas[own]
            row: list[object] = [owner, f"{area.sum() * scale**2:.4g}"]
            for found in self.values.values():
                mean = float(np.average(found[own], weights=np.maximum(area, 1e-30)))
                row += [f"{each:.4g}" for each in (mean, found[own].min(), found[own].max())]
            rows.append(row)
        return _csv(rows)

    def points(self) -> str:
        """Return a row for each cell as CSV: its object, middle, normal, area and values."""
        rows: list[list[object]] = [["object", *"xyz", "nx", "ny", "nz", "area", *self.values]]
        middles = self.cells.corners.mean(axis=1) + self.origin
        for k in np.flatnonzero(np.isfinite(self.values["sky_view"])).tolist():
            numbers = [*middles[k], *self.cells.normals[k], self.cells.areas[k]]
            numbers += [found[k] for found in self.values.values()]
            rows.append([self.owners[self.owner[k]], *(f"{each:.6g}" for each in numbers)])
        return _csv(rows)

    def picture(self, name: str, camera: bpy.types.Object, path: Path) -> None:
        """Write what a camera sees of one of `NAMES` as a PNG with its legend.

        Raises InputError for a panoramic camera, and where it cannot be written.
        """
        width, height = render_task.size(bpy.context.scene)
        origins, ways = rays_of(camera, width, height)
        at = (origins.reshape(-1, 3) - self.origin).astype(np.float32)
        met = self.caster.first_hits(at, ways.reshape(-1, 3).astype(np.float32))
        amounts = np.where(met >= 0, self.values[name][met], np.nan).reshape(height, width)
        label, unit = NAMES[name]
        write_png(path, false_colour(amounts, label, unit, scale=self.scale(name)))

    def scale(self, name: str) -> Scale:
        """Return the scale of one of `NAMES`: from 0 to 1, or to the most hours."""
        most = float(np.nanmax(self.values[name], initial=0.0))
        return Scale(0.0, 1.0 if name == "sky_view" else rounded(max(most, 0.1)))

    @property
    def lines(self) -> list[str]:
        """What was found, in words."""
        known = np.isfinite(self.values["sky_view"])
        area = np.maximum(self.cells.areas[known], 1e-30)
        said = [f"{known.sum():,} places on {len(set(self.owner[known].tolist()))} object(s)"]
        for name, (label, unit) in NAMES.items():
            found = self.values[name][known]
            if not len(found):
                continue
            unit = "" if unit == "1" else f" {unit}"
            mean = float(np.average(found, weights=area))
            said.append(f"{label.lower()}: {mean:.2f}{unit} in the mean, up to {found.max():.2f}")
        return said


def _csv(rows: list[list[object]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def exposing(times: SunTimes) -> Generator[Progress, None, Exposure]:
    """Find hours of sun and sky view factors in the open scene, yielding how far that is.

    Raises InputError as `SunTimes.suns` does, and where there are no surfaces.
    """
    suns, hours = times.suns()
    around = yield from geometry.gathering()
    if not len(around.corners):
        raise InputError("the scene", "has no surfaces", "add a mesh that is rendered")
    surfaces = around.surfaces
    small = layout.SMALL * around.size
    levels = levels_for(surfaces, layout.START * around.size, PATCHES[0], small)
    cells = Cells.of(surfaces, levels)
    matter = Light().matter(around.materials)
    hides = ~matter.clear[cells.kind] & (matter.opacity[cells.kind] > 0.5)
    caster = Caster(cells.corners[hides])
    normals = np.ascontiguousarray(cells.normals)
    places = (cells.corners.mean(axis=1) + LIFT * around.size * normals).astype(np.float32)
    casting = sun_hours(caster, places, normals, suns, hours)
    sun = yield from mapped(casting, lambda done: Progress(0.5 * done, "sun hours"))
    casting = sky_view(caster, places, normals, RAYS)
    view = yield from mapped(casting, lambda done: Progress(0.5 + 0.5 * done, "sky view"))
    flat = ~(np.linalg.norm(normals, axis=1) > 0.5)
    values = {"sun_hours": sun, "sky_view": view}
    for found in values.values():
        found[flat] = np.nan
    owner = around.owner[cells.triangle]
    return Exposure(cells, around.origin, owner, around.owners, values, Caster(cells.corners))


@dataclass(frozen=True)
class Drawing:
    """An exposure as a graphics card wants it, as `surface_light.Drawing` is."""

    exposure: Exposure

    @property
    def places(self) -> NDArray[np.float32]:
        """Corners (3 n, 3) in the world."""
        at = self.exposure.cells.corners + self.exposure.origin
        return at.reshape(-1, 3).astype(np.float32)

    def sides(self, name: str) -> NDArray[np.float32]:
        """One of `NAMES` on fronts, and nothing behind, (3 n, 2)."""
        front = np.repeat(np.nan_to_num(self.exposure.values[name], nan=-1.0), 3)
        return np.stack([front, np.full(len(front), -1.0)], axis=1).astype(np.float32)

    def scale(self, name: str) -> Scale:
        """As an `Exposure`'s."""
        return self.exposure.scale(name)

    def title(self, name: str) -> str:
        """What stands over the legend."""
        label, unit = NAMES[name]
        return label if unit == "1" else f"{label} [{unit}]"
