"""What is kept with a World's light of all that was found in its sky."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any

from ..blend_data import kept


@dataclass(frozen=True)
class LightRecord:
    """What panels, pictures and later updates ask of a World's light.

    ``image``: the HDRI's name, or the World's; ``space``: the working space; ``model``: basis and
    degree in words; ``settings``: `Settings.plain`; ``degree`` of the polynomial, and ``errors``
    that each degree leaves (``mean`` and ``worst``, fractions); ``upward``: RGB of the sky's light
    on level ground, ``level``: with the sun's, in the working space; ``spectrum`` (81,): the sky's
    on level ground; ``notes`` and ``lights``: lines to read; ``warnings``: on what is left
    out of the light; ``caption``: what a picture must say; ``rest``: what else
    `SkyLight.report` holds.
    """

    image: str = ""
    space: str = ""
    model: str = ""
    caption: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    degree: int = 0
    errors: tuple[Mapping[str, float], ...] = ()
    upward: tuple[float, ...] = ()
    level: tuple[float, ...] = ()
    spectrum: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()
    lights: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    rest: Mapping[str, Any] = field(default_factory=dict)

    def to_json(self) -> str:
        """Return it as text; what is in ``rest`` stands beside the others."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "rest"}
        return json.dumps({**self.rest, **own})

    @classmethod
    def from_json(cls, text: str) -> LightRecord:
        """Read what `to_json` wrote, also by an earlier version; the same text is read once."""
        return _record(text)

    @classmethod
    def of(cls, report: Mapping[str, Any], **others: Any) -> LightRecord:
        """Make one of a `SkyLight.report`, plain data, and further fields, which go before it."""
        found = {**report, **others}
        names = {f.name for f in fields(cls)} - {"rest"}
        own: dict[str, Any] = {k: _fixed(v) for k, v in found.items() if k in names}
        return cls(**own, rest={k: v for k, v in found.items() if k not in names})


def _fixed(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


@lru_cache(maxsize=64)
def _record(text: str) -> LightRecord:
    found = kept.parsed(text, {})
    wrong = [name for name, right in _RIGHT.items() if name in found and not right(found[name])]
    return LightRecord.of({name: value for name, value in found.items() if name not in wrong})


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _are_errors(value: Any) -> bool:
    listed = isinstance(value, list) and all(isinstance(each, dict) for each in value)
    return listed and all(kept.is_number(e.get(n)) for e in value for n in ("mean", "worst"))


_RIGHT: dict[str, Callable[[Any], bool]] = {
    **dict.fromkeys(("image", "space", "model", "caption"), _is_text),
    "settings": lambda value: isinstance(value, dict),
    "degree": lambda value: isinstance(value, int) and 0 <= value <= 6,
    "errors": _are_errors,
    "upward": lambda value: kept.are_numbers(value, 3) or value == [],
    "level": lambda value: kept.are_numbers(value, 3) or value == [],
    "spectrum": lambda value: kept.are_numbers(value, 81) or value == [],
    **dict.fromkeys(("notes", "lights", "warnings"), kept.are_texts),
}
"""Whether a value is one that a field can have; others count as missing."""
