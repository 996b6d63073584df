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

import numpy as np
from numpy.typing import NDArray

from ..atomic_file import clear_parts, replacing
from ..source_hash import source_hash

_DIGEST = "digest"
"""The array beside those of a result that proves them whole."""


def folder() -> Path | None:
    """Return the user's cache folder for this package, None where there is to be none.

    Nor is there one where nobody knows the user's home, as in a container without a user.
    """
    given = os.environ.get("SPECTRAL_SKYLIGHT_CACHE")
    if given is not None:
        return Path(given) if given else None
    named = {"win32": "LOCALAPPDATA", "darwin": ""}.get(sys.platform, "XDG_CACHE_HOME")
    below = {"win32": "AppData/Local", "darwin": "Library/Caches"}.get(sys.platform, ".cache")
    if base := os.environ.get(named):
        return Path(base) / "spectral-skylight"
    try:
        return Path.home() / below / "spectral-skylight"
    except RuntimeError:
        return None


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
    """Return the arrays of a file, None where there is none, or not all that `save` wrote."""
    if path is None:
        return None
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = dict(file)
        digest = arrays.pop(_DIGEST)
    except Exception:  # zip, zlib and numpy have a dozen ways to say that it is damaged
        return None
    return arrays if np.array_equal(digest, _digest(arrays)) else None


def save(path: Path | None, arrays: dict[str, NDArray]) -> None:
    """Write arrays, whole or not at all; where it cannot be done, nothing is kept."""
    if path is None:
        return
    with contextlib.suppress(OSError):  # a full or read-only disk costs time, not the result
        path.parent.mkdir(parents=True, exist_ok=True)
        clear_parts(path.parent)
        with replacing(path) as part, part.open("wb") as file:
            np.savez(file, **arrays, **{_DIGEST: _digest(arrays)})


def _digest(arrays: dict[str, NDArray]) -> NDArray[np.uint8]:
    """Return a hash of names, kinds and values of arrays."""
    found = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        found.update(f"{name} {array.dtype.str} {array.shape} ".encode() + array.tobytes())
    return np.frombuffer(found.digest(), np.uint8)


def _plain(value: Any) -> Any:
    return np.asarray(value).tolist()
