"""How far a run is: a bar for a person, and a small file for whoever watches from outside."""

from __future__ import annotations

import contextlib
import sys
import time
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..whole_files import write_json
from .duration import duration
from .run import Outcome

STATUS = "status.json"
PAUSE = 0.5
"""[s] between two looks at the file, or writings of it."""


class RunStatus:
    """A bar on stderr, and `STATUS` beside the plan. A context manager."""

    def __init__(self, out: Path) -> None:
        from tqdm import tqdm

        form = "{desc} {percentage:3.0f} % {bar:24} {n_fmt}/{total_fmt}{postfix}"
        self._bar = tqdm(total=0, bar_format=form, desc="batch", file=sys.stderr)
        self._path, self._written = out / STATUS, -PAUSE

    def __enter__(self) -> RunStatus:
        return self

    def __exit__(self, *_: Any) -> None:
        self._bar.close()

    def preparing(self, line: str) -> None:
        """Show what is made ready."""
        self._show("preparing", f", preparing {line}", now=True)

    def tell(self, outcome: Outcome, left: float | None) -> None:
        """Show how far the pictures are."""
        self._bar.total, self._bar.n = outcome.total, outcome.total - outcome.left
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
        self._bar.set_postfix_str(line.removeprefix(", "), refresh=False)
        if not now and time.monotonic() < self._written + PAUSE and outcome and outcome.left:
            return
        self._bar.refresh()  # not by tqdm's own clock, which jumps with the computer's
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
