"""How the picture is shown: what a view transform does to colours, and a neutral white.

White is Blender's own setting of the view. It changes what is seen and what is saved through the
view, such as PNG, never scene-linear values: an EXR stays exact.
"""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np

from ... import tags
from ...errors import InputError
from ..blend_data import kept
from . import settings as world_settings

WHITE = ("use_white_balance", "white_balance_temperature", "white_balance_tint")

PICTURE = ("view_transform", "look", "use_curve_mapping")
"""What of a view makes a picture that is not fit to judge colors."""

TRANSFORMS = {
    "Standard": (True, "shows colors as computed and clips what is brighter than the screen"),
    "Khronos PBR Neutral": (
        True,
        "shows colors as computed up to 80 % of white and compresses what is brighter",
    ),
    "AgX": (False, "looks like film: shifts hues and desaturates. Do not judge colors in it"),
    "Filmic": (False, "looks like film: lowers contrast and saturation. Do not judge colors in it"),
    "Filmic Log": (False, "shows a flat picture for grading in another program"),
    "ACES 1.3": (
        False,
        "looks like cinema: strong contrast, shifts bright hues. Do not judge colors in it",
    ),
    "ACES 2.0": (
        False,
        "looks like cinema: contrast like film, keeps hues better. Do not judge colors in it",
    ),
    "False Color": (False, "shows brightness as a heat map"),
    "Raw": (False, "shows linear values without conversion: too dark, with wrong colors"),
}
"""Blender's view transforms: whether colours can be judged by it, and what it does."""


def transform_line(scene: bpy.types.Scene) -> tuple[bool, str]:
    """Whether colours can be judged by a scene's view transform, and a sentence on what it does."""
    name = scene.view_settings.view_transform
    fit, does = TRANSFORMS.get(name, (False, "comes from a custom color configuration"))
    look = scene.view_settings.look
    if look not in ("", "None"):
        fit, does = False, f"{does}. The look {look} also changes colors"
    if scene.view_settings.use_curve_mapping:
        fit, does = False, f"{does}. The curves also change colors"
    return fit, f"{name}: {does}"


def judge(scene: bpy.types.Scene, on: bool) -> None:
    """Let a scene's view show colors as computed, or as it did before; Blender's own if it never
    was another."""
    view = scene.view_settings
    fit, _ = transform_line(scene)
    if on and not fit:
        scene[tags.PICTURE] = {name: getattr(view, name) for name in PICTURE}
        for name, value in zip(PICTURE, ("Standard", "None", False), strict=True):
            setattr(view, name, value)
    elif not on and fit:
        before = scene[tags.PICTURE].to_dict() if tags.PICTURE in scene else {PICTURE[0]: "AgX"}
        for name, value in before.items():
            setattr(view, name, type(getattr(view, name))(value))
        if tags.PICTURE in scene:
            del scene[tags.PICTURE]


def disabled_reason(scene: bpy.types.Scene, level: Sequence[float] | None) -> str:
    """Why a scene's white cannot be made neutral, empty where it can.

    ``level``: RGB of a white, level face under its sky, None before that is known.
    """
    world = scene.world
    if level is None or world is None:
        return "Make a material spectral first"
    if (world_settings.stored(world) or world_settings.Settings()).white is not None:
        return "The HDRI is already white-balanced"
    view = scene.view_settings
    white_level = tuple(view.curve_mapping.white_level) if view.use_curve_mapping else (1.0,) * 3
    if max(white_level) - min(white_level) > 1e-6:
        return "The view's curves already set a white level"
    if tags.VIEW not in scene and view.use_white_balance:
        return "The view already uses White Balance"
    if min(level) <= 0.0:
        return "The light of this sky has no white point"
    return ""


def neutral(scene: bpy.types.Scene, level: Sequence[float]) -> str:
    """Let a white, level face of this RGB (3,) look neutral in a scene's view; return a line.

    Raises InputError where `disabled_reason` says why not, and for a light that is bluer or
    greener than Blender's white balance goes; the view is as before then.
    """
    place = f'scene "{scene.name}"'
    if why := disabled_reason(scene, level):
        raise InputError(place, why, "use only one white balance")
    view = scene.view_settings
    before = _values(view)
    known = {"before": before, **kept.mapping(scene, tags.VIEW)}
    view.use_white_balance = True
    view.white_balance_whitepoint = tuple(np.array(level) / max(level))
    found = np.array(view.white_balance_whitepoint)
    off = np.abs(found / found.sum() - np.array(level) / np.sum(level)).max()
    if off > 2e-3:  # Blender leaves it as it was
        _set(view, before)
        raise InputError(
            place,
            "its light is outside the range of Blender's White Balance",
            "set the white balance by hand",
        )
    scene[tags.VIEW] = {**known, "ours": _values(view)}
    return (
        f"White Balance: {view.white_balance_temperature:.0f} K, "
        f"tint {view.white_balance_tint:+.0f}; scene-linear EXR files do not change"
    )


def refresh(scene: bpy.types.Scene, level: Sequence[float]) -> list[str]:
    """Let a neutral white follow another sky, where a scene has one of ours; return warnings."""
    if tags.VIEW not in scene:
        return []
    try:
        neutral(scene, level)
    except InputError as error:
        give_back(scene)
        return [f"the white is no longer neutral: {error}"]
    return []


def give_back(scene: bpy.types.Scene) -> None:
    """Give a scene's view its white back; what a user has changed meanwhile stays."""
    if tags.VIEW not in scene:
        return
    known, view = kept.mapping(scene, tags.VIEW), scene.view_settings
    if _values(view) == known.get("ours"):
        with contextlib.suppress(TypeError, ValueError, AttributeError):  # overwritten by hand
            _set(view, known["before"] if isinstance(known.get("before"), dict) else {})
    del scene[tags.VIEW]


def _values(view: Any) -> dict[str, Any]:
    return {name: getattr(view, name) for name in WHITE}


def _set(view: Any, values: dict[str, Any]) -> None:
    for name, value in values.items():
        setattr(view, name, value)
