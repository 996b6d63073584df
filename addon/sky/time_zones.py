"""Time zones by their names, the same on every computer.

From the IANA Time Zone Database (https://www.iana.org/time-zones), public domain, as files in the
format of RFC 8536; `.ci/datasets/time_zones.py` writes them into one. Python itself asks the
computer, and Windows has none.
"""

from __future__ import annotations

import json
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

import numpy as np
from numpy.typing import NDArray

FILE = Path(__file__).with_name("time_zones.npz")


def names() -> list[str]:
    """Return the names of all zones, from A to Z."""
    return list(_about()["zones"])


@cache
def time_zone(name: str) -> ZoneInfo:
    """Return a zone with its summer times; raises KeyError for a name that is none."""
    kind = _about()["zones"][name]
    start, end = ([0, *_member("ends").tolist()])[kind : kind + 2]
    return ZoneInfo.from_file(BytesIO(_member("rules")[start:end].tobytes()), key=name)


@cache
def _about() -> dict[str, Any]:
    return json.loads(_member("about").tobytes())


@cache
def _member(name: str) -> NDArray:
    with np.load(FILE, allow_pickle=False) as file:
        return file[name]
