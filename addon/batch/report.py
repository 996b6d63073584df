"""What came of a plan: `report.json` for programs and `report.html` for people, beside it."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..whole_files import write_json, write_text
from . import report_page
from .plan import read_header, read_tasks
from .prepare import record
from .run import RESULTS


def write_report(plan: Path) -> dict[str, Any]:
    """Write both files from what lies beside a plan, and return what `report.json` holds.

    ``pictures``: a dictionary for each task, with ``status`` ``done``, ``failed`` or ``missing``,
    ``seconds`` and ``error`` where known, paths relative to the plan; ``prepared``: what is known
    of each scene, sky and variant (`prepare.record`); ``counts`` of statuses; ``blender``: the
    versions that rendered.
    """
    header, out = read_header(plan), plan.parent
    answers = _answers(out / RESULTS)
    found: dict[str, Any] = {
        "study": header["study"],
        "tasks": header["tasks"],
        "counts": {},
        "blender": sorted({a["blender"] for a in answers.values() if "blender" in a}),
        "prepared": {},
        "pictures": [],
    }
    for task in read_tasks(plan):
        if task.blend not in found["prepared"]:
            found["prepared"][task.blend] = record(out, task.blend) or _unknown(task.blend)
        answer = answers.get(task.key, {})
        there = (out / task.exr).is_file() and (out / task.png).is_file()
        status = "done" if there else "failed" if answer.get("status") == "failed" else "missing"
        if there and answer.get("status") == "failed":
            status = "failed"
        picture = {
            "exr": task.exr,
            "png": task.png,
            "prepared": task.blend,
            "camera": task.camera,
            "frame": task.frame,
            "status": status,
            "seconds": answer.get("seconds"),
        }
        found["pictures"].append(
            picture | ({"error": answer["error"]} if status == "failed" else {})
        )
    found["counts"] = dict(Counter(picture["status"] for picture in found["pictures"]))
    found["seconds"] = sum(p["seconds"] or 0.0 for p in found["pictures"])
    write_json(out / "report.json", found)
    write_text(out / "report.html", report_page.page(found))
    return found


def _answers(path: Path) -> dict[str, dict[str, Any]]:
    """Return the last answer to each task, by its key."""
    return {answer["key"]: answer for answer in _lines(path)}


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    if not path.is_file():
        return
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in file:
            try:
                yield json.loads(line)
            except ValueError:
                continue  # a run was killed while it wrote


def _unknown(blend: str) -> dict[str, Any]:
    name = Path(blend).stem
    return {"name": name, "scene": name, "sky": "", "variant": "", "materials": [], "notes": []}
