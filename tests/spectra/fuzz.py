"""Damaged files of spectra by chance, in any number: each gives its result or one clear line.

    .venv/bin/python -m tests.spectra.fuzz --count 1000000 --seed 2

Mutations of a valid file of every kind. A short run is a test; one by hand keeps what it finds in
``--keep`` FOLDER and ends with 1.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.reflectance import read_all
from spectral_skylight.addon.spectra.refraction import read_nk
from spectral_skylight.tests.spectra import kind_files, kinds

SECONDS = 2.0
"""Processor time that no small input may take; those of the seeds take a hundredth."""

TOKENS = (
    b"nan", b"inf", b"-1e308", b"1e999", b"9" * 400, b"0", b"-1", b"1_0", b"4,5", b"\0",
    b"\0\0\0\0", b"\xff\xfe", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"{", b"}", b"[", b'"', b"'",
    b"<", b">", b"<!--", b"&a;", b"\n", b"\r", b"\r\n", b"\x0b", b"\x0c", b"\x85", b"\xe2\x80\xa8",
    b";", b",", b"\t",
    b" " * 300, b"%", b"#", b"$$", b"##", b"=", b"\\ud800", b"null", b"true", b"{}", b"[]", b"S9",
    b"BEGIN_DATA", b"END_DATA", b"nm", b"Abs", b"wavelength", b"400", b"\xb5m", b"1e-320",
    b"x" * 5000,
)  # fmt: skip


class Fault(NamedTuple):
    """What an input did that none may: its kind, name and bytes, and what happened."""

    kind: str
    name: str
    content: bytes
    what: str


def seeds() -> dict[str, tuple[str, dict[str, bytes]]]:
    """Return valid files by kind: which of them is read, and the bytes of all that belong to it."""
    from spectral_skylight.tests.spectra import published

    found = {kind: (name, {name: content}) for kind, (name, content) in kinds.KNOWN.items()}
    found["IGDB"] = ("a.dat", {"a.dat": kind_files.igdb()})
    found["IGSDB 2"] = ("a.json", {"a.json": kind_files.igsdb_2(diffuse=True)})
    nk = kind_files.rows(kind_files.RED, kind_files.GREY)
    found["metal"] = ("a.nk", {"a.nk": kind_files.text("nm,n,k", nk)})
    with tempfile.TemporaryDirectory() as folder:
        for kind, (write, _, _) in published.PUBLISHED.items():
            path = _written(write, folder, len(found))
            found[kind] = (path.name, _beside(path))
        path = _written(published.two, folder, len(found))
        found["ENVI"] = (path.name, _beside(path))
    return found


def _written(write, folder: str, number: int) -> Path:
    place = Path(folder, str(number))
    place.mkdir()
    return write(place)


def _beside(path: Path) -> dict[str, bytes]:
    """Return a file and what is read with it: a header beside it, wavelengths above it."""
    files = {path.name: path.read_bytes()}
    header = path.with_suffix(".hdr")
    if header.exists():
        files[header.name] = header.read_bytes()
    for above in path.parent.parent.glob("*Wavelengths*"):
        files[above.name] = above.read_bytes()
    return files


def mutated(content: bytes, other: bytes, chance: random.Random) -> bytes:
    """Return bytes with one to three damages: cut, lost, doubled, put in, changed, moved, mixed."""
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 2, 3))):
        at = chance.randrange(len(data) + 1)
        how = chance.randrange(8)
        if how == 0:
            del data[at:]
        elif how == 1:
            del data[at : at + chance.randrange(1, 200)]
        elif how == 2:
            data[at:at] = chance.choice(TOKENS)
        elif how == 3:
            for _ in range(chance.randrange(1, 20)):
                if data:
                    data[chance.randrange(len(data))] = chance.randrange(256)
        elif how == 4:
            part = data[at : at + chance.randrange(1, 300)]
            data[at:at] = part * chance.choice((1, 2, 50))
        elif how == 5:
            lines = data.split(b"\n")
            chance.shuffle(lines)
            data = bytearray(b"\n".join(lines))
        elif how == 6:
            start = chance.randrange(len(other) + 1)
            data[at:at] = other[start : start + chance.randrange(1, 400)]
        else:  # another number where one stands
            end = at
            while end < len(data) and data[end : end + 1] in b"0123456789.+-eE":
                end += 1
            data[at:end] = chance.choice(TOKENS[:9])
    return bytes(data)


def faults(count: int, seed: int, folder: Path) -> Iterator[Fault]:
    """Yield what goes wrong in ``count`` inputs, which are written into a folder one by one."""
    chance = random.Random(seed)
    known = seeds()
    names = sorted(known)
    for kind in names:
        for name, content in known[kind][1].items():
            place = folder / kind.replace("/", "-") / name
            place.parent.mkdir(exist_ok=True)
            place.write_bytes(content)
    for _ in range(count):
        kind = chance.choice(names)
        read, files = known[kind]
        name = chance.choice(sorted(files))
        other = known[chance.choice(names)]
        content = mutated(files[name], next(iter(other[1].values())), chance)
        place = folder / kind.replace("/", "-")
        (place / name).write_bytes(content)
        what = fault(place / read)
        if what:
            yield Fault(kind, name, content, what)
        (place / name).write_bytes(files[name])


def fault(path: Path) -> str:
    """Return what reading a file does that it may not, nothing where it does not."""
    begun = time.process_time()
    try:
        if path.suffix == ".nk":
            read_nk(path)
        else:
            values = read_all(path).values
            if not ((values >= 0.0) & (values <= 1.0)).all():
                return "a reflectance outside 0 to 1"
    except InputError as error:
        if len(str(error).splitlines()) != 1:
            return f"more than a line: {str(error)!r}"
        try:
            str(error).encode()
        except UnicodeEncodeError:
            return "a line that UTF-8 cannot hold"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    taken = time.process_time() - begun
    return f"{taken:.1f} s" if taken > SECONDS else ""


def main() -> int:
    """Run as many as asked for; print faults, and return 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="a folder for the inputs that do what none may")
    options = parser.parse_args()
    found = 0
    with tempfile.TemporaryDirectory() as folder:
        for one in faults(options.count, options.seed, Path(folder)):
            found += 1
            print(f"{one.kind}, {one.name}: {one.what}", flush=True)
            if options.keep:
                options.keep.mkdir(parents=True, exist_ok=True)
                (options.keep / f"{found}_{one.name}").write_bytes(one.content)
    print(f"{options.count} inputs, {found} faults, the process took {largest_mb():.0f} MB at most")
    return int(found > 0)


def largest_mb() -> float:
    """Return the most memory [MB] that this process has taken, NaN on Windows."""
    try:
        import resource
    except ImportError:
        return float("nan")
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


if __name__ == "__main__":
    sys.exit(main())
