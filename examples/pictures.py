"""Pictures of the example: reading EXR, showing it as the eye would see it, side by side."""

from pathlib import Path

import colour
import numpy as np
import OpenEXR

TITLES = {
    "rgb": "Blender today: RGB × RGB",
    "spectral": "Spectral Skylight",
    "reference": "Full spectrum, without Blender",
}


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
    path: Path, images: dict[str, np.ndarray], exposure: float, captions: list[str]
) -> None:
    """Save pictures side by side under their titles, captions below."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    height, width = next(iter(images.values())).shape[:2]
    figure, axes = pyplot.subplots(
        1, len(images), figsize=(4.2 * len(images), 4.2 * height / width + 1.0), dpi=110
    )
    for axis, (kind, image) in zip(axes, images.items(), strict=True):
        axis.imshow(show(image, exposure), interpolation="nearest")
        axis.set_title(TITLES[kind], fontsize=11)
        axis.set_axis_off()
    figure.subplots_adjust(left=0.01, right=0.99, top=0.91, bottom=0.2, wspace=0.02)
    for k, caption in enumerate(captions):
        figure.text(0.5, 0.125 - 0.05 * k, caption, ha="center", fontsize=9)
    figure.savefig(path)
    pyplot.close(figure)
