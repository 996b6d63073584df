"""Libraries of reflectances: what folders of files hold, found again in a moment.

A folder's index is derived and kept in the user's cache, by the size and the time of each file.
Nothing of it lies in a blend file: there, a material has its own reflectance.
"""

from __future__ import annotations

import json
import os
from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..choices import ORDERS, listed
from ..errors import InputError, parameter
from ..progress import Progress, run
from . import cache, formats
from .cielab import XYZ_to_Lab
from .curves import NoSpectra
from .illuminants import D65
from .reflectance import Kind, read_all, reflectance_hash
from .sensitivities import cmfs

NEUTRAL = 5.0
"""Chroma in CIELAB under which a colour has no hue to sort by."""


@dataclass(frozen=True)
class Library:
    """Reflectances of many files.

    ``values`` (m, 81); of each: ``names``, by which its file knows it too, ``classes`` (what kind
    of thing, or empty), ``sources`` (folder and file, for people), ``paths``, ``kinds`` (what was
    read there). ``problems``: why files and spectra cannot be used, ``unused`` in number; spectra
    of one file with the same fault share a line. ``others``: how many files hold something else.
    """

    names: tuple[str, ...] = ()
    classes: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    paths: tuple[str, ...] = ()
    kinds: tuple[Kind, ...] = ()
    values: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 81)))
    problems: tuple[str, ...] = ()
    unused: int = 0
    others: int = 0

    def __len__(self) -> int:
        return len(self.names)

    def __add__(self, other: Library) -> Library:
        """Return both, the other's reflectances after these."""
        return _joined([self, other])

    def only(self, chosen: Sequence[int] | NDArray[np.int64]) -> Library:
        """Return the reflectances of these numbers, in their order, with all problems."""

        def some(told: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(told[k] for k in chosen)

        return replace(
            self,
            names=some(self.names),
            classes=some(self.classes),
            sources=some(self.sources),
            paths=some(self.paths),
            kinds=tuple(self.kinds[k] for k in chosen),
            values=self.values[np.asarray(chosen, dtype=int)],
        )

    @cached_property
    def Lab(self) -> NDArray[np.float64]:
        """CIE L*a*b* under D65, 2° observer, (m, 3)."""
        if not len(self):
            return np.empty((0, 3))
        S = cmfs() * D65()
        return XYZ_to_Lab(self.values @ S.T, S.sum(axis=1))

    @cached_property
    def hashes(self) -> tuple[str, ...]:
        """The fingerprint of each reflectance, which managed materials keep."""
        return tuple(reflectance_hash(values) for values in self.values)

    @cached_property
    def _texts(self) -> tuple[str, ...]:
        synonyms = formats.building_materials.SYNONYMS
        also = (synonyms.get(each, "") for each in self.classes)
        told = zip(self.names, self.classes, self.sources, also, strict=True)
        return tuple(" ".join(words).casefold() for words in told)

    def search(self, text: str) -> NDArray[np.int64]:
        """Return the numbers of those whose name, class or source holds every word of a text."""
        words = text.casefold().split()
        found = (k for k, told in enumerate(self._texts) if all(word in told for word in words))
        return np.fromiter(found, dtype=np.int64)

    def order(self, by: str) -> NDArray[np.int64]:
        """Return all numbers, sorted by one of `ORDERS`; neutral colours come after all hues.

        Raises `InputError` for another order.
        """
        if by not in ORDERS:
            raise InputError(
                parameter("sort"), f"'{by}' is not an order", f"choose {listed(ORDERS)}"
            )
        if by in ("name", "source"):
            keys = self._texts if by == "name" else [source.casefold() for source in self.sources]
            return np.array(sorted(range(len(self)), key=keys.__getitem__), dtype=int)
        L, a, b = self.Lab.T
        if by == "lightness":
            return np.argsort(L, kind="stable")
        neutral = np.hypot(a, b) < NEUTRAL
        hue = np.where(neutral, L, np.degrees(np.arctan2(b, a)) % 360.0)
        return np.lexsort((hue, neutral))


def built_in() -> Library:
    """Return the checkers of colour-science and the building materials, without a file."""
    sets = formats.built_in.SETS
    return _joined([_of_record(path, path.partition(":")[2], _record(Path(path))) for path in sets])


def index(folders: Iterable[str | Path]) -> Generator[Progress, None, Library]:
    """Read all files of reflectances under folders, yielding how far it is; return them.

    A file that was read before and is as large and as old as then is not read again. A file that
    cannot be read, and a folder that is not there, are told in ``problems``, a line each.
    """
    found = Library()
    wanted = [Path(folder) for folder in folders]
    for number, folder in enumerate(wanted):
        for progress in (work := _Folder(folder)).read():
            yield Progress((number + progress.done) / len(wanted), progress.line)
        found += work.library
    return found


def whole(folders: Iterable[str | Path]) -> Library:
    """Return what `index` returns, at one go."""
    return run(index(folders))


class _Folder:
    """The index of one folder: what its cache has, brought up to date."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.library = Library()

    def read(self) -> Generator[Progress, None, None]:
        """Read what is new, yielding how far it is; `library` is there at the end."""
        if not self.folder.is_dir():
            line = f"{self.folder}: is not a folder; choose it again or remove it from the list"
            self.library = Library(problems=(line,), unused=1)
            return
        place = cache.place(
            "library", {"folder": str(self.folder.resolve())}, Path(__file__).parent
        )
        known = _unpacked(cache.load(place))
        kept: dict[str, dict[str, Any]] = {}
        parts: list[Library] = []
        closed: list[str] = []
        files = yield from _files(self.folder, closed)
        changed = len(files) != len(known)
        try:
            for number, path in enumerate(files):
                name = path.relative_to(self.folder).as_posix()
                stamp = _stamp(path)
                record = known.get(name)
                if record is None or record.get("stamp") != stamp:
                    yield Progress(number / len(files), name)
                    record, changed = {"stamp": stamp, **_record(path)}, True
                kept[name] = record
                parts.append(_of_record(str(path), f"{self.folder.name}/{name}", record))
        except GeneratorExit:  # what was read so far is not read again next time
            cache.save(place, _packed({**known, **kept}))
            raise
        if changed:
            cache.save(place, _packed(kept))
        self.library = _joined([*parts, Library(problems=tuple(closed), unused=len(closed))])


def _files(folder: Path, closed: list[str]) -> Generator[Progress, None, list[Path]]:
    """Return all files under a folder that reflectances may be in, hidden ones left out.

    ``closed`` takes a line for each folder that may not be looked into.
    """

    def tell(error: OSError) -> None:
        closed.append(f"{error.filename}: cannot be read ({error.strerror}); check permissions")

    found = []
    for number, (at, folders, names) in enumerate(os.walk(folder, onerror=tell)):
        if number % 100 == 99:  # someone chose their whole disk
            yield Progress(0.0, f"{at}: {len(found)} files so far")
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += [
            Path(at, name)
            for name in sorted(names)
            if name.lower().endswith(formats.ENDINGS) and not name.startswith(".")
        ]
    return found


def _stamp(path: Path) -> list[int]:
    """Return sizes and times of a file and of those that reading it looks into."""
    stamp = []
    for each in (path, *formats.companions(path)):
        try:
            stat = each.stat()
            stamp += [stat.st_size, stat.st_mtime_ns]
        except OSError:
            stamp += [-1, -1]
    return stamp


def _record(path: Path) -> dict[str, Any]:
    """Return what is kept of a file: spectra, problems, whether it is about something else."""
    try:
        read = read_all(path)
    except NoSpectra as error:
        # A table that is none is a mistake; a text, a record or a matrix of other things is not.
        broken = path.suffix.lower() in (".csv", ".tsv", ".sli")
        return _nothing(str(error)) if broken else _nothing() | {"other": True}
    except InputError as error:
        return _nothing(str(error))
    except Exception as error:  # a damaged file must not cost the others, whatever it raises
        line = f"{path}: cannot be read ({type(error).__name__}: {error}); get the file again"
        return _nothing(" ".join(line.split()))
    classes = read.classes or ("",) * len(read.names)
    return {
        "names": list(read.names),
        "classes": [str(kind) for kind in classes],
        "kinds": read.kinds,
        "values": read.values,
        "problems": _faults(read.problems),
        "unused": len(read.problems),
        "other": False,
    }


def _nothing(*problems: str) -> dict[str, Any]:
    empty = {"names": [], "classes": [], "kinds": [], "values": np.empty((0, 81)), "other": False}
    return {**empty, "problems": list(problems), "unused": len(problems)}


def _faults(problems: Mapping[str, InputError]) -> list[str]:
    """Return a line for each fault: a library has it in hundreds of spectra that are infrared."""
    alike: dict[str, list[str]] = {}
    for name, error in problems.items():
        _, named, rest = str(error).rpartition(f"'{name}'")
        alike.setdefault(rest if named else str(error), []).append(name)
    lines = []
    for names in alike.values():
        line, more = str(problems[names[0]]), len(names) - 1
        said = f"'{names[0]}'"
        lines.append(line.replace(said, f"{said} and {more} more", 1) if more else line)
    return lines


def _packed(records: dict[str, dict[str, Any]]) -> dict[str, NDArray]:
    """Return records as arrays: the text as JSON, the numbers one below the other."""
    text = {
        name: {key: value for key, value in record.items() if key != "values"}
        for name, record in records.items()
    }
    values = [record["values"] for record in records.values()]
    return {
        "text": np.frombuffer(json.dumps(text).encode(), np.uint8),
        "values": np.concatenate([np.empty((0, 81)), *values]),
    }


def _unpacked(arrays: dict[str, NDArray] | None) -> dict[str, dict[str, Any]]:
    """Return what `_packed` took, nothing where it is damaged."""
    if arrays is None:
        return {}
    try:
        records = json.loads(arrays["text"].tobytes().decode())
        ends = np.cumsum([len(record["names"]) for record in records.values()])
        parts = np.split(arrays["values"], ends[:-1])
        found = {
            name: {**record, "values": part}
            for (name, record), part in zip(records.items(), parts, strict=True)
        }
        for record in found.values():
            whole = _of_record("", "", record)
            if not len(whole.names) == len(whole.classes) == len(whole.kinds) == len(whole.values):
                return {}
        return found
    except (KeyError, ValueError, TypeError, AttributeError):
        return {}


def _of_record(path: str, source: str, record: dict[str, Any]) -> Library:
    count = len(record["names"])
    return Library(
        names=tuple(record["names"]),
        classes=tuple(record["classes"]),
        sources=(source,) * count,
        paths=(path,) * count,
        kinds=tuple(Kind(*kind) for kind in record["kinds"]),
        values=record["values"],
        problems=tuple(record["problems"]),
        unused=record["unused"],
        others=int(record["other"]),
    )


def _joined(parts: Sequence[Library]) -> Library:
    """Return many libraries as one; adding them up one by one would copy all each time."""

    def all_of(key: str) -> tuple[Any, ...]:
        return tuple(word for part in parts for word in getattr(part, key))

    return Library(
        names=all_of("names"),
        classes=all_of("classes"),
        sources=all_of("sources"),
        paths=all_of("paths"),
        kinds=all_of("kinds"),
        values=np.concatenate([np.empty((0, 81)), *(part.values for part in parts)]),
        problems=all_of("problems"),
        unused=sum(part.unused for part in parts),
        others=sum(part.others for part in parts),
    )
