"""A study, read from its TOML file: scenes x skies x variants x cameras x frames.

Everything that can be told without Blender is checked here.
"""

from __future__ import annotations

import datetime
import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..choices import (
    ALL_LIGHT,
    BASIS,
    ENGINES,
    GROUNDS,
    OCCLUSIONS,
    QUALITIES,
    default,
    listed,
    offered_bases,
)
from ..errors import InputError
from ..transfer.assignment import Assignment
from ..transfer.assignment_table import read_table
from .owner import check_links, check_owner
from .toml_table import Table, read_toml

KEYS = {
    "out": "folder for everything that the study writes",
    "scenes": "blend files",
    "cameras": 'names, or "all"',
    "skies": "HDRI files, or tables, or as-is",
    "variants": "tables with name and assign",
    "engine": listed(ENGINES),
    "samples": "of each pixel",
    "resolution": "[width, height]",
    "frames": "numbers, or all of the scene; its current one",
    "white": "[R, G, B] or auto, as of apply",
    "sun": "whether the sun of each HDRI shines; true",
    "ground": listed(GROUNDS),
    "occlusion": listed(OCCLUSIONS),
    "bounce": "reflected light; a bake includes it anyway",
    "gloss": "whether materials keep their gloss",
    "basis": f"{listed(offered_bases())}; {BASIS}",
    "tolerance": "CIEDE2000",
    "quality": f"of simulated skies: {listed(QUALITIES)}",
    "sky_width": "of simulated skies [pixels]; 1024",
}


def key_of(parameter: str) -> str:
    """Return a parameter's key in a study, as `errors.InputError.told` asks for it."""
    return '"times"' if parameter == "time" else f'"{parameter}"'


AS_IS = "as-is"
"""The sky that each scene has, which may move: the film of an animated file."""

PLACE_KEYS = ("date", "times", "city", "latitude", "longitude", "timezone")
SKY_KEYS = ("file", "name", *PLACE_KEYS, "north")
VARIANT_KEYS = ("name", "assign")
LAST_FRAME = 1048574
"""Of Blender's."""


@dataclass(frozen=True)
class StudySky:
    """A sky file, or a sun to simulate one for; without both the scene's own, as it is.

    ``north`` [degrees]: where true north is in the scene, clockwise from +Y seen from above; None
    for a file that stands as the scene's World, or an unturned one, has it.
    ``sun``: elevation and azimuth from true north, clockwise [degrees].
    """

    name: str
    content: str
    """Hash of what decides the sky's pixels."""
    north: float | None
    file: Path | None = None
    sun: tuple[float, float] | None = None


@dataclass(frozen=True)
class Variant:
    """What materials are given, by their names; None where their base color is to tell."""

    name: str
    content: str
    given: dict[str, Assignment | None]


@dataclass(frozen=True)
class Study:
    """What is to be rendered; paths are absolute."""

    path: Path
    out: Path
    scenes: tuple[Path, ...]
    cameras: tuple[str, ...] | None
    """None: all of each scene."""
    skies: tuple[StudySky, ...]
    variants: tuple[Variant, ...]
    frames: tuple[int, ...] | None
    engine: str | None
    samples: int | None
    resolution: tuple[int, int] | None
    quality: str
    sky_width: int
    settings: dict[str, Any] = field(default_factory=dict)
    """Options of `scene.world.settings.Settings`."""
    all_frames: bool = False
    """Whether all of each scene's frames are rendered."""

    @property
    def plan(self) -> Path:
        """Where the study's plan lies."""
        return self.out / "plan.jsonl"


def read_study(path: str | Path) -> Study:
    """Read a study with its CSVs and skies.

    Raises `InputError` for whatever of it cannot be rendered, with file, key and cure: unknown
    keys, files that are missing or damaged, suns too low to simulate, names given twice.
    """
    path = Path(path).resolve()
    table = read_toml(path, KEYS)
    here = path.parent
    scenes = table.items("scenes", (str,), "give blend files")
    cameras = table.items("cameras", (str,), 'give names, or "all"')
    resolution = table.items("resolution", (int,), "give [width, height]", None)
    if resolution and (len(resolution) != 2 or not all(1 <= n <= 65536 for n in resolution)):
        table.wrong("resolution", "give [width, height], each 1 to 65536")
    frames = table.items("frames", (int, str), "give whole numbers, or all", None)
    every = frames == ["all"]
    frames = None if every else frames
    if frames and not all(type(n) is int and abs(n) <= LAST_FRAME for n in frames):
        table.wrong("frames", f"give whole numbers, up to {LAST_FRAME}")
    study = Study(
        path=path,
        out=here / table.text("out"),
        scenes=tuple(_file(table.place, here / name) for name in scenes),
        cameras=None if cameras == ["all"] else _once(table, "cameras", cameras),
        skies=_skies(table, here),
        variants=_variants(table, here),
        frames=None if frames is None else _once(table, "frames", frames),
        engine=table.choice("engine", ENGINES, None),
        samples=table.whole("samples", 1, 1 << 24, None),
        resolution=None if resolution is None else (resolution[0], resolution[1]),
        quality=table.choice("quality", QUALITIES, default(QUALITIES)),
        sky_width=table.whole("sky_width", 8, 8192, 1024),
        settings=_settings(table),
        all_frames=every,
    )
    _once(table, "scenes", [str(scene) for scene in study.scenes])
    _check_folder(study.out)
    check_owner(path, study.out)
    return study


def folder_of(path: Path) -> Path:
    """Return the folder that a study's results go to, made where it is not there."""
    out = path.parent / read_toml(path, KEYS).text("out")
    _check_folder(out)
    return out


