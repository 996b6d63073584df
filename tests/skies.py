"""A small clear sky as a Radiance file: what commands are asked about where no OpenEXR may be."""

from pathlib import Path

import numpy as np

from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.spectra.bases import rayleigh
from spectral_skylight.addon.spectra.sensitivities import observer


def sky_pixels(rows: int) -> np.ndarray:
    """A blue sky that is whiter at the horizon, a sun at 40°, a grey ground, (rows, 2 rows, 3)."""
    towards = directions(rows, 2 * rows)
    white, blue = (observer() @ spectrum for spectrum in rayleigh()[:2])
    up = np.clip(towards[..., 2], 0.0, 1.0)[..., None]
    rgb = up * blue / blue[1] + (1.0 - up) * white / white[1]
    sun = np.array([np.cos(np.radians(40)), 0.0, np.sin(np.radians(40))])
    rgb[towards @ sun > np.cos(np.radians(0.6))] = 2000.0 * white / white[1]
    rgb[rows // 2 :] = 0.2 * white / white[1]
    return rgb * np.random.default_rng(0).uniform(0.97, 1.03, (*rgb.shape[:2], 1))


def write_hdr(path: Path, rgb: np.ndarray) -> Path:
    """Write pixels (h, w, 3), w over 7, as run-length coded RGBE; return the path."""
    height, width = rgb.shape[:2]
    exponent = np.ceil(np.log2(rgb.max(axis=2) * 256 / 255))
    rgbe = np.empty((height, width, 4), np.uint8)
    rgbe[..., :3] = rgb * 256.0 / np.exp2(exponent)[..., None]
    rgbe[..., 3] = exponent + 128
    lines = [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width)]
    for row in rgbe:
        lines.append(bytes([2, 2, width >> 8, width & 255]))
        for channel in row.T:
            for start in range(0, width, 128):  # runs of different bytes
                part = channel[start : start + 128].tobytes()
                lines.append(bytes([len(part)]) + part)
    path.write_bytes(b"".join(lines))
    return path
