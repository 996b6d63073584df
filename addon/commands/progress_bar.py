"""A bar on stderr for work that says how far it is."""

from __future__ import annotations

import sys
from collections.abc import Generator

from ..progress import Done, Progress, run


def run_with_bar(work: Generator[Progress, None, Done], doing: str, delay: float = 0.0) -> Done:
    """Do all the work and return what it made; ``doing`` says what, before each step's own line.

    The bar appears after ``delay`` [s], and is gone when the work is done.
    """
    from tqdm import tqdm

    form = "{desc:<50.50} {bar:20} {elapsed}"
    with tqdm(total=1.0, file=sys.stderr, bar_format=form, leave=False, delay=delay) as bar:

        def tell(progress: Progress) -> None:
            bar.set_description_str(f"{doing} {progress.line}", refresh=False)
            bar.update(progress.done - bar.n)

        return run(work, tell)
