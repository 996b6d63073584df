"""Asking a peer: its script runs in its own environment, and we talk through files."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
ENVIRONMENT = HERE.parents[1] / ".venvs" / "peers"
PYTHON = ENVIRONMENT / "bin" / "python"
ANSWERS = ENVIRONMENT / "answers"
"""Kept by request, the peer's scripts and pins; safe to delete."""

OURS = ("blender_render.py",)
"""Scripts that run in our own environment. They are asked every time: our code is in no name."""

MISSING = "the peers' environment is not there: sh tests/peers/run builds it"


def ask(script: str, request: dict[str, Any], *, again: bool = False) -> dict[str, NDArray[Any]]:
    """Return what a peer's script answers to a request, asking only once unless ``again``.

    Raises FileNotFoundError without the peers' environment, CalledProcessError where the script
    fails.
    """
    if not PYTHON.exists():
        raise FileNotFoundError(MISSING)
    text = json.dumps(request, sort_keys=True)
    digest = hashlib.sha256(text.encode())
    for source in [*sorted(HERE.glob(f"{script.split('_')[0]}_*.py")), HERE / "requirements.txt"]:
        digest.update(source.read_bytes())
    ANSWERS.mkdir(exist_ok=True)
    name = ANSWERS / f"{Path(script).stem}-{digest.hexdigest()[:16]}"
    question, answer = name.with_suffix(".json"), name.with_suffix(".npz")
    if again or script in OURS or not answer.exists():
        question.write_text(text)
        if script in OURS:
            module = f"spectral_skylight.tests.peers.{Path(script).stem}"
            command = [sys.executable, "-m", module]
        else:
            command = [PYTHON, HERE / script]
        # What is printed belongs to the script, not to our tables.
        subprocess.run([*command, question, answer], check=True, stdout=sys.stderr)
    with np.load(answer) as file:
        return dict(file)
