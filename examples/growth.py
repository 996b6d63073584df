"""How cost grows, with vertices, objects, materials and more:  sh examples/run growth

A town of boxes, of which one thing becomes more and more. Processor seconds of each step, and by
which power it grows over the largest three: `growth.csv` and `growth.png`. What is there stays.
"""

import argparse
import csv
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from main_job import silenced
from way import Clock

from spectral_skylight.addon.evaluation.chart_report import machine
from spectral_skylight.addon.evaluation.charts import new_figure, write
from spectral_skylight.addon.evaluation.report import write_csv
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.output import render
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer import assignment

USUAL = {"houses": 64, "cuts": 1, "materials": 8, "lamps": 0, "width": 120, "hours": 1}
"""A town where nothing is many: 64 boxes in 8 paints, 120 x 80 pixels."""

GROWING = {
    "vertices": ("cuts", (1, 4, 16, 51)),
    "objects": ("houses", (16, 64, 256, 1024)),
    "pixels": ("width", (120, 240, 480)),
    "materials": ("materials", (4, 16, 64)),
    "hours": ("hours", (1, 4, 24)),
    "lamps": ("lamps", (1, 8, 64)),
}
"""What grows: of which number of `USUAL`, over these."""

STEPS = {
    "materials": "Materials become spectral",
    "light": "All light is baked (64 rays a point)",
    "hours": "Other hours: lit anew",
    "frame": "A frame of it in Cycles, 16 samples",
}
COLOURS = dict(zip(STEPS, ("#1f6fb4", "#15803c", "#b4690e", "#777777"), strict=True))
FIELDS = ["grows", "count", *STEPS, "blender"]
RAYS, SAMPLES, SPACE = 64, 16, 18.0


def main() -> None:
    """Measure what is not there yet, and draw."""
    parser = argparse.ArgumentParser(
        prog="examples/run growth", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "growth")
    out = parser.parse_args().out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    path = out / "growth.csv"
    rows = list(csv.reader(path.open(encoding="utf-8")))[1:] if path.is_file() else []
    for grows, (name, counts) in GROWING.items():
        for count in counts:
            town = USUAL | {name: count}
            number = counted(grows, town)
            if any(row[:2] == [grows, str(number)] for row in rows):
                continue
            with silenced(out / "blender.log"):
                seconds = measured(**town)
            row = [grows, number, *(seconds[step] for step in STEPS), bpy.app.version_string]
            rows.append([str(cell) for cell in row])
            write_csv(path, FIELDS, rows)
            print(*row, flush=True)
    for file in draw(out / "growth", rows):
        print(file)


def counted(grows: str, town: dict[str, int]) -> int:
    """Return how many there are of what grows."""
    houses, cuts, width = town["houses"], town["cuts"], town["width"]
    many = {
        "vertices": 4 + houses * 6 * (cuts + 1) ** 2,
        "objects": houses + 1,
        "pixels": width * width * 2 // 3,
    }
    return many.get(grows, town.get(grows, 0))


def measured(houses, cuts, materials, lamps, width, hours) -> dict[str, float]:
    """Return the processor seconds of each step in one town."""
    build(houses, cuts, materials, lamps, width)
    scene, settings = bpy.context.scene, Settings(sun_elevation=35.0)
    curve = 0.4 + 0.2 * np.sin(np.linspace(0.0, 9.0, 81))
    given = {
        m: assignment.estimate(curve * (0.5 + 0.5 * k / materials))
        for k, m in enumerate(bpy.data.materials)
    }
    clocks = {step: Clock() for step in STEPS}
    with tempfile.TemporaryDirectory() as folder:
        sky = Path(folder) / "sky.exr"
        for hour in range(hours + 1):
            elevation = 35.0 - 5.0 * (hour % 4)
            write_panorama(sky, picture(simulate(elevation), 64, 200.0) @ observer().T)
            if hour == 0:
                use_cases.set_sky(scene, sky, settings)
                with clocks["materials"]:
                    use_cases.make_spectral(scene, given, settings)
                with clocks["light"]:
                    run(use_cases.bake(scene, settings, rays=RAYS))
                scene.cycles.samples, scene.cycles.use_denoising = SAMPLES, False
                scene.cycles.device, scene.cycles.use_adaptive_sampling = "CPU", False
                with clocks["frame"]:
                    render.render(scene, Path(folder) / "frame.exr", engine="cycles")
            else:
                with clocks["hours"]:
                    later = Settings(sun_elevation=elevation)
                    use_cases.load_sky(scene, sky, later)
    return {step: float(clock.seconds[1]) for step, clock in clocks.items()}


