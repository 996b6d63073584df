"""A study as TOML, from what a person chose."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..whole_files import write_text
from .study import KEYS


def write_study(path: Path, values: Mapping[str, Any]) -> None:
    """Write a study's values (`study.KEYS`; None is left out), each key with what it means.

    Paths in it are relative to the file where they can be. Raises `InputError` where it cannot be
    written.
    """
    lines = []
    for key, meaning in KEYS.items():
        if values.get(key) is not None:
            lines += [f"# {meaning}", f"{key} = {_toml(values[key], path.parent)}", ""]
    write_text(path, "\n".join(lines))


def _toml(value: Any, folder: Path) -> str:
    if isinstance(value, Path):
        try:
            value = os.path.relpath(value, folder)
        except ValueError:  # another drive of Windows
            value = str(value)
        value = value.replace(os.sep, "/")
    if isinstance(value, Mapping):
        items = (f"{key} = {_toml(item, folder)}" for key, item in value.items())
        return "{ " + ", ".join(items) + " }"
    if isinstance(value, list | tuple):
        inner = [_toml(item, folder) for item in value]
        if any(isinstance(item, Mapping | Path) for item in value):
            return "[\n" + "".join(f"  {item},\n" for item in inner) + "]"
        return "[" + ", ".join(inner) + "]"
    # A JSON string is a TOML string, but for the one sign that JSON leaves as it is.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
