"""The command `sky`: every option changes the picture, or says what is wrong with it."""

import json

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.addon.sky.sun_position import sun_position
from spectral_skylight.tests.pictures.reading import read_png
from spectral_skylight.tests.sky.test_all_weather import epw, row


def make(path, *options):
    arguments = ["sky", "--width", "16", "--out", path, *options]
    assert cli.main([str(argument) for argument in arguments]) == 0
    return read_panorama(path)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return make(tmp_path_factory.mktemp("sky") / "plain.exr", "--sun-elevation", 20).rgb


def test_options_change_the_sky(tmp_path, plain):
    green = tmp_path / "ground.csv"
    rows = [f"{nm},{0.02 + 0.2 * (nm > 520)},0.9" for nm in range(400, 701, 20)]
    green.write_text("\n".join(["wavelength,grass,snow", *rows]))
    for k, options in enumerate(
        (
            ("--haze", 0.3),
            ("--turbidity", 0.1),
            ("--haze", 0.05, "--angstrom", 0.5),
            ("--ozone", 500),
            ("--water", 40),
            ("--ground", 0.7),
            ("--ground", f"{green}:grass"),
            ("--orders", 1),
            ("--orders", 2),
            ("--seed", 1),
            ("--paper",),
            ("--sun-azimuth", 90),
            ("--sun-disc",),
        )
    ):
        rgb = make(tmp_path / f"{k}.exr", "--sun-elevation", 20, *options).rgb
        assert np.abs(rgb - plain).max() > 1e-4 * plain.max(), options


def test_turbidity_is_the_haze_at_1000_nm(tmp_path):
    by_turbidity = make(tmp_path / "a.exr", "--sun-elevation", 20, "--turbidity", 0.1)
    same = ("--haze", 0.1 * 0.55**-1.3, "--sun-elevation", 20)
    np.testing.assert_allclose(by_turbidity.rgb, make(tmp_path / "b.exr", *same).rgb, rtol=1e-6)


def test_sun_by_date_and_place(tmp_path, capsys):
    place = ("--latitude", 52.5, "--longitude", 13.4, "--timezone", "Europe/Berlin")
    make(tmp_path / "a.exr", "--date", "2025-06-21", "--time", "13:10", *place)
    out = capsys.readouterr().out
    # At noon on the longest day: 90 - 52.5 + 23.44, in the south.
    assert "sun at 60.9" in out and "azimuth 180." in out


def test_sun_by_date_and_city(tmp_path, capsys):
    make(tmp_path / "a.exr", "--date", "2025-06-21", "--time", "13:10", "--city", "berlin")
    out = capsys.readouterr().out
    assert out.startswith("Berlin, Germany: 52.52°, 13.41°, Europe/Berlin\n")
    assert "sun at 60.9" in out and "azimuth 180." in out
    zone = ("--timezone", "+1")  # an hour later in summer
    make(tmp_path / "a.exr", "--date", "2025-06-21", "--time", "12:10", "--city", "berlin", *zone)
    assert "sun at 60.9" in capsys.readouterr().out


def test_a_heliodon_needs_no_simulation(tmp_path, capsys):
    place = ("--city", "Berlin", "--date", "2025-06-21", "--time", "13:10")
    path = tmp_path / "paths.png"
    assert cli.main(["sky", *place, "--heliodon", str(path)]) == 0
    assert "sun at 60.9" in capsys.readouterr().out
    assert read_png(path).shape == (720, 720, 3)
    assert cli.main(["sky", "--sun-elevation", "30", "--heliodon", str(path)]) == 2
    assert "--heliodon: the place is unknown" in capsys.readouterr().err


