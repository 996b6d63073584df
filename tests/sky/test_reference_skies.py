"""The preview of a simulated sky beside the reference, on surfaces and in the dome itself."""

import pytest

from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.tests.sky.reference_skies import differences, seen, stored


@pytest.mark.parametrize(
    ("elevation", "on_faces", "in_dome"), [(-6.0, 2.0, 16.0), (0.0, 0.5, 3.0), (60.0, 0.1, 1.6)]
)
def test_the_preview_beside_the_reference(elevation, on_faces, in_dome):
    """Chance decides: of three seeds the worst had 1.77, 0.37 and 0.06 on faces.

    In the dome 12.9, 2.1 and 1.2: each direction has noise of its own, which faces do not see.
    Limits are a tenth to a half over that, as much as seeds differ.
    """
    true = stored()[elevation]
    faces, dome = differences(true, seen(simulate(elevation)))
    assert 0.0 < faces.mean() < on_faces
    assert 0.0 < dome.mean() < in_dome
    # And nothing is the same sky but a sky itself.
    assert differences(true, true)[0].max() == 0.0
