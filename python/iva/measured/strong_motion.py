"""Processed strong-motion records, volume 2: those of CSMIP, and those in the COSMOS format.

Both are text with blocks of numbers in fields of fixed width. A line above each block says how many
numbers follow, of what, in which unit and format. CSMIP states the step there as well. In the
COSMOS format (version 1.20, 2001) it stands in ms among the real numbers of the header: number 62,
and number 34 for the step of the recorder.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from iva.measured.channels import Channel
from iva.measured.clocks import evenly
from iva.measured.dialects import POINT
from iva.measured.fortran_blocks import Format, format_in, numbers_of
from iva.measured.sensor_units import unit_of

#: "  800 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)".
CSMIP = re.compile(
    r"\s*(?P<count>\d{1,9})\s+points of (?P<what>accel|veloc|displ)\w*\s+data\s+equally spaced at"
    r"\s*(?P<step>[\d.]{1,20})\s*sec\.?,?\s*(?:(?:in|\(?units?:)\s+(?P<unit>[^\s()]+))?.*",
    re.IGNORECASE,
)
#: "  800 acceleration pts, approx 4 secs, units=cm/sec2 (04), Format=(8F10.5)".
COSMOS = re.compile(
    r"\s*(?P<count>\d{1,9})\s+(?P<what>accel|veloc|displ)\w*\s+pts,.*?"
    r"units\s*=\s*(?P<unit>[^\s(,]+).*?format\s*=.*",
    re.IGNORECASE,
)
#: "  100 Real-header values follow on 17 lines, Format= (6F13.6)".
REALS = re.compile(
    r"\s*(?P<count>\d{1,9})\s+real-header\s+(?:values|lines)\s+follow.*", re.IGNORECASE
)
#: A channel within a file of several: "Chan  1: 360 Deg", "Sta Chan   1: 90 deg".
CHANNEL = re.compile(r"\bchan(?:nel)?\s+(?P<number>\d+):", re.IGNORECASE)

#: Places of the step in ms among the real numbers of a COSMOS header, the better one first.
STEPS = (61, 33)

#: The format of volume 2 of CSMIP where the line does not state it.
VOLUME_2 = Format(8, 10)

#: What a block holds.
QUANTITIES = {"accel": "acceleration", "veloc": "velocity", "displ": "displacement"}


@dataclass(frozen=True, slots=True)
class Block:
    """The numbers of one channel in one quantity.

    Parameters
    ----------
    path : str
        Name of the file for messages.
    lines : sequence of str
        All of the file.
    first : int
        Index of the first line of numbers.
    count : int
        How many there are.
    form : Format
        How they are written.
    step : float
        Seconds between them.
    """

    path: str
    lines: Sequence[str]
    first: int
    count: int
    form: Format
    step: float

    def values(self) -> NDArray[np.float64]:
        """Return the numbers, shape (count,)."""
        return numbers_of(self.path, self.lines, self.first, self.count, self.form)

    def times(self) -> NDArray[np.float64]:
        """Return the instants in s, shape (count,)."""
        return evenly(0.0, self.step, self.count)


def channels_of_strong_motion(path: str, lines: Sequence[str]) -> list[Channel]:
    """Return the blocks of a record of CSMIP or COSMOS, ``acceleration [cm/sec2]`` and so on.

    In a file of several channels the names begin with ``chan 1``, ``chan 2``, … Accelerations are
    the main channels.

    Raises
    ------
    ValueError
        If it is of volume 1, or something in it cannot be used; the message names the line.
    """
    found = list(blocks(path, lines))
    if not found:
        raise ValueError(
            f"{path}: a strong-motion record that was not processed (volume 1); give that of "
            "volume 2, with points of accel data equally spaced"
        )
    several = len({number for number, _, _, _ in found}) > 1
    return [
        Channel(
            name=f"{name} [{unit}]" if unit else name,
            also=(name,),
            unit=unit_of(unit),
            stated=unit,
            length=block.count,
            load=block.values,
            clock=block.times,
            is_ground=quantity == "acceleration",
            is_main=quantity == "acceleration",
        )
        for number, quantity, unit, block in found
        for name in [f"chan {number} {quantity}" if several else quantity]
    ]


def blocks(path: str, lines: Sequence[str]) -> Iterator[tuple[str, str, str, Block]]:
    """Give the blocks of a file: number of the channel, quantity, unit, and the numbers.

    Raises
    ------
    ValueError
        If a line above a block does not state what is needed.
    """
    at, number = 0, ""
    reals: NDArray[np.float64] = np.empty(0)
    while at < len(lines):
        line = lines[at]
        at += 1
        if found := CHANNEL.search(line):
            number = found["number"]
        if found := REALS.fullmatch(line):
            form = form_of(path, at, line)
            reals = numbers_of(path, lines, at, int(found["count"]), form)
            at += form.lines(len(reals))
        elif found := CSMIP.fullmatch(line) or COSMOS.fullmatch(line):
            stated_step = found.groupdict().get("step")
            form = VOLUME_2 if stated_step and not format_in(line) else form_of(path, at, line)
            step, count = step_of(stated_step, reals), int(found["count"])
            if step is None or count < 2:
                what = "the step between samples" if count > 1 else "two numbers or more"
                raise ValueError(f"{path}:{at}: {what} is missing; give a processed record")
            unit = (found["unit"] or "").rstrip(".,")
            quantity = QUANTITIES[found["what"].lower()]
            yield number, quantity, unit, Block(path, lines, at, count, form, step)
            at += form.lines(count)


def form_of(path: str, number: int, line: str) -> Format:
    """Return the format that the line with some number states.

    Raises
    ------
    ValueError
        If it states none.
    """
    if (form := format_in(line)) is None:
        raise ValueError(f"{path}:{number}: no format such as (8F10.5) in this line; state it")
    return form


def step_of(stated: str | None, reals: NDArray[np.float64]) -> float | None:
    """Return the seconds between samples: as stated, or from the header of COSMOS, if known."""
    if stated is not None:
        return float(stated) if POINT.fullmatch(stated) and float(stated) > 0.0 else None
    known = (float(reals[place]) for place in STEPS if place < len(reals))
    # What is unknown is negative there.
    return next((step * 1e-3 for step in known if step > 0.0), None)
