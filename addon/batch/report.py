"""What came of a plan: `report.json` for programs and `report.html` for people, beside it.

By what lies there, whoever rendered it. A copy of this file beside a plan is a script for any
worker of a farm, so it imports nothing of the package:

    blender -b --factory-startup -P report.py -- PLAN.jsonl
"""

from __future__ import annotations

import json
import os
import sys
from collections import Counter
from pathlib import Path
from typing import Any

if __package__:
    from ..atomic_file import replacing
    from ..scene.output import plan_data
    from ..scene.output.image_file import made_by
    from ..scene.output.plan_range import Answer, Task, answers, planned
    from . import report_page
else:  # a copy beside a plan
    if "plan_data" not in sys.modules:  # a farm loads all of them once it has checked their hash
        sys.path.insert(0, str(Path(__file__).resolve().parent))
    import plan_data  # type: ignore[no-redef]
    import report_page  # type: ignore[no-redef]
    from atomic_file import replacing  # type: ignore[no-redef]
    from image_file import made_by  # type: ignore[no-redef]
    from plan_range import Answer, Task, answers, planned  # type: ignore[no-redef]


def write_report(plan: Path) -> dict[str, Any]:
    """Write both files from what lies beside a plan, and return what `report.json` holds.

    ``pictures``: a dictionary for each task, with ``status`` ``done``, ``failed`` or ``missing``,
    ``blender`` (the build that rendered it), ``seconds`` and ``error`` where known, paths relative
    to the plan; ``prepared``: what is known of each scene, sky and variant (`record`); ``counts``
    of statuses; ``blender``: the builds that rendered.
    """
    out, known = plan.parent, answers(plan.parent)
    header = plan_data.header(plan)
    found: dict[str, Any] = {
        "study": header["study"],
        "tasks": header["tasks"],
        "counts": {},
        "blender": [],
        "prepared": {},
        "pictures": [],
    }
    for task in planned(plan):
        if task["blend"] not in found["prepared"]:
            found["prepared"][task["blend"]] = record(out, task["blend"]) or _unknown(task["blend"])
        found["pictures"].append(_picture(out, task, known.get(task["key"], {})))
    found["counts"] = dict(Counter(picture["status"] for picture in found["pictures"]))
    found["seconds"] = sum(p["seconds"] or 0.0 for p in found["pictures"])
    found["blender"] = sorted({p["blender"] for p in found["pictures"] if p["blender"]})
    _write(
        plan_data.inside(out, "report.json", ".json"),
        json.dumps(found, ensure_ascii=False, indent=1) + "\n",
    )
    _write(plan_data.inside(out, "report.html", ".html"), report_page.page(found))
    return found


def _picture(out: Path, task: Task, known: dict[str, Answer]) -> dict[str, Any]:
    """Return what is known of a picture, first of all by its own files."""
    picture = {
        "exr": task["exr"],
        "png": task["exr"].removesuffix(".exr") + ".png",
        "prepared": task["blend"],
        "camera": task["camera"],
        "frame": task["frame"],
        "status": "done",
        "blender": None,
        "seconds": known.get("rendered", {}).get("seconds"),
    }
    try:
        picture["blender"] = made_by(
            plan_data.inside(out, task["exr"], ".exr"), task["key"]
        ).removeprefix("Blender ")
    except (OSError, ValueError):
        if "failed" not in known:
            return {**picture, "status": "missing"}
        return {**picture, "status": "failed", "error": known["failed"]["error"]}
    return picture


def record(out: Path, blend: str) -> dict[str, Any] | None:
    """Return what is known of a prepared file, None where it is not ready.

    ``format``: `plan_data.RECORD`, by which ours are known; ``name``: of the file; ``scene``,
    ``sky``, ``variant``: names of what it was made of; ``sun``: elevation and azimuth [degrees],
    null without one; ``blender``: the version that made it;
    ``materials``: a dictionary each, as `spectral.Result`, with its color as CSS has it;
    ``light``: which light its tolerance has chosen, as `LeastLight`, null where none was to choose;
    ``notes``: lines to read; ``elsewhere``: a line for each image that is still read from another
    place.
    """
    try:
        path = plan_data.inside(out, blend, ".blend")
        return plan_data.record(path.with_suffix(".json")) if path.is_file() else None
    except (OSError, ValueError):
        return None


def _unknown(blend: str) -> dict[str, Any]:
    name = Path(blend).stem
    return {"name": name, "scene": name, "sky": "", "variant": "", "materials": [], "notes": []}


def _write(path: Path, text: str) -> None:
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8", errors="backslashreplace", newline="")


if __name__ == "__main__":
    code = 1
    try:
        counts = write_report(Path(sys.argv[-1]))["counts"]
        print(", ".join(f"{count} {status}" for status, count in counts.items()))
        code = 0
    except BaseException as error:
        print(f"report.py: {error}", file=sys.stderr)
    finally:
        sys.stdout.flush()
        os._exit(code)  # Blender before 5.0 can crash at exit, and does not pass a code on
