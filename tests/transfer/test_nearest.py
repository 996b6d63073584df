"""Measured spectra near to a material: by its color, by its name, and by how much they differ."""

import json

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.spectra import library
from spectral_skylight.addon.spectra.library import Library
from spectral_skylight.addon.spectra.reflectance import Kind
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.nearest import NAME_COUNTS, nearest, words_of
from spectral_skylight.addon.transfer.prediction import rgb_albedo

WHITE = np.ones(3)


def made(*named, kinds=None):
    """A library of greys: name and reflectance of each."""
    count = len(named)
    return Library(
        names=tuple(name for name, _ in named),
        classes=("",) * count,
        sources=("folder/file.csv",) * count,
        paths=("file.csv",) * count,
        kinds=kinds or (Kind("CSV", "reflectance", "fraction"),) * count,
        values=np.array([np.full(81, grey) for _, grey in named]),
    )


def test_a_spectrums_own_color_is_nearest_to_it():
    """Of a hundred measured patches each is found by its color, with ΔE 0."""
    found = library.built_in()
    colors = rgb_albedo(found.values)
    for k in range(0, len(found), 7):
        first = nearest(found, colors[k], count=1)[0]
        assert first.delta_E == pytest.approx(0.0, abs=1e-6)
        np.testing.assert_allclose(colors[first.number], colors[k], atol=1e-9)


def test_differences_are_those_of_the_colors_in_any_space():
    found = library.built_in()
    color = np.array([0.3, 0.15, 0.08])
    for space in ("Linear Rec.709", "ACEScg"):
        colors = rgb_albedo(found.values, space)
        ranked = nearest(found, color, count=len(found), space=space)
        expected = np.sort(delta_E(colors, color, WHITE, space))
        np.testing.assert_allclose([one.delta_E for one in ranked], expected)
    assert len(nearest(found, color)) == 10


def test_a_name_brings_forward_what_shares_its_words():
    greys = made(("slate", 0.30), ("red brick", 0.34), ("brick, dark", 0.02))
    assert [one.number for one in nearest(greys, [0.3] * 3)] == [0, 1, 2]
    ranked = nearest(greys, [0.3] * 3, "Brick_Wall.001")
    assert ranked[0].number == 1 and ranked[0].words == ("brick",)
    # A word counts as much as a stated difference, not more: black is no red brick.
    assert ranked[0].delta_E < ranked[2].delta_E and ranked[2].number == 2
    assert ranked[2].delta_E > NAME_COUNTS


def test_words_mean_the_same_in_other_languages():
    assert words_of("Ziegelwand alt") == ("ziegelwand", "alt")
    assert words_of("Ziegel.001") == words_of("OldBricks")[1:] == ("brick",)
    assert words_of("béton clair")[0] == words_of("M_Concrete_02")[0] == "concrete"
    assert words_of("Material.003") == ()


def test_what_cannot_be_told_gives_nothing():
    assert nearest(Library(), [0.5] * 3, "brick") == []
    assert nearest(made(("a", 0.5)), [np.nan, 0, 0]) == []
    glass = made(("pane", 0.5), kinds=(Kind("IGSDB", "transmittance", "fraction"),))
    assert nearest(glass, [0.5] * 3) == []


def test_command(capsys):
    arguments = ["library", "--near", "0.36,0.34,0.32", "--for", "Neutral Wall"]
    assert cli.main([*arguments, "--json"]) == 0
    spectra = json.loads(capsys.readouterr().out)["spectra"]
    assert len(spectra) == 10 and "neutral" in spectra[0]["name"]
    assert {"format", "quantity", "unit", "delta_E"} <= set(spectra[0])
    assert (spectra[0]["format"], spectra[0]["quantity"]) == ("colour-science", "reflectance")
    assert cli.main(arguments) == 0
    out, err = capsys.readouterr()
    assert out.count("ΔE") == 10
    assert "as building materials: reflectance, fraction" in err and "10 of 202 spectra" in err
