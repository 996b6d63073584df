"""Arguments that several commands share."""

from __future__ import annotations

import argparse


def three(text: str) -> tuple[float, float, float]:
    """Return the three numbers of ``R,G,B``."""
    try:
        r, g, b = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not three numbers R,G,B") from None
    return r, g, b


def white_or_auto(text: str) -> tuple[float, float, float] | str:
    """Return the three numbers of ``R,G,B``, or ``auto``."""
    return text if text == "auto" else three(text)


def add_matrix_options(parser: argparse.ArgumentParser) -> None:
    """Add what decides a material's matrix, but for the sky."""
    parser.add_argument(
        "--basis",
        default="rayleigh",
        metavar="NAME",
        help="rayleigh, daylight, atmosphere or 'measured FILE.csv'",
    )
    parser.add_argument(
        "--sun-elevation", type=float, metavar="DEG", help="default: where the HDRI has it"
    )
    parser.add_argument("--camera", metavar="NAME|FILE", help="what took a raw HDRI")
    parser.add_argument(
        "--white", type=three, metavar="R,G,B", help="neutral light before white balance"
    )
    parser.add_argument("--unit", choices=("percent", "fraction"), help="of the reflectances")
