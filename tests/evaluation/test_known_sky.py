"""Every method under one sky whose spectra are known."""

import json

import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.evaluation.known_sky import evaluate_sky
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import from_pixels
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.tests.sky.spectral_files import write_hsr
from spectral_skylight.tests.sky.test_radiance_hsr import BANDS, radiance


def test_its_own_spectrum_is_near_the_best_matrix(tmp_path, capsys):
    file = write_hsr(tmp_path / "sky.hsr", radiance(BANDS))
    assert cli.main(["evaluate", "--sky", str(file), "--json"]) == 0
    methods = json.loads(capsys.readouterr().out)["methods"]
    mean = {method["method"]: method["delta_E"]["mean"] for method in methods}
    # The limit is by other weights, so the two may change places by a hair.
    assert mean["own spectrum"] < 1.5 * mean["best 3x3"] + 0.005
    assert mean["own spectrum"] < 0.2 * mean["atmosphere, colour known"]


def test_what_else_goes_with_it_and_what_knows_nothing(tmp_path, capsys):
    file = write_hsr(tmp_path / "sky.hsr", radiance(BANDS))
    assert cli.main(["evaluate", "--sky", str(file), "--out", str(tmp_path / "out")]) == 2
    assert "--out: does not go with --sky" in capsys.readouterr().err
    light = analyse(from_pixels(radiance(BANDS)[..., [12, 8, 4]], "three.exr"))
    with pytest.raises(InputError, match="three.exr: holds no spectra"):
        evaluate_sky(light, colorchecker()[1])
