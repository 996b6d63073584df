"""Telling Blender what the add-on brings: classes, properties and the command ``skylight``.

Nothing here computes, so nothing is imported that computes: enabling must take no time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import bpy

from .ui import (
    animate,
    apply,
    assets,
    assign,
    assignment_files,
    bake,
    batch,
    choose_reflectance,
    drop,
    everything,
    explain,
    false_colour,
    follow,
    help,
    imports,
    last_guard,
    library,
    load_sky,
    make_sky,
    material_panel,
    menu,
    meter,
    open_example,
    panels,
    pictures,
    place,
    preferences,
    preview_cache,
    properties,
    refine_sky,
    remove,
    split_view,
    staleness_handlers,
    sunlight,
    swatch_grid,
    translation,
    update,
    view,
)

MODULES = (
    preferences,
    properties,
    place,
    load_sky,
    open_example,
    animate,
    make_sky,
    refine_sky,
    choose_reflectance,
    everything,
    apply,
    update,
    help,
    bake,
    remove,
    explain,
    follow,
    view,
    split_view,
    panels,
    meter,
    false_colour,
    library,
    sunlight,
    swatch_grid,
    assign,
    assignment_files,
    assets,
    drop,
    material_panel,
    batch,
    menu,
    pictures,
)
CLASSES: tuple[type, ...] = tuple(cls for module in MODULES for cls in module.CLASSES)

ATTACHED = (
    properties,
    place,
    library,
    batch,
    meter,
    menu,
    follow,
    split_view,
    refine_sky,
    staleness_handlers,
    help,
    translation,
    imports,
)
"""Modules that give Blender more than classes."""

_undo: list[Callable[[], Any]] = []  # what takes back each step of `register`, in its order


def register() -> None:
    """Register classes, properties and the command; a step that fails takes back those before."""
    try:
        for cls in CLASSES:
            bpy.utils.register_class(last_guard.guarded(cls))
            _undo.append(partial(bpy.utils.unregister_class, cls))
        for module in ATTACHED:
            module.attach()
            _undo.append(module.detach)
        _undo.append(preview_cache.clear)
        _undo.append(false_colour.hide)
        command = bpy.utils.register_cli_command("skylight", _command)
        _undo.append(partial(bpy.utils.unregister_cli_command, command))
    except Exception:
        unregister()
        raise


def unregister() -> None:
    """Take back what `register` did; what materials and Worlds were given stays with them."""
    while _undo:
        _undo.pop()()


def _command(arguments: Sequence[str]) -> int:
    from .cli import main

    return main(arguments)
