"""The command line: ``spectral-skylight …`` and, in Blender, ``blender -c skylight …``.

Exit codes: 0 done, 1 failed, 2 wrong usage or bad input (one line on stderr).
"""

from __future__ import annotations

import _thread
import argparse
import contextlib
import io
import os
import re
import signal
import sys
import threading
import traceback
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import NoReturn

from .commands import outputs
from .commands.arguments import option
from .errors import InputError, fault, printable

COMMANDS = (
    "matrix",
    "library",
    "sky",
    "irradiance",
    "picture",
    "evaluate",
    "chart",
    "apply",
    "animate",
    "explain",
    "measure",
    "sunlight",
    "glazing",
    "render",
    "batch",
)
"""Names of the commands and of their modules."""

PROGRAM = "spectral-skylight"

LABORATORY = ("evaluate", "chart")
"""Those that measure speed, too: as numpy is."""


_NOT_NOW = re.compile(
    r"<frozen importlib|[/\\]scripts[/\\](addons\w*|startup|modules[/\\](?!bpy[/\\]ops))"
)
"""Files of code in which no request to end is obeyed, but soon after.

Blender crashes of an exception while it is imported and loses one in its handlers; NumPy loses one
while it is imported.
"""


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; ``arguments`` as in ``sys.argv[1:]``. Returns the exit code."""
    arguments = sys.argv[1:] if arguments is None else arguments
    for stream in (sys.stdout, sys.stderr):  # names of files may be what a terminal cannot show
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    code, line = 1, ""
    with _ended_gently():
        try:
            code, line = _run(arguments)
            if sys.stdout is not None:
                sys.stdout.flush()
        except BrokenPipeError:  # who reads has enough
            _close_output()
        except OSError as error:
            line = printable(str(error))
            _close_output()
        except KeyboardInterrupt:
            line = "stopped"
        except Exception as error:
            line = fault(error)
            if os.environ.get("SPECTRAL_SKYLIGHT_TRACEBACK"):
                traceback.print_exc()
    if line:
        with contextlib.suppress(OSError):  # where nobody can be told
            print(f"{PROGRAM}: {line}", file=sys.stderr)
    return code


def _run(arguments: Sequence[str]) -> tuple[int, str]:
    """Run a command and return the exit code, and the line that says what is wrong with its use."""
    try:
        options = _parser(arguments).parse_args(arguments)
    except SystemExit as stop:  # --help, wrong usage
        return int(stop.code or 0), ""
    if options.command not in LABORATORY:
        # Before numpy is imported. Products are small here: OpenBLAS's threads wait for one another
        # longer than they work, most of all where other work fills the processors.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        outputs.check(options)
        options.run(options)
    except InputError as error:
        return 2, error.told(getattr(options, "parameter_name", option))
    return 0, ""


def _close_output() -> None:
    """Let what cannot be written any more go nowhere, or Python complains of it in the end."""
    try:
        sys.stdout.flush()
    except OSError:
        with contextlib.suppress(OSError, ValueError):  # where it is no file at all
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextlib.contextmanager
def _ended_gently() -> Iterator[None]:
    """Let a request to end do what Ctrl-C does, in Blender too, which takes that away.

    What is half-written is then removed; what the caller ignores, as under nohup, stays ignored.
    """

    def stop(number: int, frame: FrameType | None) -> None:
        here = str(Path(__file__).parent)
        while frame is not None and not frame.f_code.co_filename.startswith(here):
            if _NOT_NOW.search(frame.f_code.co_filename):
                threading.Timer(0.05, _thread.interrupt_main, [number]).start()
                return
            frame = frame.f_back
        raise KeyboardInterrupt

    names = ("SIGTERM", "SIGINT", "SIGHUP")
    found = [getattr(signal, name) for name in names if hasattr(signal, name)]
    if threading.current_thread() is not threading.main_thread():
        found = []
    before = {each: signal.getsignal(each) for each in found}
    for each, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(each, stop)
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler or signal.SIG_DFL)


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser of the command that is asked for, or of all where none is."""
    first = next(iter(arguments), "")
    parser = _Parser(prog=PROGRAM, description="Spectrally correct colors under skies.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", dest="command")
    for name in [first] if first in COMMANDS else COMMANDS:
        import_module(f".commands.{name}", __package__).add(commands)
    return parser
