"""How files name wavelengths: a column of them, a row of them, and what unit they are in."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from itertools import groupby

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .files import number

NM, UM, ANGSTROM, PER_CM, EV, INDEX = "nm", "µm", "Å", "cm⁻¹", "eV", "index"

_UNITS = (
    (PER_CM, r"cm ?\^?\(?[-−⁻] ?[1¹]|\b1 ?/ ?cm|\bper ?cm|wave ?numbers?|wellenzahl|"
     r"nombres? d.ondes?|n[uú]mero d[ei]? ?.?onda|numeri? d.onda|golfgetal|"
     r"波数|волнов\w+ числ|\bkayser"),
    (UM, r"[uµμ]m\b|[uµμ]m(?![a-z])|\bmicrons?\b|\bmicro ?-?met|mikromet|микром|микрон|微米"),
    (ANGSTROM, r"[åÅ](?![a-zäöü])|\b[aå]ngstr[oö]m"),
    (EV, r"\be ?v\b|photon energy|photonenergie"),
    (NM, r"\bnm\b|_nm\b|(?<![a-z])nm(?![a-z])|\bnano ?-?met|нм|нанометр|纳米|ナノメートル"),
)  # fmt: skip
_UNIT = tuple((unit, re.compile(pattern, re.IGNORECASE)) for unit, pattern in _UNITS)
_NO_LENGTH = re.compile(
    r"\bt?hz\b|frequen|\bseconds?\b|\bminutes?\b|\btime\b|\bpixels?\b|2 ?theta|\bm/z\b|\bkelvin\b",
    re.IGNORECASE,
)

_WORDS = re.compile(
    r"wave ?(-|_)?len?gh?ths?|wave ?(-|_)?numbers?|waves?|wvl?s?|wls?|lambda|λ|nanomet(er|re)s?|nm|"
    r"microns?|micromet(er|re)s?|[uµμ]m|x([ _-]?axis)?|"
    r"wellenl(ä|ae|a)ngen?|wellenzahl(en)?|longueurs? d.ondes?|nombres? d.ondes?|"
    r"longitud(es)? de onda|n[uú]mero de onda|comprimentos? de onda|lunghezz[ae] d.onda|"
    r"numero d.onda|golflengten?|golfgetal|våglängd(er)?|bølgelengde[r]?|bølgelængde[r]?|"
    r"aallonpituu[sd](et)?|długoś(ć|ci) fali|vlnov(á|é) délk[ay]|hullámhossz|dalga ?boyu|"
    r"lungime[a]? de undă|μήκος κύματος|длин[аы] волны?|довжина хвилі|波長|波长|파장|"
    r"cm ?\^?[-−] ?1",
    re.IGNORECASE,
)
_AFTER = re.compile(
    r"[\s_()\[\]{}/|,.:;*#'\"-]*(in\b|en\b|unit\w*)?[\s_()\[\]{}/|,.:;*'\"-]*"
    r"(?P<unit>[a-zA-Zåäöÿ-ɏµμ^−⁻¹ÅΑ-ωА-я一-鿿ァ-ヿ 0-9/-]{0,20})"
    r"[\s_()\[\]{}/|,.:;*'\"]*"
)

_INDEX = re.compile(
    r"#|(un)?named:? ?\d*|index|idx|no\.?|nr\.?|n°|nº|№|row(s|name|names|id| ?no\.?| ?number)?|id|"
    r"pixels?|px|channels?|chan|ch|bands?|band ?(no|number)\.?|obs|lfd\.?( ?nr\.?)?|points?|"
    r"number|sample ?(no|number)\.?|x\.?1|v1|",
    re.IGNORECASE,
)

_LONGEST_HEADER = 200
_AROUND = re.compile(r"(?<![a-z])[nµμu]m\b|[\s\0_()\[\]{}.,:;-]+", re.IGNORECASE)
_LOOKED_AT = 160  # cells

_NUMBER = re.compile(r"\d+(?:[.,]\d+)?")
_LIKELY = (150.0, 30000.0)
"""[nm] in which columns lie that nobody names wavelengths; row numbers begin at 0 or 1."""


def unit_of(text: str) -> str | None:
    """Return the unit of wavelength that a text names, `INDEX` for another, None where none."""
    for unit, pattern in _UNIT:
        if pattern.search(text):
            return unit
    return INDEX if _NO_LENGTH.search(text) else None


@lru_cache(maxsize=1 << 12)
def heads_wavelengths(text: str) -> bool:
    """Whether a column under this header holds wavelengths (or wavenumbers)."""
    if len(text) > _LONGEST_HEADER:
        return False
    text = " ".join(text.replace("_", " ").split()).strip("\"'[]() ")
    match = _WORDS.match(text)
    if match is None:
        return bool(_EV.fullmatch(text))
    after = _AFTER.fullmatch(text, match.end())
    if after is None:
        return False
    rest = after["unit"].strip()
    if not rest:
        return True
    return unit_of(rest) is not None and not re.search(r"%|refl|trans|abs", rest, re.IGNORECASE)


_EV = re.compile(r"(photon )?energy ?[(\[]? ?ev ?[)\]]?|ev", re.IGNORECASE)


def heads_index(text: str) -> bool:
    """Whether a column under this header counts rows, channels or samples."""
    return len(text) < 30 and _INDEX.fullmatch(" ".join(text.replace("_", " ").split())) is not None


def numbers_rows(text: str, values: NDArray[np.float64]) -> bool:
    """Whether a column under this header is a number of rows, channels or samples."""
    if not heads_index(text):
        return False
    word = text.strip().casefold()
    whole = bool(np.isfinite(values).all() and (values == np.round(values)).all())
    return counts(values) or (whole and word not in ("", "v1", "x1", "x.1"))


def counts(values: NDArray[np.float64]) -> bool:
    """Whether a column holds nothing but 0, 1, 2, … or 1, 2, 3, …."""
    return bool(values.size > 1 and values[0] in (0.0, 1.0) and (np.diff(values) == 1.0).all())


def likely(values: NDArray[np.float64]) -> bool:
    """Whether a column that nobody names can be wavelengths in nm: it goes through light."""
    if values.size < 3 or not np.isfinite(values).all():
        return False
    low, high = values.min(), values.max()
    steps = np.diff(values)
    one_way = bool((steps > 0).all() or (steps < 0).all())
    return one_way and _LIKELY[0] <= low <= 500.0 and 600.0 <= high <= _LIKELY[1]


def to_nm(values: ArrayLike, unit: str) -> NDArray[np.float64]:
    """Return wavelengths [nm] from any of the units; a wavenumber of 0 gives infinity."""
    found = np.asarray(values, dtype=float)
    with np.errstate(all="ignore"):
        if unit in (PER_CM, EV):
            # h c / e, CODATA 2018, exact to the digits.
            return (1e7 if unit == PER_CM else 1239.841984) / found
        return found * {NM: 1.0, UM: 1000.0, ANGSTROM: 0.1}[unit]


def in_header(cells: Sequence[str]) -> list[tuple[str, list[int], NDArray[np.float64]]]:
    """Return the runs of cells that name wavelengths, as ``400nm``, ``X400`` or ``R [410]``.

    Each as what is around the numbers, the columns and the wavelengths [nm]; a run has at least
    eight, rises or falls and reaches from 430 or less to 680 or more.
    """
    some = [_split(cell) for cell in cells[:_LOOKED_AT]]
    # Alone, a number under 150 is a value: most rows are not looked at further.
    if sum(one is not None and (one[1] >= 150.0 or one[0] != "\0") for one in some) < 8:
        return []
    told = some + [_split(cell) for cell in cells[_LOOKED_AT:]]
    runs = []
    at = 0
    for affix, group in groupby(told, key=lambda one: None if one is None else one[0]):
        size = len(list(group))
        columns = list(range(at, at + size))
        at += size
        if affix is None or size < 8:
            continue
        values = np.array([one[1] for one in told[columns[0] : at] if one is not None])
        around = _AROUND.sub(" ", affix).strip()
        for part in _one_way(values):
            # ``X0.4`` is in µm; alone, 0.4 is a reflectance.
            by_size = UM if around and values[part].max() < 50.0 else NM
            nm = to_nm(values[part], unit_of(affix) or by_size)
            if _through_light(nm):
                runs.append((around, columns[part], nm))
    return runs


def _through_light(nm: NDArray[np.float64]) -> bool:
    """Whether numbers are wavelengths of a spectrum: through light, in steps of one size."""
    steps = np.abs(np.diff(nm))
    return bool(
        nm.size >= 8
        and nm.min() >= 150.0
        and nm.min() <= 430.0
        and 680.0 <= nm.max() < 30000.0
        and steps.max() <= max(50.0, 5.0 * float(np.median(steps)))
        and np.count_nonzero((nm >= 430.0) & (nm <= 680.0)) >= 6
    )


def _split(cell: str) -> tuple[str, float] | None:
    """Return what is around the one number of a cell that can be a wavelength, and the number."""
    if not cell or len(cell) > 60:
        return None
    if re.search(r"(?<![\d.,])0\d", cell):  # numbered names: sample_0400
        return None
    found = [match for match in _NUMBER.finditer(cell) if match[0] not in ("1",)]
    candidates = [match for match in found if 0.2 <= (number(match[0]) or 0.0) <= 30000.0]
    if len(candidates) != 1 and not (candidates and len(found) == len(candidates) == 2):
        return None
    match = candidates[-1] if len(candidates) == 1 else max(candidates, key=_as_nm)
    value = number(match[0])
    if value is None:
        return None
    return f"{cell[: match.start()]}\0{cell[match.end() :]}", value


def _as_nm(match: re.Match[str]) -> bool:
    return 200.0 <= (number(match[0]) or 0.0) <= 2600.0


def _one_way(values: NDArray[np.float64]) -> list[slice]:
    """Return the parts of a row of numbers that only rise, or only fall."""
    if values.size < 2:
        return []
    signs = np.sign(np.diff(values))
    parts, start = [], 0
    while start < len(signs):
        end = start + 1
        while end < len(signs) and signs[end] == signs[start]:
            end += 1
        if signs[start] != 0 and end - start >= 7:
            parts.append(slice(start, end + 1))
            start = end + 1
        else:
            start = end
    return parts
