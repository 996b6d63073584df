"""What commands write: nothing that is read, nothing twice, no device, and names as they are meant.

An option of a file or folder that is written has `output` or `output_folder` as its type; whatever
else an option names is an input, so that no command can forget one.
"""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable, Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from ..errors import InputError
from .arguments import option


class Output(str):
    """A path that is written. ``others``: endings of files that are written beside it."""

    ending = ""
    others: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    """Patterns of the files that are written into a folder; empty for a file."""


def output(ending: str, *others: str) -> Callable[[str], Output]:
    """Return the type of an option that names a file to write, of this ending."""

    def typed(text: str) -> Output:
        path = Output(text)
        path.ending, path.others = ending, others
        return path

    return typed


def output_folder(*names: str) -> Callable[[str], Output]:
    """Return the type of an option that names a folder to write files like these into."""

    def typed(text: str) -> Output:
        path = Output(text)
        path.names = names
        return path

    return typed


def check(options: argparse.Namespace) -> None:
    """Raise InputError for an output that cannot be, before any work.

    That is one of another ending, one that is no regular file, one in a folder that is none, and
    one that an option names as an input or as another output. Links are followed.
    """
    named = [(name, value) for name, value in vars(options).items() if isinstance(value, Output)]
    if not named:
        return
    inputs = [path for value in vars(options).values() for path in _files(value)]
    taken: list[Path] = []
    for name, value in named:
        for path in _written(option(name), value, inputs):
            if any(_same(path, other) for other in inputs):
                raise InputError(option(name), f"{path} is an input, too", "choose another name")
            if any(_same(path, other) for other in taken):
                raise InputError(option(name), f"{path} is an output already", "choose two names")
            taken.append(path)


def _written(name: str, value: Output, inputs: list[Path]) -> Iterator[Path]:
    """Give the files that an output may be, checked on their own."""
    path = Path(value)
    if value.names:
        for other in inputs:
            if any(fnmatch(other.name, pattern) for pattern in value.names):
                yield path / other.name
        return
    if path.suffix.lower() != value.ending or not path.stem:
        raise InputError(name, f"{value} is no {value.ending}", f"write FILE{value.ending}")
    if not value.others and not path.parent.is_dir():
        raise InputError(name, f"{path.parent} is no folder", "choose another place")
    for each in (path, *(path.with_suffix(other) for other in value.others)):
        if each.exists() and not each.is_file():
            raise InputError(name, f"{each} is no regular file", "choose another name")
        yield each


def _files(value: Any) -> Iterator[Path]:
    """Give the files that an option's value may name: whole, or before a ``:COLUMN``."""
    if isinstance(value, list | tuple):
        for each in value:
            yield from _files(each)
    if isinstance(value, str) and not isinstance(value, Output):
        value = re.sub(r"^measured[ :=]\s*", "", value)  # as `spectra.bases` has it
        ends = [k for k, sign in enumerate(value) if sign == ":"] + [len(value)]
        yield from (path for end in ends if (path := Path(value[:end])).name and _is_file(path))


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long for a name, or with a zero byte
        return False


def _same(one: Path, other: Path) -> bool:
    """Whether two paths are one file, also by links, and by upper and lower case where it may."""
    try:
        if one.exists() and other.exists():
            return one.samefile(other)
    except OSError:
        return False
    return os.path.normcase(os.path.realpath(one)) == os.path.normcase(os.path.realpath(other))
