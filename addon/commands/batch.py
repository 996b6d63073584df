"""`batch`: many pictures, planned and rendered."""

from __future__ import annotations

import argparse
import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..errors import InputError
from . import batch_flamenco
from .arguments import Commands, option


def add(commands: Commands) -> None:
    """Add the command, and those under it, to those of the parser."""
    parser = commands.add_parser(
        "batch", help="render many pictures, on this machine or a render farm"
    )
    parser.set_defaults(parameter_name=_parameter_name)
    steps = parser.add_subparsers(required=True, metavar="plan|run|report|flamenco")
    plan = steps.add_parser("plan", help="check a study and list its pictures in a plan")
    plan.add_argument("study", metavar="STUDY.toml")
    plan.add_argument(
        "--prepare", action="store_true", help="also prepare the files that render workers open"
    )
    plan.set_defaults(run=_plan)
    run = steps.add_parser("run", help="render the missing pictures of a study")
    run.add_argument("study", metavar="STUDY.toml|PLAN.jsonl")
    where = run.add_mutually_exclusive_group()
    where.add_argument(
        "--workers", type=_count, help="number of processes; default: chosen automatically"
    )
    where.add_argument(
        "--scheduler",
        metavar="tcp://HOST:8786",
        help="address of the Dask scheduler whose workers render",
    )
    run.add_argument(
        "--blender",
        metavar="PATH",
        help="Blender executable on the rendering machine; default: this Blender",
    )
    run.add_argument("--timeout", type=float, metavar="SECONDS", help="time limit for one picture")
    run.add_argument("--dry-run", action="store_true", help="only list what would be rendered")
    run.set_defaults(run=_run)
    report = steps.add_parser("report", help="write report.html and report.json for a plan")
    report.add_argument("plan", metavar="PLAN.jsonl|STUDY.toml")
    report.set_defaults(run=_report)
    batch_flamenco.add(steps)


def _parameter_name(parameter: str) -> str:
    """Return what a parameter is called here: a study's key, else an option of these commands."""
    from ..batch.study import KEYS, key_of

    return key_of(parameter) if parameter in KEYS else option(parameter)


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 1024:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of processes")
    return int(text)


def _plan(options: argparse.Namespace) -> None:
    """Write a study's plan, and say how much it is."""
    from ..batch import plan, prepare, run_status, scenes, study
    from ..batch.lock import locked

    read = study.read_study(options.study)
    with locked(read.out):
        looked, program = scenes.look_into(read), scenes.program_hash()
        path = plan.write_plan(read, looked, program)
        print(path)
        print(_contents(path))
        if options.prepare:
            with run_status.RunStatus(read.out) as shown:
                made = prepare.prepare(read, looked, program, shown.preparing)
            print(_prepared(path, made))


def _contents(path: Path) -> str:
    from ..batch.plan import read_header

    header = read_header(path)
    return (
        f"{header['tasks']} pictures: {header['scenes']} scene(s), {header['skies']} skies, "
        f"{header['variants']} variant(s)"
    )


def _prepared(path: Path, made: Any) -> str:
    from ..batch.plan import read_header

    return (
        f"{made.skies} skies computed for {read_header(path)['tasks']} pictures; "
        f"{made.made} files prepared, {made.kept} were ready"
    )


def _run(options: argparse.Namespace) -> None:
    """Plan, prepare and render; fail where a picture did."""
    from ..batch import report, run, run_status
    from ..batch.lock import locked
    from ..batch.worker import blender_command

    if options.scheduler is None:
        blender_command(options.blender)
    out, path, outcome, state = _folder(options.study), None, None, "failed"
    with locked(out), run_status.RunStatus(out) as shown:
        try:
            path = _ready(options, shown)
            if options.dry_run:
                print(_contents(path))
                state = "done"
                return
            with _pool(options, path) as (pool, together, count):
                outcome = run.run(path, pool, shown.tell, together, count)
            state = "done" if outcome.complete else "failed"
        except KeyboardInterrupt:
            state = "stopped"
            raise
        finally:
            shown.end(state, outcome)
            if path is not None and not options.dry_run:
                report.write_report(path)
    _say(path, outcome)


@contextlib.contextmanager
def _pool(options: argparse.Namespace, plan: Path) -> Iterator[tuple[Any, Any, Any]]:
    """Yield those who render, how many pictures one takes at once, and how many they are."""
    if options.scheduler is not None:
        try:
            from ..batch import dask_farm
        except ImportError as error:
            cure = 'pip install "spectral-skylight[farm]"'
            raise InputError("--scheduler", f"needs Dask ({error})", cure) from None
        asked = (options.scheduler, plan.parent, options.blender, options.timeout)
        with dask_farm.dask_pool(*asked) as farm:
            yield farm, farm.together, farm.workers
        return
    from ..batch import local_pool
    from ..batch.plan import read_header, read_tasks

    first = next(read_tasks(plan, 0, 1))
    count = options.workers or local_pool.useful_workers(first.engine, read_header(plan)["tasks"])
    pool = local_pool.LocalPool(plan.parent, count, options.blender, options.timeout)
    with contextlib.closing(pool):
        yield pool, local_pool.TOGETHER, count


def _ready(options: argparse.Namespace, shown: Any) -> Path:
    """Return the path of a plan whose files are prepared."""
    from ..batch import plan, prepare, run, scenes, study

    given = Path(options.study).resolve()
    run.clear_leftovers(_folder(options.study))
    if given.suffix == ".jsonl":
        if not run.unprepared(given):
            return given
        given = (given.parent / plan.read_header(given)["study"]).resolve()
    shown.preparing("the plan")
    read = study.read_study(given)
    if read.out.resolve() != (out := _folder(options.study).resolve()):
        raise InputError(out, f"is of {given}, which writes to {read.out}", "run that study")
    looked, program = scenes.look_into(read), scenes.program_hash()
    path = plan.write_plan(read, looked, program)
    if not options.dry_run:
        made = prepare.prepare(read, looked, program, shown.preparing)
        print(_prepared(path, made))
    return path


def _folder(given: str) -> Path:
    """Return the folder of a plan or a study's results."""
    from ..batch import plan, study

    path = Path(given).resolve()
    if path.suffix == ".jsonl":
        plan.read_header(path)
        return path.parent
    return study.folder_of(path)


def _say(path: Path, outcome: Any) -> None:
    """Print what came of it; raise where not all pictures are there."""
    failed, page = len(outcome.failures), path.with_name("report.html")
    print(f"{outcome.rendered} rendered, {outcome.skipped} already done, {failed} failed")
    print(page)
    for failure in outcome.failures[:20]:
        print(failure, file=sys.stderr)
    if outcome.stopped:
        raise OSError(
            f"{outcome.stopped}; {outcome.left} pictures are left: free disk space and run again"
        )
    if not outcome.complete:
        raise OSError(f"{failed} picture(s) failed, see {page}")


def _report(options: argparse.Namespace) -> None:
    """Write the report of what is there, and fail where that is not everything."""
    from ..batch import plan, report

    path = Path(options.plan).resolve()
    path = path if path.suffix == ".jsonl" else _folder(options.plan) / "plan.jsonl"
    plan.read_header(path)
    counts = report.write_report(path)["counts"]
    print(", ".join(f"{count} {status}" for status, count in counts.items()))
    print(path.with_name("report.html"))
    if set(counts) != {"done"}:
        raise OSError("some pictures are missing")
