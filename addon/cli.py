"""The command line: ``spectral-skylight …`` and, in Blender, ``blender -c skylight …``.

Exit codes: 0 done, 1 failed, 2 wrong usage or bad input (one line on stderr).
"""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import NoReturn

from .commands.arguments import option
from .errors import InputError

COMMANDS = (
    "matrix",
    "library",
    "sky",
    "irradiance",
    "picture",
    "evaluate",
    "chart",
    "apply",
    "explain",
    "render",
    "batch",
)
"""Names of the commands and of their modules."""

LABORATORY = ("evaluate", "chart")
"""Those that measure speed, too: as numpy is."""


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; ``arguments`` as in ``sys.argv[1:]``. Returns the exit code."""
    arguments = sys.argv[1:] if arguments is None else arguments
    parser = _parser(arguments)
    for stream in (sys.stdout, sys.stderr):  # names of files may be what a terminal cannot show
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        options = parser.parse_args(arguments)
    except SystemExit as stop:  # --help, wrong usage
        return int(stop.code or 0)
    if options.command not in LABORATORY:
        # Before numpy is imported. Products are small here: OpenBLAS's threads wait for one another
        # longer than they work, most of all where other work fills the processors.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        options.run(options)
    except InputError as error:
        name = getattr(options, "parameter_name", option)
        print(f"{parser.prog}: {error.told(name)}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"{parser.prog}: stopped", file=sys.stderr)
        return 1
    return 0


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser of the command that is asked for, or of all where none is."""
    first = next(iter(arguments), "")
    parser = _Parser(prog="spectral-skylight", description="Spectrally correct colors under skies.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", dest="command")
    for name in [first] if first in COMMANDS else COMMANDS:
        import_module(f".commands.{name}", __package__).add(commands)
    return parser
