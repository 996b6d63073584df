"""Folders of reflectances: found, searched, sorted, cached; a broken file is lost alone."""

import json
import os

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.pictures import swatches
from spectral_skylight.addon.spectra import library
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.addon.transfer.swatches import beside, under_sky

X = np.arange(380, 781, 10)


def curve(low, high, centre=580, width=40):
    return low + (high - low) / (1 + np.exp((centre - X) / width))


def csv(path, **columns):
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = [f"{x},{','.join(f'{c[k]:.6f}' for c in columns.values())}" for k, x in enumerate(X)]
    path.write_text("\n".join([f"nm,{','.join(columns)}", *rows]))
    return path


@pytest.fixture
def folder(tmp_path):
    """Bricks and a tile, a file that is broken in part, one that is broken, two of other things."""
    root = tmp_path / "paints"
    csv(root / "walls" / "bricks.csv", red=curve(0.05, 0.6), grey=curve(0.4, 0.4))
    csv(root / "roof" / "tile.csv", dark=curve(0.04, 0.04), blue=curve(0.6, 0.05))
    csv(root / "roof" / "half.csv", white=curve(0.9, 0.9), wrong=curve(-0.5, 0.5))
    (root / "broken.csv").write_text("nm,a\n400,high\n")
    (root / "README.txt").write_text("Paints, measured by hand.\nNo numbers here.\n")
    (root / "settings.json").write_text('{"theme": "dark"}')
    (root / ".hidden.csv").write_text("nm,a\n")
    return root


def test_a_folder_is_found_and_a_broken_file_spoils_itself_alone(folder):
    found = library.whole([folder])
    assert found.names == ("white", "dark", "blue", "red", "grey")
    assert found.sources[3] == "paints/walls/bricks.csv" and found.others == 2
    assert [problem.count("\n") for problem in found.problems] == [0, 0]
    for problem, parts in zip(
        sorted(found.problems), (["broken.csv:2", "'high'"], ["half.csv", "'wrong'"]), strict=True
    ):
        assert all(part in problem for part in parts)
    file = read_reflectances(folder / "walls" / "bricks.csv")
    np.testing.assert_array_equal(found.values[3:], file.values)


def test_search_and_orders(folder):
    found = library.whole([folder])
    names = np.array(found.names)
    assert set(names[found.search("BRICKS")]) == {"red", "grey"}
    assert list(names[found.search("bricks grey")]) == ["grey"]
    assert len(found.search("")) == 5 and len(found.search("marble")) == 0
    assert list(names[found.order("name")]) == ["blue", "dark", "grey", "red", "white"]
    assert names[found.order("lightness")[[0, -1]]].tolist() == ["dark", "white"]
    assert list(names[found.order("hue")]) == ["red", "blue", "dark", "grey", "white"]
    assert found.only(found.order("source")).sources[0] == "paints/roof/half.csv"
    with pytest.raises(InputError, match="name, hue, lightness or source"):
        found.order("price")


def test_Lab_is_colour_sciences_own():
    """Integrated by colour-science from the patches as they are tabulated, not on our grid."""
    import colour

    found = library.built_in()
    patches = colour.SDS_COLOURCHECKERS["ColorChecker N Ohta"]
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    d65 = colour.SDS_ILLUMINANTS["D65"]
    start = found.sources.index("ColorChecker N Ohta")
    for k, patch in list(enumerate(patches.values(), start))[:24:5]:
        XYZ = colour.sd_to_XYZ(patch, observer, d65, method="Integration") / 100
        Lab = colour.XYZ_to_Lab(XYZ, colour.CCS_ILLUMINANTS[observer.name]["D65"])
        np.testing.assert_allclose(found.Lab[k], Lab, atol=0.2)


def test_what_was_read_once_is_not_read_again(folder, monkeypatch):
    read = []
    original = library.read_all
    monkeypatch.setattr(library, "read_all", lambda path: read.append(path.name) or original(path))
    first = library.whole([folder])
    count = len(read)
    assert count == 6
    again = library.whole([folder])
    assert len(read) == count and again.names == first.names
    assert again.problems == first.problems and again.others == first.others
    np.testing.assert_array_equal(again.values, first.values)
    csv(folder / "walls" / "bricks.csv", red=curve(0.05, 0.6), grey=curve(0.4, 0.4), new=X / 999)
    (folder / "roof" / "half.csv").unlink()
    later = library.whole([folder])
    assert read[count:] == ["bricks.csv"]
    assert later.names == ("dark", "blue", "red", "grey", "new")


def test_work_that_was_ended_goes_on_where_it_was(folder, monkeypatch):
    work = library.index([folder])
    lines = [next(work).line for _ in range(4)]
    work.close()
    read = []
    original = library.read_all
    monkeypatch.setattr(library, "read_all", lambda path: read.append(path) or original(path))
    assert len(library.whole([folder])) == 5
    assert len(lines) == 4 and len(read) == 3


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 no zip", b"\x00" * 100])
def test_a_damaged_cache_is_made_anew(folder, tmp_path, monkeypatch, damage):
    monkeypatch.setenv("SPECTRAL_SKYLIGHT_CACHE", str(tmp_path / "cache"))
    first = library.whole([folder])
    (file,) = (tmp_path / "cache").iterdir()
    file.write_bytes(damage)
    assert library.whole([folder]).names == first.names


def test_folders_that_are_not_there_are_told(tmp_path, folder):
    found = library.whole([tmp_path / "gone", folder])
    assert len(found) == 5 and "gone: is not a folder" in found.problems[0]


