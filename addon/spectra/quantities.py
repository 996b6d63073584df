"""What a spectrum's numbers are: which quantity, in which unit, by the words that stand at them.

Only what is a reflectance or transmittance, or can be made one exactly, is taken; the words are
those of instruments and spreadsheets in the languages that write them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

REFLECTANCE, TRANSMITTANCE = "reflectance", "transmittance"
ABSORBANCE, LOG_R, LOG_T = "absorbance", "log(1/R)", "log(1/T)"
LN_R, LN_T, KUBELKA_MUNK = "ln(1/R)", "ln(1/T)", "Kubelka-Munk"
NOT_SAID = ""

TAKEN = (NOT_SAID, REFLECTANCE, TRANSMITTANCE)
"""Quantities whose numbers count as they are."""

ASIDE = ("deviations", "gloss", "refractive index")
"""What stands beside reflectances in tables, and is none."""

_TELLS = (NOT_SAID, REFLECTANCE, TRANSMITTANCE, LOG_R, LOG_T, LN_R, LN_T, KUBELKA_MUNK)

PERCENT, FRACTION, UNCLEAR = "percent", "fraction", "unclear"

_CONVERTED = {
    ABSORBANCE: lambda a: 10.0**-a,
    LOG_R: lambda a: 10.0**-a,
    LOG_T: lambda a: 10.0**-a,
    LN_R: lambda a: np.exp(-a),
    LN_T: lambda a: np.exp(-a),
    # P. Kubelka 1948 (DOI 10.1364/JOSA.38.000448): K/S = (1 - R)² / 2R of an opaque layer.
    KUBELKA_MUNK: lambda f: 1.0 + f - np.sqrt(f * f + 2.0 * f),
}

_LOG = r"(?:lg|log(?:_?10|₁₀)?)"
_WORDS: tuple[tuple[str, str], ...] = (
    (KUBELKA_MUNK, r"kubelka|\bk ?/ ?s\b|\bf ?\( ?r ?[∞]?(inf)?\)|remission function"),
    (LOG_R, rf"\b{_LOG} ?\(? ?1 ?/ ?r|[-−] ?{_LOG} ?\(? ?r\b|1 ?/ ?r\b.*\blog"),
    (LOG_T, rf"\b{_LOG} ?\(? ?1 ?/ ?t|[-−] ?{_LOG} ?\(? ?t\b"),
    (LN_R, r"\bln ?\(? ?1 ?/ ?r|[-−] ?ln ?\(? ?r\b"),
    (LN_T, r"\bln ?\(? ?1 ?/ ?t|[-−] ?ln ?\(? ?t\b"),
    ("deviations", r"(?:^|[\s_.(\[-])(?:std\.?(?:[ _.-]?dev\w*)?|stdev|st\.? ?dev\.?|sd|stdabw\.?|"
     r"standard ?(?:deviation|error)|standardabweichung|[ée]cart[- ]type|desviaci[oó]n|deviazione|"
     r"uncertaint\w+|unsicherheit|incertitude|incertidumbre|incertezza|variance|error ?bars?|"
     r"std ?err\w*|stderr|rmse|cov|cv ?%)(?=$|[\s_.)\]%-])|±|标准偏差|標準偏差"),
    ("gloss", r"^\W*(?:gloss|glanz\w*|brillant|brillo|brillantezza|brilho|光沢\w*|光泽\w*)"
     r"[ _-]?(?:\d|\(|\[|gu\b|unit|value|$)"),
    ("refractive index", r"refractive ind|brechungsindex|indice de r[ée]fraction|"
     r"[íi]ndice de refracci[oó]n|extinction coeff|extinktionskoeff"),
    ("emissivity", r"(?<!low)(?<!low.)(?<!r)emissivit|(?<!r)emissionsgrad|"
     r"[ée]missivit|emisivi|emittance|"
     r"放射率|发射率"),
    ("absorptance", r"absorptan|absorptivit|absorptionsgrad|assorbimento|absortan|吸収率|吸收率"),
    (REFLECTANCE, r"radiance factor|strahldichtefaktor|reflectance factor|reflection coeff|"
     r"коэфф?ициент\w* (?:яркости|отражения)"),
    ("light", r"(?<![a-z])(?:ir)?rad(?:iance\b|\.)|exitance|"
     r"spectral (?:power|flux|intensity|density)|"
     r"radiant (?:flux|power|intens|energy)|"
     r"(?<!r)emission|emissive|emitted|\bluminance|illuminance|"
     r"\bphotons?\b|\bflux\b|"
     r"\bquanta\b|(?<![a-z])[mµμun]?w ?[/·*] ?\(? ?(?:m|cm|sr|nm)|"
     r"(?<![a-z])[mµμun]?w ?(?:m|cm|sr|nm) ?\^?[-−⁻²]|"
     r"/ ?sr\b|\bsr ?\^?[-−⁻]|\b[mµμ]?mol\b.*(?:m|s)|cd ?/ ?m|\blux\b|"
     r"strahldichte|bestrahlungsst|strahlungs(?:fluss|leistung)|leuchtdichte|beleuchtungsst|"
     r"[ée]clairement|luminanza|luminancia|irradianza|irraggiamento|irradi[aâ]nc|radiancia|"
     r"\bemisi[oó]n|(?<!r)emiss[aã]o|"
     r"放射輝度|放射照度|分光放射|輝度|辐射|辐照|辐亮|发射光谱|яркост|облуч|излуч"),
    ("counts", r"\bcounts?\b|\bdns?\b|\bdigital numbers?\b|\braw (?:counts?|dns?|data|signal)\b|"
     r"\badc\b|\bcts\b|\bcps\b|^\W*intensit(?:y|é|à|ä?t|ies)\W*$|^\W*intensit\w+ ?[(\[]|"
     r"^\W*intensidade?\W*|^\W*scope\b|\bz[äa]hl(?:rate|er|impulse)\w*|\bcuentas\b|\bcoups\b|"
     r"\bconteggi\b|\bcontagens\b|\bvolts?\b|カウント|计数|計数|отсч[её]т"),
    (ABSORBANCE, r"absorban|^\W*abs\.?\W*$|^\W*abs\.? ?[(\[]|[(\[]abs\.?[)\]]|"
     r"extin[ck]tion|extinción|estinzione|"
     r"optical densit|optische dichte|densit[ée] optique|densidad [oó]ptica|densit[àa] ottica|"
     r"densidade [óo]ptica|^\W*o\.?d\.?\W*\d*\W*$|absorvânci|assorbanz|absorbtie|"
     r"吸光度|吸亮度|оптическ\w+ плотност|흡광도"),
    ("arbitrary units", r"arbitrary|\ba\. ?u\.\)?\W*$|^\W*au\W*$|willkürlich|"
     r"unit[ée]s? arbitraire"),
    ("absorption", r"absorption|absorci[oó]n|absorç[aã]o|поглощ"),
    ("fluorescence", r"(?:fluores\w+|luminescence|raman) (?:emission|intens|spectr|signal|count)"),
    (REFLECTANCE, r"reflect|\brefl?\b\.?|(?<![a-z])refl(?![a-z])|r[ée]fl[ée]ct|r[ée]fl[ée]x|"
     r"reflekt|reflex|remission|riflett|riflession|reflet[âa]n|\balbedo\b|отраж|відбит|odbi[cć]|"
     r"odraz|heijast|yansı|visszaver|反射|반사|% ?r(?![a-z])|(?<![a-z])r ?[(\[]?%|\bsc[ie]\b|"
     r"(?<![a-z])r ?[(\[] ?[)\]]|ρ"),
    (TRANSMITTANCE, r"transmi(?:t|s)|durchlass|durchläss|trasmi(?:tt|ss)|透過|透射|透过|пропуск|"
     r"przepuszcz|propust|läpäis|geçirg|áteresz|투과|% ?t(?![a-z])|(?<![a-z])t ?[(\[]?%|τ"),
)  # fmt: skip
_QUANTITIES = tuple((name, re.compile(pattern, re.IGNORECASE)) for name, pattern in _WORDS)

_NO_VALUE = r"(?<!\d)(?<!\d[ \u00a0\u202f])"
# A number before the sign is a value, as in "Grey 20 %".
_PERCENT = re.compile(
    rf"{_NO_VALUE}(?:%|\bper ?cent|(?<![a-z])pct(?![a-z])|_percent|\bprozent|\bpour ?-?cent|"
    r"\bpor ?ciento|\bporcent|\bpor ?cento|\bper ?cento|\bprocent|процент|百分|パーセント|퍼센트)|"
    r"[(\[]0 ?(?:[-–…]|\.\.+) ?100 ?%?[)\]]",
    re.IGNORECASE,
)
_FRACTION = re.compile(
    r"\bfraction|_fraction|[(\[]0(?:\.0*)? ?(?:[-–…,]|\.\.+) ?1(?:\.0*)?[)\]]|[(\[]1\.0+[)\]]|"
    r"[(\[]-[)\]]|(?:grad|ance|anz|ion|factor) ?\[1\]|\bunitless|\bdimensionless|\banteil|"
    r"\bbruchteil|\bfracci[oó]n|\bfrazione|\bfra[cç][aã]o|\bdecimal|\bdimensionslos|"
    r"\bsans dimension",
    re.IGNORECASE,
)
_RANGES = (
    (re.compile(r"\b0 ?(?:[-–…]|\.\.+|to|bis|à|a) ?100\b"), " percent "),
    (
        re.compile(r"\b0(?:\.0)? ?(?:[-–…]|\.\.+|to|bis|à|a) ?1(?:\.0+)?\b(?![.,]?\d| ?%)"),
        " fraction ",
    ),
)

_READ = 300

_KEYS = re.compile(
    r"[\W_]*(?:y[ _-]?(?:axis)?[ _-]?(?:units?|label|mode|axis|title|data|type|scale)?|"
    r"ordinate(?:[ _-]?(?:mode|type|units?|label|axis))?|photometric ?mode|photo(?:metric)? ?mode|"
    r"(?:measur\w+|data|scan|spectr\w+|acquisition|processing|collection|signal|result)"
    r"[ _-]?(?:type|mode|quantity|units?|kind)?|mode|quantity|physical quantity|"
    r"(?:\w+ )?units?|values?|type|scale|"
    r"messgröße|messgroesse|messart|messmodus|modus|einheit(?:en)?|größe|groesse|grandeur|unités?|"
    r"mesure|type de mesure|magnitud|unidad(?:es)?|medida|medici[oó]n|modo|grandezza|unità|misura|"
    r"unidade|medida|grootheid|eenheid|enhet|storhet|单位|測定モード|測光モード|測定種別|单位|単位|"
    r"единиц\w+|величина)[\W_]*",
    re.IGNORECASE,
)
_X_KEYS = re.compile(
    r"[\W_]*(?:x[ _-]?(?:axis)?[ _-]?(?:units?|label|mode|axis|title)?|abscissa.*|"
    r"(?:wave ?length|wave ?number|spectral)s?[ _-]?units?|wellenlängeneinheit)[\W_]*",
    re.IGNORECASE,
)
_ASIDE = re.compile(
    r"calib|referen[ck]|\blamp|light ?source|lichtquelle|illuminan|observer|detector|grating|"
    r"filter|"
    r"instrument|serial|spectrometer|spectrophotom|\bfile|\.[a-z]{3}\b|path|folder|humid|feucht|"
    r"humedad|umidit|uncertain|unsicher|incert|accura|repeatab|error|noise|temperatur|version|"
    r"software|operator|user|corrected for|date|standard|dark (?:signal|current|spectrum)|stray|"
    r"moistur|content|gehalt|concentrat|konzentrat|confidence|opacity|coverage|composit|weight",
    re.IGNORECASE,
)


class Said(NamedTuple):
    """What words say of numbers: the quantity, ``NOT_SAID`` without, and the unit or None."""

    quantity: str = NOT_SAID
    unit: str | None = None

    def over(self, other: Said) -> Said:
        """Return this, and where it is silent what another says."""
        quantity = self.quantity or other.quantity
        told = self.unit if self.unit is not None or self.quantity else other.unit
        if self.quantity and self.unit is None and other.quantity in ("", self.quantity):
            told = other.unit
        return Said(quantity, told)


@lru_cache(maxsize=1 << 12)
def said(words: str) -> Said:
    """Return what a header says of its column, by its first `_READ` characters."""
    words = words[:_READ]
    words = " ".join(words.replace("_", " ").split()) if "_" in words else words
    quantity = next((name for name, word in _QUANTITIES if word.search(words)), NOT_SAID)
    return Said(quantity, unit_of(words))


def unit_of(words: str) -> str | None:
    """Return percent or fraction, None where the words name neither or both."""
    percent, fraction = _PERCENT.search(words), _FRACTION.search(words)
    if bool(percent) == bool(fraction):
        return None
    return PERCENT if percent else FRACTION


_FROM = re.compile(r"data from \S*(?:absorb|reflect|transm)", re.IGNORECASE)
"""OceanView names its files by what it measures."""


def around(lines: Iterable[str]) -> tuple[Said, str]:
    """Return what the lines around a table say of all its numbers, and what of its wavelengths.

    Lines ``key: value`` count where the key is one of the ordinate's (``YUNITS %R``); other lines
    where all that speak agree, and none of what an instrument tells about itself.
    """
    keyed, loose = Said(), []
    x_unit = ""
    for line in lines:
        if len(line) > 400:
            continue
        for pattern, word in _RANGES:
            line = pattern.sub(word, line)
        key, value = _keyed(line)
        if value and _X_KEYS.fullmatch(key):
            x_unit = x_unit or value
            continue
        found = said(value if value and _KEYS.fullmatch(key) else line)
        if found.quantity in ASIDE:
            continue
        if value and _KEYS.fullmatch(key):
            keyed = keyed.over(found)
        elif (_FROM.match(line) or not _ASIDE.search(line)) and (
            not value or found.quantity in _TELLS
        ):
            loose.append(found)
    return keyed.over(_agreed(loose)), x_unit


def _keyed(line: str) -> tuple[str, str]:
    """Return key and value of a line, both empty where it is none."""
    bare = line.strip().lstrip("#%/!;* \t").strip()
    for separator in ("\t", ":", "=", ";", "  "):
        key, found, value = bare.partition(separator)
        if found and value.strip():
            return key.strip().strip('"'), value.strip(' ,;\t"')
    return bare, ""


def _agreed(found: list[Said]) -> Said:
    quantities = {one.quantity for one in found if one.quantity}
    units = {one.unit for one in found if one.unit}
    quantity = quantities.pop() if len(quantities) == 1 else NOT_SAID
    return Said(quantity, units.pop() if len(units) == 1 else None)


def converted(quantity: str, values: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return the reflectance or transmittance (a fraction) that a quantity is, None if it is none.

    ``values`` of any shape. 10^-A of an absorbance or log(1/R), e^-A of ln(1/R); of K/S the
    reflectance of an opaque layer, P. Kubelka 1948 (DOI 10.1364/JOSA.38.000448), NaN under 0.
    """
    if quantity not in _CONVERTED:
        return None
    with np.errstate(all="ignore"):
        return np.asarray(_CONVERTED[quantity](values))
