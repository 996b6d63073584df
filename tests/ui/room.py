"""What of a panel's texts would be cut off in a sidebar of some width: Blender's rows, by numbers.

The measures are those of interface_layout.cc and interface_widgets.cc at scale 1, held against a
real window's rows of 250 pixels. A layout that only records what is drawn has no widths.
"""

from types import SimpleNamespace

import bpy

from spectral_skylight.addon.ui import catalogue, text_width, translation

UNIT = 20
"""[pixels] of a button's height, and of an icon's place."""
TABS, PANEL, BOX, SPACE = UNIT, 18, 5, 8
"""[pixels] of the tabs, and on either side of a panel's and a box's content; between items."""
LABEL, ICON, BUTTON, ARROW, DIGITS = 4, 26, 5, 20, 40
"""[pixels] that a text leaves free: of a label, beside an icon, of a button, of a menu's arrow, and
of a number with its name."""
DIVIDE = 0.4
"""Of a row: the names of properties, where they stand before their values."""
NUMBER = "-00.00"
"""What stands in a number's field behind its name."""


class Layout:
    """A layout that knows what it is; its items are layouts or (kind, text, icon)."""

    def __init__(self, kind="column", language="", factor=0.0):
        own = {"kind": kind, "language": language, "factor": factor, "items": [], "space": SPACE}
        self.__dict__.update(own, use_property_split=False)

    def __setattr__(self, name, value):
        if name == "use_property_split":
            self.__dict__[name] = value

    def __getattr__(self, name):
        def draw(*arguments, **options):
            return SimpleNamespace()

        return draw

    def _within(self, kind, factor=0.0, align=False):
        found = Layout(kind, self.language, factor)
        found.__dict__["space"] = 0 if align else SPACE
        found.use_property_split = self.use_property_split
        self.items.append(found)
        return found

    def row(self, align=False, **_):
        return self._within("row", align=align)

    def column(self, **_):
        return self._within("column")

    def box(self):
        return self._within("box")

    def split(self, factor=0.0, **_):
        return self._within("split", factor)

    def grid_flow(self, columns=0, **_):
        return self._within("column")  # one column of it is as wide as it may be

    def panel(self, *_, **__):
        return self._within("row"), self._within("column")

    def _text(self, context, text):
        return catalogue.of(self.language).messages.get((context, text), text)

    def label(self, text="", icon="NONE", translate=True, **_):
        self.items.append(("label", self._text("*", text) if translate else text, icon != "NONE"))

    def operator(self, name, text=None, icon="NONE", translate=True, **_):
        if text is None:
            kind = getattr(bpy.ops, name.split(".")[0])
            text = getattr(kind, name.split(".")[1]).get_rna_type().name
        text = self._text("Operator", text) if translate else text
        self.items.append(("operator", text, icon != "NONE"))
        return SimpleNamespace()

    def operator_menu_enum(self, name, _, text=None, icon="NONE", translate=True):
        self.operator(name, text, icon, translate)

    def menu(self, name, text=None, icon="NONE", **_):
        text = getattr(bpy.types, name).bl_label if text is None else text
        self.items.append(("menu", self._text("*", text), icon != "NONE"))

    def progress(self, text="", **_):
        self.items.append(("operator", self._text("*", text), False))

    def template_icon(self, icon_value=0, scale=1.0):
        self.items.append(("picture", "", UNIT * scale))

    def prop(self, data, name, text=None, icon="NONE", **_):
        rna = data.bl_rna.properties[name]
        text = self._text("*", rna.name if text is None else text)
        value = {"FLOAT": NUMBER, "INT": NUMBER}.get(rna.type, "") if rna.subtype != "COLOR" else ""
        if rna.type == "ENUM":
            value = max(
                (self._text("*", item.name) for item in rna.enum_items), key=text_width.width
            )
        kind = "color" if rna.subtype == "COLOR" else rna.type.lower()
        self.items.append((kind, text, icon != "NONE", value, self.use_property_split))


