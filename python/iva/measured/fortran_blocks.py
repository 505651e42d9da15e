"""Numbers in the fields of fixed width that Fortran writes, several a line: (8F10.5), (10I8)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from iva.measured.dialects import POINT

#: A format: how many fields a line has, the letter of the conversion, the width of a field.
FORMAT = re.compile(
    r"(?:(?<=\dP)|(?<![\w.]))(?P<fields>\d{1,3})(?:[FEGD](?P<width>\d{1,2})\.\d+|I(?P<whole>\d{1,2}))",
    re.IGNORECASE,
)


@dataclass(frozen=True, slots=True)
class Format:
    """A format of Fortran with one kind of field.

    Parameters
    ----------
    fields : int
        Numbers in a full line.
    width : int
        Characters of each.
    is_whole : bool
        They are whole numbers; others have a decimal point.
    """

    fields: int
    width: int
    is_whole: bool = False

    def lines(self, count: int) -> int:
        """Return how many lines so many numbers take."""
        return -(-count // self.fields)

    def cells(self, line: str) -> list[str]:
        """Return the fields of a line that are not empty at its end, without blanks around."""
        text = line.rstrip()
        return [text[at : at + self.width].strip() for at in range(0, len(text), self.width)]


def format_in(text: str) -> Format | None:
    """Return the first format that a text states, if there is one.

    Examples
    --------
    >>> format_in("in cm/sec2. (8f10.6)"), format_in("Format=(10I8)")
    (Format(fields=8, width=10, is_whole=False), Format(fields=10, width=8, is_whole=True))
    """
    found = FORMAT.search(text)
    if found is None:
        return None
    form = Format(int(found["fields"]), int(found["width"] or found["whole"]), bool(found["whole"]))
    return form if form.fields and form.width else None


def numbers_of(
    path: str, lines: Sequence[str], first: int, count: int, form: Format
) -> NDArray[np.float64]:
    """Return the numbers of a block of lines.

    Parameters
    ----------
    path : str
        Name for messages.
    lines : sequence of str
        All of the file.
    first : int
        Index of the first line of the block.
    count : int
        How many numbers there should be.
    form : Format
        How they are written.

    Returns
    -------
    ndarray, shape (count,)

    Raises
    ------
    ValueError
        If there are fewer, or a field is not a number.
    """
    if first + form.lines(count) > len(lines):
        raise ValueError(f"{path}: it ends within the {count} numbers that it should have")
    values = np.empty(count)
    for place in range(count):
        row, field = divmod(place, form.fields)
        if field == 0:
            cells = form.cells(lines[first + row])
        values[place] = value_of(path, first + row + 1, "".join(cells[field : field + 1]), form)
    return values


def value_of(path: str, number: int, text: str, form: Format) -> float:
    """Return the number in a field of the line with some number.

    Raises
    ------
    ValueError
        If it is none, or lacks the decimal point, without which Fortran puts one into it.
    """
    if POINT.fullmatch(text) and (form.is_whole or "." in text):
        return decimal(text)
    raise ValueError(
        f"{path}:{number}: {text[:40]!r} is not a number; there should be {form.fields} in this "
        f"line, each {form.width} characters wide"
    )


def decimal(text: str) -> float:
    """Return the number that a text spells with a decimal point, also as 1.5D-3."""
    return float(text.upper().replace("D", "E"))
