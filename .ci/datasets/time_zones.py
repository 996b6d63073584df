"""Write the time zones that ship, from the tz database as a package of PyPI holds it.

    pip download --no-deps tzdata==2026.6
    .venv/bin/python .ci/datasets/time_zones.py tzdata-2026.6-py2.py3-none-any.whl

IANA Time Zone Database (https://www.iana.org/time-zones), public domain.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from spectral_skylight.addon.sky import time_zones


def main(wheel: Path, out: Path = time_zones.FILE) -> None:
    """Write the file that ships: every zone's name, and of each kind of zone its rules once."""
    with ZipFile(wheel) as package:
        names = package.read("tzdata/zones").decode().split()
        rules = {name: package.read(f"tzdata/zoneinfo/{name}") for name in names}
    kinds = sorted(set(rules.values()))
    about = {
        "source": "IANA Time Zone Database, https://www.iana.org/time-zones, public domain",
        "package": wheel.name,
        "zones": {name: kinds.index(rules[name]) for name in sorted(names)},
    }
    np.savez_compressed(
        out,
        about=np.frombuffer(json.dumps(about).encode(), np.uint8),
        rules=np.frombuffer(b"".join(kinds), np.uint8),
        ends=np.cumsum([len(each) for each in kinds]),
    )
    print(f"{out}: {len(names)} zones, {out.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
