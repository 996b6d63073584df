"""The lettering of pictures, made anew:  .venv/bin/python tests/pictures/letters.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np

SHIPPED = Path(__file__).resolve().parents[2] / "addon" / "pictures" / "letters.npz"
EM = 40
CHARACTERS = "".join(
    [*map(chr, range(0x20, 0x7F)), *map(chr, range(0xA1, 0x180)), "Δλρ–—‘’“”…−×≤≥□"]
)


def make() -> dict[str, np.ndarray]:
    """Return DejaVu Sans, without hinting, as `lettering` reads it."""
    from matplotlib import font_manager, ft2font

    font = ft2font.FT2Font(font_manager.findfont("DejaVu Sans"))
    font.set_size(EM, 72)
    flags = ft2font.LoadFlags.NO_HINTING
    boxes, pixels = [], []
    for character in CHARACTERS:
        font.set_text(character, 0.0, flags=flags)
        font.draw_glyphs_to_bitmap(antialiased=True)
        image = np.asarray(font.get_image())
        rows, columns = (np.flatnonzero(image.any(axis=side)) for side in (1, 0))
        image = image[: rows[-1] + 1, : columns[-1] + 1] if len(rows) else image[:0, :0]
        glyph = font.load_char(ord(character), flags=flags)
        left, top = glyph.bbox[0] // 64, -(-glyph.bbox[3] // 64)
        boxes.append((*image.shape, left, top, glyph.linearHoriAdvance / 65536))
        pixels.append(image.ravel())
    return {
        "characters": np.array(list(CHARACTERS)),
        "boxes": np.array(boxes, np.float32),
        "pixels": np.concatenate(pixels),
    }


if __name__ == "__main__":
    np.savez_compressed(SHIPPED, **make())
    print(f"{SHIPPED}: {SHIPPED.stat().st_size / 1024:.0f} kB")
