"""The third box of the panel: what is seen, how far the light is, and what RGB would get wrong."""

from __future__ import annotations

import math

import bpy

from ..choices import BAKED
from ..grouping import some
from . import follow, panel_text, split_view, staleness_handlers, under_way
from .panel_text import paragraph
from .translation import translated

CLOSE = 0.5
"""CIEDE2000 below which nobody sees a difference side by side."""


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """RGB or spectral, the light's state, and the view."""
    box = layout.box()
    _comparison(box, context)
    light(box, context)
    _view(box, context)


def _comparison(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    from ..scene.materials import rgb_comparison

    shown = max((rgb_comparison.shown_by(m) for m in rgb_comparison.shown_now()), default=0)
    row, below = layout.row(align=True), layout.row(align=True)
    below.operator("skylight.split_view", depress=split_view.is_on())
    for show, text, state in (
        ("BEFORE", "RGB", rgb_comparison.RGB),
        ("AFTER", "Spectral", rgb_comparison.SPECTRAL),
        ("DIFFERENCE", "Difference × 8", rgb_comparison.DIFFERENCE),
    ):
        part = (row if state != rgb_comparison.DIFFERENCE else below).row(align=True)
        part.alert = state == shown != rgb_comparison.SPECTRAL
        pressed = state == shown
        change = part.operator("skylight.before_after", text=translated(text), depress=pressed)
        change.show = "AFTER" if pressed else show  # pressed again, it lets go
    row.operator("skylight.show_in_viewport", text="", icon="SHADING_RENDERED")
    if shown:
        row = layout.row()
        row.alert = True
        row.label(text="Renders show this too", icon="ERROR")
    if line := gain(context):
        paragraph(layout, context, line)


def gain(context: bpy.types.Context) -> str:
    """What RGB × RGB gets wrong under this sky, in one line; empty before anything is known."""
    from ..scene import portraits

    rows = [(rgb, name) for name, rgb, _ in portraits.expected() if math.isfinite(rgb)]
    if not rows or panel_text.is_of_other_sky(context):
        return ""
    worst, name = max(rows)
    if worst >= CLOSE:
        mean = sum(rgb for rgb, _ in rows) / len(rows)
        return f"RGB is off by ΔE {mean:.1f}, {worst:.1f} on {name}"
    close = f"RGB is close here, at most ΔE {worst:.1f}"
    estimated = portraits.unsure() is not None
    if panel_text.is_low(context.scene.world):
        return f"{close}. It matters more when measured" if estimated else close
    if estimated:
        return f"{close}. It matters at low sun, or when measured"
    return f"{close}. It matters at low sun"


def light(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How far the light is, in one row whatever it is: what stands below must not move away from
    under the pointer. All else that is to be said of it stands in a closed part."""
    from ..scene import out_of_date

    sentences = [*filter(None, out_of_date.caption(context.scene).split("; "))]
    row = layout.row(align=True)
    if under_way.draw(row):
        pass  # all else changes with it
    elif follow.work() is not None or follow.waiting():
        _progress(row)
    elif follow.halt():
        row.label(text=translated(follow.halt()), icon="ERROR")
        row.operator("skylight.update", text="", icon="PLAY")
    elif text := _old(context):
        row.label(text=translated(text), icon="ERROR")
        row.operator("skylight.bake", text="", icon="RENDER_STILL")
    else:
        state = sentences[0].partition(":")[0] if sentences else "no light yet"
        row.label(text=translated(_capital(state)), icon="LIGHT_SUN")
    header, body = layout.panel("skylight_about_light", default_closed=True)
    header.label(text="About This Light")
    if len(names := out_of_date.unbaked(context.scene)) > 1:
        sentences.append(f"Old light: {some(names, 'object')}")
    for sentence in [*sentences, *follow.lines()] if body is not None else ():
        paragraph(body, context, _capital(sentence))


def _progress(row: bpy.types.UILayout) -> None:
    """A bar with a button that ends it."""
    current = follow.work()
    if current is None:
        row.progress(factor=0.0, text="Waiting for you to pause")
    else:
        left = f", {current.left:.0f} s left" if current.left >= 1.0 else ""
        done = current.progress.done
        row.progress(factor=done, text=translated(f"All light: {100 * done:.0f} %{left}"))
    row.operator("skylight.stop_light", text="", icon="CANCEL")


def _old(context: bpy.types.Context) -> str:
    """Which objects have no light or an old one, where nobody but a person bakes it."""
    from ..scene import out_of_date

    names = out_of_date.unbaked(context.scene)
    if names:
        return f"Old light: {names[0]}" if len(names) == 1 else f"Old light: {len(names)} objects"
    return "Objects changed" if staleness_handlers.moved() and _is_by_hand(context) else ""


def _capital(sentence: str) -> str:
    return sentence[:1].upper() + sentence[1:]


def _view(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    from ..scene.world import view_transform

    fit, _ = view_transform.transform_line(context.scene)
    row = layout.row(align=True)
    row.operator("skylight.view_as", text="Picture", depress=not fit).judge = False
    row.operator("skylight.view_as", text="Judge Colors", depress=fit).judge = True


def _is_by_hand(context: bpy.types.Context) -> bool:
    """Whether materials show bakes that no one but a person makes."""
    world = context.scene.world
    return world is not None and world.skylight.occlusion == BAKED
