"""By how much a measurement would change an estimate: told by measured building materials."""

import numpy as np
import pytest

from spectral_skylight.addon.spectra.cielab import XYZ_to_Lab, delta_E_2000
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.library import built_in
from spectral_skylight.addon.spectra.sensitivities import cmfs
from spectral_skylight.addon.transfer import unmeasured
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.addon.transfer.textures import basis

DUSK, DAY = [0.25, 0.3, 0.6], [0.95, 1.0, 1.05]
SKY = transfer("atmosphere", sun_elevation=2.0)


def test_an_estimate_that_is_measured_changes_by_nothing():
    own = np.array([[0.5, 0.2, 0.1], [0.3, 0.3, 0.3]]) @ basis()
    assert unmeasured.change(SKY, own, [DUSK, DAY]) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_change_is_that_of_the_whole_spectra():
    """Against the product of spectra, in CIE XYZ: two reflectances of one color under D65."""
    brick = built_in().values[built_in().names.index("Brick: Building, red")]
    estimate = rgb_albedo(brick) @ basis()
    S = cmfs()
    # The working space's primaries are printed to four digits.
    np.testing.assert_allclose(S @ (D65() * brick), S @ (D65() * estimate), rtol=1e-4)
    light = SKY.restoration @ np.array(DUSK)
    measured, guessed = (XYZ_to_Lab(S @ (light * rho), S @ light) for rho in (brick, estimate))
    expected = float(delta_E_2000(guessed, measured))
    assert expected > 1.0
    # 0.01, for the same reason.
    assert unmeasured.change(SKY, brick, DUSK) == pytest.approx([expected], abs=0.03)


def test_building_materials_tell_of_one_another():
    """Each left out, the others' colors say which change more, and how much on the whole."""
    found = unmeasured._measured()
    changes = unmeasured.change(SKY, found, DUSK)
    told = []
    for k in range(0, len(found), 2):
        others = np.delete(found, k, axis=0)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(unmeasured, "_measured", lambda others=others: others)
            told.append(float(unmeasured.expected_change(SKY, found[k], DUSK)[0]))
    # Found: 0.6. Without any sense for color it is 0.
    assert np.corrcoef(told, changes[::2])[0, 1] > 0.4
    assert np.mean(told) == pytest.approx(changes.mean(), rel=0.25)


def test_dusk_asks_for_more_measuring_than_day():
    estimates = np.array([[0.6, 0.2, 0.1], [0.1, 0.4, 0.1], [0.5, 0.5, 0.5]]) @ basis()
    dusk = unmeasured.expected_change(SKY, estimates, DUSK)
    day = unmeasured.expected_change(transfer("atmosphere", sun_elevation=50.0), estimates, DAY)
    assert np.all(dusk > 3.0 * day)
    assert np.isnan(unmeasured.expected_change(SKY, estimates, np.zeros(3))).all()
    # A gray is unsure by less than a red: its estimate is flat, as most measured grays are.
    assert dusk[2] < dusk[0]
