"""The chart of whole pictures: what is off by how much after how long, whichever way it is made.

    sh examples/run chart --scenes [NAME ...] [--ways PATTERN ...] [--draw]

Each way runs in a process of its own, and leaves its points in `scenes.csv`. What stands there for
the same scene, program and Blender is not measured again, so that one may stop and go on.
"""

import argparse
import csv
import multiprocessing
import os
import resource
import sys
import time
from collections.abc import Callable
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.evaluation.report import write_csv
from spectral_skylight.addon.evaluation.scene_chart import FIELDS, report_scenes

SCENES = "street", "courtyard", "sun", "room", "white", "dusk"
HERE = Path(__file__).resolve().parent
SIZE = 120, 80
"""Pixels of the pictures, as the references of `sh examples/run NAME` have them."""
MOST = 900
"""Seconds after which a way is given up."""

FORKS = "forkserver" in multiprocessing.get_all_start_methods()
PROCESSES = multiprocessing.get_context("forkserver" if FORKS else "spawn")
"""One process a way, so that none finds anything warm. This one never imports bpy, which no other
could import after that: it changes the path."""


def main() -> int:
    """Measure what is not there yet, and draw; exit code as the command line's."""
    parser = argparse.ArgumentParser(prog="examples/run chart --scenes", description=__doc__)
    parser.add_argument("--scenes", nargs="*", metavar="NAME", help=", ".join(SCENES))
    parser.add_argument("--ways", nargs="+", default=["*"], metavar="PATTERN")
    parser.add_argument("--out", type=Path, default=HERE / "out" / "chart")
    parser.add_argument("--references", type=Path, default=HERE / "out", metavar="DIR")
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw what is there")
    options = parser.parse_args()
    if FORKS:
        PROCESSES.set_forkserver_preload(["bands", "pictures"])
    try:
        wanted = options.scenes or list(SCENES)
        if unknown := sorted(set(wanted) - set(SCENES)):
            cure = f"use {', '.join(SCENES)}"
            raise InputError("--scenes", f"{unknown[0]} is not one of them", cure)
        out = options.out.resolve()
        out.mkdir(parents=True, exist_ok=True)
        if not options.draw:
            measure(wanted, options.ways, out, options.references.resolve())
        for path in report_scenes(out, read(out / "scenes.csv")):
            print(path)
    except InputError as error:
        print(f"examples/run: {error}", file=sys.stderr)
        return 2
    return 0


def measure(names: list[str], patterns: list[str], out: Path, references: Path) -> None:
    """Fill `scenes.csv` with what is missing, those ways first that tell most."""
    path = out / "scenes.csv"
    states, program, known = _in_a_process(prepared, names, references)
    ways = [way for way in known if any(fnmatch(way, pattern) for pattern in patterns)]
    if not ways:
        raise InputError("--ways", f"{patterns} fits none", f"it has {'; '.join(known)}")
    for way in ways:
        for name in names:
            state = states[name] + program * way.startswith("Ours")
            if any((r["scene"], r["way"], r["state"]) == (name, way, state) for r in read(path)):
                continue
            print(f"{time.strftime('%H:%M:%S')} {name}: {way}", flush=True)
            try:
                new = _in_a_process(measured, name, way, references)
            except RuntimeError as error:
                new = [{"failed": str(error)}]
            # What others have left meanwhile stays.
            kept = [row for row in read(path) if (row["scene"], row["way"]) != (name, way)]
            for point in new:
                kept.append({field: str(point.get(field, "")) for field in FIELDS})
                kept[-1] |= {"scene": name, "way": way, "state": state}
            write_csv(path, FIELDS, [[row[field] for field in FIELDS] for row in kept])


def read(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table of points; none before any."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if rows and set(FIELDS) - set(rows[0]):
        raise InputError(path, "has other columns", "move it away, to measure anew")
    return rows


def _in_a_process(work: Callable[..., Any], *arguments: Any) -> Any:
    """Return what work returns in a process of its own; RuntimeError where it fails there."""
    here, there = PROCESSES.Pipe(duplex=False)
    process = PROCESSES.Process(target=_child, args=(there, work, arguments))
    process.start()
    there.close()
    try:
        done, result = here.recv() if here.poll(MOST) else (False, f"not done after {MOST} s")
    except EOFError:
        process.join()
        done, result = False, f"Blender has ended with exit code {process.exitcode}"
    finally:
        process.kill()
        process.join()
    if not done:
        raise RuntimeError(result)
    return result


def _child(result: Any, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    try:
        result.send((True, work(*arguments)))
    except Exception as error:
        result.send((False, f"{type(error).__name__}: {error}"))
    result.close()
    os._exit(0)  # bpy before 5.0 can crash while the interpreter takes itself apart


def prepared(names: list[str], references: Path) -> tuple[dict[str, str], str, list[str]]:
    """Make scenes ready; return the digest of each, the add-on's own, and all ways' names."""
    from lit_scenes import SCENES as examples
    from ready import ready
    from ways import there

    from spectral_skylight.addon.batch.scenes import program_hash

    states = {name: ready(name, examples[name], references, SIZE).digest for name in names}
    return states, f".{program_hash()[:8]}", there()


def measured(name: str, way: str, references: Path) -> list[dict]:
    """Return the points of one way, as rows of the table; in a process of its own."""
    import bpy
    from lit_scenes import SCENES as examples
    from main_job import silenced
    from ready import ready
    from ways import WAYS

    scene = ready(name, examples[name], references, SIZE)
    points = []
    with silenced(scene.folder / "blender.log"):
        for shot in WAYS[way].shots(scene, True):
            point: dict = {
                "family": WAYS[way].family,
                "label": WAYS[way].label,
                **_both("", shot.seconds),
                **_both("setup_", shot.setup),
                "megabytes": shot.megabytes or "",
                "memory_MB": shot.memory
                or resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
                "noise": scene.noise()["mean"],
                "noise_p95": scene.noise()["p95"],
                "blender": bpy.app.version_string,
            }
            for what, seconds in shot.again.items():
                point |= _both(f"{what}_", seconds)
            points.append(point | scene.figures(shot.picture))
    return points


def _both(prefix: str, seconds) -> dict[str, float]:
    wall, processor = map(float, seconds)
    return {f"{prefix}seconds": wall, f"{prefix}processor": processor}


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # bpy before 5.0 can crash while the interpreter takes itself apart