def test_spectra_of_a_file_with_the_same_fault_share_a_line(tmp_path):
    values = {f"leaf {k}": np.where(X == 500, -0.1, 0.2) for k in range(30)}
    csv(
        tmp_path / "leaves.csv",
        **values,
        good=curve(0.1, 0.2),
        lost=np.where(X == 600, np.nan, 0.2),
    )
    found = library.whole([tmp_path])
    assert found.names == ("good",) and found.unused == 31
    assert len(found.problems) == 2
    assert ":14, column 'leaf 0' and 29 more: -0.1 is below 0" in found.problems[0]
    assert "'lost': nan is not a number" in found.problems[1]


def test_a_folder_that_may_not_be_looked_into_is_told(folder, monkeypatch):
    original = os.scandir

    def scandir(path):
        if str(path).endswith("walls"):
            raise PermissionError(13, "Permission denied", str(path))
        return original(path)

    monkeypatch.setattr(os, "scandir", scandir)
    found = library.whole([folder])
    assert found.names == ("white", "dark", "blue") and found.unused == 3
    assert any("walls: cannot be read (Permission denied)" in line for line in found.problems)


def test_whatever_a_reader_raises_costs_its_file_alone(folder, monkeypatch):
    original = library.read_all

    def fail(path):
        if path.name == "tile.csv":
            raise OverflowError("bytes that mean\nnothing")
        return original(path)

    monkeypatch.setattr(library, "read_all", fail)
    found = library.whole([folder])
    assert found.names == ("white", "red", "grey")
    (line,) = [problem for problem in found.problems if "tile.csv" in problem]
    assert "OverflowError: bytes that mean nothing" in line


def test_swatches_under_a_sky_have_its_colour_and_not_its_strength():
    mapping = transfer("rayleigh")
    light = np.array([3.0, 5.0, 9.0])
    rho = np.stack([np.ones(81), np.full(81, 0.25)])
    rgb = under_sky(mapping, rho, light)
    np.testing.assert_allclose(rgb[0] / rgb[0, 0], light / light[0], rtol=1e-9)
    np.testing.assert_allclose(rgb[1], rgb[0] / 4, rtol=1e-9)
    assert rgb[0] @ [0.2126, 0.7152, 0.0722] == pytest.approx(1.0, abs=1e-3)
    np.testing.assert_allclose(under_sky(mapping, rho, 100 * light), rgb)
    assert not under_sky(mapping, rho, np.zeros(3)).any()
    beside_it, d65 = beside(mapping, rho, light)
    assert beside_it.max() == pytest.approx(1.0)  # a screen can show it
    np.testing.assert_allclose(beside_it / rgb, d65 / rgb_albedo(rho), rtol=1e-9)


def test_the_sheet_shows_both_halves_of_each():
    pixels = swatches.swatches(["a", "b"], [[1, 0, 0], [0, 1, 0]], [[0, 0, 1], [2, 2, 2]])
    left, top, wide = swatches.MARGIN, swatches.TOP, swatches.WIDTH
    y = int(top + swatches.HEIGHT / 2)
    seen = [pixels[y, int(left + x)].tolist() for x in (9, wide - 9, wide + 30, 2 * wide)]
    assert seen == [[255, 0, 0], [0, 0, 255], [0, 255, 0], [255, 255, 255]]
    assert swatches.swatches([], None, np.zeros((0, 3))).shape[2] == 3
    many = swatches.swatches(["x"] * 999, None, np.zeros((999, 3)))
    assert many.shape[0] < 5000


def test_command(folder, tmp_path, capsys):
    sheet = tmp_path / "sheet.png"
    arguments = ["library", str(folder), "--search", "bricks", "--sort", "lightness", "--json"]
    assert cli.main([*arguments, "--sky-rgb", "0.3,0.5,1", "--sheet", str(sheet)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert sorted(one["name"] for one in told["spectra"]) == ["grey", "red"]
    grey = next(one for one in told["spectra"] if one["name"] == "grey")
    np.testing.assert_allclose(grey["rgb_d65"], 0.4, atol=1e-6)
    np.testing.assert_allclose(
        np.divide(grey["rgb_sky"], grey["rgb_sky"][0]), [1, 5 / 3, 10 / 3], rtol=1e-6
    )
    assert len(told["problems"]) == 2 and told["others"] == 2
    assert sheet.read_bytes().startswith(b"\x89PNG")
    assert cli.main(["library", "--search", "dark skin"]) == 0
    out, err = capsys.readouterr()
    assert "colour:BabelColor Average:dark skin" in out and "3 of 202 spectra" in err
    assert cli.main(["library", "--sort", "price"]) == 2
    assert cli.main(["library", "--search", "nothing like it", "--sheet", str(sheet)]) == 2
    assert "matches no reflectance" in capsys.readouterr().err


def test_what_the_list_names_the_other_commands_take(folder, capsys):
    """FILE:COLUMN as the list prints it is FILE:COLUMN as they read it."""
    from spectral_skylight.addon.spectra.reflectance import read_one

    assert cli.main(["library", str(folder), "--search", "red"]) == 0
    told = capsys.readouterr().out.split(maxsplit=3)[3].strip()
    assert read_one(told).names == ("red",)
    np.testing.assert_allclose(
        rgb_albedo(read_one(told).values), rgb_albedo(library.whole([folder]).values)[3:4]
    )
