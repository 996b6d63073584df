"""`render`: an EXR and a PNG of a blend file, without a window."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..choices import ENGINES
from .arguments import Commands
from .outputs import output


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "render", help="render a .blend to an EXR and a PNG, without a window"
    )
    parser.add_argument("scene", metavar="SCENE.blend")
    parser.add_argument("--out", required=True, type=output(".exr", ".png"), metavar="FILE.exr")
    parser.add_argument("--camera", metavar="NAME", help="default: the scene's")
    parser.add_argument("--engine", choices=tuple(ENGINES), help="default: the scene's")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Render, and print the paths of the pictures."""
    from ..scene.files import blend_file
    from ..scene.materials import rgb_comparison
    from ..scene.output import render

    scene = blend_file.open_scene(options.scene)
    for path in (Path(options.out), Path(options.out).with_suffix(".png")):
        blend_file.check_unread(path)
    if found := rgb_comparison.shown_now():
        names = ", ".join(material.name for material in found[:5]) + (" …" if found[5:] else "")
        line = f"{names}: rendered as RGB × RGB, because the file was saved in comparison mode"
        print(f"WARNING: {line}; make them spectral again with apply", file=sys.stderr)
    for path in render.render(scene, options.out, options.camera, options.engine):
        print(path)
