"""A study that was damaged, or made to hurt, is read or is one line."""

import random

import pytest

from spectral_skylight.addon.batch.study import Study, read_study
from spectral_skylight.addon.errors import InputError
from spectral_skylight.tests.batch.studies import NOON, write_inputs, write_study
from spectral_skylight.tests.spectra.fuzz import mutated

HUGE = "9" * 5000


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "house.blend").touch()
    return write_inputs(tmp_path)


@pytest.mark.parametrize(
    "line",
    [
        f"frames = [0x{'1' * 5000}]", f"frames = [{HUGE}]", "frames = [true]", "frames = [1048575]",
        f"white = [1.0, 1.0, {HUGE[:400]}]", "white = [inf, 1, 1]", "samples = true",
        f"resolution = [{HUGE[:30]}, 1]", "tolerance = nan", f"x = {'[' * 5000}",
        f"engine = {HUGE[:99]}",
        'variants = [{name = "a", assign = "\\u0000"}]',
        f'variants = [{{name = "a", assign = "{"b" * 300}.csv"}}]',
    ],
)  # fmt: skip
def test_values_that_hurt(folder, line):
    path = write_study(folder, variants=None, engine=None, samples=None, resolution=None)
    path.write_text(f"{path.read_text()}\n{line}\n")
    with pytest.raises(InputError) as caught:
        read_study(path)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    "change",
    [
        {"timezone": float("inf")}, {"timezone": 1e300}, {"date": "0001-01-01", "times": ["00:30"]},
        {"date": "9999-12-31", "timezone": "-14"}, {"timezone": "+" + "9" * 400},
        {"timezone": "../../etc/passwd"}, {"latitude": float("nan")}, {"times": ["24:61"]},
    ],
)  # fmt: skip
def test_days_and_places_that_are_none(folder, change):
    path = write_study(folder, skies=[{**NOON, "timezone": "+2", **{
        key: value for key, value in change.items() if not isinstance(value, float)
    }}])  # fmt: skip
    for key, value in change.items():
        if isinstance(value, float):
            path.write_text(path.read_text().replace(
                'timezone = "+2"' if key == "timezone" else "latitude = 48.1", f"{key} = {value}"
            ))  # fmt: skip
    with pytest.raises(InputError):
        read_study(path)


def test_damage_of_any_kind_is_one_line(folder):
    """Two hundred mutations, always the same, of a study and of the table that it names."""
    skies = ["sky.exr", {**NOON, "timezone": "Europe/Berlin"}]
    path, table = write_study(folder, skies=skies), folder / "red.csv"
    generator, read = random.Random(7), 0
    whole = {each: each.read_bytes() for each in (path, table)}
    for turn in range(200):
        each = (path, table)[turn % 2]
        each.write_bytes(mutated(whole[each], whole[path], generator))
        try:
            read += isinstance(read_study(path), Study)
        except InputError as error:
            assert "\n" not in str(error)
        each.write_bytes(whole[each])
    assert read > 10