def build(houses: int, cuts: int, materials: int, lamps: int, width: int) -> None:
    """Make the town the open file's only scene: boxes of 10 m, each face in ``cuts`` x ``cuts``."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, rng = bpy.context.scene, np.random.default_rng(0)
    scene.world = bpy.data.worlds.new("World")
    paints = [bpy.data.materials.new(f"Paint {k}") for k in range(materials)]
    for paint in paints if bpy.app.version < (5, 0, 0) else ():
        paint.use_nodes = True
    side = int(np.ceil(houses**0.5))
    half = side * SPACE / 2
    edge = half + 20.0
    ground = [(-edge, -edge, 0), (edge, -edge, 0), (edge, edge, 0), (-edge, edge, 0)]
    add(scene, "Ground", np.array(ground), [(0, 1, 2, 3)], paints[0])
    for k in range(houses):
        at = np.array([k % side, k // side]) * SPACE - half + SPACE / 2
        size = rng.uniform((7.0, 7.0, 4.0), (12.0, 12.0, 14.0))
        corners, faces = sides(cuts)
        add(scene, f"House {k}", corners * size + [*at, 0.0], faces, paints[k % materials])
    for k in range(lamps):
        data = bpy.data.lights.new(f"Lamp {k}", "POINT")
        data.energy = 500.0
        lamp = bpy.data.objects.new(f"Lamp {k}", data)
        lamp.location = (*rng.uniform(-half, half, 2), 5.0)
        scene.collection.objects.link(lamp)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -edge, 25.0), (np.radians(68.0), 0.0, 0.0)
    camera.data.clip_end = 5000.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = width, width * 2 // 3


def sides(cuts: int) -> tuple[np.ndarray, list[tuple[int, int, int, int]]]:
    """Return the corners of a unit box on the ground and its quads, six sides of cuts x cuts."""
    step = np.linspace(-0.5, 0.5, cuts + 1)
    u, v = (axis.ravel() for axis in np.meshgrid(step, step, indexing="ij"))
    w, places, faces = np.full(u.size, 0.5), [], []
    for axis in range(3):
        for sign in (1.0, -1.0):
            columns = [None, None, None]
            columns[axis], columns[(axis + 1) % 3], columns[(axis + 2) % 3] = sign * w, sign * u, v
            first = len(places) * u.size
            places.append(np.stack(columns, axis=1) + np.array([0.0, 0.0, 0.5]))
            for i in range(cuts):
                for j in range(cuts):
                    a = first + i * (cuts + 1) + j
                    faces.append((a, a + cuts + 1, a + cuts + 2, a + 1))
    return np.concatenate(places), faces


def add(scene, name: str, places: np.ndarray, faces: list, paint: bpy.types.Material) -> None:
    """Add an object of these polygons."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(places.tolist(), [], faces)
    mesh.materials.append(paint)
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def slope(counts: np.ndarray, seconds: np.ndarray) -> float:
    """Return by which power seconds grow over the last three counts."""
    return float(np.polyfit(np.log(counts[-3:]), np.log(np.maximum(seconds[-3:], 1e-3)), 1)[0])


def draw(stem: Path, rows: list[list[str]]) -> list[Path]:
    """Draw seconds over counts, log-log, with the slope of each line at its end."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    known = {grows: [row for row in rows if row[0] == grows] for grows in GROWING}
    known = {grows: own for grows, own in known.items() if len(own) > 1}
    figure = new_figure(15.0, 8.2)
    axes = figure.subplots(2, 3)
    for axis in axes.flat[len(known) :]:
        axis.set_axis_off()
    for axis, (grows, own) in zip(axes.flat, known.items(), strict=False):
        counts = np.array([float(row[1]) for row in own])
        every = {s: np.array([float(row[2 + k]) for row in own]) for k, s in enumerate(STEPS)}
        beside = 0.0
        for step, seconds in sorted(every.items(), key=lambda each: each[1][-1]):
            if not seconds.all():
                continue
            beside = max(seconds[-1], 1.15 * beside)  # no number covers the one below
            axis.loglog(counts, seconds, marker="o", markersize=4, color=COLOURS[step])
            text = f"{slope(counts, seconds):.2f}"
            axis.annotate(
                text,
                (counts[-1], beside),
                (5, -3),
                textcoords="offset points",
                fontsize=9,
                color=COLOURS[step],
            )
        axis.set_title(grows, loc="left", fontsize=12, weight="bold")
        axis.set(xlabel=f"Number of {grows}", xlim=(counts[0] / 1.3, counts[-1] * 2.0))
        axis.grid(True, which="major", color="#e8e8e8")
        axis.spines[["top", "right"]].set_visible(False)
        for one in axis.xaxis, axis.yaxis:
            low, high = one.get_view_interval()
            wide = one is axis.xaxis and high > 300.0 * low
            one.set_major_locator(LogLocator(10.0, (1.0,) if wide else (1.0, 2.0, 5.0)))
            one.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
            one.set_minor_formatter(NullFormatter())
    for axis in axes[:, 0]:
        axis.set_ylabel("Processor time [s]")
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], marker="o", color=COLOURS[s], label=t) for s, t in STEPS.items()]
    figure.legend(handles=handles, loc="outside upper left", ncols=4, frameon=False)
    on = machine()
    figure.supxlabel(
        f"The number at a line's end: by which power it grows over its last three points. "
        f"{on['processor']}, {on['cores']} cores, Blender {rows[-1][-1]}",
        fontsize=9,
        color="#555555",
        x=0.012,
        ha="left",
    )
    return write(figure, stem)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # bpy before 5.0 can crash while the interpreter takes itself apart
