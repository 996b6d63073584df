"""The tables' figures as pictures."""

from __future__ import annotations

from pathlib import Path

from numpy.typing import NDArray

from spectral_skylight.tests.peers.conditions import SUN_ELEVATIONS


def draw_skies(
    path: Path, bands: NDArray, spectra: dict[str, dict[str, NDArray]], rows: list
) -> None:
    """Draw mean spectra of the sky and, below, how the differences go with the sun's elevation.

    ``spectra``: by condition, by whose sky, (suns, b) in ``bands``.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(2, len(spectra), figsize=(3.6 * len(spectra), 6.4), sharey="row")
    sun = SUN_ELEVATIONS.index(30.0)
    for (peer, skies), above, below in zip(spectra.items(), *axes, strict=True):
        for whose, values in skies.items():
            above.plot(bands, values[sun] / values[sun].mean(), label=whose)
        above.set_title(peer)
        above.set_xlabel("wavelength [nm]")
        for beside in ("ours alike", "ours full"):
            found = [row for row in rows if (row.peer, row.beside) == (peer, beside)]
            line = below.plot(SUN_ELEVATIONS, [row.duv_mean for row in found], label=beside)
            worst = [row.duv_max for row in found]
            below.plot(SUN_ELEVATIONS, worst, "--", color=line[0].get_color())
        below.set_xlabel("sun elevation [°]")
    axes[0, 0].set_ylabel("mean over the sky, sun at 30°, mean 1")
    axes[1, 0].set_ylabel("distance in u'v' (dashed: worst)")
    axes[0, 0].legend()
    axes[1, 0].legend()
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_renderers(path: Path, results: list) -> None:
    """Draw every renderer's mean CIEDE2000, with its 95th percentile, over its seconds."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7.5, 4.5))
    for one in sorted(results, key=lambda one: one.mean_delta_E):
        line = axes.plot([one.seconds] * 2, [one.mean_delta_E, one.p95_delta_E], lw=1)
        axes.plot(one.seconds, one.mean_delta_E, "o", color=line[0].get_color(), label=one.method)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.yaxis.set_minor_formatter("{x:.1f}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xlabel("seconds for three pictures of 48 x 32 pixels, once all is loaded")
    axes.set_ylabel("CIEDE2000: mean, up to 95th percentile")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)
