"""Write the library of building materials that ships, from the published libraries.

    .venv/bin/python .ci/datasets/building_materials.py s07_AV95_envi.sli slum.csv

The first is the USGS Spectral Library Version 7 convolved to AVIRIS 1995 (R. Kokaly et al. 2017,
DOI 10.3133/ds1035, public domain), the second the Spectral Library of impervious Urban Materials
(S. Kotthaus et al. 2014, DOI 10.5281/zenodo.4263842, CC0 1.0) as CSV.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np

from spectral_skylight.addon.spectra import formats
from spectral_skylight.addon.spectra.formats import building_materials

USGS: dict[str, dict[str, str]] = {
    "Asphalt": {"Road, old": "GDS376", "Roof, tar, black": "GDS346"},
    "Brick": {
        "Building, dark red": "GDS350",
        "Building, red": "GDS353",
        "Building, light gray": "GDS354",
        "Paving, red": "GDS349",
        "Paving, tan": "GDS347",
        "Paving, brown gray": "GDS348",
        "Paving, dark gray": "GDS355",
    },
    "Concrete": {
        "Road, light gray": "GDS375",
        "Building": "Concrete WTC01-37A",
        "Cinder block, gray": "GDS356",
    },
    "Fabric": {
        "Cotton, white": "GDS437",
        "Burlap, brown": "GDS430",
        "Nylon, red": "GDS431",
        "Nylon, green": "GDS432",
        "Nylon, blue": "GDS433",
        "Carpet, light brown": "GDS535",
        "Carpet, gray": "GDS536",
        "Terrycloth, yellow": "GDS537",
    },
    "Grass": {
        "Lawn, green": "Lawn_Grass GDS91",
        "Dry, golden": "GDS480",
        "Cheatgrass, dry": "Cheatgrass ANPC1",
    },
    "Leaves": {
        "Aspen, upper side": "Aspen Aspen-1",
        "Aspen, under side": "Aspen Aspen-2",
        "Aspen, yellow": "Aspen Aspen-4",
        "Maple": "Maple_Leaves DW92-1",
        "Oak, fresh": "Oak-Leaf-1",
        "Oak, dry": "Oak-Leaf-2",
        "Walnut": "Walnut_Leaf",
        "Blue spruce, needles": "Blue_Spruce DW92-5",
        "Lodgepole pine, needles": "LP-Needles-1",
        "Juniper": "Juniper IH91-4B",
    },
    "Metal": {
        "Aluminum, brushed": "Aluminum brushed",
        "Aluminum, painted light gray": "GDS333",
        "Steel, galvanized": "GalvanizedSheetMetal GDS334",
        "Steel, galvanized, corrugated": "GDS352",
        "Steel, rusted": "Rusted_Tin_Can",
        "Copper, verdigris": "Verdigris GDS789",
    },
    "Paint": {
        "Titanium white": "GDS798",
        "Zinc white": "GDS807",
        "Lead white": "GDS796",
        "Bone black": "GDS808",
        "Yellow ocher": "GDS794",
        "Naples yellow": "GDS787",
        "Cadmium yellow": "GDS788",
        "Cadmium orange": "GDS786",
        "Cadmium red": "GDS778",
        "Venetian red": "GDS783",
        "Burnt sienna": "GDS812",
        "Burnt umber": "GDS811",
        "Chromium oxide green": "GDS795",
        "Viridian": "GDS800",
        "Cobalt blue": "GDS790",
        "Cerulean blue": "GDS797",
        "Ultramarine": "GDS791",
        "Prussian blue": "GDS802",
    },
    "Plastic": {
        "PVC, white": "GDS338",
        "Vinyl, white": "GDS372",
        "Vinyl, red": "GDS398",
        "Tarpaulin, green": "GDS339",
        "Tarpaulin, blue": "GDS340",
        "Pipe, blue": "GDS344",
        "Polystyrene, blue": "GDS345",
        "ABS, black": "GDS341",
    },
    "Plaster": {"Gypsum": "Gypsum SU2202", "Calcite, lime": "Calcite WS272 BECKa"},
    "Roofing": {
        "Asphalt shingle, tan": "GDS366",
        "Asphalt shingle, dark gray": "GDS367",
        "Asphalt shingle, light gray": "GDS368",
        "Felt, black": "GDS377",
        "Fiberglass, white": "GDS335",
        "Fiberglass, green": "GDS337",
        "Cedar shake, fresh": "GDS357",
        "Cedar shake, weathered": "GDS359",
        "Cedar shake, overgrown": "GDS360",
    },
    "Soil": {
        "Sand, beach": "Sand GrndIsle1",
        "Sand, wet": "Sand DWO-3-DEL2b",
        "Sand, quartz": "Quartz GDS74 Sand Ottawa BECKc",
        "Snow, melting": "mSnw01a ",
    },
    "Stone": {
        "Limestone": "Limestone CU02-11A",
        "Basalt, fresh": "Basalt_fresh",
        "Basalt, weathered": "Basalt_weathered",
    },
    "Wood": {
        "Pine, beam": "GDS363",
        "Pine, plywood": "GDS365",
        "Particle board": "GDS364",
        "Strand board": "GDS362",
    },
}
"""By class, names and what tells the record from others."""

SLUM: dict[str, dict[str, str]] = {
    "Asphalt": {"London, A001": "A001", "London, A006": "A006"},
    "Brick": {"London, B002": "B002", "London, B007": "B007"},
    "Concrete": {"London, C001": "C001", "London, C005": "C005"},
    "Granite": {"London, G002": "G002", "London, G005": "G005"},
    "Roofing": {"London, R001": "R001", "London, R005": "R005"},
    "Stone": {"London, S001": "S001"},
    "Metal": {"London, Z001": "Z001", "London, Z006": "Z006"},
}


def rows(path: Path, chosen: dict[str, dict[str, str]], source: str):
    """Yield class, name, source and values at the grid of the file that ships."""
    table = formats.read(path)
    grid = building_materials.GRID
    for kind, names in chosen.items():
        for name, record in names.items():
            found = [k for k, each in enumerate(table.names) if record in each]
            found = found[:1] if source != "SLUM" else found
            if not found:
                raise SystemExit(f"{path}: has no record {record!r}")
            values = table.values[:, found[0]]
            known = np.isfinite(values) & (values > -1.0)
            yield kind, name, source, np.interp(grid, table.wavelengths[known], values[known])


def main() -> None:
    """Write the file."""
    usgs, slum = map(Path, sys.argv[1:])
    found = [*rows(usgs, USGS, "USGS"), *rows(slum, SLUM, "SLUM")]
    found.sort(key=lambda row: row[:2])
    with building_materials.FILE.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        for k, heading in enumerate(("class", "name", "source")):
            table.writerow([heading, *(row[k] for row in found)])
        for k, wavelength in enumerate(building_materials.GRID):
            table.writerow([f"{wavelength:g}", *(f"{row[3][k]:.4f}" for row in found)])


if __name__ == "__main__":
    main()
