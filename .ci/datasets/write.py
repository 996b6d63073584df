"""Write the published tables of colour-science that the package needs into the file that ships.

    .venv/bin/python .ci/datasets/write.py

`tests/spectra/test_datasets.py` compares the file with the colour-science that is installed.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib.metadata import distribution
from pathlib import Path

import numpy as np
from colour.characterisation import MSDS_CAMERA_SENSITIVITIES, SDS_COLOURCHECKERS
from colour.colorimetry import (
    MSDS_CMFS,
    SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES,
    SDS_ILLUMINANTS,
    SDS_LIGHT_SOURCES,
)
from colour.plotting.datasets.astm_g_173 import SD_ASTMG173_ETR
from colour.quality import SDS_TCS
from colour.recovery import MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
from numpy.typing import NDArray

from spectral_skylight.addon.spectra import datasets

SOURCES = {
    datasets.CMFS: "CIE 018:2019, DOI 10.25039/TR.018.2019",
    datasets.SUNLIGHT: "ASTM G173-03, extraterrestrial; Gueymard 2004, "
    "DOI 10.1016/j.solener.2003.08.039",
    datasets.DAYLIGHT: "Judd, MacAdam and Wyszecki 1964, DOI 10.1364/JOSA.54.001031; CIE 015:2018",
    datasets.ILLUMINANTS: "CIE 015:2018, DOI 10.25039/TR.015.2018; ISO 7589",
    datasets.LIGHT_SOURCES: "RIT's PointerData.xls; NIST CQS simulation 7.4.xls; Kinoton 75P",
    datasets.CAMERAS: "National Physical Laboratory: Darrodi et al. 2015, "
    "DOI 10.1364/JOSAA.32.000381",
    datasets.CHECKERS: "BabelColor's average of 30 charts, 2012; Ohta 1997; ISO 17321-1:2012; "
    "PMC: Luo 2024, DOI 10.1002/col.22940",
    datasets.BASIS_REFLECTANCES: "Mallett and Yuksel 2019, DOI 10.2312/sr.20191216",
    datasets.TEST_COLOURS: "CIE 13.3-1995",
}


def tables() -> Iterator[tuple[str, str, datasets.Dataset]]:
    """Yield kind, name and content of every table, as colour-science has it."""
    observer = "CIE 1931 2 Degree Standard Observer"
    yield datasets.CMFS, observer, _of(MSDS_CMFS[observer], ("x", "y", "z"))
    yield datasets.SUNLIGHT, "ASTM G173 ETR", _of(SD_ASTMG173_ETR, ("extraterrestrial",))
    for name, component in SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES.items():
        yield datasets.DAYLIGHT, name, _of(component, (name,))
    for kind, spectra in (
        (datasets.ILLUMINANTS, SDS_ILLUMINANTS),
        (datasets.LIGHT_SOURCES, SDS_LIGHT_SOURCES),
    ):
        for name, light in spectra.items():
            yield kind, name, _of(light, (name,))
    for name, camera in MSDS_CAMERA_SENSITIVITIES.items():
        yield datasets.CAMERAS, name, _of(camera, ("R", "G", "B"))
    for name in ("BabelColor Average", "ColorChecker N Ohta", "ISO 17321-1", "PMC"):
        patches = SDS_COLOURCHECKERS[name]
        first, *others = (patch.wavelengths for patch in patches.values())
        assert all(np.array_equal(first, other) for other in others)
        values = np.stack([patch.values for patch in patches.values()], axis=1)
        yield datasets.CHECKERS, name, datasets.Dataset(first, values, tuple(patches))
    samples = SDS_TCS
    first, *others = (sample.wavelengths for sample in samples.values())
    assert all(np.array_equal(first, other) for other in others)
    values = np.stack([sample.values for sample in samples.values()], axis=1)
    yield datasets.TEST_COLOURS, "CIE 1995", datasets.Dataset(first, values, tuple(samples))
    functions = _of(MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019, ("red", "green", "blue"))
    yield datasets.BASIS_REFLECTANCES, "Mallett 2019", functions


def _of(spectra: object, columns: tuple[str, ...]) -> datasets.Dataset:
    values = np.reshape(spectra.values, (len(spectra.wavelengths), -1))
    return datasets.Dataset(spectra.wavelengths, values, columns)


def members() -> dict[str, NDArray]:
    """Return all that the file holds, by the names of its members."""
    columns: dict[str, dict[str, tuple[str, ...]]] = {}
    arrays: dict[str, NDArray] = {}
    for kind, name, table in tables():
        columns.setdefault(kind, {})[name] = table.columns
        arrays[f"{kind}/{name}"] = np.column_stack([table.wavelengths, table.values])
    library = distribution("colour-science")
    about = {
        "library": "colour-science",
        "version": library.version,
        "url": "https://www.colour-science.org",
        "license": "BSD-3-Clause\n\n" + library.read_text("licenses/LICENSE"),
        "sources": SOURCES,
        "columns": columns,
    }
    return {datasets.ABOUT: np.frombuffer(json.dumps(about).encode(), np.uint8), **arrays}


def main(path: Path = datasets.FILE) -> None:
    """Write the file that ships."""
    np.savez_compressed(path, **members())
    print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
