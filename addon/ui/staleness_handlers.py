"""What has changed since materials were made spectral, noticed while a person works.

What is known here follows from the file and is forgotten with the session: undo, saving and scripts
need nothing of it, and without a window no handler runs (`scene.stale` tells the same when asked).
A handler looks only at what Blender says has changed, so that panels have nothing to compute.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy
from bpy.app.handlers import persistent

from .. import tags
from . import follow
from .last_guard import handler as guarded

LIGHTS = bpy.types.Light, bpy.types.World, bpy.types.Material
"""What gives or reflects light, beside objects."""
PLACES = bpy.types.Object, bpy.types.Collection
"""What is somewhere: a collection tells of what was deleted or hidden."""

_stale: dict[int, str] = {}  # by a material's session_uid, why it is
_files: dict[int, tuple[str, str]] = {}  # the same, by what was found on disk, and for which hash
_moved = False
_ours = False  # whether what Blender tells of is our own doing
_at_work = False  # whether it would tell in the midst of that


def stale(material: bpy.types.Material) -> str:
    """Why a material is no longer what was made spectral, empty as far as is known."""
    uid = material.session_uid
    return _stale.get(uid) or _files.get(uid, ("", ""))[1]


def stale_materials() -> list[bpy.types.Material]:
    """The materials that are known to be stale."""
    return [m for m in bpy.data.materials if stale(m)] if _stale or _files else []


def moved() -> bool:
    """Whether objects have changed since the bakes were looked at."""
    return _moved


def found_files(lines: dict[bpy.types.Material, str]) -> None:
    """Remember of which materials the files on disk are no longer those that were read."""
    from ..scene.materials import spectral_material

    _files.clear()
    for material, line in lines.items():
        _files[material.session_uid] = spectral_material.hash_of(material), line


def found_bakes() -> None:
    """Remember that bakes were looked at just now."""
    global _moved
    _moved = False


@contextlib.contextmanager
def ours(context: bpy.types.Context) -> Iterator[None]:
    """Do work whose changes are not a user's."""
    global _ours
    _ours = True
    try:
        with at_work():
            yield
        context.view_layer.update()
    finally:
        _ours = False


@contextlib.contextmanager
def at_work() -> Iterator[None]:
    """Do work of which Blender does not tell us in its midst, for what it names may be gone then.

    It evaluates the scene whenever the work asks for it, and Blender 5.2 has crashed on what the
    step before had replaced. `look` at all materials afterwards.
    """
    global _at_work
    before, _at_work = _at_work, True
    try:
        yield
    finally:
        _at_work = before


def after(context: bpy.types.Context) -> None:
    """Look at all materials once we have changed some, and light what has no light yet."""
    if not bpy.app.background:
        with ours(context):
            pass  # Blender tells now of what we have changed
    look()
    follow.ask()


def look() -> None:
    """Look at all materials of the file."""
    _stale.clear()
    if not any(tags.MATERIAL in material for material in bpy.data.materials):
        return
    from ..scene.materials import spectral_material

    found = spectral_material.managed_materials()
    hashes = {m.session_uid: spectral_material.hash_of(m) for m in found}
    for uid in [uid for uid, (known, _) in _files.items() if hashes.get(uid) != known]:
        del _files[uid]
    for material in found:
        _look_at(material)


def _look_at(material: bpy.types.Material) -> None:
    from ..scene import out_of_date as freshness

    if line := freshness.colour(material):
        _stale[material.session_uid] = line
    else:
        _stale.pop(material.session_uid, None)


@persistent
@guarded
def _changed(scene, depsgraph) -> None:
    global _moved
    if _at_work:
        return
    for update in depsgraph.updates:
        changed = update.id
        if not _ours and isinstance(changed, LIGHTS):
            follow.ask()
        if isinstance(changed, bpy.types.Material) and tags.MATERIAL in changed:
            _look_at(changed.original)  # its viewport colour, where it has no nodes of its own
        elif isinstance(changed, bpy.types.NodeTree) and changed.is_embedded_data:
            # The old shader shows no more: of its values' changes only the tree is told.
            for material in bpy.data.materials:
                if tags.MATERIAL in material and material.node_tree == changed.original:
                    _look_at(material)
        elif (
            isinstance(changed, PLACES)
            and (update.is_updated_transform or update.is_updated_geometry)
            and not _ours
        ):
            _moved = _moved or getattr(changed, "type", "") not in ("LIGHT", "EMPTY")
            follow.ask()


@persistent
@guarded
def _undoing(*_) -> None:
    follow.drop()  # what it holds of the file is no more


@persistent
@guarded
def _undone(*_) -> None:
    look()
    follow.ask()


@persistent
@guarded
def _loaded(*_) -> None:
    _files.clear()
    found_bakes()
    look()


@persistent
@guarded
def _written(*_) -> None:
    found = [material.name for material in bpy.data.materials if tags.SHOWS_RGB in material]
    if found:
        print(f"WARNING: Spectral Skylight: {len(found)} material(s) show RGB × RGB")


HANDLERS = {
    "depsgraph_update_post": _changed,
    "load_post": _loaded,
    "undo_pre": _undoing,
    "redo_pre": _undoing,
    "load_pre": _undoing,
    "undo_post": _undone,
    "redo_post": _undone,
    "save_pre": _written,
    "render_init": _written,
}


def attach(background: bool = False) -> None:
    """Begin to watch, where there is a window, or also without one."""
    if bpy.app.background and not background:
        return
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def detach() -> None:
    """Watch no longer, and forget."""
    for name, handler in HANDLERS.items():
        handlers = getattr(bpy.app.handlers, name)
        if handler in handlers:
            handlers.remove(handler)
    _stale.clear()
    _files.clear()
