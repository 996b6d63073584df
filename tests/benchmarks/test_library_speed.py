"""How long a folder of 2,500 files of the USGS library takes, at first and again."""

import numpy as np
import pytest

from spectral_skylight.addon.spectra import library

CHANNELS = 2151


@pytest.fixture(scope="module")
def folder(tmp_path_factory, request):
    """As many files as splib07 has, each with all channels of its field spectrometer.

    A few where nothing is timed.
    """
    count = 2500 if request.config.getoption("benchmark_enable") else 25
    root = tmp_path_factory.mktemp("splib07a")
    chapter = root / "ChapterM_Minerals"
    chapter.mkdir()
    x = np.linspace(0.35, 2.5, CHANNELS)
    wavelengths = "\n".join(f"   {value:.6f}" for value in x)
    title = " splib07a Record=1: Wavelengths ASD\n"
    (root / "splib07a_Wavelengths_ASD_0.35-2.5_microns_2151_ch.txt").write_text(title + wavelengths)
    rows = "\n".join(f"  {0.3 + 0.2 * np.sin(5 * value):.7e}" for value in x)
    for k in range(count):
        path = chapter / f"splib07a_Mineral_{k:04}_ASDFRa_AREF.txt"
        path.write_text(f" splib07a Record={k}: Mineral {k}  ASDFRa AREF\n{rows}")
    return root


def test_index_of_2500_files(benchmark, folder):
    library.whole([folder.parent / "none"])  # loads the tables
    found = benchmark.pedantic(library.whole, ([folder],), rounds=1)
    assert len(found) >= 25 and not found.problems


def test_index_of_2500_files_again(benchmark, folder):
    library.whole([folder])
    assert len(benchmark.pedantic(library.whole, ([folder],), rounds=3)) >= 25


def test_searching_and_sorting_2500(benchmark, folder):
    found = library.whole([folder])
    found.order("hue")  # the colours are derived once

    def type_and_sort():
        return len(found.search("mineral 1")), found.order("hue")

    assert benchmark(type_and_sort)[0] > 10
