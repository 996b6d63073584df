"""Every name on the page of nomenclature is in the code, and says what it is."""

import importlib
import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[1] / "addon" / "NOMENCLATURE.md"
ROW = re.compile(r"^\| ?([^|]*?) ?\| `([\w.]+)` \| ?([^|]*?) ?\|", re.MULTILINE)
ROWS = ROW.findall(PAGE.read_text(encoding="utf-8"))


def found(name):
    """The object of a dotted name below `addon`, and the one that holds it."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        try:
            thing = importlib.import_module(f"spectral_skylight.addon.{'.'.join(parts[:length])}")
        except ModuleNotFoundError as error:
            if not (error.name or "").startswith("spectral_skylight"):
                pytest.skip(f"{error.name} is not installed")
            continue
        holder = thing
        for part in parts[length:]:
            holder, own = thing, getattr(thing, "__dataclass_fields__", {})
            thing = own[part] if part in own else getattr(thing, part)
        return thing, holder
    raise AssertionError(name)


@pytest.mark.parametrize("name", [name for _, name, _ in ROWS])
def test_the_name_is_in_the_code(name):
    thing, holder = found(name)
    assert thing is not None
    assert (thing.__doc__ or holder.__doc__ or "").strip()


def test_shapes_are_those_of_the_grid():
    from spectral_skylight.addon.spectra.grid import WAVELENGTHS

    assert len(ROWS) > 20 and WAVELENGTHS.shape == (81,)
    assert [s for s, n, unit in ROWS if "(n,)" in unit and n == "spectra.grid.WAVELENGTHS"]
