"""HDRIs whose numbers are not what they seem."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import from_pixels, read_panorama, write_panorama
from spectral_skylight.addon.sky.sky_classification import FOREIGN
from spectral_skylight.addon.sky.sun import separate_sun
from spectral_skylight.addon.spectra.daylight_locus import LIMIT, locus_distance
from spectral_skylight.addon.spectra.working_spaces import LUMINANCE, rec709_to_working
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.white import estimate_white
from spectral_skylight.tests.stability.lights import (
    CHECKER,
    S,
    bright,
    daylight,
    errors,
    sky,
    skylight,
)

UP = [[0.0, 0.0, 1.0]]


@pytest.fixture(scope="module")
def clear():
    """A clear sky, sun at 35°: its picture with the disc, and the spectrum of the sky alone."""
    found = sky(35.0)
    return picture(found, 256, 180.0, True, S), bright(found.irradiance())


def as_bright(rgb):
    """Numbers of luminance 1, for comparison with a light of luminance 1."""
    return (rgb / (rgb @ LUMINANCE))[None]


def test_negative_pixels_and_blue_out_of_gamut(keep):
    """A twilight's darkest blue, in a spring with much ozone, has less than no red in Rec.709; DWA
    compression does the same."""
    whole = picture(sky(-6.0, ozone=400.0), 64, 180.0, False, S)
    whole[32:] = 0.0
    low = whole.copy()
    # What lossy files hold: a few negatives, as deep as 2e-3 of a bright pixel (measured in the
    # studio skies of Blender).
    low[::7, ::5] -= 2e-3 * whole.max()
    for pixels, what in ((whole, "red of a sky at -6°"), (low, "noise of lossy files")):
        panorama = from_pixels(pixels.copy(), "sky")
        before, after = exact_irradiance(pixels, UP), exact_irradiance(panorama.rgb, UP)
        M = transfer().matrices(CHECKER)
        moved = delta_E(after @ np.swapaxes(M, 1, 2), before @ np.swapaxes(M, 1, 2), before).mean()
        assert panorama.negatives > 0
        assert any("negative value(s) were set to zero" in n for n in analyse(panorama, 1).notes)
        assert moved < 0.02
        keep(
            f"negative values: {what}",
            f"{100 * panorama.negatives / pixels.size:.1f} % of values; set to zero the light "
            f"moves by ΔE {moved:.3f}",
            "sets them to zero and says how many",
        )


@pytest.mark.parametrize(("part", "said"), [(0.1, True), (0.01, True), (0.001, True)])
def test_a_clipped_sun(keep, clear, part, said):
    """What is cut off the disc is light that no lamp gives back."""
    rgb, _ = clear
    share = separate_sun(rgb)[1].share
    light = analyse(from_pixels(np.minimum(rgb, part * rgb.max()), "sky"), 1)
    assert light.sun.clipped == said
    assert any("clips the sun" in note for note in light.notes) == said
    assert light.sun.share < share
    keep(
        f"the sun clipped at {100 * part:g} % of its brightest pixel",
        f"the sun's share of the light falls from {100 * share:.0f} to {100 * light.sun.share:.0f}"
        " %",
        "finds it still, says that it was clipped",
    )


@pytest.mark.parametrize("width", [1.0, 3.0, 6.0])
def test_the_aureole_taken_for_the_disc(keep, width):
    """The same light as a blur: a sun is only what is small, the rest stays sky."""
    found = sky(35.0)
    rgb = picture(found, 256, 180.0, False, S)
    direct = found.direct @ S.T * np.sin(np.radians(35.0)) / np.pi
    true = direct @ LUMINANCE / ((exact_irradiance(rgb, UP)[0] + direct) @ LUMINANCE)
    towards = np.array([0.0, -np.cos(np.radians(35.0)), np.sin(np.radians(35.0))])
    away = np.degrees(np.arccos(np.clip(directions(256, 512) @ towards, -1, 1)))
    blur = np.exp(-0.5 * (away / (width / 2.355)) ** 2)[..., None].astype(np.float32)
    rgb += blur * (direct / exact_irradiance(blur.repeat(3, axis=2), UP)[0]).astype("f4")
    _, sun = separate_sun(rgb)
    share = 0.0 if sun is None else sun.share
    # Half the light of a Gauss blur lies within its half maximum, which is what is taken, and two
    # pixels (1.4°) around it.
    assert 0.5 * true <= share <= 1.005 * true
    keep(
        f"the sun blurred to {width:g}° across",
        f"{100 * share:.0f} % of the light is taken for the sun's, {100 * true:.0f} % is",
        "sets apart what is half as bright as the peak; the rest lights as sky, from around it",
    )


def test_a_white_balanced_sky(keep, clear):
    rgb, spectrum = clear
    neutral = S @ spectrum
    white = neutral / neutral[1]
    light = analyse(from_pixels(rgb / white.astype("f4"), "sky"), 1)
    found = estimate_white(light, transfer())
    assert found.suspected

    def off(undone):
        M = transfer(white=undone).matrices(CHECKER)
        seen = neutral / white
        return delta_E(M @ seen, (CHECKER * spectrum) @ S.T / white, seen).mean()

    left, mended, told = off(None), off(found.white), off(white)
    assert left > 0.8 and mended < 0.5 * left and told < 0.25
    keep(
        "white-balanced until the sky is grey",
        f"ΔE {left:.1f}; undone by the estimate {mended:.2f}, by the true white {told:.2f}",
        "says so with the error that is left; `--white` undoes it",
    )


def test_a_tone_mapped_sky(keep, clear, tmp_path):
    rgb, spectrum = clear
    linear = np.clip(rgb * (0.25 / np.median(rgb)), 0.0, 1.0)
    mapped = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    light = analyse(from_pixels(mapped, "sky"), 1)
    off = errors(spectrum, seen=as_bright(light.faces[0])).mean()
    assert off > 2.0
    assert any("tone-mapped" in note for note in light.notes)
    (tmp_path / "sky.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(64))
    with pytest.raises(InputError, match="tone-mapped"):
        read_panorama(tmp_path / "sky.png")
    keep(
        "tone-mapped to sRGB",
        f"ΔE {off:.1f} on level faces, and no sun",
        "refuses PNG, JPEG, WebP, BMP and TIFF; in a float file says that white is flat",
    )


def test_wrong_primaries(keep, tmp_path):
    """ACEScg's numbers read as Rec.709's are a greyer sky: no colour gives them away."""
    T = rec709_to_working("ACEScg")
    off = {}
    for name, light in (("the sky", skylight(40.0)), ("sun and sky", daylight(40.0))):
        off[name] = errors(light, seen=(T @ S @ light)[None]).mean()
        assert off[name] > 0.8 and locus_distance(T @ S @ light) < LIMIT
    acescg = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    rgb = np.broadcast_to(T @ S @ skylight(40.0), (16, 32, 3)).astype("f4")
    write_panorama(tmp_path / "sky.exr", rgb, {"chromaticities": acescg})
    notes = analyse(read_panorama(tmp_path / "sky.exr"), 1).notes
    assert any("other primaries" in note for note in notes)
    keep(
        "ACEScg read as Rec.709",
        ", ".join(f"ΔE {value:.1f} under {name}" for name, value in off.items()),
        "says so where the file's header names its primaries; silent otherwise",
    )


def test_elevation_wrong_by_five_degrees(keep):
    """`atmosphere` told a wrong sun is worse than told the right one, not than `rayleigh`."""
    for elevation in (-4.0, 0.0, 4.0):
        light = skylight(elevation)
        off = [
            errors(
                light, transfer("atmosphere", sun_elevation=elevation + by, sky_rgb=S @ light)
            ).mean()
            for by in (-5.0, 0.0, 5.0)
        ]
        paper = errors(light).mean()
        assert off[1] <= max(off[0], off[2]) and max(off) < paper
        keep(
            f"sun at {elevation:g}°, set 5° lower or higher",
            f"ΔE {off[0]:.2f} or {off[2]:.2f}; set correctly {off[1]:.2f}, `rayleigh` {paper:.2f}",
            "weighs elevations within some 2° and the sky's own colour",
        )


@pytest.mark.parametrize("name", ["Nikon 5100", "Sigma SDMerill"])
def test_a_camera_that_is_no_observer(keep, name):
    """Raw numbers taken for colours; with the camera's curves the paper's error is back."""
    camera = transfer(camera=name)
    light = skylight(40.0)
    raw = as_bright(camera.S_in @ light)
    unaware, aware = errors(light, seen=raw).mean(), errors(light, camera).mean()
    assert unaware > 5.0 and aware < 0.4
    assert locus_distance(raw[0]) > LIMIT > locus_distance(raw[0], camera.S_in)
    panorama = from_pixels(np.broadcast_to(raw, (16, 32, 3)).astype("f4"), "sky")
    found = analyse(panorama, 1).outside
    assert found.mostly and found.shares[0, FOREIGN] == 1.0
    assert analyse(panorama, 1, camera.S_in).outside.holds
    keep(
        f"a {name}'s raw numbers taken for colours",
        f"ΔE {unaware:.0f}; with `--camera` {aware:.1f}",
        "says: mostly outside the model of skylight",
    )
