"""A table of what the materials of a scene are given, as a CSV that survives a re-import.

    material,reflectance,glass,metal,behind,pane,unit
    Wall,plaster.csv:lime,,,,,
    Window,,float.json,,,block,
    Handle,,,Cu.csv,,,
    Floor,estimate,,,,,

Columns may stand in any order, and all but the first may be missing.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..spectra import files
from ..spectra.checks import UNITS
from ..spectra.formats import built_in
from ..spectra.grid import WAVELENGTHS
from ..spectra.reflectance import split_assignment
from .assignment import BLOCK, SINGLE_FACE, Assignment, read, read_metal

KINDS = ("reflectance", "glass", "metal")
COLUMNS = ("material", *KINDS, "behind", "pane", "unit")
ESTIMATE = "estimate"
"""In the place of a file: the material's base color is to tell its reflectance."""

PANES = {"": SINGLE_FACE, "face": SINGLE_FACE, "block": BLOCK}


def read_table(path: Path, folders: Sequence[Path] = ()) -> dict[str, Assignment | None]:
    """Read what each material is given, None where its base color is to tell.

    Files are relative to the table's own folder, or to the first of ``folders`` that has them.
    Raises InputError for a table that is no UTF-8 text, names a material twice, gives one nothing
    or two things, or has a column that nobody knows, and for files as their readers do; the message
    names the line.
    """
    found: dict[str, Assignment | None] = {}
    for number, row in _rows(path):
        place = f"{path}, line {number}"
        name = row["material"]
        if not name:
            raise InputError(place, "is half empty", "give a material and what it is made of")
        if name in found:
            raise InputError(place, f'names "{name}" again', "give each material once")
        found[name] = _assignment(place, row, (path.parent, *folders))
    if not found:
        raise InputError(path, "assigns nothing", "give material and reflectance in each line")
    return found


def _rows(path: Path) -> list[tuple[int, dict[str, str]]]:
    try:
        text = files.content(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(path, "is not UTF-8 text", "save it as UTF-8") from None
    lines = text.splitlines()
    head = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    reader = csv.reader(lines, delimiter=max(",;\t", key=head.count), skipinitialspace=True)
    names: list[str] = []
    rows = []
    try:
        for cells in reader:
            values = [cell.strip() for cell in cells]
            if not any(values) or values[0].startswith("#"):
                continue
            if not names:
                names = _header(path, [value.lower() for value in values])
            else:
                row = dict(zip(names, [*values, *[""] * len(names)], strict=False))
                rows.append((reader.line_num, dict.fromkeys(COLUMNS, "") | row))
    except csv.Error as error:
        raise InputError(f"{path}, line {reader.line_num}", str(error), "mend the line") from None
    return rows


def _header(path: Path, names: list[str]) -> list[str]:
    held = ", ".join(name for name in names if name) or "none"
    if "material" not in names or not set(names) & set(KINDS):
        missing = "material" if "material" not in names else "reflectance"
        raise InputError(path, f'has no column "{missing}"', f"its columns are {held}")
    for name in names:
        if name and name not in COLUMNS:
            known = ", ".join(COLUMNS)
            raise InputError(path, f'has a column "{name}"', f"the columns are {known}")
        if name and names.count(name) > 1:
            raise InputError(path, f'has two columns "{name}"', "leave one out")
    return names


def _assignment(place: str, row: dict[str, str], folders: Sequence[Path]) -> Assignment | None:
    given = [kind for kind in KINDS if row[kind]]
    if not given:
        raise InputError(place, "is half empty", "give a material and what it is made of")
    if len(given) > 1:
        raise InputError(place, f"gives both {' and '.join(given)}", "give each material one")
    kind, unit = given[0], row["unit"].lower() or None
    if unit not in (None, *UNITS):
        raise InputError(place, f'has the unit "{unit}"', "choose percent or fraction")
    if row["pane"].lower() not in PANES or (row["pane"] and kind != "glass"):
        raise InputError(place, f'has the pane "{row["pane"]}"', "of glass: face or block")
    if row["behind"] and kind != "reflectance":
        raise InputError(place, f"is {kind} behind glass", "leave one of the two out")
    if row[kind].lower() == ESTIMATE and kind == "reflectance":
        if row["behind"]:
            raise InputError(place, "is an estimate behind glass", "give it a measured reflectance")
        return None
    file = _file(row[kind], folders)
    if kind == "metal":
        return read_metal(file)
    found = read(file, unit=unit, faces=PANES[row["pane"].lower()] if kind == "glass" else 0)
    if row["behind"]:
        found = found.lit_through(read(_file(row["behind"], folders), faces=SINGLE_FACE))
    return found


def _file(text: str, folders: Sequence[Path]) -> str:
    """``FILE[:COLUMN]`` below the first folder that has it; a checker's name lies in none."""
    if built_in.recognises(text):
        return text
    for folder in folders:
        path, _ = split_assignment(str(folder / text))
        if path.is_file():
            return str(folder / text)
    return str(folders[0] / text)


def table_files(path: Path, assignments: Mapping[str, Assignment]) -> dict[Path, str]:
    """Return the table at ``path`` as text, from which `read_table` reads the same values again.

    Spectra that no file holds any more come with it, as ``NAME.reflectances.csv`` beside it: text
    by path, the table last.
    """
    beside = path.with_name(f"{path.stem}.reflectances.csv")
    orphans = {
        name: one for name, one in assignments.items() if not one.source and not one.estimated
    }
    text = io.StringIO()
    table = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    table.writeheader()
    for name, one in sorted(assignments.items()):
        kind = "metal" if one.metal is not None else "glass" if one.faces else "reflectance"
        row = {"material": name, kind: _told(one.source, path.parent)}
        if one.estimated:
            row["reflectance"] = ESTIMATE
        elif name in orphans:
            row = {
                "material": name,
                "glass" if one.faces else "reflectance": f"{beside.name}:{name}",
            }
            row["unit"] = "fraction"
        else:
            row["unit"] = one.unit if one.unit in UNITS else ""
            row["behind"] = _told(one.behind, path.parent)
        row["pane"] = "block" if one.faces == BLOCK else ""
        table.writerow(row)
    files = {beside: _curves(orphans)} if orphans else {}
    return {**files, path: text.getvalue()}


def _curves(orphans: Mapping[str, Assignment]) -> str:
    """The values of spectra, all digits, a column each."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["wavelength_nm", *orphans])
    values = np.stack([one.values for one in orphans.values()], axis=1)
    for wavelength, row in zip(WAVELENGTHS, values, strict=True):
        table.writerow([f"{wavelength:g}", *(repr(float(value)) for value in row)])
    return text.getvalue()


def _told(source: str, folder: Path) -> str:
    """``FILE[:COLUMN]`` relative to a folder where it lies below it, with slashes."""
    if not source or built_in.recognises(source):
        return source
    path, column = split_assignment(source)
    path = path.resolve()
    told = path.relative_to(folder.resolve()) if path.is_relative_to(folder.resolve()) else path
    return f"{told.as_posix()}:{column}" if column else told.as_posix()
