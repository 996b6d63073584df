"""What stands in a plan's folder, read as what it should be: anyone may have written it.

Paths lie below the folder, whatever the plan or a link says; a line or a record is whole, or none.
Everything here raises ValueError for what is not right. A copy of this file lies beside each plan,
so it imports nothing of the package.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

FORMAT = "spectral-skylight plan"
RECORD = "spectral-skylight prepared file"
"""By which plans and records of prepared files are known."""
VERSION = 1
"""Of plans."""

_LONGEST = 255
"""Bytes in a name that file systems take."""


def inside(root: Path, name: object, ending: str) -> Path:
    """Return the path of a file that a plan names, as `checked`, where no link leads out either."""
    path = root / checked(name, ending)
    if not path.resolve().is_relative_to(root.resolve()):
        raise ValueError(f"{name} is a link that leads out of the plan's folder")
    return path


def checked(name: object, ending: str) -> str:
    """Return the name of a file of this ending, relative to a plan's folder and with slashes.

    It leads out of the folder on no system.
    """
    text = name if isinstance(name, str) else ""
    parts = text.split("/")
    plain = not re.search(r'[\\:*?"<>|\x00-\x1f\x7f\ud800-\udfff]', text)
    short = plain and all(len(part.encode()) <= _LONGEST for part in parts)
    if not short or not text.endswith(ending) or {"", ".", ".."} & set(parts):
        raise ValueError(f"{name!r:.200} is no path of a {ending} below the plan's folder")
    return text


def header(plan: Path) -> dict[str, Any]:
    """Return the first line of a plan; raises OSError where it cannot be read."""
    if plan.exists() and not plan.is_file():
        raise ValueError("is no regular file")
    with plan.open(encoding="utf-8", errors="replace") as file:
        line = file.readline(1 << 16)
    try:
        version = _whole({"format": lambda value: value == FORMAT}, line).get("version")
    except ValueError:
        raise ValueError("is not a plan") from None
    if version != VERSION:
        raise ValueError(f"is of version {version!r:.100}")
    return _whole(_HEADER, line)


def task(line: str) -> dict[str, Any]:
    """Return the task of a plan's line, see `batch.task.Task`."""
    found = _whole(_TASK, line)
    if unknown := found.keys() - _TASK.keys():
        raise ValueError(f"nobody knows its {min(unknown)!r:.100}")
    checked(found["blend"], ".blend")
    checked(found["exr"], ".exr")
    return found


def answer(line: str) -> dict[str, Any]:
    """Return an answer that was kept to a task that was rendered or failed."""
    found = _whole(_ANSWER, line)
    if found["status"] == "failed" and not isinstance(found.get("error"), str):
        raise ValueError("it failed without an error")
    if found["status"] == "rendered" and not _is_time(found.get("seconds", 0)):
        raise ValueError("it took no time that can be")
    return found


def record(path: Path) -> dict[str, Any]:
    """Return what is known of a prepared file, by the path of its record; raises OSError."""
    if not path.is_file():
        raise ValueError("it is no regular file")
    return _whole(_KNOWN, path.read_text(encoding="utf-8", errors="replace"))


def _whole(kinds: dict[str, Callable[[Any], bool]], text: str) -> dict[str, Any]:
    """Return a JSON object whose named values are all of their kinds."""
    try:
        found = json.loads(text)
    except RecursionError:
        raise ValueError("it is too deep") from None
    if not isinstance(found, dict):
        raise ValueError("it is no object")
    for name, is_right in kinds.items():
        if not is_right(found.get(name)):
            raise ValueError(f"its {name} is {found.get(name)!r:.100}")
    return found


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _are(kind: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, list) and all(kind(each) for each in value)


def _between(low: int, high: int) -> Callable[[Any], bool]:
    return lambda value: type(value) is int and low <= value <= high


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) < 1e12


def _is_time(value: Any) -> bool:
    return _is_number(value) and value >= 0


def _or_none(kind: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: value is None or kind(value)


def _count(kind: Callable[[Any], bool], count: int) -> Callable[[Any], bool]:
    return lambda value: _are(kind)(value) and len(value) == count


def _is_material(value: Any) -> bool:
    return isinstance(value, dict) and all(is_(value.get(name)) for name, is_ in _MATERIAL.items())


_HEADER = {"study": _is_text, "tasks": _between(0, 1 << 40)}
_TASK = {
    **dict.fromkeys(("scene", "camera", "key", "blend", "exr"), _is_text),
    "index": _between(0, 1 << 40),
    "frame": _between(-(1 << 20), 1 << 20),
    "samples": _or_none(_between(1, 1 << 24)),
    "engine": lambda value: value in (None, "eevee", "cycles"),
    "resolution": _count(_between(1, 1 << 16), 2),
}
_ANSWER = {"key": _is_text, "status": lambda value: value in ("rendered", "failed")}
_MATERIAL = {
    **dict.fromkeys(("material", "reflectance", "line"), _is_text),
    **dict.fromkeys(("matrix_delta_E", "rgb_delta_E"), _or_none(_is_number)),
    "out_of_gamut": lambda value: isinstance(value, bool),
    "swatch": lambda value: value is None or bool(re.fullmatch(r"rgb\([\d. ]{1,40}\)", str(value))),
}
_KNOWN = {
    "format": lambda value: value in (None, RECORD),  # of an earlier version
    **dict.fromkeys(("name", "scene", "sky", "variant"), _is_text),
    "sun": _or_none(_count(_is_number, 2)),
    "materials": _are(_is_material),
    "notes": _are(_is_text),
}
