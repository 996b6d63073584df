"""`batch flamenco`: a plan as a job for Flamenco's workers."""

from __future__ import annotations

import argparse
import json
import sys

from .arguments import Commands


def add(steps: Commands) -> None:
    """Add the command to those of `batch`."""
    parser = steps.add_parser("flamenco", help="submit a plan as a job to Flamenco 3")
    parser.add_argument(
        "plan", metavar="PLAN.jsonl", help="plan, prepared with batch plan --prepare"
    )
    parser.add_argument(
        "--manager",
        metavar="http://HOST:8080",
        help="URL of the Flamenco Manager; default: print the job as JSON",
    )
    parser.add_argument(
        "--together", type=int, default=12, help="largest number of pictures per task"
    )
    parser.add_argument(
        "--workers",
        type=int,
        help="number of workers; default: as registered at the Manager, or 10",
    )
    parser.add_argument("--priority", type=int, default=50)
    parser.add_argument(
        "--tag", metavar="NAME", help="worker tag: only workers that have it render; default: all"
    )
    parser.add_argument(
        "--report", action="store_true", help="let a worker write the report in the end"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print the page of the job at the Manager, or the job itself and where its type belongs."""
    from ..batch.flamenco import submit
    from ..errors import InputError

    for option in ("together", "workers"):
        if (number := getattr(options, option)) is not None and number < 1:
            raise InputError(f"--{option}", f"{number} is too small", "use 1 or more")
    if options.tag and not options.manager:
        raise InputError("--tag", "is known to a Manager alone", "give --manager, too")
    how = (options.priority, options.report)
    if not options.manager:
        workers = options.workers or submit.WORKERS
        job = submit.job_of(options.plan, options.together, workers, *how)
        print(json.dumps(job, indent=1, ensure_ascii=False))
        print(f'copy {submit.SCRIPT} into the Manager\'s folder "scripts"', file=sys.stderr)
        return
    workers = options.workers or submit.workers_of(options.manager, options.tag)
    job = submit.job_of(options.plan, options.together, workers, *how)
    print(submit.submit(options.manager, job, options.tag))
    if lacks := submit.lacks(options.manager):
        print(lacks, file=sys.stderr)
