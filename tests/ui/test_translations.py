"""The interface in other languages: whole, true to the English, and composed of its parts.

What is read from the code needs no Blender. `tests/ui/strings.py` says which strings count.
"""

import ast
import re

import pytest

from spectral_skylight.addon.ui import catalogue
from spectral_skylight.tests.ui import strings

MESSAGES = strings.messages()
UPDATE = "run `python -m spectral_skylight.tests.ui.strings` and fill in the empty msgstr"


@pytest.fixture(scope="module", params=catalogue.LANGUAGES)
def known(request):
    """The messages of one language."""
    return catalogue.read(request.param)


def test_the_code_is_read():
    assert len(MESSAGES) > 600
    assert all(any(strings.ADDON.glob(name)) for name in strings.SENTENCES)
    for message in (
        ("Operator", "Make Everything Spectral"),
        ("*", "Turn of the sky about the vertical, counterclockwise from above"),
        ("*", "Open Sky"),
        ("Line", "{0} of {1}: {2} measured, {3} estimated"),
        ("Line", "emits light"),
    ):
        assert message in MESSAGES


def test_every_text_is_translated_and_none_is_left_over(known):
    missing = [message for message in MESSAGES if not known.get(message)]
    assert not missing, f"{UPDATE}: {missing}"
    assert not known.keys() - MESSAGES.keys(), UPDATE


def test_values_and_figures_stay(known):
    """Every place for a value, and every figure; a translation may write more, as 2 for two."""
    for (_, english), text in known.items():
        assert not text or catalogue.places(text) == catalogue.places(english), text
        for figure in re.findall(r"\d[\d.,]*\d|\d", english):
            assert not text or figure in text, (english, text)
        for sign in ("%", "ΔE", "RGB × RGB", "D65", ".exr", "CSV", "..."):
            assert not text or sign in text or sign not in english, (english, text)


def test_no_translation_is_longer_than_twice_the_english(known):
    """In `text_width`'s terms: a character of Japanese is as wide as two of others."""
    wide = lambda text: sum(2 if ord(c) > 0x2FFF else 1 for c in text)  # noqa: E731
    wrong = [text for (_, english), text in known.items() if wide(text) > 2 * wide(english) + 12]
    assert wrong == []


def registered():
    """Every text that Blender's own data says of what the add-on registers, with its context."""
    import bpy

    from spectral_skylight.addon import registration

    def of_properties(rna):
        for each in rna.properties:
            if each.identifier in ("rna_type", "name") or each.is_hidden:
                continue
            texts = (each.name if each.name != each.identifier else "", each.description)
            yield from ((each.translation_context, text) for text in texts)
            for item in getattr(each, "enum_items_static", ()):
                yield from (
                    (each.translation_context, text) for text in (item.name, item.description)
                )

    for name in dir(bpy.ops.skylight):
        rna = getattr(bpy.ops.skylight, name).get_rna_type()
        yield "Operator", rna.name
        yield "*", rna.description
        yield from of_properties(rna)
    for cls in registration.CLASSES:
        if issubclass(cls, bpy.types.PropertyGroup | bpy.types.AddonPreferences):
            yield from of_properties(cls.bl_rna)
        elif issubclass(cls, bpy.types.Panel | bpy.types.Menu | bpy.types.FileHandler):
            yield "*", cls.bl_label


@pytest.mark.blender
def test_what_blender_knows_is_read_from_the_code_too(addon):
    """The other way than `strings`: a text that it does not see would never be translated."""
    found = {(context, text) for context, text in registered() if re.search("[a-z]{2}", text)}
    assert len(found) > 300
    missing = {m for m in found - MESSAGES.keys() if m[1] not in strings.NOT_SHOWN}
    assert missing == set()


