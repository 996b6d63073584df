"""Files for users, written whole or not at all; what prevents it is one clear line."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .atomic_file import clear_parts, replacing
from .errors import InputError


@contextlib.contextmanager
def writing(path: str | Path) -> Iterator[Path]:
    """Yield a path to write to, which replaces ``path`` as a whole, as `atomic_file.replacing`.

    Raises `InputError` where the file cannot be written, which Blender and OpenEXR report by
    RuntimeError; what stood there stays. What killed processes left beside it is removed.
    """
    clear_parts(Path(path).parent)
    try:
        with replacing(Path(path)) as part:
            yield part
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or str(error).strip() or type(error).__name__
        problem = f"cannot be written ({reason.splitlines()[-1]})"
        raise InputError(path, problem, "choose another place, or check the disk") from error


def write_text(path: Path, text: str) -> None:
    """Write text as UTF-8 with line ends as they are; InputError as `writing`.

    Half characters, of names that are no UTF-8, are escaped as JSON and Python do.
    """
    with writing(path) as part:
        part.write_text(text, encoding="utf-8", errors="backslashreplace", newline="")


def write_json(path: Path, content: Any) -> None:
    """Write plain data; numbers that are not finite become null. InputError as `writing`."""
    write_text(
        path, json.dumps(_finite(content), ensure_ascii=False, indent=1, default=list) + "\n"
    )


def _finite(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: _finite(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_finite(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content
