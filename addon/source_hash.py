"""A hash of the program's own files, for results that are kept as long as it stays the same."""

from __future__ import annotations

import hashlib
from pathlib import Path

ROOT = Path(__file__).parents[1]
"""The package, which holds `addon` and `node_groups`."""


def source_files(*places: Path, root: Path = ROOT) -> list[Path]:
    """Return all files of folders, with those in them, and lone files, in a fixed order.

    Modules, tables and whatever else the program reads; not documents, compiled or hidden files.
    All lie under ``root``.
    """
    found = {
        path
        for place in places
        for path in ([place] if place.is_file() else place.rglob("*"))
        if path.is_file()
        if path.suffix != ".md"
        if not any(part.startswith((".", "__pycache__")) for part in path.relative_to(root).parts)
    }
    return sorted(found)


def source_hash(*places: Path, root: Path = ROOT) -> str:
    """Return a hash of names and bytes of `source_files`; the same wherever ``root`` is."""
    digest = hashlib.sha256()
    for path in source_files(*places, root=root):
        name, content = path.relative_to(root).as_posix(), path.read_bytes()
        digest.update(f"{name} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:24]
