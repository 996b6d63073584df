"""A table of what materials are given says the same after a round trip, and bad ones say why."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer import assignment
from spectral_skylight.addon.transfer.assignment import Assignment, estimate
from spectral_skylight.addon.transfer.assignment_table import read_table, table_files


@pytest.fixture
def folder(tmp_path):
    rows = "".join(f"{nm},{10 + nm / 20},{80 - nm / 40}\n" for nm in range(380, 781, 10))
    (tmp_path / "paint.csv").write_text("nm,red [%],clear [%]\n" + rows)
    metal = "".join(f"{nm / 1000},{0.2 + nm / 4000},{2 + nm / 500}\n" for nm in range(380, 781, 20))
    (tmp_path / "gold.csv").write_text("wl,n,k\n" + metal)
    return tmp_path


def written(folder, text):
    path = folder / "table.csv"
    path.write_text(text, encoding="utf-8")
    return path


def names(folder):
    return assignment.read(str(folder / "paint.csv:red [%]")).name


def test_each_kind_is_read(folder):
    red = names(folder)
    path = written(
        folder,
        "pane;unit;material;reflectance;glass;metal;behind\n"
        f";percent;Wall;paint.csv:{red};;;\n"
        "\n# a remark\n"
        "block;;Window;;paint.csv:clear [%];;\n"
        ";;Handle;;;gold.csv;\n"
        ";;Floor;estimate;;;\n"
        f";;Sill;paint.csv:{red};;;paint.csv:clear [%]\n",
    )
    found = read_table(path)
    assert list(found) == ["Wall", "Window", "Handle", "Floor", "Sill"]
    assert found["Floor"] is None
    wall, window, handle, sill = (found[name] for name in ("Wall", "Window", "Handle", "Sill"))
    assert wall.values[0] == pytest.approx(0.29) and not wall.faces and wall.metal is None
    assert window.faces == assignment.BLOCK and window.values[0] == pytest.approx(0.705)
    assert handle.metal is not None and handle.values.shape == (81,)
    np.testing.assert_allclose(sill.values, wall.values * window.values, rtol=1e-12)


def test_what_is_written_is_read_again(folder):
    """Files by their names, values that no file holds beside the table, all to the last bit."""
    red = f"{folder / 'paint.csv'}:{names(folder)}"
    glass = assignment.read(f"{folder / 'paint.csv'}:clear [%]", faces=assignment.SINGLE_FACE)
    lost = np.random.default_rng(1).random(81)
    given = {
        "Wall": assignment.read(red),
        'Window, "north"': glass,
        "Sill": assignment.read(red).lit_through(glass),
        "Handle": assignment.read_metal(str(folder / "gold.csv")),
        "Door": Assignment("by a script", lost),
        "Block": Assignment("clear", lost, faces=assignment.BLOCK),
        "Floor": estimate(np.full(81, 0.4)),
    }
    path = folder / "sub" / "table.csv"
    path.parent.mkdir()
    files = table_files(path, given)
    assert list(files) == [path.with_name("table.reflectances.csv"), path]
    for file, text in files.items():
        file.write_text(text, encoding="utf-8")
    found = read_table(path)
    assert found.keys() == given.keys() and found.pop("Floor") is None
    for name, one in found.items():
        np.testing.assert_array_equal(one.values, given[name].values, err_msg=name)
        assert one.faces == given[name].faces, name
        assert (one.metal is None) == (given[name].metal is None), name


def test_files_below_the_table_move_with_it(folder):
    given = {"Wall": assignment.read(f"{folder / 'paint.csv'}:{names(folder)}")}
    files = table_files(folder / "table.csv", given)
    assert "Wall,paint.csv:" in files[folder / "table.csv"]


def test_a_second_folder_is_looked_into(folder):
    (folder / "tables").mkdir()
    path = folder / "tables" / "one.csv"
    path.write_text(f"material,reflectance\nWall,paint.csv:{names(folder)}\n")
    assert read_table(path, (folder,))["Wall"].values[0] == pytest.approx(0.29)


MISTAKES = {
    "no material": ("name,reflectance\nWall,paint.csv", 'no column "material"'),
    "no kind": ("material,behind\nWall,paint.csv", 'no column "reflectance"'),
    "a column that nobody knows": ("material,reflectance,color\n", 'a column "color"'),
    "a column twice": ("material,glass,glass\n", 'two columns "glass"'),
    "nothing": ("material,reflectance\n", "assigns nothing"),
    "half": ("material,reflectance\nWall,\n", "line 2: is half empty"),
    "twice": ("material,reflectance\nWall,estimate\nWall,estimate\n", 'line 3: names "Wall" again'),
    "two kinds": ("material,reflectance,glass\nWall,a.csv,b.csv", "gives both reflectance and"),
    "a pane of no glass": ("material,reflectance,pane\nWall,a.csv,block", 'the pane "block"'),
    "a unit": ("material,reflectance,unit\nWall,a.csv,permille", 'the unit "permille"'),
    "glass behind": ("material,glass,behind\nWall,a.csv,b.csv", "is glass behind glass"),
    "an estimate behind": ("material,reflectance,behind\nWall,estimate,b.csv", "estimate behind"),
    "no such file": ("material,reflectance\nWall,none.csv:red", "none.csv"),
    "an open quote": ('material,reflectance\n"Wall,paint.csv\n', "is half empty"),
}


@pytest.mark.parametrize(("text", "message"), MISTAKES.values(), ids=MISTAKES.keys())
def test_mistakes_name_file_line_and_cure(folder, text, message):
    with pytest.raises(InputError) as caught:
        read_table(written(folder, text))
    assert message in str(caught.value) and "\n" not in str(caught.value)
    assert WAVELENGTHS.shape == (81,)


def test_a_table_that_is_no_text(folder):
    (folder / "table.csv").write_bytes(b"material,reflectance\n\xff\xfe,x\n")
    with pytest.raises(InputError, match="is not UTF-8 text"):
        read_table(folder / "table.csv")
    with pytest.raises(InputError, match="cannot be read"):
        read_table(folder / "no table.csv")
