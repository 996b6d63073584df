"""Ways to the whole picture: Eevee, ours, Cycles and its peers, each timed from the opened file on.

A way yields `Shot`s: one, or several that become better. Times are wall and processor seconds of
this process alone, to be had on any machine by `sh examples/run chart --scenes`.
"""

import sys

from way import Way
from ways_cycles import rgb, wavelengths
from ways_eevee import eevee
from ways_ours import ours, progressive, traced
from ways_peers import missing, mitsuba, radiance

from spectral_skylight.addon.choices import AUTO, DOME, OPEN

RAYS = 64, 128, 256, 512, 1024
PEERS = "Mitsuba 3", "Radiance"

WAYS: dict[str, Way] = {
    "Ours, all light, in Cycles": ours(AUTO, "cycles"),
    "Ours, all light": ours(AUTO, "eevee"),
    "Cycles RGB, 64 samples": rgb(64),
    "Cycles RGB, 1024 samples": rgb(1024),
    "Eevee as it comes": eevee(),
    "Ours, open sky, in Cycles": ours(OPEN, "cycles"),
    "Ours, progressive": progressive(),
    **{f"Cycles RGB, {n} samples, denoised": rgb(n, True) for n in (16, 64, 256)},
    "Eevee, rays and probes by hand": eevee(by_hand=True),
    "Ours, live": ours(DOME, "eevee"),
    "Ours, open sky": ours(OPEN, "eevee"),
    **{f"Mitsuba 3, {n} samples": mitsuba(n) for n in (16, 128)},
    **{f"Radiance, {quality} quality": radiance(quality) for quality in ("low", "medium", "high")},
    **{f"Cycles by wavelength, {n} samples": wavelengths(n) for n in (16, 128)},
    **{f"Ours, {n} rays, in Cycles": ours(AUTO, "cycles", n) for n in RAYS},
    **{f"Cycles RGB in Rec.2020, {n} samples": rgb(n, wide=True) for n in (64, 1024)},
    **{f"Ours, traced, {n} samples": traced(n) for n in (16, 64, 256, 1024)},
    **{f"Ours, traced, {n} samples, denoised": traced(n, True) for n in (16, 32, 64, 256)},
    **{f"Ours, traced in Rec.2020, {n} samples": traced(n, wide=True) for n in (64, 256, 1024)},
    **{
        f"Ours, traced in Rec.2020, {n} samples, denoised": traced(n, True, wide=True)
        for n in (16, 64)
    },
    **{f"Cycles RGB, {n} samples": rgb(n) for n in (16, 256, 4096)},
    **{f"Cycles RGB, {n} samples, denoised": rgb(n, True) for n in (32, 1024)},
    **{
        f"Cycles RGB in Rec.2020, {n} samples, denoised": rgb(n, True, wide=True) for n in (16, 256)
    },
    **{f"Mitsuba 3, {n} samples": mitsuba(n) for n in (1024,)},
}
"""All ways, those that tell most first."""


def there() -> list[str]:
    """Return the names of the ways that one can go here, and say which one cannot, and why."""
    why = missing()
    if why:
        print(why, file=sys.stderr)
    return [name for name in WAYS if not (why and name.startswith(PEERS))]
