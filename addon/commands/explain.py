"""`explain`: why a material of a blend file has the color it has."""

from __future__ import annotations

import argparse
import json

from .arguments import Commands


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "explain", help="show each step from a material's file to its color"
    )
    parser.add_argument("scene", metavar="SCENE.blend")
    parser.add_argument("--material", required=True, metavar="NAME")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print the steps, then what looks suspicious."""
    from ..scene.explain import explain
    from ..scene.files import blend_file

    scene = blend_file.open_scene(options.scene)
    found = explain(scene, blend_file.material(options.material))
    if options.json:
        print(json.dumps(found.plain(), indent=1))
    else:
        print("\n".join(found.lines))
