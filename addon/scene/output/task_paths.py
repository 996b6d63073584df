"""Where the files of a plan lie: below its folder, whatever the plan or a link in it says.

A plan may come from anywhere. A copy of this file lies beside each plan, so it imports nothing of
the package.
"""

from __future__ import annotations

import re
from pathlib import Path

_LONGEST = 255
"""Bytes in a name that file systems take."""


def checked(name: object, ending: str) -> str:
    """Return the name of a file, relative to a plan's folder and with slashes.

    Raises ValueError where it would lead out of the folder, on any system, or ends otherwise.
    """
    text = name if isinstance(name, str) else ""
    parts = text.split("/")
    plain = not re.search(r'[\\:*?"<>|\x00-\x1f\x7f\ud800-\udfff]', text)
    short = plain and all(len(part.encode()) <= _LONGEST for part in parts)
    if not short or not text.endswith(ending) or {"", ".", ".."} & set(parts):
        raise ValueError(f"{name!r:.200} is no path of a {ending} below the plan's folder")
    return text


def inside(root: Path, name: object, ending: str) -> Path:
    """Return the path of a file that a plan names; ValueError as `checked`, and for links."""
    path = root / checked(name, ending)
    if not path.resolve().is_relative_to(root.resolve()):
        raise ValueError(f"{name} is a link that leads out of the plan's folder")
    return path
