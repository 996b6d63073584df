"""Noise: what short numbers and grain in a sky become in a colour."""

import numpy as np
import pytest

from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.sky.light import FACES
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.tests.stability.lights import CHECKER, NAMES, S, sky, skylight

M = transfer().matrices(CHECKER)


def half(rgb):
    """Half floats: 11 bits, each number off by at most 2^-11 of itself."""
    return rgb.astype(np.float16).astype(float)


def rgbe(rgb):
    """Radiance's: 8 bits of the brightest channel; decoded to the middle of the step."""
    step = 2.0 ** (np.floor(np.log2(rgb.max(axis=-1, keepdims=True))) + 1 - 8)
    return (np.floor(rgb / step) + 0.5) * step


def eight_bit(rgb):
    """sRGB's curve in 255 steps, exposed for the brightest pixel, brought back to linear."""
    linear = rgb / rgb.max()
    curve = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    curve = np.round(curve * 255.0) / 255.0
    linear = np.where(curve < 0.04045, curve / 12.92, ((curve + 0.055) / 1.055) ** 2.4)
    return linear * rgb.max()


def colours(lights):
    return np.einsum("mij,kj->kmi", M, lights)


@pytest.fixture(scope="module")
def low_sun():
    rgb = picture(sky(10.0), 128, 180.0, False, S).astype(float)
    return np.maximum(rgb, 1e-6 * rgb.max())


@pytest.mark.parametrize(
    ("short", "name", "pixel_under", "face_under"),
    # A pixel's ΔE: 2^-11 moves it by some 0.01, 2^-8 of the blue by 0.1, a step of 1/255 by 1.
    # A face sums thousands of pixels, whose rounding is independent where the sky is not even.
    [
        (half, "half floats", 0.02, 0.005),
        (rgbe, "RGBE (.hdr)", 0.2, 0.05),
        (eight_bit, "8 bits, sRGB", 1.5, 0.6),
    ],
)
def test_short_numbers(keep, low_sun, short, name, pixel_under, face_under):
    found = short(low_sun)
    before, after = exact_irradiance(low_sun, FACES), exact_irradiance(found, FACES)
    face = delta_E(colours(after), colours(before), before[:, None])
    pixels, exact = (rgb[:64:4, ::8].reshape(-1, 3) for rgb in (found, low_sun))
    pixel = delta_E(colours(pixels), colours(exact), exact[:, None])
    assert pixel.mean() < pixel_under and face.mean() < face_under
    assert face.mean() < 0.25 * pixel.mean()
    keep(
        f"a sky in {name}",
        f"ΔE {pixel.mean():.2g} of a single pixel, {face.mean():.2g} of a face's light",
        "refuses 8-bit files" if short is eight_bit else "nothing: irradiance sums it away",
    )


def test_how_much_each_matrix_amplifies(keep):
    """Independent noise of 1 % in each channel of the light, in each channel of the colour.

    To first order a colour c = M E has the standard deviation sqrt(sum (M_ij E_j)^2) per unit of
    relative noise, and divided by c_i it is 1 for RGB × RGB and for every grey.
    """
    light = S @ skylight(40.0)
    grey = transfer().matrices(np.full((1, 81), 0.4))[0]
    np.testing.assert_allclose(amplification(grey[None], light), 1.0, atol=1e-9)  # M = 0.4 I
    found = {name: amplification(transfer(name).matrices(CHECKER), light) for name in BASES}
    for by_patch in found.values():
        assert by_patch.mean() < 1.5
        # Red hardly shows in saturated green and cyan: small differences of large numbers.
        worst = np.unravel_index(np.argmax(by_patch), by_patch.shape)
        assert worst[1] == 0 and NAMES[worst[0]] in ("bluish green", "cyan", "green", "blue")
    # Sampled: 1 % of noise, small enough for the first order to hold to some per cent.
    rng = np.random.default_rng(11)
    noisy = light * (1.0 + 0.01 * rng.normal(size=(20_000, 3)))
    sampled = np.einsum("mij,kj->kmi", M, noisy).std(axis=0) / np.abs(M @ light) / 0.01
    np.testing.assert_allclose(sampled, found["rayleigh"], rtol=0.03)  # 1 / sqrt(2 * 20000) x 6
    for name, by_patch in found.items():
        mean, (patch, _) = (
            by_patch.mean(axis=0),
            np.unravel_index(by_patch.argmax(), by_patch.shape),
        )
        keep(
            f"grain of the sky, through `{name}`",
            f"grows {mean[0]:.1f}, {mean[1]:.1f} and {mean[2]:.1f} times in red, green and blue, "
            f"at most {by_patch.max():.0f} times (red of {NAMES[patch]})",
            "nothing: a face's light is the mean of thousands of pixels",
        )


BASES = ("rayleigh", "daylight", "atmosphere")


def amplification(matrices, light):
    """Relative noise out over relative noise in, (m, 3)."""
    return np.sqrt((matrices * light) ** 2 @ np.ones(3)) / np.abs(matrices @ light)
