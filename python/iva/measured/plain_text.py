"""Text that studies read: a time and a value a line, or ``dt = …`` and values.

Such records are read by the reader of studies, which names line and column of what it refuses. What
their heads say of units is found here.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial

import numpy as np

from iva import _iva
from iva.measured.channels import Channel, is_clock
from iva.measured.dialects import POINT, Dialect
from iva.measured.headers import names_and_units
from iva.measured.sensor_units import parted, unit_of

#: What ends a line by itself, on old computers; studies do not know it.
ALONE = re.compile(rb"\r(?!\n)")

#: The first line of values at equal steps.
STEP = re.compile(r"dt(?:$|[\s=,;])", re.IGNORECASE)


def is_plain(contents: bytes) -> bool:
    """Return whether the reader of studies finds lines of text in the contents of a file."""
    try:
        contents.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return ALONE.search(contents) is None


def is_stepped(lines: Sequence[str]) -> bool:
    """Return whether lines hold a time step, ``dt = …``, and values."""
    first = next(filter(is_filled, lines), "")
    return STEP.match(first.strip()) is not None


def channels_of_stepped(name: str, lines: Sequence[str]) -> list[Channel]:
    """Return the one channel of a text with a time step and values.

    A comment above may state the unit, such as ``# acceleration [g]``.

    Raises
    ------
    ValueError
        If something in it cannot be used; the message names line and column.
    """
    first = next(at for at, line in enumerate(lines) if is_filled(line))
    word, stated = named(lines[:first], Dialect(" ", "."), 1)[0]
    unit = unit_of(stated) if stated else None
    record = _iva.read_record(name)
    values = np.array(record.values)
    return [
        Channel(
            name=word if unit else "",
            also=(parted(word)[0],) if unit else (),
            unit=unit,
            stated=stated if unit else "",
            length=len(values),
            load=values.copy,
            clock=partial(np.array, record.times),
        )
    ]


def channels_of_points(name: str, lines: Sequence[str]) -> list[Channel] | None:
    """Return time and value of a text of two columns with decimal points, or none if it is another.

    The first column is the time, unless names say that the second one is.

    Raises
    ------
    ValueError
        If something in it cannot be used; the message names line and column.
    """
    filled = [(at, line) for at, line in enumerate(lines) if is_filled(line)]
    # The second line that counts has numbers, whether the first is a header or not.
    if not filled or not all(is_point(line) for _, line in (filled[:2][-1], filled[-1])):
        return None
    first = next(at for at, line in filled if is_point(line))
    dialect = dialect_of(lines[first])
    if dialect.delimiter != "," and any("," in line for line in lines[first:]):
        return None  # a decimal comma that comes late
    heads = named(lines[:first], dialect, 2)
    units = [unit_of(stated) if stated else None for _, stated in heads]
    time, value = [is_clock(*head, unit) for head, unit in zip(heads, units, strict=True)]
    if value and not time:
        return None
    record = _iva.read_record(name)
    columns = [np.array(record.times), np.array(record.values)]
    return [
        Channel(
            name=word,
            also=(parted(word)[0],) if word else (),
            unit=unit,
            stated=stated,
            length=len(values),
            load=values.copy,
        )
        for (word, stated), unit, values in zip(heads, units, columns, strict=True)
    ]


def is_filled(line: str) -> bool:
    """Return whether a line counts: it is no comment and not empty."""
    return bool(line.strip()) and not line.lstrip().startswith("#")


def dialect_of(line: str) -> Dialect:
    """Return how a line of two numbers with decimal points is divided."""
    return Dialect(next((mark for mark in ";," if mark in line), " "), ".")


def is_point(line: str) -> bool:
    """Return whether a line is a time and a value with decimal points."""
    cells = dialect_of(line).cells(line)
    return len(cells) == 2 and all(map(POINT.fullmatch, cells))


def named(preamble: Sequence[str], dialect: Dialect, count: int) -> list[tuple[str, str]]:
    """Return name and text of the unit of each column, as the lines above the numbers have them."""
    filled = [line for line in preamble if line.strip()]
    return list(zip(*names_and_units(filled, dialect, count), strict=True))
