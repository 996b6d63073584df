"""The window in the reader's language, where there is a catalogue of it."""

from __future__ import annotations

from functools import lru_cache

import bpy

from . import catalogue


def translated(text: str) -> str:
    """Return a composed line in the language of the interface; the line itself without one.

    Blender looks up constant labels by itself. What is composed of values, and what other rooms
    say, goes through here on its way into the window.
    """
    language = _language()
    return _line(language, text) if language else text


def _language() -> str:
    """The interface's language, where there is a catalogue of it; empty for English."""
    language = bpy.app.translations.locale
    known = language in catalogue.LANGUAGES
    return language if known and bpy.context.preferences.view.use_translate_interface else ""


@lru_cache(maxsize=4096)
def _line(language: str, text: str) -> str:
    return catalogue.of(language).line(text)


def attach() -> None:
    """Give Blender the catalogues: at once to a reader of one, else when Blender has time."""
    if bpy.app.translations.locale in catalogue.LANGUAGES:
        _give()
    elif not bpy.app.background:  # for one who changes the language later
        bpy.app.timers.register(_give, first_interval=1.0, persistent=True)


def _give() -> None:
    found = {language: catalogue.read(language) for language in catalogue.LANGUAGES}
    bpy.app.translations.register(__name__, found)


def detach() -> None:
    """Take them back."""
    if bpy.app.timers.is_registered(_give):
        bpy.app.timers.unregister(_give)
    bpy.app.translations.unregister(__name__)  # nothing where they were not given yet
    _line.cache_clear()
