"""The one exception for input that a user can mend, and how it names parameters."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable
from pathlib import Path

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
        return printable(_named(f"{place}: {problem}; {cure}", name))

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


def fault(error: BaseException) -> str:
    """Return the line for an exception that nobody foresaw: a fault of the program's own.

    It names the exception, the last place in our files, and who wants to know of it.
    """
    root = Path(__file__).parents[1]
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if Path(frame.filename).is_relative_to(root)] or frames
    at = f" ({Path(ours[-1].filename).name}, line {ours[-1].lineno})" if ours else ""
    said = " ".join(f"{type(error).__name__}: {error}".split())[:300]
    return printable(f"a fault of this program, {said}{at}; please report this line {_address()}")


def _address() -> str:
    import tomllib

    try:
        manifest = (Path(__file__).parents[1] / "blender_manifest.toml").read_text("utf-8")
        found = tomllib.loads(manifest)
        return f"at {found['website']}" if "website" in found else f"to {found['maintainer']}"
    except (OSError, ValueError, KeyError):  # installed by pip, without it
        return "to the Spectral Skylight developers"


def printable(line: str) -> str:
    """Return a line without what a file's text or name may hold: breaks, escapes, half signs."""
    return line if line.isprintable() else "".join(c if c.isprintable() else " " for c in line)


def _named(text: str, name: Callable[[str], str]) -> str:
    return _PARAMETER.sub(lambda found: name(found[1]), text)
