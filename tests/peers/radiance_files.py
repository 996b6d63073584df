"""Radiance's programs and its spectral pictures. Runs in the peers' environment."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pyradiance

HOME = Path(pyradiance.__file__).parent
BANDS = np.arange(390.0, 771.0, 20.0)
"""Middles of the 20 bands [nm], 380 to 780. In files they stand the other way round."""


def run(program, *arguments, cwd=None, **options):
    """Run one of Radiance's programs and return what it prints; raises where it fails."""
    library = {**os.environ, "RAYPATH": f".:{HOME / 'lib'}"}
    command = [HOME / "bin" / program, *map(str, arguments)]
    done = subprocess.run(
        command, cwd=cwd, env=library, stdout=subprocess.PIPE, check=True, **options
    )
    return done.stdout


def read_picture(path):
    """Return a spectral picture, (h, w, 20), short waves first.

    Each pixel has one exponent for its 20 mantissas of 8 bits, which are read at their middle.
    """
    data = Path(path).read_bytes()
    start = data.index(b"\n\n") + 2
    end = data.index(b"\n", start)
    _, height, _, width = data[start:end].split()
    pixels = np.frombuffer(data[end + 1 :], np.uint8).reshape(int(height), int(width), -1)
    scale = np.ldexp(1.0, pixels[..., -1].astype(int) - 136)
    values = (pixels[..., -2::-1] + 0.5) * scale[..., None]
    return np.where(pixels[..., -1:] > 0, values, 0.0)


def write_picture(path, values):
    """Write (h, w, 20), short waves first, as `read_picture` reads it."""
    largest = np.maximum(values.max(axis=-1), 1e-30)
    exponent = np.frexp(largest)[1]
    mantissas = np.floor(np.ldexp(values, 8 - exponent[..., None])).clip(0, 255)
    pixels = np.concatenate([mantissas[..., ::-1], exponent[..., None] + 128], axis=-1)
    header = "#?RADIANCE\nNCOMP=20\nWAVELENGTH_SPLITS= 780 588 480 380\nFORMAT=Radiance_spectra\n"
    size = f"\n-Y {values.shape[0]} +X {values.shape[1]}\n"
    Path(path).write_bytes((header + size).encode() + pixels.astype(np.uint8).tobytes())
