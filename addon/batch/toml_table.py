"""A table of a TOML file, asked for its values: what is wrong is said with file, key and cure."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NoReturn

from ..choices import listed
from ..errors import InputError
from ..spectra import files

_MISSING: Any = object()


class Table:
    """A table and where it stands; each value is taken by a method that checks its kind."""

    def __init__(self, place: str, values: dict[str, Any], known: Iterable[str]) -> None:
        self.place, self.values = place, values
        for key in values:
            if key not in (known := list(known)):
                near = difflib.get_close_matches(key, known, 1, 0.5)
                cure = f'did you mean "{near[0]}"?' if near else f"known are {', '.join(known)}"
                raise InputError(f'{place}, "{key}"', "is not a key of this table", cure)

    def wrong(self, key: str, cure: str) -> NoReturn:
        """Raise what says that a key's value, or its absence, will not do."""
        found = _shown(self.values[key]) if key in self.values else "missing"
        raise InputError(f'{self.place}, "{key}"', found, cure)

    def text(self, key: str, default: Any = _MISSING) -> Any:
        """Return a value that is text and not empty."""
        value = self.values.get(key, default)
        if value is not default and not (isinstance(value, str) and value):
            self.wrong(key, "give text")
        return value if value is not _MISSING else self.wrong(key, "give text")

    def choice(self, key: str, choices: Iterable[str], default: Any = _MISSING) -> Any:
        """Return one of some words."""
        value = self.values.get(key, default)
        if value is _MISSING or (value is not default and value not in list(choices)):
            self.wrong(key, f"choose {listed(choices)}")
        return value

    def number(self, key: str, low: float, high: float, default: Any = _MISSING) -> Any:
        """Return a number from ``low`` to ``high``."""
        value = self.values.get(key, default)
        if value is _MISSING or (value is not default and not _number(value, low, high)):
            self.wrong(key, f"give a number from {low:g} to {high:g}")
        return value

    def whole(self, key: str, low: int, high: int, default: Any = _MISSING) -> Any:
        """Return a whole number from ``low`` to ``high``."""
        value = self.values.get(key, default)
        if value is _MISSING or (value is not default and not _whole(value, low, high)):
            self.wrong(key, f"give a whole number from {low} to {high}")
        return value

    def switch(self, key: str, default: bool) -> bool:
        """Return true or false."""
        value = self.values.get(key, default)
        return value if isinstance(value, bool) else self.wrong(key, "give true or false")

    def items(self, key: str, kinds: tuple[type, ...], cure: str, default: Any = _MISSING) -> Any:
        """Return an array of values of some kinds, at least one; a lone value is an array too."""
        if key not in self.values and default is not _MISSING:
            return default
        value = self.values.get(key)
        value = [value] if isinstance(value, kinds) else value
        if not (isinstance(value, list) and value and all(isinstance(v, kinds) for v in value)):
            self.wrong(key, cure)
        return value


def read_toml(path: Path, known: Iterable[str]) -> Table:
    """Return the top table of a file; InputError with line and column where it is no TOML."""
    try:
        values = tomllib.loads(files.content(path).decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise InputError(path, "is not UTF-8 text", "save it as UTF-8") from None
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise InputError(path, f"is not TOML: {reason}", "see https://toml.io") from None
    return Table(str(path), values, known)


def _shown(value: Any) -> str:
    """Return a value as its file may have it, short."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # Python writes no numbers of more than 4300 digits
        return "more than can be"
    return text if len(text) <= 200 else f"{text[:200]} …"


def _number(value: Any, low: float, high: float) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high


def _whole(value: Any, low: int, high: int) -> bool:
    return type(value) is int and low <= value <= high
