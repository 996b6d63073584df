"""Write the α-opic action spectra that ship, from the table that the CIE publishes.

    .venv/bin/python .ci/datasets/alpha_opic.py CIE_a-opic_action_spectra.csv

CIE 2018, CIE alpha-opic action spectra (data table), International Commission on Illumination,
Vienna, AT, DOI 10.25039/CIE.DS.vqqhzp5a, CC BY-SA 4.0: wavelength, then the columns of
`photometry.ALPHA_OPIC`; a first line of names may be there, and what is not defined counts as 0.
`tests/spectra/test_photometry.py` compares four of its five columns with their own sources.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from spectral_skylight.addon.spectra import photometry


def main(path: Path) -> None:
    """Write the file."""
    table = np.nan_to_num(np.genfromtxt(path, delimiter=","))
    table = table[table[:, 0] >= 380.0]
    head = ",".join(["wavelength", *photometry.ALPHA_OPIC])
    lines = [",".join(f"{value:.7g}" for value in row) for row in table]
    text = "\n".join([head, *lines, ""])
    photometry.FILE.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
