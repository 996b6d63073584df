"""The colour space in which this file computes."""

from __future__ import annotations

import bpy


def name() -> str:
    """The file's working space: "Linear Rec.709", "Linear Rec.2020" or "ACEScg".

    Blender 4.5 has one for all files; from 5.0 each file names its own. A custom config.ocio may
    mean something else by the name: Blender tells no more.
    """
    settings = getattr(bpy.data, "colorspace", None)
    return "Linear Rec.709" if settings is None else settings.working_space
