"""Names of things as names of files, on any system."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence

LONGEST = 100
"""Bytes: a picture's name is made of several, and file systems take 255."""

_FORBIDDEN = re.compile(r'[<>:"/\\|?*\x00-\x1f\x7f]+')
_DEVICES = re.compile(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\.|$)")


def file_names(names: Sequence[str]) -> list[str]:
    """Return a file name for each name: alike where it can be, and each of its own.

    Windows' forbidden signs become dashes, spaces stay; names that would then be one file, also on
    systems that take a and A for the same, get -2, -3 …; long ones are cut and given a hash.
    """
    taken: set[str] = set()
    found = []
    for name in names:
        base = _safe(name)
        candidate, number = base, 1
        while candidate.casefold() in taken:
            number += 1
            candidate = f"{base}-{number}"
        taken.add(candidate.casefold())
        found.append(candidate)
    return found


def _safe(name: str) -> str:
    safe = _FORBIDDEN.sub("-", name).strip(" .") or "-"
    if _DEVICES.match(safe):
        safe = f"-{safe}"
    if len(safe.encode()) > LONGEST:
        digest = hashlib.sha256(name.encode()).hexdigest()[:8]
        safe = safe.encode()[: LONGEST - 9].decode(errors="ignore").rstrip(" .") + f"-{digest}"
    return safe
