"""The names above the columns of a text, and the units beside or below them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from iva.measured.channels import CLOCKS
from iva.measured.dialects import COMMENTS, Dialect
from iva.measured.sensor_units import OF_FORCES, OTHERS, bare, parted, unit_called

#: A name between blanks, with what is in brackets behind it: "a1 [g]", "a / (m/s²)".
WORD = re.compile(r"[^\s\[({]+(?:\s+/\s+\S+|\s*(?:\[[^\]]*\]|\([^)]*\)|\{[^}]*\}))?")


def uncommented(line: str) -> str:
    """Return a line without the mark of a comment at its begin."""
    text = line.strip()
    for mark in COMMENTS:
        if text.startswith(mark):
            return text.lstrip(mark).strip()
    return text


def divided(line: str, dialect: Dialect, count: int) -> list[str] | None:
    """Return the cells of a header line, or none if it has not as many as there are columns.

    Above columns between blanks names may hold single blanks, or be divided by something else.

    Examples
    --------
    >>> blanks = Dialect(" ", ".")
    >>> divided("# Zeit [s]  a1 [g]", blanks, 2), divided("time, a 1 (g)", blanks, 2)
    (['Zeit [s]', 'a1 [g]'], ['time', 'a 1 (g)'])
    """
    text = uncommented(line)
    if not text:
        return None
    if dialect.delimiter != " ":
        # A mark of a comment may stand before a delimiter; what the line begins with counts.
        cells = dialect.cells(text)
        if len(cells) == count + 1 and not cells[-1]:
            cells.pop()
        return spaced(cells) if len(cells) == count and any(cells) else None
    if count == 1:
        return spaced([text.strip('";,')])
    ways = [re.split(r"\s*\t\s*", text), re.split(r"\s{2,}", text), text.split(";")]
    for cells in [*ways, text.split(","), WORD.findall(text), text.split()]:
        if len(cells) == count:
            return spaced([cell.strip().strip('"') for cell in cells])
    return None


def spaced(cells: Sequence[str]) -> list[str]:
    """Return cells with single blanks between their words."""
    return [" ".join(cell.split()) for cell in cells]


def names_and_units(
    preamble: Sequence[str], dialect: Dialect, count: int
) -> tuple[list[str], list[str]]:
    """Return the names of the columns, with units where they have some, and the units alone.

    The last line before the numbers that has as many cells as there are columns gives the names, or
    the units of the names in the line above it. Of several such lines it is the last that states a
    known unit or the time. No line is looked for behind one of another number of cells, unless that
    is a comment.

    Parameters
    ----------
    preamble : sequence of str
        The lines before the numbers, comments included, empty ones left out.
    dialect : Dialect
        How the numbers are divided.
    count : int
        Number of columns.

    Returns
    -------
    names : list of str, length count
        Empty strings if there are none.
    units : list of str, length count
        Empty strings where the file states none.
    """
    rows: list[list[str]] = []
    for line in reversed(preamble):
        cells = divided(line, dialect, count)
        if cells is not None:
            rows.append(cells)
        elif uncommented(line) == line.strip():
            break
    empty = [""] * count
    telling = [place for place, cells in enumerate(rows) if any(map(is_telling, cells))]
    place = telling[0] if telling else 0
    if place >= len(rows):
        return empty, empty
    cells = rows[place]
    names = rows[place + 1] if place + 1 < len(rows) else empty
    if is_of_units(cells, names):
        return names, [bare(cell).strip("-") for cell in cells]
    return cells, [parted(cell)[1] for cell in cells]


def is_telling(cell: str) -> bool:
    """Return whether a cell is a known unit, states one, or is a name of the time."""
    name, unit = parted(cell)
    return bool(unit_called(unit or bare(cell))) or name.casefold() in CLOCKS


def is_of_units(cells: Sequence[str], names: Sequence[str]) -> bool:
    """Return whether cells below names are units and nothing else, one known at least.

    N may be north as well, unless the name above is that of a force, or another unit is known.

    Examples
    --------
    >>> is_of_units(["s", "N", "°C"], ["t", "F", "T"]), is_of_units(["N", "V"], ["", ""])
    (True, False)
    """
    known = [unit_called(bare(cell)) is not None for cell in cells]
    sure = any(
        is_known and (cell != "N" or any(word in name.casefold() for word in OF_FORCES))
        for cell, name, is_known in zip(cells, names, known, strict=True)
    )
    # Of one in brackets it is clear that it is a unit, whichever.
    return sure and all(
        is_known or cell in ("", "-") or cell in OTHERS or bare(cell) != cell
        for cell, is_known in zip(cells, known, strict=True)
    )
