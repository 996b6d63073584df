"""One run at a time in a folder: a lock of the operating system's, which no kill leaves behind."""

from __future__ import annotations

import contextlib
import os
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from ..errors import InputError

NAME = ".lock"
_BEYOND = 1 << 20  # the byte that Windows locks, behind what others want to read


@contextlib.contextmanager
def locked(folder: Path, patience: float = 1.0) -> Iterator[None]:
    """Hold a folder; InputError where another process does for longer than ``patience`` [s]."""
    path = folder / NAME
    folder.mkdir(parents=True, exist_ok=True)
    with path.open("a+", encoding="utf-8") as file:
        until = time.monotonic() + patience
        while not _try(file):
            if time.monotonic() >= until:
                file.seek(0)
                who = file.read().strip() or "another process"
                raise InputError(folder, f"{who} is at work here", "wait for its end, or stop it")
            time.sleep(0.05)
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        file.flush()
        yield  # closing the file ends the lock; so does the end of the process


if os.name == "nt":
    import msvcrt

    def _try(file: IO[str]) -> bool:
        file.seek(_BEYOND)
        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
        except OSError:
            return False
        return True
else:
    import fcntl

    def _try(file: IO[str]) -> bool:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
