"""A disk that is full after so many bytes of a file, by the limit on the size of files."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

THERE = resource is not None
WHY = "only POSIX limits the size of a process's files"


@contextlib.contextmanager
def full_after(size: int) -> Iterator[None]:
    """Refuse whatever this process writes behind ``size`` bytes of a file, as a full disk does."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
