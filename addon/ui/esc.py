"""Esc for work in the background; without any, poll lets it mean what it always means."""

from __future__ import annotations

import bpy


class EscKey:
    """Esc in all windows, as the key of one operator."""

    def __init__(self, operator: str) -> None:
        self._operator = operator
        self._bound: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []

    def attach(self) -> None:
        """Bind the key; a Blender in the background has none."""
        known = bpy.context.window_manager.keyconfigs.addon
        if known is not None:
            keymap = known.keymaps.new("Window")
            item = keymap.keymap_items.new(self._operator, "ESC", "PRESS")
            self._bound.append((keymap, item))

    def detach(self) -> None:
        """Leave Esc as it was."""
        for keymap, item in self._bound:
            keymap.keymap_items.remove(item)
        self._bound.clear()
