"""The measured building materials that ship, by names like ``building:USGS:Brick: building, red``.

From the USGS Spectral Library Version 7 (R. Kokaly et al. 2017, DOI 10.3133/ds1035, public domain)
and the Spectral Library of impervious Urban Materials of London (S. Kotthaus et al. 2014, DOI
10.5281/zenodo.4263842, CC0 1.0). ``.ci/datasets/building_materials.py`` writes the file.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from ...errors import InputError
from ..table import Table
from .spectra import table

PREFIX = "building:"

FILE = Path(__file__).parents[1] / "building_materials.csv"

SETS = ("USGS", "SLUM")

SYNONYMS = {
    "Asphalt": "tarmac Asphalt asphalte asfalto アスファルト",
    "Brick": "Ziegel Klinker Backstein brique ladrillo 煉瓦 レンガ",
    "Concrete": "cement Beton béton hormigón コンクリート",
    "Fabric": "textile cloth Stoff tissu tela 布",
    "Granite": "Granit granito 花崗岩 御影石",
    "Grass": "lawn Rasen Gras herbe gazon césped hierba 芝 草",
    "Leaves": "foliage tree hedge Laub Blätter feuilles hojas 葉",
    "Metal": "Metall métal acero 金属",
    "Paint": "pigment Farbe Anstrich peinture pintura 塗料 絵具",
    "Plaster": "render stucco Putz Gips plâtre enduit yeso 漆喰",
    "Plastic": "Kunststoff plastique plástico プラスチック",
    "Roofing": "roof tile shingle Dach Dachziegel toiture teja tejado 屋根 瓦",
    "Soil": "earth sand ground Boden Erde Sand sol terre suelo arena 土 砂",
    "Stone": "rock Stein pierre piedra 石",
    "Wood": "timber Holz bois madera 木",
}
"""What else a class is called, in English and in the languages of the interface."""

GRID = np.arange(380.0, 785.0, 10.0)
"""[nm], as far apart as the USGS's bands are wide."""


def read(path: str) -> Table:
    """Return a set's reflectances; `InputError` for one that is not there."""
    name = path.removeprefix(PREFIX).strip()
    if name not in SETS:
        some = ", ".join(f"'{PREFIX}{each}'" for each in SETS)
        raise InputError(path, "is no set of building materials", f"there are {some}")
    with FILE.open(newline="", encoding="utf-8") as file:
        classes, names, sources, *rows = list(csv.reader(file))
    own = [k for k, source in enumerate(sources) if source == name]
    values = np.array([[float(row[k]) for k in own] for row in rows])
    return table(
        Path(path),
        [f"{classes[k]}: {names[k]}" for k in own],
        GRID,
        values,
        unit="fraction",
        classes=[classes[k] for k in own],
    )
