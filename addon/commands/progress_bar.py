"""A bar on stderr for work that says how far it is."""

from __future__ import annotations

import time
from collections.abc import Generator

from ..bar import Bar
from ..progress import Done, Progress, run


def run_with_bar(work: Generator[Progress, None, Done], doing: str, delay: float = 0.0) -> Done:
    """Do all the work and return what it made; ``doing`` says what, before each step's own line.

    The bar appears after ``delay`` [s], and is gone when the work is done.
    """
    bar, start = Bar(delay), time.monotonic()

    def tell(progress: Progress) -> None:
        minutes, seconds = divmod(int(time.monotonic() - start), 60)
        text = f"{doing} {progress.line}"
        bar.show(f"{text:<50.50}", progress.done, f"{minutes:02d}:{seconds:02d}")

    try:
        return run(work, tell)
    finally:
        bar.close()
