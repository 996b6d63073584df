"""The interface's texts in other languages, read from catalogues that translators' tools edit.

`translations/LANGUAGE.po` is a GNU gettext catalogue in UTF-8. The contexts "*" and "Operator" are
those that Blender looks up by itself. "Line" is what is composed: ``{0}`` stands for a value, and
parts of a line have messages of their own. So rooms that know nothing of Blender, and blend files,
keep plain English, and the window shows it in the reader's language.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

FOLDER = Path(__file__).with_name("translations")
LANGUAGES = ("de_DE", "es", "fr_FR", "ja_JP")
"""By Blender's names for them; each has its catalogue."""

BLENDER, OPERATOR, LINE = "*", "Operator", "Line"
"""Contexts of messages: Blender's default, its buttons', and ours of lines that are composed."""

Messages = dict[tuple[str, str], str]
"""By context and English text, the text in a language; empty where nobody has translated it."""

_LINE = re.compile(r'(msgctxt|msgid|msgstr)? ?"(.*)"')
_ESCAPE = re.compile(r"\\(.)")
_VALUE = "((?:(?!; ).)*?)"  # a value is no two sentences
_PLACE = re.compile(r"\{\d+\}")


def read(language: str) -> Messages:
    """Return a language's messages; none where it has no catalogue."""
    path = FOLDER / f"{language}.po"
    if not path.is_file():
        return {}
    messages: Messages = {}
    entry: dict[str, str] = {}
    key = ""
    for line in path.read_text(encoding="utf-8").splitlines():
        found = _LINE.fullmatch(line)
        if found is None:
            continue
        if found[1] and (found[1] == "msgctxt" or found[1] in entry):
            entry = {}  # the next message begins
        key = found[1] or key
        text = _ESCAPE.sub(lambda sign: {"n": "\n", "t": "\t"}.get(sign[1], sign[1]), found[2])
        entry[key] = entry.get(key, "") + text
        if key == "msgstr" and entry.get("msgid"):
            messages[entry.get("msgctxt", BLENDER), entry["msgid"]] = entry["msgstr"]
    return messages


def places(text: str) -> list[str]:
    """Return the places of values in a text, sorted: ``{0}``, ``{1}``."""
    return sorted(_PLACE.findall(text))


@dataclass(frozen=True)
class _Template:
    """A message with places for values: how its English is known, and what it becomes.

    ``rarest`` of its parts, at which one sees first; ``known``: letters, the more the surer.
    """

    rarest: str
    known: int
    pattern: re.Pattern[str]
    order: tuple[int, ...]
    text: str
    is_words: bool
    is_tail: bool


class Catalogue:
    """The messages of one language, and lines composed of them."""

    def __init__(self, messages: Messages) -> None:
        self.messages = {key: text for key, text in messages.items() if text}
        self._templates = sorted(self._read(), key=lambda each: (-each.known, each.rarest != "; "))

    def _read(self) -> Iterator[_Template]:
        for (context, english), text in self.messages.items():
            is_tail = english[0] in ",;: "  # what code appends to any line
            if context == LINE and (is_tail or _PLACE.search(english)):
                parts = _PLACE.split(english)
                is_words = any(map(str.isalpha, "".join(parts)))
                value = _VALUE if is_words else "(.*?)"
                pattern = "(.*?)" * is_tail + value.join(map(re.escape, parts))
                order = tuple(int(place[1:-1]) for place in _PLACE.findall(english))
                found = re.compile(pattern, re.DOTALL)
                rarest, known = max(parts, key=len), len("".join(parts))
                yield _Template(rarest, known, found, order, text, is_words, is_tail)

    def line(self, text: str) -> str:
        """Return a line in the language, as far as its messages say it; else the line itself.

        A part of a line may also begin one, with a capital letter.
        """
        small = text[:1].lower() + text[1:]
        for find in (self._whole, self._composed):
            if found := find(text):
                return found
            if found := find(small):
                return found[:1].upper() + found[1:]
        return text

    def _whole(self, text: str) -> str:
        return self.messages.get((LINE, text)) or self.messages.get((BLENDER, text), "")

    def _composed(self, text: str) -> str:
        for each in self._templates:
            found = each.pattern.fullmatch(text) if each.rarest in text else None
            if found is None:
                continue
            parts = [self._part(part) for part in found.groups()]
            if each.is_words or parts != list(found.groups()):
                start = parts.pop(0) if each.is_tail else ""
                values = dict(zip(each.order, parts, strict=True))
                return start + each.text.format(*(values[place] for place in sorted(values)))
        return ""

    def _part(self, text: str) -> str:
        """A value in a line. A single word may be somebody's name for a thing: it stays."""
        return self.messages.get((LINE, text)) or (self.line(text) if " " in text else text)


@lru_cache(maxsize=1)
def of(language: str) -> Catalogue:
    """Return the catalogue of a language; it is read once."""
    return Catalogue(read(language))
