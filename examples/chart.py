"""Accuracy against speed, every method that we know of:  sh examples/run chart

Twelve simulated skies in full spectrum, nine faces, 24 patches; and what a sample costs in Eevee.
Some minutes. Picture and tables: examples/out/chart/
"""

import sys
from pathlib import Path

from spectral_skylight.addon import cli

OUT = Path(__file__).resolve().parent / "out" / "chart"

if __name__ == "__main__":
    sys.exit(cli.main(["chart", "--out", str(OUT), *sys.argv[1:]]))
