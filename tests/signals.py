"""Processes that hear signals, whatever started the tests."""

from __future__ import annotations

import signal
import time
from pathlib import Path


def heard() -> None:
    """Run in a new process before its command: a shell's job in the background ignores Ctrl-C, and
    one that outlives its terminal its end; both hand that on."""
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)


def wait_until_caught(pid: int, kind: int, seconds: float = 60.0) -> None:
    """Wait until a process has a handler of its own for a signal; where that cannot be seen, as
    long as commands take to begin."""
    status = Path(f"/proc/{pid}/status")
    if not status.exists():
        time.sleep(1.5)
        return
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        mask = next(line for line in status.read_text().splitlines() if line.startswith("SigCgt"))
        if int(mask.split()[1], 16) >> (kind - 1) & 1:
            return
        time.sleep(0.05)
