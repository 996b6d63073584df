"""Small spectral skies, and files of them as other programs write them."""

from pathlib import Path

import numpy as np

from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.spectra.bases import rayleigh
from spectral_skylight.addon.spectra.grid import WAVELENGTHS

SUN = np.array([0.6, 0.48, 0.64])


def radiance(wavelengths, rows=32, sun=0.0):
    """A blue sky, white at the horizon and warm about the sun, grey ground, (rows, 2 rows, n)."""
    towards = directions(rows, 2 * rows)
    base = rayleigh() / rayleigh().mean(axis=1, keepdims=True)
    white, blue, _ = (np.interp(wavelengths, WAVELENGTHS, one) for one in base)
    warm = white * (np.asarray(wavelengths) / 550.0) ** 2
    up = np.clip(towards[..., 2], 0.0, 1.0)[..., None]
    near = np.maximum(towards @ SUN, 0.0)[..., None] ** 8
    found = up * blue + (1.0 - up) * white + 2.0 * near * warm
    found[rows // 2 :] = 0.3 * white
    found[towards @ SUN > np.cos(np.radians(1.0))] += sun * warm
    return 0.05 * found


def write_hsr(path: Path, values, splits="780 588 480 380", exposure=None, size="-Y {} +X {}"):
    """Write radiance (h, w, n), short waves first, in bands of 380 to 780 nm, as Radiance does."""
    values = np.asarray(values) * 400.0
    exponent = np.frexp(np.maximum(values.max(axis=-1), 1e-30))[1]
    mantissas = np.floor(np.ldexp(values, 8 - exponent[..., None])).clip(0, 255)
    if float(splits.split()[0]) > float(splits.split()[-1]):
        mantissas = mantissas[..., ::-1]
    byte = np.where(values.any(axis=-1), exponent + 128, 0)
    pixels = np.concatenate([mantissas, byte[..., None]], axis=-1).astype(np.uint8)
    head = [
        "#?RADIANCE",
        f"NCOMP={values.shape[2]}",
        f"WAVELENGTH_SPLITS= {splits}",
        *([] if exposure is None else [f"EXPOSURE={exposure}"]),
        "FORMAT=Radiance_spectra",
        "",
        size.format(*values.shape[:2]),
        "",
    ]
    path.write_bytes("\n".join(head).encode() + pixels.tobytes())
    return path


def write_fichet(path: Path, channels, header=None, half=False, **more):
    """Write channels (h, w) by name as OpenEXR does, with attributes of the layout."""
    import OpenEXR

    kind = np.float16 if half else np.float32
    attributes = {"spectralLayoutVersion": "1.0", "emissiveUnits": "W.m^-2.sr^-1", **(header or {})}
    attributes = {name: value for name, value in attributes.items() if value is not None}
    planes = {name: np.ascontiguousarray(plane, kind) for name, plane in channels.items()}
    OpenEXR.File({**attributes, **more}, planes).write(str(path))
    return path


def stokes(values, wavelengths, kind="S0", name="{:.1f}nm"):
    """Radiance (h, w, n) as channels of the layout, by default ``S0.550,0nm``."""
    return {
        f"{kind}.{name.format(nm).replace('.', ',')}": values[..., k]
        for k, nm in enumerate(wavelengths)
    }
