"""Accuracy against speed, every method that we know of:  sh examples/run chart

Twelve simulated skies in full spectrum, nine faces, 24 patches; and what a sample costs in Eevee:
some minutes. Then whole pictures of six scenes, which take hours: what is measured stays, so that
one may stop and go on. `--scenes [NAME ...]` makes these alone, other options the first alone.
Mitsuba 3 and Radiance are among them once `sh tests/peers/run` has built their environment.
Pictures and tables: examples/out/chart/
"""

import sys
from pathlib import Path

from spectral_skylight.addon import cli

OUT = Path(__file__).resolve().parent / "out" / "chart"


def main(arguments: list[str]) -> int:
    """Make both charts, or the one that options are for; exit code as the command line's."""
    runs = [arguments] if arguments else [[], ["--scenes"]]
    return next((code for one in runs if (code := cli.main(["chart", "--out", str(OUT), *one]))), 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
