"""The one exception for input that a user can mend, and how it names parameters."""

from __future__ import annotations

import re
from collections.abc import Callable

_PARAMETER = re.compile("‹([a-z_]+)›")


def parameter(name: str) -> str:
    """Return what stands in an `InputError` for a parameter, by its name in Python.

    How a user gives it differs: an option of the command line, a field of the panel, a key of a
    study. Whoever shows the error says it, see `InputError.told`.
    """
    return f"‹{name}›"


def in_words(name: str) -> str:
    """Return a parameter's name as plain words: ``sun elevation``."""
    return name.replace("_", " ")


class InputError(ValueError):
    """Bad input: one line that names the file or `parameter`, the place in it and the cure."""

    def __init__(self, place: object, problem: str, cure: str) -> None:
        super().__init__(str(place), problem, cure)  # all three, or it could not be pickled

    @property
    def problem(self) -> str:
        """What is wrong, in words."""
        return _named(self.args[1], in_words)

    def told(self, name: Callable[[str], str]) -> str:
        """Return the line with each parameter as ``name`` calls it."""
        place, problem, cure = self.args
        line = _named(f"{place}: {problem}; {cure}", name)
        # What a file says, and its name, may hold breaks, escapes and half characters.
        if line.isprintable():
            return line
        return "".join(c if c.isprintable() else " " for c in line)

    def within(self, place: object, name: Callable[[str], str]) -> InputError:
        """Return the same error at a place of a file in which parameters have other names."""
        inner, problem, cure = (_named(text, name) for text in self.args)
        return InputError(f"{place}, {inner}", problem, cure)

    def of(self, old: str, new: str) -> InputError:
        """Return the same fault of another thing, which the place names between quotes."""
        place, problem, cure = self.args
        return InputError(place.replace(f"'{old}'", f"'{new}'", 1), problem, cure)

    def __str__(self) -> str:
        return self.told(in_words)


def _named(text: str, name: Callable[[str], str]) -> str:
    return _PARAMETER.sub(lambda found: name(found[1]), text)
