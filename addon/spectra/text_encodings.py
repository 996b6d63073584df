"""In which encoding a text is that is not UTF-8: by the headings that instruments write in it.

An encoding of two bytes a character decodes nearly anything, so one counts only where it yields
words that stand over spectra; Latin-1 is what is left.
"""

from __future__ import annotations

import codecs
import re

_HEADINGS = (
    ("cp932", "波長|反射|透過|吸光|測定|試料|分光"),
    ("gb18030", "波长|反射|透射|透过|吸光|样品|测量|光谱"),
    ("big5", "波長|反射|透射|穿透|吸光|樣品|測量|光譜"),
    ("cp949", "파장|반사|투과|흡광|시료|측정|분광"),
    ("cp1251", "(?i)длин[аы] волн|отражен|пропускан|поглощен|образец|спектр|довжина хвилі"),
    ("koi8-r", "(?i)длин[аы] волн|отражен|пропускан|поглощен|образец|спектр"),
)
_WORDS = tuple((name, re.compile(words)) for name, words in _HEADINGS)

FALLBACK = "latin-1"


def national(head: bytes) -> str:
    """Return the encoding of a text that begins with these bytes and is not UTF-8.

    The one that yields most of its headings' words; `FALLBACK` where none yields any.
    """
    most, best = 0, FALLBACK
    for name, words in _WORDS:
        decoder = codecs.getincrementaldecoder(name)()
        try:
            found = decoder.decode(head)  # a character that is cut off at the end may be begun
        except UnicodeDecodeError:
            continue
        count = len(words.findall(found))
        if count > most:
            most, best = count, name
    return best