def natural(item):
    """How wide an item would be in a row, and whether it stays so: what has a text shares alike."""
    if isinstance(item, Layout):
        if item.kind == "row" and item.items:
            widths = [natural(each) for each in item.items]
            return sum(w for w, _ in widths) + item.space * (len(widths) - 1), all(
                f for _, f in widths
            )
        return (10 * UNIT, False) if item.items else (0, True)
    kind, text, icon, *_ = item
    if kind == "picture":
        return icon, True
    is_icon = not text and kind in ("label", "operator", "menu")
    return (UNIT, True) if is_icon else (10 * UNIT, False)


def cut(layout, width):
    """Yield (text, pixels too many) for each text that has too little room."""
    items = layout.items
    if layout.kind in ("row", "split"):
        room = width - layout.space * (len(items) - 1)
        if layout.kind == "split" and layout.factor:
            rest = (1.0 - layout.factor) / max(1, len(items) - 1)
            widths = [room * (rest if k else layout.factor) for k in range(len(items))]
        else:
            wanted = [natural(item) for item in items]
            fixed = sum(w for w, is_fixed in wanted if is_fixed)
            free = sum(w for w, is_fixed in wanted if not is_fixed)
            share = max(0.0, room - fixed) / free if free else 1.0
            widths = [w if is_fixed else w * share for w, is_fixed in wanted]
    else:
        widths = [width - 2 * BOX * (layout.kind == "box")] * len(items)
    for item, own in zip(items, widths, strict=True):
        if isinstance(item, Layout):
            yield from cut(item, own)
        else:
            yield from _cut(item, own)


def _cut(item, room):
    kind, text, icon, *more = item
    value, is_split = more or ("", False)
    if kind in ("label", "boolean"):
        room *= 1.0 - DIVIDE * (is_split and kind == "boolean")
        parts = [(text, room - (ICON if icon or kind == "boolean" else LABEL))]
    elif kind == "picture":
        parts = []
    elif kind in ("color", "string", "pointer") and not is_split:
        parts = [(text, 0.5 * room - LABEL)]
    elif is_split:
        parts = [(text, DIVIDE * room - LABEL)]
        if value:
            parts.append((value, (1.0 - DIVIDE) * room - 2 * BUTTON - ARROW))
    elif kind in ("float", "int"):
        parts = [(text + value, room - DIGITS)]
    elif kind == "enum":
        parts = [(value, room - 2 * BUTTON - ARROW)]
    else:
        parts = [(text, room - (ICON if icon else 0) - BUTTON)]
    for part, own in parts:
        if part and text_width.width(part) > own:
            yield part, text_width.width(part) - own


class _Context:
    """Blender's context, with a region of a width."""

    def __init__(self, width):
        self.region = SimpleNamespace(width=width)

    def __getattr__(self, name):
        return getattr(bpy.context, name)


def content(sidebar):
    """The width of a panel's content in a sidebar of a width [pixels]."""
    return sidebar - TABS - 2 * PANEL


WIDTHS = 250, 300, 400
"""[pixels] of the sidebar: somewhat less than Blender's own, and up to a wide one."""


def cut_off(monkeypatch, draw):
    """What is cut off in any language at any width: lines to read, none where all is whole.

    ``draw`` takes a layout and a context, as panels do.
    """
    found = {}
    for language in ("", *catalogue.LANGUAGES):
        monkeypatch.setattr(translation, "_language", lambda language=language: language)
        for width in WIDTHS:
            layout = Layout(language=language)
            draw(layout, _Context(width))
            for text, more in cut(layout, content(width)):
                found[f"{language or 'English'}: {text!r} needs {more:.0f} px more at {width}"] = (
                    None
                )
    monkeypatch.setattr(translation, "_language", lambda: "")
    return [*found]


def of_panel(panel):
    """How `cut_off` draws a panel; nothing where it does not show."""

    def draw(layout, context):
        if not hasattr(panel, "poll") or panel.poll(context):
            panel.draw(SimpleNamespace(layout=layout), context)

    return draw
