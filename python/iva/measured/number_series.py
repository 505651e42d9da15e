"""One series of numbers written several a line, such as 8F10.5: the accelerogram of El Centro.

Such a block looks like a table of eight columns, in each of which every eighth sample would stand.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from iva.measured.channels import Channel
from iva.measured.clocks import evenly
from iva.measured.dialects import POINT, Dialect, is_comment
from iva.measured.fortran_blocks import Format, decimal, format_in, numbers_of
from iva.measured.headers import names_and_units
from iva.measured.sensor_units import unit_of

#: With fewer numbers a line, a text without names is taken for a table; with fewer than the second
#: number it is not looked through for pairs.
FEWEST_A_LINE, FEWEST_OF_PAIRS = 5, 4

#: A format stands within so many lines.
HEADER_LINES = 60

#: The step in the lines above the numbers: "dt = 0.02 s", "1559 points at 0.02 sec".
STEP = re.compile(
    r"\b(?:dt|delta t|step|intervals?(?: of)?|(?:points|values|spaced) at)\b[^\w.]{0,20}"
    r"(?P<step>\d{0,9}\.\d{1,20}|\d{1,9})\s*(?P<unit>ms(?:ec)?|s(?:ec)?)\b",
    re.IGNORECASE,
)
#: The unit there: "in g", "in units of cm/s^2", "unit: m/s^2".
UNIT = re.compile(
    r"\b(?:in(?:\s+units?)?|units?)(?:\s+of)?\b\s*[:=]?\s*(?P<unit>[^\s,;()]+)", re.IGNORECASE
)


def series_in(path: str, lines: Sequence[str]) -> list[Channel] | None:
    """Return the one channel of a text that is such a series, or none if it is another text.

    It is one if a line above the numbers states the format, or if five numbers or more stand in
    each line, less in the last one, without names above them and without a time before them.

    Parameters
    ----------
    path : str
        Name for messages.
    lines : sequence of str
        All of the file.

    Raises
    ------
    ValueError
        If the last line is full as well, so that it may be a table; or if it holds pairs.
    """
    found = formatted(path, lines) or unformatted(path, lines)
    if found is None:
        return None
    preamble, values = found
    step, unit = stated_in(preamble)
    return [
        Channel(
            name="",
            also=(),
            unit=unit_of(unit) if unit else None,
            stated=unit,
            length=len(values),
            load=values.copy,
            clock=None if step is None else partial(evenly, 0.0, step, len(values)),
        )
    ]


def formatted(path: str, lines: Sequence[str]) -> tuple[Sequence[str], NDArray[np.float64]] | None:
    """Return preamble and values of a text whose head states a format.

    Raises
    ------
    ValueError
        If a field is not a number; the message names the line.
    """
    for at, line in enumerate(lines[:HEADER_LINES]):
        form = format_in(line)
        if form is None or form.fields == 1:
            continue
        first = next((k for k in range(at + 1, len(lines)) if is_full(lines[k], form)), None)
        if first is None:
            return None
        block = filled_of(lines[first:])
        count = form.fields * (len(block) - 1) + len(form.cells(block[-1]))
        values = numbers_of(path, lines, first, count, form)
        check_pairs(path, values, form.fields)
        return lines[:first], values
    return None


def is_full(line: str, form: Format) -> bool:
    """Return whether a line is made of as many numbers as its format says."""
    cells = form.cells(line)
    return len(cells) == form.fields and all(map(POINT.fullmatch, cells))


def unformatted(
    path: str, lines: Sequence[str]
) -> tuple[Sequence[str], NDArray[np.float64]] | None:
    """Return the same of a text whose head states no format.

    Raises
    ------
    ValueError
        If it may be a table.
    """
    filled = [(at, line) for at, line in enumerate(lines) if not is_comment(line)]
    a_line = len(filled[-2][1].split()) if len(filled) > 2 else 0
    if a_line < FEWEST_OF_PAIRS:
        return None
    rows = [(at, line.split()) for at, line in filled]
    begins = (k for k, (_, row) in enumerate(rows) if is_row(row, a_line))
    if (begin := next(begins, None)) is None:
        return None
    first, block = rows[begin][0], [row for _, row in rows[begin:]]
    names, _ = names_and_units(filled_of(lines[:first]), Dialect(" ", "."), a_line)
    # Words of a title, with a year among them, are no names.
    if any(names) and not any(POINT.fullmatch(name.strip(",;")) for name in names):
        return None
    if not all(is_row(row, a_line) for row in block[:-1]):
        return None
    last = block[-1]
    if len(last) > a_line or not is_row(last, len(last)):
        return None
    values = np.array([decimal(word) for row in block for word in row])
    check_pairs(path, values, a_line)
    if a_line < FEWEST_A_LINE or increases(values[::a_line]):
        return None
    if len(last) == a_line:
        raise ValueError(
            f"{path}: its lines of {a_line} numbers may be one series or {a_line} columns; write "
            f"names above columns, {advice(lines[first], a_line)}"
        )
    return lines[:first], values


def advice(line: str, a_line: int) -> str:
    """Return how to write a series so that it is not taken for columns."""
    width = len(line.rstrip()) / a_line
    if not width.is_integer():
        return "or the series with one number a line"
    return f"or a line such as '({a_line}F{width:.0f}.5), dt = 0.02 s, in g' above a series"


def check_pairs(path: str, values: NDArray[np.float64], a_line: int) -> None:
    """Check that numbers, `a_line` in each line, are not pairs of a time and a value.

    Raises
    ------
    ValueError
        If they are.
    """
    if a_line % 2 == 0 and increases(values[::2]):
        raise ValueError(
            f"{path}: its lines seem to hold {a_line // 2} pairs of a time and a value; write one "
            "pair a line"
        )


def is_row(words: Sequence[str], count: int) -> bool:
    """Return whether words are so many numbers."""
    return len(words) == count and all(map(POINT.fullmatch, words))


def filled_of(lines: Sequence[str]) -> list[str]:
    """Return the lines that are not empty."""
    return [line for line in lines if line.strip()]


def increases(values: NDArray[np.float64]) -> bool:
    """Return whether values are those of a clock: three or more, each larger than the last."""
    return len(values) > 2 and bool((np.diff(values) > 0.0).all())


def stated_in(preamble: Sequence[str]) -> tuple[float | None, str]:
    """Return the step in s and the text of the unit that the lines above the numbers state.

    Examples
    --------
    >>> stated_in(["El Centro, 8F10.5", "1559 points at 0.02 sec, in units of g"])
    (0.02, 'g')
    >>> stated_in(["(6F12.6), dt = 5 ms, unit: cm/s^2"])
    (0.005, 'cm/s^2')
    """
    steps = [found for line in preamble for found in STEP.finditer(line)]
    seconds = {
        float(found["step"]) * (1e-3 if found["unit"][0] in "mM" else 1.0) for found in steps
    }
    words = [one["unit"].rstrip(".") for line in preamble for one in UNIT.finditer(line)]
    units = {word: unit for word in words if (unit := unit_of(word)) and unit.quantity != "time"}
    # What is stated in two ways is not known.
    step = seconds.pop() if len(seconds) == 1 else 0.0
    return step or None, next(iter(units)) if len(units) == 1 else ""