LINES = {
    "8 of 11: 1 measured, 7 estimated": "8 von 11: 1 gemessen, 7 geschätzt",
    "Day, sun at 33°, good": "Tag, Sonne 33°, gut",
    "17 materials (Wall, Roof, Door …): emits light": (
        "17 Materialien (Wall, Roof, Door …): strahlt Licht ab"
    ),
    "All light is baked": "Alles Licht ist gebacken",
    "All light: 40 %, 12 s left": "Alles Licht: 40 %, noch 12 s",
    "All light: 40 %": "Alles Licht: 40 %",
    "No light is baked yet: the open sky lights every face": (
        "Noch kein Licht ist gebacken: der offene Himmel beleuchtet jede Fläche"
    ),
    "sky: basis daylight, degree 2, no sun; 40 % of the sky is hidden from these materials: "
    "sky shadows are not noticeable": (
        "Himmel: Basis daylight, Grad 2, keine Sonne; 40 % des Himmels sind vor diesen Materialien "
        "verborgen: Himmelsschatten sind nicht merklich"
    ),
    "Left alone: Red Brick: is hair": "Nicht verändert: Red Brick: ist Haar",
    "Wall: brick, ΔE 0.1 (at most 0.3), RGB × RGB 2.0; out of gamut: Blender clamps it": (
        "Wall: brick, ΔE 0.1 (höchstens 0.3), RGB × RGB 2.0; "
        "außerhalb des Farbumfangs: Blender begrenzt es"
    ),
}


@pytest.mark.parametrize("english", LINES)
def test_a_line_is_put_together_of_its_parts(english):
    assert catalogue.of("de_DE").line(english) == LINES[english]


def test_every_line_is_known_with_values(known):
    """In each catalogue's own words: no other message takes its place, or takes it apart."""
    own = catalogue.Catalogue(known)
    for (context, english), text in known.items():
        if context == "Line" and strings.is_words(english):
            values = [str(7 + number) for number in range(len(catalogue.places(english)))]
            assert own.line(english.format(*values)) == text.format(*values)


@pytest.mark.parametrize("name", ["Material", "Day", "Ground", "Glass", "Remove All", "Roof, old"])
def test_names_that_people_give_stay(name):
    """Though the interface has such words too."""
    assert catalogue.of("de_DE").line(f"Sky: {name}") == f"Himmel: {name}"
    assert catalogue.of("de_DE").line(f"{name}: emits light") == f"{name}: strahlt Licht ab"


def test_what_no_catalogue_knows_stays():
    for language in catalogue.LANGUAGES:
        for text in ("", "brick", "Wall: 0.3", "/tmp/a b.csv: line 3: no number; mend it"):
            assert catalogue.of(language).line(text) == text


def test_a_catalogue_as_other_tools_write_it(tmp_path, monkeypatch):
    """Lines broken, quotes escaped, comments, plural and obsolete messages, no context."""
    (tmp_path / "de_DE.po").write_text(
        '# A comment\nmsgid ""\nmsgstr ""\n"Language: de_DE\\n"\n\n#: panels.py:3\n#, fuzzy\n'
        'msgctxt "Line"\nmsgid ""\n"Say \\"{0}\\" "\n"twice"\n'
        'msgstr "Zweimal „{0}“\\n"\n"sagen"\n\n'
        'msgid "Sky"\nmsgstr "Himmel"\n\nmsgctxt "Operator"\nmsgid "Bake"\nmsgstr ""\n'
        '#~ msgid "Old"\n#~ msgstr "Alt"\n',
        encoding="utf-8",
    )
    monkeypatch.setattr(catalogue, "FOLDER", tmp_path)
    assert catalogue.read("de_DE") == {
        ("Line", 'Say "{0}" twice'): "Zweimal „{0}“\nsagen",
        ("*", "Sky"): "Himmel",
        ("Operator", "Bake"): "",
    }
    assert catalogue.read("es") == {}


def composed_labels(tree):
    """Every text that is composed and goes into the window as it is, by its line."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        named = {keyword.arg: keyword.value for keyword in node.keywords}
        text = named.get("text")
        if ast.unparse(node.func).rpartition(".")[2] == "poll_message_set":
            text = node.args[0]
        if text is not None and "translate" not in named and not is_translated(text):
            yield node.lineno, ast.unparse(text)


def is_translated(node):
    if isinstance(node, ast.IfExp):
        return is_translated(node.body) and is_translated(node.orelse)
    if isinstance(node, ast.Call):
        return ast.unparse(node.func) in ("translated", "line")  # `last_guard`'s is for us to read
    return isinstance(node, ast.Constant)


@pytest.mark.parametrize("path", strings.OWN, ids=lambda path: path.name)
def test_labels_are_constant_or_translated(path):
    """Blender looks constants up by itself. What is composed goes through `translated`; what is
    somebody's name for a thing has ``translate=False``."""
    assert [*composed_labels(ast.parse(path.read_text(encoding="utf-8")))] == []
