"""Whether the Python modules are there that the add-on's zip brings, and what to do without."""

from __future__ import annotations

import importlib.util
import sys
from functools import cache
from importlib.machinery import PathFinder
from pathlib import Path

import bpy

from . import panel_text

NEEDED = {"colour": "colour-science", "scipy": "scipy", "OpenEXR": "OpenEXR"}
"""Module and what pip and people call it."""

ALSO = "tqdm typing-extensions"
"""What these need in turn, beside numpy."""

PYTHONS = ((3, 11), (3, 13))
"""Of Blender's own builds; the zips have wheels for these."""


@cache
def missing() -> str:
    """One sentence on what is missing and what to do, empty where nothing is.

    Looked up once a session (modules are found, not imported), for panels ask at every redraw.
    """
    names = [name for module, name in NEEDED.items() if not _found(module)]
    if not names:
        return ""
    python = "{}.{}".format(*sys.version_info)
    if sys.version_info[:2] in PYTHONS:
        cure = (
            "install the Spectral Skylight zip made for your platform "
            "(Preferences, Get Extensions, Install from Disk)"
        )
    else:
        cure = (
            f"no zip brings them for Python {python}, so press Copy Command, run what it copied "
            "in a terminal"
        )
    return (
        f"{', '.join(names)} missing: {cure}, then restart Blender; finished files render without"
    )


def command() -> str:
    """What to run in a terminal where no zip fits, empty where one does or nothing is missing.

    It installs into Blender's folder for users' own modules, and leaves the system and numpy alone.
    """
    if not missing() or sys.version_info[:2] in PYTHONS:
        return ""
    folder = bpy.utils.user_resource("SCRIPTS", path="modules")
    packages = " ".join([*NEEDED.values(), ALSO])
    return f'"{sys.executable}" -m pip install --no-deps --target "{folder}" {packages}'


def _found(module: str) -> bool:
    """Whether a module can be found that was made for this Python."""
    spec = importlib.util.find_spec(module)
    if spec is None:
        return False
    if module != "scipy":
        return True
    # Wheels of another Python leave a package that is found and cannot be imported.
    (folder,) = spec.submodule_search_locations or [""]
    return PathFinder.find_spec("_ccallback_c", [str(Path(folder) / "_lib")]) is not None


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The sentence, and where no zip fits the button that copies the command."""
    panel_text.paragraph(layout, context, missing(), "ERROR")
    if command():
        layout.operator("skylight.copy_command", icon="COPYDOWN")


class SKYLIGHT_OT_copy_command(bpy.types.Operator):
    """Copy the command that installs what is missing, to be run in a terminal"""

    bl_idname = "skylight.copy_command"
    bl_label = "Copy Command"

    def execute(self, context):
        """Put the command on the clipboard, and into the log."""
        context.window_manager.clipboard = command()
        self.report({"INFO"}, command())
        return {"FINISHED"}


CLASSES = (SKYLIGHT_OT_copy_command,)
