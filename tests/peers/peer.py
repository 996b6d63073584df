"""Asking a peer: its script runs in its own environment, and we talk through files."""

from __future__ import annotations

import hashlib
import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
ENVIRONMENT = HERE.parents[1] / ".venvs" / "peers"
PYTHON = ENVIRONMENT / "bin" / "python"
ANSWERS = ENVIRONMENT / "answers"
"""Kept by request, script and pins; safe to delete."""

MISSING = "the peers' environment is not there: sh tests/peers/run builds it"


def ask(script: str, request: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """Return what a peer's script answers to a request, asking only once.

    Raises FileNotFoundError without the environment, CalledProcessError where the script fails.
    """
    if not PYTHON.exists():
        raise FileNotFoundError(MISSING)
    text = json.dumps(request, sort_keys=True)
    digest = hashlib.sha256(text.encode())
    for source in (script, "radiance_files.py", "requirements.txt"):
        digest.update((HERE / source).read_bytes())
    ANSWERS.mkdir(exist_ok=True)
    name = ANSWERS / f"{Path(script).stem}-{digest.hexdigest()[:16]}"
    question, answer = name.with_suffix(".json"), name.with_suffix(".npz")
    if not answer.exists():
        question.write_text(text)
        subprocess.run([PYTHON, HERE / script, question, answer], check=True)
    with np.load(answer) as file:
        return dict(file)
