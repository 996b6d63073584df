"""Measured reflectances that a painted material may be: near to its base color, and to its name."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..spectra.library import Library
from ..spectra.quantities import TRANSMITTANCE
from ..spectra.working_spaces import DEFAULT_SPACE
from .measures import delta_E
from .prediction import rgb_albedo

NAME_COUNTS = 10.0
"""[CIEDE2000] that all words of a name weigh: as far as bricks are from one another."""

_SHORTEST = 3
"""Letters of a word that counts."""

_IDLE = frozenset(["material", "mat", "shader", "new", "the", "and", "color", "colour", "surface"])

_SAME = (
    "brick bricks klinker ziegel backstein mauerwerk brique ladrillo mattone tijolo baksteen",
    "concrete beton béton hormigón calcestruzzo cemento concreto cement",
    "wood timber holz bois madera legno madeira hout",
    "stone stein naturstein pierre piedra pietra pedra steen",
    "tile tiles fliese dachziegel tuile teja tegola telha shingle roof",
    "asphalt bitumen tarmac road straße asphalte asfalto",
    "glass glas verre vidrio vetro vidro glazing",
    "grass lawn rasen gras wiese herbe césped erba grama",
    "metal metall métal metallo steel stahl acier acero aluminium aluminum",
    "plaster putz stucco render enduit yeso intonaco gips gypsum",
    "sand sable arena sabbia zand",
    "soil erde boden sol suelo terra earth",
    "leaf leaves laub blatt feuille hoja foglia foliage tree",
    "paint farbe anstrich peinture pintura vernice tinta verf",
)
_MEANING = {word: group.split()[0] for group in _SAME for word in group.split()}


class Nearest(NamedTuple):
    """One measured spectrum: its ``number`` in the library, by how much choosing it changes the
    base color (``delta_E``, CIEDE2000 under D65), and the ``words`` of the name that it shares."""

    number: int
    delta_E: float
    words: tuple[str, ...]


def nearest(
    library: Library,
    base_color: ArrayLike,
    name: str = "",
    count: int = 10,
    space: str = DEFAULT_SPACE,
) -> list[Nearest]:
    """Return the measured reflectances that are nearest to a material, the best first.

    Parameters
    ----------
    library
        What to choose from; transmittances in it are passed over.
    base_color
        Linear RGB (3,) of the working ``space``, what the material reflects of D65, white 1.
    name
        The material's name. Words of it, in common languages, that a spectrum's name, class or
        file have too bring it forward by up to `NAME_COUNTS`.
    count
        How many at most.

    Returns
    -------
    Their numbers in the library, in order of ΔE less what the name counts; none where the library
    is empty or the color is not finite.
    """
    color = np.asarray(base_color, dtype=float)
    if not len(library) or not np.isfinite(color).all():
        return []
    differences = delta_E(rgb_albedo(library.values, space), color, np.ones(3), space)
    wanted = words_of(name)
    shared = [
        tuple(word for word in wanted if word in told)
        for told in (
            words_of(" ".join(texts))
            for texts in zip(library.names, library.classes, library.sources, strict=True)
        )
    ]
    weight = np.array([len(words) for words in shared]) * NAME_COUNTS / max(len(wanted), 1)
    opaque = [k for k, kind in enumerate(library.kinds) if kind.quantity != TRANSMITTANCE]
    order = sorted(opaque, key=lambda k: (differences[k] - weight[k], k))
    return [Nearest(k, float(differences[k]), shared[k]) for k in order[:count]]


def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name that mean something, one for all that mean the same."""
    apart = re.sub(r"(?<=[a-zß-ÿ])(?=[A-ZÀ-Þ])", " ", name)
    found = re.findall(r"[^\W\d_]+", apart.casefold())
    words = (_MEANING.get(word) or _MEANING.get(word.rstrip("s"), word) for word in found)
    telling = (word for word in words if len(word) >= _SHORTEST and word not in _IDLE)
    return tuple(dict.fromkeys(telling))
