"""Text and plain data to files, whole or not at all."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..scene.output.image_file import part_of


def write_json(path: Path, content: Any) -> None:
    """Write plain data, whole or not at all; numbers that are none become null."""
    text = json.dumps(_finite(content), ensure_ascii=False, indent=1, default=list)
    write_whole(path, text + "\n")


def write_whole(path: Path, text: str) -> None:
    """Write text, whole or not at all; InputError where that cannot be done."""
    part = part_of(path)
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise InputError(path, f"cannot be written ({error.strerror})", "check the disk") from None
    finally:
        part.unlink(missing_ok=True)


def _finite(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: _finite(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_finite(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content
