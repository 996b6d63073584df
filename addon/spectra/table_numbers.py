"""The numbers of a block of rows, and what stands where one is missing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .cells import Row, Sheet, value


def check_widths(sheet: Sheet, rows: list[Row], columns: int, named: bool) -> None:
    """Raise `InputError` for a row that is longer than its heading, and for decimal commas in it.

    ``columns``: how many there are; ``named``: whether a heading says so.
    """
    for row in rows:
        if len(row.cells) > columns:
            raise InputError(
                f"{sheet.path}:{row.line}",
                f"{len(row.cells)} columns where the first line has {columns}",
                "make every row as long as the first"
                + (
                    "; with decimal commas separate by semicolons" if sheet.separator == "," else ""
                ),
            )
    if (
        sheet.separator == ","
        and not named
        and columns > 2
        and all("." not in row.text for row in rows)
    ):
        # 380,0,05: no reflectance is 0 at all wavelengths, or 1, and has whole numbers beside it.
        seconds = {row.cells[1] for row in rows if len(row.cells) > 1}
        if seconds <= {"0", "1"} and rows[0].cells[0] not in ("0", "1"):
            raise InputError(
                f"{sheet.path}:{rows[0].line}",
                "decimal commas between commas",
                "with decimal commas separate by semicolons",
            )


def numbers_of(rows: list[Row], columns: int) -> tuple[NDArray, dict[tuple[int, int], str]]:
    """Return all cells as numbers (k, columns), and what stands where there is none."""
    data = np.full((len(rows), columns), np.nan)
    words: dict[tuple[int, int], str] = {}
    for k, row in enumerate(rows):
        try:
            data[k, : len(row.cells)] = [float(cell) for cell in row.cells if len(cell) < 40]
            if "_" not in row.text:
                continue
        except ValueError:
            pass
        data[k] = np.nan
        for column, cell in enumerate(row.cells):
            found = value(cell)
            if found is not None:
                data[k, column] = found
            elif cell:
                words[k, column] = cell
    return data, words
