"""How far a run is: a bar for a person, and a small file for whoever watches from outside."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import Any

from ..bar import Bar
from ..errors import InputError
from ..whole_files import write_json
from .duration import duration
from .owner import STATUS
from .run import Outcome

PAUSE = 0.5
"""[s] between two looks at the file, or writings of it."""


class RunStatus:
    """A bar on stderr, and `STATUS` beside the plan. A context manager."""

    def __init__(self, out: Path) -> None:
        self._bar, self._done, self._total = Bar(), 0, 0
        self._path, self._written = out / STATUS, -PAUSE

    def __enter__(self) -> RunStatus:
        return self

    def __exit__(self, *_: Any) -> None:
        self._bar.close(leave=True)

    def preparing(self, line: str) -> None:
        """Show what is made ready."""
        self._show("preparing", f", preparing {line}", now=True)

    def tell(self, outcome: Outcome, left: float | None) -> None:
        """Show how far the pictures are."""
        self._done, self._total = outcome.total - outcome.left, outcome.total
        failed = f", {len(outcome.failures)} failed" if outcome.failures else ""
        more = "" if left is None else f", {duration(left)} left"
        self._show("rendering", more + failed, outcome, left)

    def end(self, state: str, outcome: Outcome | None = None) -> None:
        """Say how it ended: done, failed or stopped."""
        self._show(state, f", {state}", outcome, now=True)

    def _show(
        self,
        state: str,
        line: str,
        outcome: Outcome | None = None,
        left: float | None = None,
        now: bool = False,
    ) -> None:
        done = self._done / self._total if self._total else 0.0
        figures = f"{self._done}/{self._total}{line}"
        self._bar.show(f"batch {100 * done:3.0f} %", done, figures)
        if not now and time.monotonic() < self._written + PAUSE and outcome and outcome.left:
            return
        self._written = time.monotonic()
        status = {"state": state, "line": line.removeprefix(", "), "left": left}
        if outcome is not None:
            status |= {
                "total": outcome.total,
                "done": outcome.rendered + outcome.skipped,
                "failed": len(outcome.failures),
            }
        with contextlib.suppress(InputError):  # a full disk stops the pictures, with a better word
            write_json(self._path, status)
