"""One line for each cause: who is concerned stands together, with their number."""

from __future__ import annotations

from collections.abc import Iterable

NAMED = 3
"""So many are named of more."""


def some(names: Iterable[str], kind: str) -> str:
    """Return names as a line has them: ``Wall``, or ``17 materials (Wall, Roof, Door …)``."""
    each = list(dict.fromkeys(names))
    if len(each) == 1:
        return each[0]
    more = " …" if len(each) > NAMED else ""
    return f"{len(each)} {kind}s ({', '.join(each[:NAMED])}{more})"


def grouped(found: Iterable[tuple[str, str]], kind: str = "material") -> list[str]:
    """Return a line for each cause of pairs (name, cause), in the order of the causes."""
    causes: dict[str, list[str]] = {}
    for name, cause in found:
        causes.setdefault(cause, []).append(name)
    return [f"{some(names, kind)}: {cause}" for cause, names in causes.items()]
