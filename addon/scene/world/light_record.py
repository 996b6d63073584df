"""What is kept with a World's light of all that was found in its sky."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any


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
    return LightRecord.of(json.loads(text))
