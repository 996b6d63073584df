"""OpenEXR files as another reader than the product's has them."""

from pathlib import Path

import numpy as np
import OpenEXR


def picture(path: Path | str) -> np.ndarray:
    """Return the colour channels (h, w, 3 or 4) of a picture."""
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        return next(c.pixels for name, c in channels.items() if name.endswith(("RGB", "RGBA")))


def planes(path: Path | str) -> dict[str, np.ndarray]:
    """Return each channel (h, w) of all parts by its name."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: c.pixels for part in file.parts for name, c in part.channels.items()}
