"""A file that is replaced as a whole or stays as it was.

A copy of this file lies beside each plan of a batch, so it imports nothing of the package.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import socket
import threading
from collections.abc import Iterator
from pathlib import Path


def host() -> str:
    """Return this machine's name as names of files can have it."""
    return "".join(c for c in socket.gethostname() if c.isalnum() or c == "-") or "host"


def part_of(path: Path) -> Path:
    """Return the name under which this thread writes a file before it is whole.

    In the same folder: only there is renaming one indivisible act.
    """
    who = f"{host()}.{os.getpid()}-{threading.get_native_id()}"
    return path.with_name(f".{path.stem}.{who}.part{path.suffix}")


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a path to write to, which takes the place of ``path`` if all goes well, else is gone.

    A file that is replaced passes on its mode. A symbolic link stays one, and what it points to is
    replaced. Raises OSError where that cannot be done, also for what is no regular file.
    """
    path = Path(os.path.realpath(path)) if path.is_symlink() else path
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is no regular file", str(path))
    part = part_of(path)
    try:
        yield part
        if path.exists():
            shutil.copymode(path, part)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
