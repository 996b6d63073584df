"""A bar on stderr that says how far work is."""

from __future__ import annotations

import math
import sys
import time

_WIDTH = 20
_PAUSE = 0.05
"""[s] between two drawings: work may have thousands of steps a second."""


class Bar:
    """One line that is written over and over. It appears after ``delay`` [s], never if closed.

    Where stderr is no terminal nothing is drawn: of a line that is left, that alone.
    """

    def __init__(self, delay: float = 0.0) -> None:
        self._next = time.monotonic() + delay if sys.stderr.isatty() else math.inf
        self._line, self._shown = "", ""

    def show(self, before: str, done: float, after: str = "") -> None:
        """Show a bar that is ``done``, 0 to 1, between two texts."""
        filled = round(_WIDTH * min(max(done, 0.0), 1.0))
        self._line = f"{before} {'#' * filled}{'.' * (_WIDTH - filled)} {after}".rstrip()
        if time.monotonic() >= self._next:
            self._draw(self._line)

    def close(self, leave: bool = False) -> None:
        """Take the line away, or leave it as it was shown last."""
        if leave and self._line:
            start = "\r" if self._shown else ""
            print(f"{start}{self._line:<{len(self._shown)}}", file=sys.stderr, flush=True)
        elif self._shown:
            self._draw("")
        self._line = self._shown = ""

    def _draw(self, line: str) -> None:
        end = "" if line else "\r"
        print(f"\r{line:<{len(self._shown)}}", end=end, file=sys.stderr, flush=True)
        self._shown, self._next = line, time.monotonic() + _PAUSE
