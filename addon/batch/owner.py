"""Whose a folder of results is: one study's, and nothing in it leads elsewhere.

What stands there may come from anywhere, or be a person's own: nothing is written over that is not
known to be a study's, and links out of the folder are not followed.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from ..errors import InputError
from ..scene.output import plan_data
from .task import sources

PLAN = "plan.jsonl"
STATUS = "status.json"
REPORTS = ("report.html", "report.json", "results.jsonl")
"""What stands beside a plan and never without one."""


def check_links(out: Path) -> None:
    """Raise InputError for what is right in ``out`` and is a link out of it, or a device."""
    root = out.resolve()
    for path in out.iterdir() if out.is_dir() else ():
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise InputError(out, f"its {path.name} is no regular file", "remove it")
        if path.is_symlink() and not path.resolve().is_relative_to(root):
            cure = "remove it, or choose another folder"
            raise InputError(out, f"its {path.name} is a link that leads out of the folder", cure)


def check_owner(study: Path, out: Path) -> None:
    """Raise InputError where ``out`` belongs to another study, or a person.

    Another study is one that is still there and still writes here.
    """
    cure = 'choose another "out"'
    if not (out / PLAN).exists():
        for name in _written(out):
            raise InputError(out, f"its {name} is of no study and would be written over", cure)
        return
    try:
        other = (out / plan_data.header(out / PLAN)["study"]).resolve()
    except (OSError, ValueError):
        raise InputError(out / PLAN, "is not a plan and would be written over", cure) from None
    if other != study.resolve() and _writes_to(other, out):
        raise InputError(out, f"belongs to the study {other}", cure)


def _written(out: Path) -> Iterator[str]:
    """Give names of files that stand where no plan does, and are not what a stopped run left."""
    yield from (name for name in REPORTS if (out / name).exists())
    if (out / STATUS).exists():
        try:
            found = (out / STATUS).read_text(encoding="utf-8") if (out / STATUS).is_file() else ""
            ours = "state" in json.loads(found)
        except (OSError, ValueError, TypeError, RecursionError):
            ours = False
        yield from () if ours else (STATUS,)
    for name, content in sources().items():  # they are copied before the plan is written
        if (out / name).exists() and not ((out / name).is_file() and _holds(out / name, content)):
            yield name


def _holds(path: Path, content: bytes) -> bool:
    return path.stat().st_size == len(content) and path.read_bytes() == content


def _writes_to(study: Path, out: Path) -> bool:
    from .study import KEYS
    from .toml_table import read_toml

    try:
        return (study.parent / read_toml(study, KEYS).text("out")).resolve() == out.resolve()
    except (InputError, OSError, ValueError):
        return False
