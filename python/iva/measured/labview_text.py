"""LabVIEW measurement files (.lvm): names, units and the step stand in their heads.

By National Instruments' specification of the format a head is made of tags with their values,
divided by a separator, up to a line ``***End_of_Header***``. The head of the file is followed by
segments, each with a head, a line of names and the numbers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from iva.measured.channels import Channel
from iva.measured.clocks import evenly
from iva.measured.dialects import POINT, Dialect
from iva.measured.fortran_blocks import decimal
from iva.measured.sensor_units import parted, unit_of

#: What ends a head.
END = "***End_of_Header***"

#: Tags of the head of a file.
SEPARATOR, DECIMAL = "Separator", "Decimal_Separator"

#: The columns of the abscissa and of remarks.
ABSCISSA, REMARKS = "X_Value", "Comment"

#: What six digits round a number by, over the number.
ROUNDED = 1e-5


@dataclass(frozen=True, slots=True)
class Segment:
    """A segment of an LVM file.

    Parameters
    ----------
    path : str
        Name of the file for messages.
    lines : sequence of str
        All of the file.
    first : int
        Index of the first line of numbers.
    dialect : Dialect
        How lines are divided.
    tags : dict of str to list of str
        The head: the values of each tag, one for each channel.
    """

    path: str
    lines: Sequence[str]
    first: int
    dialect: Dialect
    tags: dict[str, list[str]]

    def tag(self, name: str, index: int) -> str:
        """Return the value of a tag for a channel, '' if there is none."""
        values = self.tags.get(name, [])
        return values[index] if index < len(values) else ""

    def number(self, name: str, index: int) -> float:
        """Return the value of a tag for a channel as a number.

        Raises
        ------
        ValueError
            If it is none.
        """
        text = self.tag(name, index)
        value = (
            decimal(point)
            if POINT.fullmatch(point := text.replace(self.dialect.decimal, "."))
            else math.nan
        )
        if not math.isfinite(value):
            raise ValueError(f"{self.path}: {name} = {text!r} of channel {index}: give a number")
        return value

    def values(self, column: int, count: int) -> NDArray[np.float64]:
        """Return the numbers of a column, shape (count,).

        Raises
        ------
        ValueError
            If there are fewer, or a cell is not a number.
        """
        if self.first + count > len(self.lines):
            raise ValueError(f"{self.path}: it ends within the {count} samples that it states")
        values = np.empty(count)
        for place in range(count):
            where = f"{self.path}:{self.first + place + 1}"
            values[place] = self.dialect.value(where, self.cell(place, column))
        return values

    def cell(self, place: int, column: int) -> str:
        """Return a cell of the numbers, '' if its line has fewer."""
        cells = self.dialect.cells(self.lines[self.first + place])
        return cells[column] if column < len(cells) else ""

    def times(self, index: int, abscissa: int, count: int) -> NDArray[np.float64]:
        """Return the instants of a channel in s, shape (count,): those of its head.

        Raises
        ------
        ValueError
            If the column of the abscissa has others, beyond what six digits round them by.
        """
        step = self.number("Delta_X", index)
        times = evenly(self.number("X0", index), step, count)
        if self.first >= len(self.lines) or not self.cell(0, abscissa):
            return times
        away = np.abs(self.values(abscissa, count) - times)
        if not (away <= 0.5 * abs(step) + ROUNDED * np.abs(times)).all():
            raise ValueError(
                f"{self.path}: X_Value of channel {index} is up to {away.max():.4g} s away from X0 "
                "and Delta_X; save it as text with a column of time"
            )
        return times

    def channel(self, index: int, column: int, abscissa: int, name: str) -> Channel:
        """Return a channel: the one with some index, whose numbers stand in some column.

        Raises
        ------
        ValueError
            If its abscissa is not the time, or a number of the head cannot be used.
        """
        if self.tag("X_Dimension", index) not in ("", "Time"):
            dimension = self.tag("X_Dimension", index)
            raise ValueError(
                f"{self.path}: X_Dimension = {dimension!r} of {name!r}: give a record over Time"
            )
        count = max(int(self.number("Samples", index)), 0)
        label = self.tag("Y_Unit_Label", index)
        stated = label if unit_of(label) else parted(name)[1] or label
        return Channel(
            name=name,
            also=(parted(name)[0],),
            unit=unit_of(stated) if stated else None,
            stated=stated,
            length=count,
            load=partial(self.values, column, count),
            clock=partial(self.times, index, abscissa, count),
        )


def channels_of_labview_text(path: str, lines: Sequence[str]) -> list[Channel]:
    """Return the channels of an LVM file with one segment.

    Raises
    ------
    ValueError
        If it has several segments or none with a head, or something in it cannot be used.
    """
    ends = [at for at, line in enumerate(lines) if line.startswith(END)]
    if len(ends) != 2 or ends[1] + 1 >= len(lines):
        raise ValueError(
            f"{path}: an LVM file with {max(len(ends) - 1, 0)} segments that have a head; save it "
            "with one"
        )
    said = [line for line in lines[: ends[0]] if line.startswith(SEPARATOR)]
    delimiter = said[0][len(SEPARATOR) : len(SEPARATOR) + 1] if said else "\t"
    head = tags_of(lines[: ends[0]], delimiter)
    dialect = Dialect(delimiter, head[DECIMAL][0] if DECIMAL in head else ".")
    segment = Segment(
        path, lines, ends[1] + 2, dialect, tags_of(lines[ends[0] + 1 : ends[1]], delimiter)
    )
    channels: list[Channel] = []
    abscissa = 0
    for column, name in enumerate(dialect.cells(lines[ends[1] + 1])):
        if name == ABSCISSA:
            abscissa = column  # of the channels behind it
        elif name not in (REMARKS, ""):
            channels.append(segment.channel(len(channels), column, abscissa, name))
    if not channels:
        raise ValueError(f"{path}: an LVM file without names of channels; save it anew")
    return channels


def tags_of(lines: Sequence[str], delimiter: str) -> dict[str, list[str]]:
    """Return the tags of a head with their values."""
    rows = [[cell.strip() for cell in line.split(delimiter)] for line in lines]
    return {row[0]: row[1:] for row in rows if row[0] and len(row) > 1}
