"""The library that is shown: derived from its folders, kept while Blender runs, in no file.

Panels read it at every redraw; only the refreshing operator computes.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import lru_cache
from typing import Any

import bpy

from ..errors import InputError
from ..progress import Progress, a_while, run

ALL = "ALL"
"""The category that holds every reflectance."""

OFFERED = 3
"""Measured reflectances that are offered for a material."""

library: Any = None
"""The `spectra.library.Library`, None before it was read."""

daylight: Any = None
"""Its colours under D65 (m, 3) in the working space."""

under_sky: Any = None
"""Its colours under the sky, None where there was none."""

lit_by = ""
"""The `scene.under_sky.sky_key` of that sky."""

_near: tuple[float, float, float] | None = None  # the color that a grid begins with

SLICE = 0.05
"""[s] of work between two looks at what a person does."""

_lighting: Generator[Progress, None, None] | None = None

partial = False
"""Whether the library's folders were left out so far."""


def put(found: Any, part: bool = False) -> None:
    """Show another library, its colours not known yet; ``part``: `partial`."""
    global library, daylight, under_sky, lit_by, partial
    library, daylight, under_sky, lit_by, partial = found, None, None, "", part
    for derived in (_shown, _nearest, categories, _found):
        derived.cache_clear()


def light(context: bpy.types.Context) -> None:
    """Compute the colours, as `lighting` does."""
    run(lighting(context))


def lighting(context: bpy.types.Context) -> Generator[Progress, None, None]:
    """Compute the colours, under D65 and under the scene's sky where it has one."""
    global daylight, under_sky, lit_by
    from ..scene import swatches_under_sky as scene_sky
    from . import properties

    found, key, world = library, sky_key(context), context.scene.world
    colours, plain = None, scene_sky.daylight(found.values)
    try:
        if world is not None:
            settings = properties.settings_of(world)
            colours, plain = yield from scene_sky.colouring(world, settings, found.values)
    except InputError:  # the panel says what is wrong with the sky; D65 is shown all the same
        pass
    if library is found:
        under_sky, daylight, lit_by = colours, plain, key


def is_stale(context: bpy.types.Context) -> bool:
    """Whether the colours are those under another sky."""
    return library is not None and sky_key(context) != lit_by


def follow_sky(context: bpy.types.Context) -> None:
    """Let the colours be those under the scene's sky soon, where they are another's."""
    if not is_stale(context) or bpy.app.background:
        return
    if not bpy.app.timers.is_registered(_follow):
        bpy.app.timers.register(_follow, first_interval=0.01)


def _follow() -> float | None:
    global _lighting
    for window in bpy.context.window_manager.windows:
        with bpy.context.temp_override(window=window):
            _lighting = _lighting or lighting(bpy.context)
            try:
                a_while(_lighting, SLICE)
                return 0.01
            except StopIteration:
                _lighting = None
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
        return None
    return None


def sky_key(context: bpy.types.Context) -> str:
    """What tells whether the scene has another sky than the one that swatches are lit by."""
    from ..scene import swatches_under_sky as scene_sky
    from . import properties

    world = context.scene.world
    return scene_sky.sky_key(world, properties.settings_of(world) if world is not None else None)


def colour(of: Any, number: int) -> tuple[float, float, float]:
    """Return one of the colours as a swatch can show it; black where it is not known."""
    if of is None or number >= len(of):
        return (0.0, 0.0, 0.0)
    red, green, blue = (min(max(float(part), 0.0), 1.0) for part in of[number])
    return red, green, blue


def shown(search: str, by: str) -> tuple[list[bool], list[int]]:
    """Return whether each reflectance is found, and its place in the order."""
    return _shown(id(library), search, by)


@lru_cache(maxsize=32)
def _shown(which: int, search: str, by: str) -> tuple[list[bool], list[int]]:
    count = len(library)
    wanted = set(library.search(search).tolist())
    places = [0] * count
    for place, number in enumerate(library.order(by.lower()).tolist()):
        places[number] = place
    return [k in wanted for k in range(count)], places


def nearest(color: tuple[float, float, float], name: str, space: str) -> tuple[Any, ...]:
    """Return the measured reflectances nearest to a material's base color and its name.

    The `transfer.nearest.Nearest` of the library that is shown, the best first; none without one.
    """
    return _nearest(id(library), color, name, space) if library is not None else ()


@lru_cache(maxsize=64)
def _nearest(which: int, color: tuple[float, ...], name: str, space: str) -> tuple[Any, ...]:
    from ..transfer.nearest import nearest as find

    return tuple(find(library, color, name, OFFERED, space))


@lru_cache(maxsize=2)
def categories(which: int) -> tuple[tuple[str, str, str], ...]:
    """Return the library's classes as an enum has them, those of all first.

    ``which``: the id of `library`, for what is kept belongs to one library.
    """
    named = sorted({kind for kind in library.classes if kind}) if library is not None else []
    return (ALL, "All", "Every reflectance"), *((kind, kind, "") for kind in named)


def look_near(material: bpy.types.Material | None) -> None:
    """Let a grid begin with what is nearest to a material as it is now, however it changes then."""
    from ..scene.materials import base_color

    global _near
    _near = None if material is None else base_color.shown_colour(material)


def found(own: Any) -> tuple[int, ...]:
    """Return the numbers of what a grid shows for a `SkylightLibrary`: the nearest first, by name
    where its material has no color. Patches of color checkers, which nothing is built of, are left
    out as long as nobody asks for them."""
    from ..scene.blend_data import working_space

    if library is None:
        return ()
    return _found(id(library), own.search, own.category, _near, own.material, working_space.name())


@lru_cache(maxsize=32)
def _found(which: int, search: str, category: str, color: Any, name: str, space: str) -> Any:
    from ..spectra.formats import checkers
    from ..transfer.nearest import nearest as find

    wanted = {k for k in library.search(search) if category in (ALL, library.classes[k])}
    if not search and category == ALL:
        wanted = {k for k in wanted if not library.paths[k].startswith(checkers.PREFIX)}
    if color is None:
        order = library.order("name").tolist()
    else:
        order = [one.number for one in find(library, color, name, len(library), space)]
    first = [k for k in order if k in wanted]
    return (*first, *sorted(wanted.difference(first)))


def swatch(number: int) -> tuple[int, int, int]:
    """Return the sRGB color of one under the sky, under D65 where there is none."""
    from ..scene import swatches_under_sky

    shown = daylight if under_sky is None else under_sky
    red, green, blue = swatches_under_sky.on_screen(shown[number])
    return red, green, blue


def place(number: int | None) -> tuple[str, str] | None:
    """The file and the column of a reflectance, by which it is found again in another library."""
    return None if number is None else (library.paths[number], library.names[number])


def seen(context: bpy.types.Context) -> int | None:
    """The number of the reflectance that is chosen and to be seen in the list; None without."""
    number, own = chosen(context), context.window_manager.skylight_library
    return number if number is not None and shown(own.search, own.order)[0][number] else None


def chosen(context: bpy.types.Context) -> int | None:
    """The number of the reflectance that is chosen in the list, None without a list."""
    own = context.window_manager.skylight_library
    known = library is not None and len(own.spectra) == len(library)
    return own.active if known and own.active < len(own.spectra) else None
