"""Results that took long, kept on disk under a name made of all that went into them.

Safe to delete at any time. ``SPECTRAL_SKYLIGHT_CACHE`` names another folder, or none if empty.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from ..atomic_file import replacing
from ..source_hash import source_hash


def folder() -> Path | None:
    """Return the user's cache folder for this package, None where there is to be none."""
    given = os.environ.get("SPECTRAL_SKYLIGHT_CACHE")
    if given is not None:
        return Path(given) if given else None
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "spectral-skylight"


def place(kind: str, content: dict[str, Any], *code: Path) -> Path | None:
    """Return the file for a result: ``content`` is all that decides it, and folders of ``code``.

    None where there is to be no cache.
    """
    root = folder()
    if root is None:
        return None
    digest = hashlib.sha256(json.dumps(content, sort_keys=True, default=_plain).encode())
    digest.update(source_hash(*code).encode())
    return root / f"{kind}-{digest.hexdigest()[:32]}.npz"


def load(path: Path | None) -> dict[str, NDArray] | None:
    """Return the arrays of a file, None where there is none or it is damaged."""
    if path is None:
        return None
    try:
        with np.load(path, allow_pickle=False) as file:
            return dict(file)
    except (OSError, ValueError, EOFError, BadZipFile):
        return None


def save(path: Path | None, arrays: dict[str, NDArray]) -> None:
    """Write arrays, whole or not at all; where it cannot be done, nothing is kept."""
    if path is None:
        return
    with contextlib.suppress(OSError):  # a full or read-only disk costs time, not the result
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as part, part.open("wb") as file:
            np.savez(file, **arrays)


def _plain(value: Any) -> Any:
    return np.asarray(value).tolist()
