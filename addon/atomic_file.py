"""A file that is replaced as a whole or stays as it was.

A copy of this file lies beside each plan of a batch, so it imports nothing of the package.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

PART = re.compile(r"\..*\.(?P<host>[^.]+)\.(?P<process>\d+)-\d+\.part(\..*)?@?", re.DOTALL)
"""What `part_of` returns. Blender writes under that name with an @ first."""

LONGEST = 250
"""[bytes] File systems take 255 in a name, and Blender 255 with its @ and the end of the text."""


def host() -> str:
    """Return this machine's name as names of files can have it."""
    return "".join(c for c in socket.gethostname() if c.isalnum() or c == "-") or "host"


def part_of(path: Path) -> Path:
    """Return the name under which this thread writes a file before it is whole.

    In the same folder: only there is renaming one indivisible act. Names that are too long are cut.
    """
    who = f".{host()[:64]}.{os.getpid()}-{threading.get_native_id()}.part{path.suffix[:16]}"
    room = LONGEST - len(who.encode()) - 1  # of them all, but for the dot in front
    return path.with_name(
        f".{path.stem.encode(errors='ignore')[:room].decode(errors='ignore')}{who}"
    )


def clear_parts(folder: Path) -> None:
    """Remove what dead processes of this machine left half-written in a folder."""
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            found = PART.fullmatch(entry.name)
            if found and found["host"] == host()[:64] and not _alive(int(found["process"])):
                with contextlib.suppress(OSError):
                    Path(entry.path).unlink()


def _alive(process: int) -> bool:
    """Whether a process is there; on Windows its file says so, which cannot be removed then."""
    if os.name == "nt":
        return process == os.getpid()
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:  # it is another user's
        return True
    return True


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
        for left in (part, part.with_name(f"{part.name}@")):  # Blender's own, where it ran full
            left.unlink(missing_ok=True)
