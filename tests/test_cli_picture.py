"""The command `picture` on reflectance files: what is drawn, and the one line where nothing is."""

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.pictures import curve as curves
from spectral_skylight.addon.pictures import sky_map
from spectral_skylight.addon.pictures.sheet import sheet
from spectral_skylight.addon.pictures.theme import DARK, LIGHT
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests.pictures.reading import read_png


@pytest.fixture
def paints(tmp_path):
    path = tmp_path / "paints.csv"
    rows = [f"{nm},{0.05 + 0.4 * (nm > 580)},{0.001 * nm}" for nm in range(400, 701, 10)]
    path.write_text("\n".join(["nm,brick,slope", *rows]) + "\n")
    return path


@pytest.fixture
def hdri(tmp_path):
    up = np.clip(directions(32, 64)[..., 2:], 0, 1)
    write_panorama(tmp_path / "sky.exr", ((0.2 + 0.8 * up) * [0.35, 0.45, 0.68]).astype("f4"))
    return str(tmp_path / "sky.exr")


def picture(tmp_path, *arguments):
    out = tmp_path / "out.png"
    assert cli.main(["picture", *map(str, arguments), "--out", str(out)]) == 0
    return read_png(out)


def test_one_material_is_a_curve_and_a_matrix(tmp_path, paints, hdri, capsys):
    pixels = picture(tmp_path, f"{paints}:slope", "--scale", 1)
    assert "measured from 400 to 700 nm" in capsys.readouterr().out
    assert pixels.shape == (480 + 44 + 20, 2 * 480 + 3 * 20, 3)
    assert (pixels[-1, -1] == np.round(255 * LIGHT.paper)).all()
    x, y = 20 + curves.place_x(550.0), 44 + curves.place_y(0.55, 1.0)
    assert np.abs(pixels[int(y), int(x)] - 255 * LIGHT.ink).max() < 40
    beneath = picture(tmp_path, f"{paints}:slope", "--sky", hdri, "--scale", 1, "--theme", "dark")
    assert beneath.shape == (480 + 44 + 20, 3 * 480 + 4 * 20, 3)
    assert (beneath[-1, -1] == np.round(255 * DARK.paper)).all()
    bar = 44 + int(sky_map.BARS[0]) + 10, 2 * 500 + 20 + int(sky_map.LEFT) + 10
    assert np.abs(beneath[bar] - 255 * np.array(sky_map.MARKS[sky_map.SKY])).max() < 2


def test_many_materials_are_compared_under_a_sky(tmp_path, paints, hdri, capsys):
    pixels = picture(tmp_path, paints, "--sky", hdri)
    assert pixels.shape[1] == round((2 * 480 + 3 * 20) * 1.5)
    one = picture(tmp_path, paints, "--sky-rgb", "0.3,0.5,0.9")
    assert one.shape[1] == round((480 + 2 * 20) * 1.5)
    capsys.readouterr()
    picture(tmp_path, paints, "--sky-rgb", "0.9,0.1,0.9")
    assert "errors are unknown" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["paints.csv"], "holds 2 materials"),
        (["paints.csv:tile"], "no column 'tile'"),
        (["paints.csv:brick", "--scale", "9"], "--scale"),
        (["paints.csv:brick", "--material", "Wall"], "--material"),
        (["paints.csv:brick", "--out", "none/there.png"], "choose another place"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(
    tmp_path, paints, hdri, monkeypatch, capsys, options, says
):
    monkeypatch.chdir(tmp_path)
    out = [] if "--out" in options else ["--out", "out.png"]
    assert cli.main(["picture", *options, *out]) == 2
    message = capsys.readouterr().err
    assert says in message and message.count("\n") == 1
    assert not (tmp_path / "out.png").exists()


def test_pictures_of_different_heights_share_a_sheet():
    tall, low = np.full((60, 40, 3), 9, np.uint8), np.full((30, 40, 3), 7, np.uint8)
    pixels = sheet("title", [tall, low])
    assert pixels.shape == (60 + 44 + 20, 2 * 40 + 3 * 20, 3)
    assert (pixels[44:104, 20:60] == 9).all() and (pixels[44:74, 80:120] == 7).all()
