"""Renderers that know spectra: Mitsuba 3, and Radiance with 20 bands; where their environment is.

Both are given the geometry, the reflectances, the sun and the lamps with their spectra. Radiance is
given the sky's too. Mitsuba takes the HDRI, for its environment map knows no other.
"""

from collections.abc import Iterator
from typing import Any

import bands
import numpy as np
import referee
from ready import Ready
from reference import WAVELENGTHS
from stage import Stage
from way import Shot, Way

from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests.peers import peer
from spectral_skylight.tests.peers.renderers import BANDS, in_bands_summed
from spectral_skylight.tests.peers.skies import in_bands

QUALITIES = {
    "low": "-ab 2 -ad 512 -as 256 -aa 0.2 -ar 128 -lw 2e-3",
    "medium": "-ab 4 -ad 1024 -as 512 -aa 0.15 -ar 256 -lw 5e-4",
    "high": "-ab 8 -ad 4096 -as 1024 -aa 0.1 -ar 512 -lw 1e-5 -lr 12",
}
"""Options of `rtrace`: its bounces, its rays, and how far what they bring is reused."""


def missing() -> str | None:
    """Say in one line how to have the peers; None where they are."""
    return None if peer.PYTHON.exists() else f"Mitsuba 3 and Radiance: {peer.MISSING}"


def mitsuba(samples: int) -> Way:
    """Mitsuba 3, spectral, with every bounce."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        sky = ready.folder / "mitsuba_sky.exr"
        write_panorama(sky, (ready.stage.sky @ bands.S.T).astype(np.float32))
        request = _request(ready.stage, np.eye(WAVELENGTHS.size)) | {
            "wavelengths": WAVELENGTHS.tolist(),
            "samples": samples,
            "bounces": referee.BOUNCES,
        }
        answer = peer.ask("mitsuba_stage.py", request | {"file": str(sky)}, again=True)
        yield _shot(answer, answer["picture"].astype(float))

    return Way("Mitsuba 3, spectral", f"{samples}", shots)


def radiance(quality: str) -> Way:
    """Radiance with 20 bands, by one of `QUALITIES`."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        file = ready.folder / "radiance_sky.npz"
        rays = np.concatenate(ready.stage.camera.rays(), axis=-1).reshape(-1, 6)
        np.savez(file, sky=in_bands(ready.stage.sky, BANDS), rays=rays)
        request = _request(ready.stage, in_bands(np.eye(WAVELENGTHS.size), BANDS).T)
        request |= {"options": QUALITIES[quality], "file": str(file)}
        answer = peer.ask("radiance_stage.py", request, again=True)
        yield _shot(answer, answer["picture"].astype(float) @ in_bands_summed(bands.S).T)

    return Way("Radiance, 20 bands", quality, shots)


def _request(stage: Stage, to: np.ndarray) -> dict[str, Any]:
    """Return a stage of matt polygons as JSON has it, its spectra ``to`` (m, 81) numbers."""
    surfaces = []
    for name, thing in stage.things.items():
        matter = stage.matter[thing.matter]
        if thing.ball or matter.measured is None or matter.roughness is not None:
            raise ValueError(f"{name}: the peers are given matt polygons alone")
        reflectance = (to @ matter.measured).tolist()
        surfaces.append({"polygons": thing.polygons, "reflectance": reflectance})
    suns = [] if stage.sun is None else [stage.sun]
    seen = stage.camera
    axes = {name: getattr(seen, name).tolist() for name in ("location", "right", "up", "back")}
    return {
        "surfaces": surfaces,
        "suns": [
            {"direction": sun.direction.tolist(), "spectrum": (to @ sun.spectrum).tolist()}
            for sun in suns
        ],
        "lamps": [
            {
                "at": lamp.location,
                # A lamp of Blender sends this out [W/sr] for each watt.
                "intensity": (to @ lamp.spectrum * lamp.energy / (4 * np.pi)).tolist(),
                "radius": lamp.radius,
            }
            for lamp in stage.lamps.values()
        ],
        "camera": axes | {"width": seen.width, "height": seen.height, "scale": seen.scale},
    }


def _shot(answer: dict[str, np.ndarray], picture: np.ndarray) -> Shot:
    """Nothing is kept: whatever changes, all is traced anew."""
    again = dict.fromkeys(("frame", "hour", "paint"), answer["seconds"])
    size, memory = float(answer["size"]), float(answer["memory"])
    return Shot(picture, answer["seconds"], answer["setup"], again, size, memory)