def _settings(table: Table) -> dict[str, Any]:
    white = table.values.get("white")
    if white is not None and white != "auto":
        white = table.items("white", (int, float), "give [R, G, B] or auto")
        if len(white) != 3 or not all(0.0 < part <= 1e9 for part in white):
            table.wrong("white", "give three numbers above 0, or auto")
        white = tuple(float(part) for part in white)
    found = {
        "white": white,
        "sun": table.switch("sun", True),
        "ground": table.choice("ground", GROUNDS, default(GROUNDS)),
        "occlusion": table.choice("occlusion", OCCLUSIONS, default(OCCLUSIONS)),
        "bounce": table.switch("bounce", False),
        "gloss": table.switch("gloss", False),
        "basis": table.text("basis", BASIS),
        "tolerance": table.number("tolerance", 1e-6, 100.0, None),
    }
    if found["bounce"] and found["occlusion"] not in ALL_LIGHT:
        table.wrong("bounce", 'needs all light: omit occlusion, or give "auto"')
    return found


def _skies(table: Table, here: Path) -> tuple[StudySky, ...]:
    found = table.items("skies", (str, dict), "give HDRI files, or tables with date and times")
    skies: list[StudySky] = []
    for number, value in enumerate(found, 1):
        if value == AS_IS:
            skies.append(StudySky(AS_IS, AS_IS, None))
            continue
        values = {"file": value} if isinstance(value, str) else value
        skies += _sky(Table(f"{table.place}, skies {number}", values, SKY_KEYS), here)
    return tuple(skies)


def _sky(table: Table, here: Path) -> Iterable[StudySky]:
    """Give the skies of one table: a file's, or one for each of its times."""
    from ..scene.files.exr_decoder import read_sky
    from ..sky.place import place
    from ..sky.simulation import LOWEST_SUN
    from ..sky.sun_position import sun_positions

    if "file" in table.values:
        for key in PLACE_KEYS:
            if key in table.values:
                table.wrong(key, "leave it out beside a file, or leave out the file")
        file = _file(table.place, here / table.text("file"))
        read_sky(file)
        north = table.number("north", -360.0, 360.0, None)
        yield StudySky(table.text("name", file.stem), file_hash(file), north, file=file)
        return
    date = str(table.items("date", (str, datetime.date), "give YYYY-MM-DD")[0])[:10]
    times = table.items("times", (str, datetime.time), "give times such as 09:00")
    given = _place(table)
    north = float(table.number("north", -360.0, 360.0))
    times = [str(time) for time in times]
    try:
        where = place(**given)
        suns = sun_positions(date, times, where.latitude, where.longitude, where.timezone)
    except InputError as error:
        raise error.within(table.place, key_of) from None
    for time, sun in zip(times, suns, strict=True):
        if sun[0] < LOWEST_SUN:
            raise InputError(
                f"{table.place}, {date} {time}",
                f"the sun is {-sun[0]:.1f}° below the horizon",
                f"skies are simulated down to {LOWEST_SUN:g}°: leave that time out",
            )
        name = f"{table.text('name', '')}_{date}_{time[:5].replace(':', '')}".lstrip("_")
        yield StudySky(name, content_hash([*sun]), north, sun=sun)


def _place(table: Table) -> dict[str, Any]:
    """Return what a table says of the place: a city, or all else."""
    city = table.text("city", None)
    optional = () if city is None else (None,)
    zone = table.items(
        "timezone", (str, int, float), "give Europe/Berlin, or hours such as +2", *optional
    )
    zone = None if zone is None else zone[0]
    return {
        "city": city,
        "latitude": table.number("latitude", -90.0, 90.0, *optional),
        "longitude": table.number("longitude", -180.0, 180.0, *optional),
        "timezone": zone if zone is None or isinstance(zone, str) else f"{zone:+g}",
    }


def _variants(table: Table, here: Path) -> tuple[Variant, ...]:
    default = [{"name": "as-is"}]  # the scene as it is, with what it has of spectral materials
    found = table.items("variants", (dict,), "give tables with name and assign", default)
    variants = []
    for number, values in enumerate(found, 1):
        one = Table(f"{table.place}, variants {number}", values, VARIANT_KEYS)
        name, assign = one.text("name"), one.text("assign", None)
        given = {} if assign is None else read_table(_file(one.place, here / assign), (here,))
        content = content_hash({m: one and one.content for m, one in given.items()})
        variants.append(Variant(name, content, given))
    _once(table, "variants", [variant.name for variant in variants])
    return tuple(variants)


def _file(place: str, path: Path) -> Path:
    try:
        there = path.is_file()
    except (OSError, ValueError):  # no file has such a name
        there = False
    if not there:
        raise InputError(place, f"there is no file {path}", "paths are relative to the study")
    return path.resolve()


def _once(table: Table, key: str, values: list[Any]) -> tuple[Any, ...]:
    for value in values:
        if values.count(value) > 1:
            raise InputError(f'{table.place}, "{key}"', f"{value} is given twice", "leave one out")
    return tuple(values)


def _check_folder(out: Path) -> None:
    """Raise InputError unless files can be written into ``out``, which is made."""
    import tempfile

    check_links(out)
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except OSError as error:
        raise InputError(
            out, f"cannot be written to ({error.strerror})", 'change "out", or the folder\'s rights'
        ) from None


def content_hash(content: Any) -> str:
    """Return a hash of plain data."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:24]


def file_hash(path: Path) -> str:
    """Return a hash of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:24]
