"""Text with columns of numbers: CSV in its many dialects, and what programs of recorders write."""

from __future__ import annotations

import codecs
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from iva.measured.channels import Channel
from iva.measured.dialects import Layout, is_comment, layouts
from iva.measured.headers import is_telling, names_and_units
from iva.measured.sensor_units import parted, unit_of

#: Byte order marks and the encodings that they announce.
MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}


def lines_of(path: str, contents: bytes) -> list[str]:
    """Return the lines of a text in UTF-8, UTF-16 with its mark, or latin-1.

    Raises
    ------
    ValueError
        If it is none.
    """
    # Not splitlines: it takes some letters of latin-1 for ends of lines.
    return re.split(r"\r\n|\r|\n", decoded(path, contents))


def channels_of_text(path: str, lines: Sequence[str]) -> list[Channel]:
    """Return the columns of a text.

    Parameters
    ----------
    path : str
        Name for messages.
    lines : sequence of str
        All of the file.

    Raises
    ------
    ValueError
        If there are no columns of numbers, or a line among them is none; the message names it.
    """
    filled = [(number, line) for number, line in enumerate(lines, 1) if not is_comment(line)]
    fitting = layouts([line for _, line in filled])
    if not fitting:
        raise ValueError(f"{path}: no columns of numbers in it; give times and values")
    layout = fitting[0]
    begin, preamble = begins(path, lines, filled, layout)
    if rivals := ambiguous(fitting):
        layout = told(path, rivals, preamble, filled[begin:])
        begin, preamble = begins(path, lines, filled, layout)
    rows = filled[begin:]
    names, units = names_and_units(preamble, layout.dialect, layout.count)
    block = Block(path, layout, rows)
    return [
        Channel(
            name=name,
            also=(parted(name)[0],) if name else (),
            unit=unit_of(unit) if unit else None,
            stated=unit,
            length=len(rows),
            load=partial(block.column, column),
        )
        for column, (name, unit) in enumerate(zip(names, units, strict=True))
    ]


def decoded(path: str, contents: bytes) -> str:
    """Return the text of a file.

    Raises
    ------
    ValueError
        If it is none.
    """
    encoding = next((MARKS[mark] for mark in MARKS if contents.startswith(mark)), "utf-8")
    try:
        text = contents.decode(encoding)
    except UnicodeDecodeError as error:
        if encoding != "utf-8":
            raise ValueError(f"{path}: damaged text ({encoding}); give text in UTF-8") from error
        text = contents.decode("latin-1")
    if "\0" in text:
        raise ValueError(f"{path}: a binary file; give text in UTF-8")
    return text


def begins(
    path: str, lines: Sequence[str], filled: Sequence[tuple[int, str]], layout: Layout
) -> tuple[int, list[str]]:
    """Return the place of the first line of numbers that another follows, and the lines before it.

    Raises
    ------
    ValueError
        If there is none.
    """
    before = False
    for place, (_, line) in enumerate(filled):
        now = layout.is_data(line)
        if before and now:
            first = filled[place - 1][0]
            return place - 1, [line for line in lines[: first - 1] if line.strip()]
        before = now
    raise ValueError(f"{path}: no two lines of numbers in a row; give times and values")


def ambiguous(fitting: Sequence[Layout]) -> tuple[Layout, Layout] | None:
    """Return the layouts in which commas divide columns and are decimal marks, if both may be.

    ``0,5`` may be two columns or one, ``0,5 x 0,5`` three columns in two ways.
    """
    words = fitting[0].count - len(fitting[0].numeric)
    equal = [one for one in fitting if one.count - len(one.numeric) == words]
    dividing = [one for one in equal if one.dialect.delimiter == ","]
    decimal = [one for one in equal if one.dialect.decimal == "," and one not in dividing]
    return (dividing[0], decimal[0]) if dividing and decimal else None


def told(
    path: str,
    rivals: tuple[Layout, Layout],
    preamble: Sequence[str],
    rows: Sequence[tuple[int, str]],
) -> Layout:
    """Return the one of two ambiguous layouts that the header or the digits tell.

    Raises
    ------
    ValueError
        If neither does.
    """
    for layout in rivals:
        names, units = names_and_units(preamble, layout.dialect, layout.count)
        if any(map(is_telling, names)) or any(map(unit_of, units)):
            return layout
    # No whole number is written as 040588.
    if any(re.search(r"\d,0\d", line) for _, line in rows):
        return rivals[1]
    raise ValueError(
        f"{path}: its commas may divide columns or be decimal marks; write it with semicolons "
        "between columns, or with names above them"
    )


@dataclass(frozen=True, slots=True)
class Block:
    """The lines of numbers.

    Parameters
    ----------
    path : str
        Name for messages.
    layout : Layout
        How they are divided.
    rows : sequence of (int, str)
        Number and text of each line.
    """

    path: str
    layout: Layout
    rows: Sequence[tuple[int, str]]

    def column(self, index: int) -> NDArray[np.float64]:
        """Return a column, shape (n,), NaN where a value is missing.

        Raises
        ------
        ValueError
            If a line has another number of cells, or a cell is not a number.
        """
        dialect, count = self.layout.dialect, self.layout.count
        values = np.empty(len(self.rows))
        for place, (number, line) in enumerate(self.rows):
            cells = dialect.cells(line)
            if len(cells) != count:
                raise ValueError(
                    f"{self.path}:{number}: this line has {len(cells)} columns, those before it "
                    f"have {count}; give as many in each"
                )
            values[place] = dialect.value(f"{self.path}:{number}", cells[index])
        return values
