"""Whether the Python modules are there that the add-on's zip brings."""

from __future__ import annotations

import importlib.util
from functools import cache

NEEDED = {"colour": "colour-science", "scipy": "scipy", "OpenEXR": "OpenEXR"}
"""Module and what people call it."""


@cache
def missing() -> str:
    """One sentence on what is missing and what to do, empty where nothing is.

    Looked up once a session (modules are found, not imported), for panels ask at every redraw.
    """
    names = [name for module, name in NEEDED.items() if importlib.util.find_spec(module) is None]
    if not names:
        return ""
    return (
        f"{' and '.join(names)} missing: install the Spectral Skylight zip made for your platform "
        "(Preferences, Get Extensions, Install from Disk), then restart Blender"
    )