def test_a_standard_sky(tmp_path, capsys):
    found = make(tmp_path / "a.exr", "--sun-elevation", 30, "--cie", 5, "--illuminance", 10000)
    assert "CIE standard sky 5, uniform" in capsys.readouterr().out
    luminance = found.rgb[: len(found.rgb) // 2] @ [0.2126, 0.7152, 0.0722]
    np.testing.assert_allclose(luminance, 1 / np.pi, rtol=1e-3)  # the weights have four digits


def test_the_sky_of_a_weather_file(tmp_path, capsys):
    file = epw(tmp_path / "a.epw", [row(15, 700, 120)])
    found = make(tmp_path / "a.exr", "--date", "2025-06-21", "--time", "14:30", "--epw", file)
    out = capsys.readouterr().out
    assert "sky of Zürich: direct 700 and diffuse 120 W/m², 4 % cloud" in out
    elevation, _ = sun_position("2025-06-21", "14:30", 47.4, 8.6, "+1")
    assert f"sun at {elevation:.2f}°" in out
    # Diffuse daylight has some 130 lm/W: 15,600 lx, over pi and 10,000 cd/m².
    assert 0.3 < found.rgb[: len(found.rgb) // 2].mean() < 0.8


def test_standard_error_is_stated(tmp_path, capsys):
    make(tmp_path / "a.exr", "--sun-elevation", 30)
    assert "standard error of the irradiance at most 0." in capsys.readouterr().out
    make(tmp_path / "a.exr", "--sun-elevation", 30, "--orders", 1)
    assert "at most 0.00 %" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "part"),
    [
        ([], "--sun-elevation or --date"),
        (["--sun-elevation", "20", "--date", "2025-06-21"], "--sun-elevation or --date"),
        (["--date", "2025-06-21"], "--latitude"),
        (["--epw", "a.epw"], "--epw: the hour is unknown"),
        (["--date", "2025-06-21", "--epw", "none.epw"], "none.epw"),
        (["--date", "2025-06-21", "--epw", "a", "--cie", "1"], "leave --cie out"),
        (["--date", "2025-06-21", "--epw", "a", "--latitude", "1"], "leave --latitude"),
        (["--sun-elevation", "20", "--cie", "16"], "--cie: there is no standard sky 16"),
        (["--sun-elevation", "-3", "--cie", "1"], "--sun-elevation: -3°"),
        (["--sun-elevation", "20", "--cie", "1", "--illuminance", "0"], "--illuminance: 0 lx"),
        (["--sun-elevation", "20", "--illuminance", "9000"], "give --cie too"),
        (["--date", "2025-06-21", "--city", "Oz"], "--city: 'Oz' is not in the list"),
        (["--date", "2025-06-21", "--city", "Bonn", "--latitude", "1"], "leave --latitude"),
        (["--sun-elevation", "20", "--city", "Bonn"], "--city: the day is unknown"),
        (["--date", "2025-06-21", "--epw", "a", "--city", "Bonn"], "leave --city out"),
        (["--date", "2025-13-01", "--latitude", "0", "--longitude", "0"], "--date"),
        (["--sun-elevation", "20", "--orders", "some"], "--orders"),
        (["--sun-elevation", "20", "--orders", "0"], "--orders"),
        (["--sun-elevation", "20", "--ground", "1.5"], "ground"),
        (["--sun-elevation", "20", "--ground", "none.csv"], "none.csv"),
        (["--sun-elevation", "20", "--ozone", "-5"], "ozone"),
        (["--sun-elevation", "20", "--width", "4"], "--width"),
        (["--sun-elevation", "20", "--sun-azimuth", "nan"], "--sun-azimuth"),
        (["--sun-elevation", "20", "--sun-azimuth", "1e999"], "--sun-azimuth"),
    ],
)
def test_what_is_wrong_is_said(capsys, tmp_path, options, part):
    assert cli.main(["sky", "--out", str(tmp_path / "sky.exr"), *options]) == 2
    error = capsys.readouterr().err
    assert part in error and error.count("\n") == 1
    assert not (tmp_path / "sky.exr").exists()


@pytest.fixture(scope="module")
def balanced(tmp_path_factory):
    """A clear sky with its sun, the same balanced until its upper half is grey, and that white."""
    folder = tmp_path_factory.mktemp("balanced")
    make(folder / "sky.exr", "--sun-elevation", 40, "--width", 512, "--sun-disc")
    sky = read_panorama(folder / "sky.exr").rgb
    white = sky[:64].mean(axis=(0, 1)) / sky[:64, :, 1].mean()
    write_panorama(folder / "grey.exr", sky / white)
    return folder, white


def printed(capsys, *arguments):
    capsys.readouterr()
    assert cli.main([str(argument) for argument in (*arguments, "--json")]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_white_balance_is_said_and_undone(tmp_path, capsys, balanced):
    """The sky made grey: `irradiance` warns, and `--white auto` gives back its blue."""
    folder, white = balanced

    def found(name, *options):
        out = ("--out", tmp_path / "e.exr")
        return printed(capsys, "irradiance", folder / name, *out, *options)

    assert not any("balance" in note for note in found("sky.exr")["notes"])
    warned = found("grey.exr")
    assert warned["white"] is None
    assert any("appears white-balanced" in note for note in warned["notes"])
    undone = found("grey.exr", "--white", "auto")
    # A standard deviation of the estimate is some 0.1 of each channel.
    np.testing.assert_allclose(undone["white"], white, rtol=0.25)
    assert undone["upward"][2] > 1.3 * undone["upward"][0]
    assert any("estimated from the sky" in note for note in undone["notes"])
    none = found("sky.exr", "--white", "auto")
    assert none["white"] is None
    assert any("no white balance is undone" in note for note in none["notes"])


def test_matrices_of_a_balanced_sky(tmp_path, capsys, balanced):
    folder, white = balanced
    paint = tmp_path / "paint.csv"
    rows = [f"{nm},{0.05 + 0.8 * (nm > 560)}" for nm in range(380, 781, 20)]
    paint.write_text("\n".join(["nm,orange", *rows]))

    def found(name, *options):
        sky = ("--sky", folder / name)
        return printed(capsys, "matrix", paint, "--basis", "rayleigh", *sky, *options)

    warned, undone = found("grey.exr"), found("grey.exr", "--white", "auto")
    told = found("grey.exr", "--white", ",".join(map(str, white)))
    assert any("appears white-balanced" in note for note in warned["notes"])
    assert any("estimated from the sky" in note for note in undone["notes"])
    assert told["notes"] == [] and told["white"] == pytest.approx(white.tolist(), rel=1e-5)
    off, mended = (
        np.abs(np.subtract(one["materials"][0]["matrix"], told["materials"][0]["matrix"])).max()
        for one in (warned, undone)
    )
    assert mended < 0.5 * off
    assert cli.main(["matrix", str(paint), "--white", "auto"]) == 2
    assert "give --sky HDRI" in capsys.readouterr().err
