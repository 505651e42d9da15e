"""The dialect of a text of columns: what separates them, and which mark is the decimal one."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from csv import reader
from dataclasses import dataclass

#: Lines that begin with one of these hold no numbers.
COMMENTS = ("#", "%", "//")

#: What a missing value is written as; it counts as a number, which a later check refuses.
MISSING = {
    "",
    "nan",
    "n/a",
    "na",
    "null",
    "none",
    "-",
    "--",
    "inf",
    "+inf",
    "-inf",
    "1.#qnan",
    "1.#inf",
    "#n/a",
    "#nv",
}

#: Digits with the decimal mark M; a comma has digits on both sides, for "1, 2" are two columns.
POINT = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?")
COMMA = re.compile(r"[+-]?\d+(?:,\d+)?(?:[eEdD][+-]?\d+)?")

#: So many lines decide.
SAMPLE = 400


@dataclass(frozen=True, slots=True)
class Dialect:
    r"""How a line is divided into cells, and what a number looks like.

    Parameters
    ----------
    delimiter : str
        ``";"``, ``"\t"``, ``","``, or ``" "`` for any number of blanks.
    decimal : {".", ","}
        The decimal mark.
    ends : bool
        Each line ends with a delimiter, behind which there is no column.
    """

    delimiter: str
    decimal: str
    ends: bool = False

    def cells(self, line: str) -> list[str]:
        """Return the cells of a line, without blanks and quotes around them."""
        if self.delimiter == " ":
            return [cell.strip('"') for cell in line.split()]
        if '"' in line:
            cells = next(reader([line], delimiter=self.delimiter, skipinitialspace=True), [""])
        else:
            cells = line.split(self.delimiter)
        if self.ends and len(cells) > 1 and not cells[-1].strip():
            cells.pop()
        return [cell.strip() for cell in cells]

    def is_number(self, cell: str) -> bool:
        """Return whether a cell holds a number, or says that it is missing."""
        pattern = COMMA if self.decimal == "," else POINT
        return pattern.fullmatch(cell) is not None or cell.casefold() in MISSING

    def value(self, place: str, cell: str) -> float:
        """Return the number of a cell, NaN if it says that it is missing.

        Parameters
        ----------
        place : str
            File and line for messages.
        cell : str
            The text of the cell.

        Raises
        ------
        ValueError
            If it is not a number.
        """
        if not self.is_number(cell):
            raise ValueError(
                f"{place}: {cell[:40]!r} is not a number; give numbers such as "
                f"-0{self.decimal}5e-3, with the same decimal mark in all lines"
            )
        if cell.casefold() in MISSING:
            return float("nan")
        # Fortran writes 1.5D-3.
        return float(cell.replace(self.decimal, ".").replace("D", "E").replace("d", "e"))


#: In the order in which equally good ones are taken.
DIALECTS = [
    Dialect(delimiter, decimal) for delimiter in ("\t", ";", ",", " ") for decimal in (".", ",")
]


@dataclass(frozen=True, slots=True)
class Layout:
    """A dialect and the columns that a text has in it.

    Parameters
    ----------
    dialect : Dialect
        How lines are divided.
    count : int
        Number of columns.
    numeric : tuple of int
        Those that hold numbers.
    fitting : int
        Number of cells in them that do, of the lines that were looked at.
    """

    dialect: Dialect
    count: int
    numeric: tuple[int, ...]
    fitting: int

    @property
    def rank(self) -> tuple[int, int, int]:
        """Less is better: few columns of words, then many of numbers, then few other cells."""
        return (self.count - len(self.numeric), -len(self.numeric), -self.fitting)

    def is_data(self, line: str) -> bool:
        """Return whether a line has numbers where it should, at least one that is not missing."""
        cells = self.dialect.cells(line)
        if len(cells) != self.count:
            return False
        numbers = [cells[column] for column in self.numeric]
        return all(map(self.dialect.is_number, numbers)) and any(
            cell.casefold() not in MISSING for cell in numbers
        )


def is_comment(line: str) -> bool:
    """Return whether a line holds no numbers: a comment, or nothing."""
    return not line.strip() or line.lstrip().startswith(COMMENTS)


def layouts(lines: Sequence[str]) -> list[Layout]:
    """Return the layouts that fit the lines of a text, the best first; none if it has no numbers.

    Parameters
    ----------
    lines : sequence of str
        Those that are no comments, preamble included.
    """
    # Preambles stand at the begin.
    body = lines[len(lines) // 2 :]
    sample = body[:: max(1, len(body) // SAMPLE)]
    found = [layout for dialect in DIALECTS for layout in laid_out(dialect, sample)]
    return sorted(found, key=lambda layout: layout.rank)


def laid_out(dialect: Dialect, sample: Sequence[str]) -> Iterator[Layout]:
    """Give the layout of some lines in a dialect, if they have columns of numbers in it."""
    rows = [dialect.cells(line) for line in sample]
    if not rows:
        return
    count = Counter(map(len, rows)).most_common(1)[0][0]
    even = [row for row in rows if len(row) == count]
    if 2 * len(even) <= len(rows):
        return
    if dialect.delimiter in ";,\t" and count > 1 and all(not row[-1] for row in even):
        dialect = Dialect(dialect.delimiter, dialect.decimal, ends=True)
        count -= 1
    if dialect.delimiter != " " and count == 1:
        if dialect.ends:  # one column, each line closed by a delimiter
            yield from columns_of(dialect, even, count)
        return  # else that of blanks, which needs none
    yield from columns_of(dialect, even, count)


def columns_of(dialect: Dialect, rows: Sequence[Sequence[str]], count: int) -> Iterator[Layout]:
    """Give the layout of rows if at least one column is made of numbers for the most part."""
    numeric = []
    fitting = 0
    for column in range(count):
        cells = [row[column] for row in rows]
        numbers = sum(map(dialect.is_number, cells))
        given = any(cell.casefold() not in MISSING for cell in cells)
        if given and 2 * numbers >= len(cells):
            numeric.append(column)
            fitting += numbers
    if numeric:
        yield Layout(dialect, count, tuple(numeric), fitting)
