"""The building materials that ship: whole, found by their names, as they were published."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra import library
from spectral_skylight.addon.spectra.formats import building_materials
from spectral_skylight.addon.spectra.reflectance import read_one


def shipped():
    every = library.built_in()
    return every.only([k for k, path in enumerate(every.paths) if path.startswith("building:")])


def test_sixty_to_a_hundred_of_every_kind():
    found = shipped()
    assert 60 <= len(found) <= 100 and found.problems == ()
    assert len(set(found.names)) == len(found)
    assert set(found.classes) == set(building_materials.SYNONYMS)
    assert found.values.min() >= 0.0 and found.values.max() <= 1.0
    assert building_materials.FILE.stat().st_size < 50_000


def test_one_is_given_by_its_name():
    brick = read_one("building:USGS:Brick: Building, red").values[0]
    assert brick[-1] > 3 * brick[4]  # red: iron oxide's edge at 580 nm
    with pytest.raises(InputError, match="no set of building materials"):
        read_one("building:Paris:Brick")


@pytest.mark.parametrize(
    ("text", "kind"),
    [("backstein", "Brick"), ("béton", "Concrete"), ("レンガ", "Brick"), ("madera", "Wood")],
)
def test_they_are_found_in_other_languages(text, kind):
    found = shipped()
    chosen = [found.classes[k] for k in found.search(text)]
    assert chosen and set(chosen) == {kind}


def test_they_are_as_they_were_published(shared_data):
    """Read from the USGS's own file: to the digits that ship, straight between its bands."""
    from spectral_skylight.addon.spectra import formats

    folder = shared_data / "reflectance" / "usgs_splib07_aviris95"
    path = folder / "s07_AV95_envi.sli"
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    table = formats.read(path)
    record = next(k for k, name in enumerate(table.names) if "GDS353" in name)
    ours = formats.read("building:USGS")
    column = ours.values[:, list(ours.names).index("Brick: Building, red")]
    expected = np.interp(building_materials.GRID, table.wavelengths, table.values[:, record])
    assert column == pytest.approx(expected, abs=5.1e-5)
