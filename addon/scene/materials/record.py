"""What a managed material keeps of itself, as custom properties hold it.

All that is needed later lies in the blend file: values, where they came from, what was predicted.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields
from functools import lru_cache
from typing import Any

import bpy

from ....node_groups import skylight_surface
from ... import tags
from ..blend_data import kept


@dataclass(frozen=True)
class Result:
    """What one material was given, and what is predicted of it under the sky.

    ``model``: one of `choice.MODELS`; expected CIEDE2000 of RGB × RGB and of the model, and the
    model's to count on (``bound``), NaN where unknown; ``colour``: RGB on level ground in the
    working space; ``line``: all that in words; ``unknown``: why no error could be predicted;
    ``measuring``: the CIEDE2000 by which a measurement is expected to change an estimate, None of
    what is measured and where unknown.
    """

    material: str
    reflectance: str
    model: str = ""
    rgb_delta_E: float = math.nan
    matrix_delta_E: float = math.nan
    bound: float = math.nan
    colour: tuple[float, float, float] = (0.0, 0.0, 0.0)
    out_of_gamut: bool = False
    line: str = ""
    unknown: str = ""
    measuring: float | None = None


@dataclass(frozen=True)
class Details:
    """All that a record holds beside the nodes' own values.

    ``values``: the reflectance (81,), empty in files of the first version; ``measured``: from where
    to where [nm]; ``source``: what base color it came from (`base_color.source`), None for a
    measured one without a texture; ``white``: the luminance of white on level ground;
    ``unit``, ``file`` and ``behind`` as `Assignment` has them.
    """

    result: Result | None = None
    values: tuple[float, ...] = ()
    measured: tuple[float, float] | None = None
    source: tuple[Any, ...] | None = None
    white: float = 1.0
    unit: str = ""
    file: str = ""
    behind: str = ""

    @property
    def sentences(self) -> list[str]:
        """What is predicted of the material, in words; nothing in files of the first version."""
        found = self.result
        if found is None:
            return []
        if not math.isfinite(found.rgb_delta_E):
            lines = [f"Error unknown: {found.unknown or 'the sky is dark'}"]
        else:
            rgb, ours = found.rgb_delta_E, found.matrix_delta_E
            lines = [f"Mean error: ΔE {rgb:.1f} with RGB × RGB, {ours:.1f} spectral"]
            if math.isfinite(found.bound):
                lines.append(f"Largest error: ΔE {found.bound:.1f}. ΔE 1 is just noticeable")
        if found.out_of_gamut:
            lines.append("Out of gamut: Blender clamps it")
        return lines

    def to_json(self) -> str:
        """Return it as text, the result's fields beside the others."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "result"}
        return json.dumps({**(asdict(self.result) if self.result else {}), **own})

    @classmethod
    def from_json(cls, text: str) -> Details:
        """Read what `to_json` wrote, also by an earlier version; the same text is read once."""
        return _details(text)


@lru_cache(maxsize=4096)
def _details(text: str) -> Details:
    found = _plain(kept.parsed(text, {}))
    result = {name: found[name] for name, right in _RESULT.items() if right(found.get(name))}
    own = {name: found[name] for name, right in _DETAILS.items() if right(found.get(name))}
    return Details(
        Result(**result) if {"material", "reflectance"} <= result.keys() else None, **own
    )


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_error(value: Any) -> bool:
    """Whether a value is a number; NaN is an error that is unknown."""
    return isinstance(value, float) or kept.is_number(value)


_RESULT: dict[str, Callable[[Any], bool]] = {
    "material": _is_text,
    "reflectance": _is_text,
    "model": _is_text,
    "rgb_delta_E": _is_error,
    "matrix_delta_E": _is_error,
    "bound": _is_error,
    "colour": lambda value: kept.are_numbers(value, 3),
    "out_of_gamut": lambda value: isinstance(value, bool),
    "line": _is_text,
    "unknown": _is_text,
    "measuring": kept.is_number,
}
_DETAILS: dict[str, Callable[[Any], bool]] = {
    "values": lambda value: kept.are_numbers(value, 81) or value == (),
    "measured": lambda value: kept.are_numbers(value, 2),
    "source": lambda value: isinstance(value, tuple),
    "white": kept.is_number,
    "unit": _is_text,
    "file": _is_text,
    "behind": _is_text,
}
"""Whether a value is one that a field can have; others count as missing."""


def _plain(found: Mapping[str, Any]) -> dict[str, Any]:
    """Lists as tuples, which records hold."""
    return {k: tuple(v) if isinstance(v, list) else v for k, v in found.items()}


@dataclass(frozen=True)
class MaterialRecord:
    """The custom property of a managed material.

    ``id``: the kind of its group; ``version``: the group's; ``without_nodes``: it had no nodes
    before, which Blender 4.5 allows; ``gloss``: it keeps its own; ``textured``: its base color's
    texture makes its reflectance.
    """

    reflectance: str
    reflectance_hash: str
    details: Details = Details()
    without_nodes: bool = False
    gloss: bool = False
    textured: bool = False
    id: str = skylight_surface.KIND
    version: int = skylight_surface.VERSION

    def keep(self, material: bpy.types.Material) -> None:
        """Write it to a material."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "details"}
        # Custom properties hold no nested lists.
        material[tags.MATERIAL] = {**own, "extra": self.details.to_json()}

    @classmethod
    def of(cls, material: bpy.types.Material) -> MaterialRecord | None:
        """Return what a material keeps, None for one without, or one damaged by hand."""
        found = kept.mapping(material, tags.MATERIAL)
        texts = [found.get(name) for name in ("reflectance", "reflectance_hash", "extra")]
        if not kept.are_texts(texts):
            return None
        own = {f.name: found[f.name] for f in fields(cls) if f.name in found}
        return cls(**own, details=Details.from_json(found["extra"]))
