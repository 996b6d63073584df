"""Pictures of the example: reading EXR, showing it as the eye would see it, side by side."""

from pathlib import Path

import colour
import numpy as np
import OpenEXR

_OURS = {"rgb": "Blender today: RGB × RGB", "spectral": "Spectral Skylight"}
TITLES = {
    "checker": {**_OURS, "reference": "Full spectrum, without Blender"},
    "building": {**_OURS, "reference": "Cycles, wavelength by wavelength, every bounce"},
}
"""Of the main job's pictures, by scene."""


def read(path: Path) -> np.ndarray:
    """Return the linear RGB (h, w, 3) of an EXR file."""
    channels = OpenEXR.File(str(path)).channels()
    pixels = next(c.pixels for name, c in channels.items() if name.endswith(("RGB", "RGBA")))
    return pixels[..., :3].astype(float)


def exposure(faces: np.ndarray) -> float:
    """Return the exposure [stops] that leaves white paper on the brightest face below white."""
    return float(np.log2(0.9 / faces.max()))


def show(image: np.ndarray, exposure: float) -> np.ndarray:
    """Return a linear picture as display values 0 to 1: Blender's view transform Standard."""
    return colour.cctf_encoding(np.clip(image * 2.0**exposure, 0, 1), function="sRGB")


def save_png(path: Path, image: np.ndarray, exposure: float) -> None:
    """Save a linear picture through `show`."""
    import matplotlib.image

    matplotlib.image.imsave(path, show(image, exposure))


def save_comparison(
    path: Path,
    images: dict[str, np.ndarray],
    errors: dict[str, np.ndarray],
    exposure: float,
    captions: list[str],
    titles: dict[str, str],
    most: float = 2.0,
) -> None:
    """Save pictures side by side under their titles, maps of their CIEDE2000 and captions below.

    ``errors`` (h, w) by the name of the picture, empty where there is no reference; ``most``: the
    CIEDE2000 that the maps show brightest.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    height, width = next(iter(images.values())).shape[:2]
    rows = 2 if errors else 1
    inches = 4.2 * height / width + 0.35
    figure, axes = pyplot.subplots(
        rows,
        len(images),
        squeeze=False,
        figsize=(4.2 * len(images), rows * inches + (0.9 if captions else 0.0)),
        dpi=110,
        layout="constrained",
    )
    for axis in axes.flat:
        axis.set_axis_off()
    for axis, (kind, image) in zip(axes[0], images.items(), strict=True):
        axis.imshow(show(image, exposure), interpolation="nearest")
        axis.set_title(titles[kind], fontsize=11)
    for k, error in enumerate(errors.values()):
        worst = np.nanmax(error)
        shown = axes[1, k].imshow(error, cmap="magma", vmin=0, vmax=most, interpolation="nearest")
        axes[1, k].set_title(
            f"CIEDE2000: mean {np.nanmean(error):.2f}, worst {worst:.1f}", fontsize=10
        )
    if errors:
        bar = axes[1, -1].inset_axes([0.02, 0.1, 0.05, 0.8])
        figure.colorbar(shown, cax=bar, extend="max", label="CIEDE2000")
    figure.supxlabel("\n".join(captions), fontsize=9)
    figure.savefig(path, bbox_inches="tight", pad_inches=0.1)  # or long captions cut the titles
    pyplot.close(figure)
