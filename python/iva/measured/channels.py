"""The channels of a file, and the one that is meant by a name or an index."""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from iva.measured.sensor_units import Unit
from iva.parameters import shown
from iva.spelling import hint

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: So many names are listed in a message.
FEW = 12

#: Columns with one of these names hold the time, whether they state a unit or not.
CLOCKS = {"t", "time", "zeit", "temps", "tempo", "tiempo", "x_value"}


@dataclass(frozen=True, slots=True)
class Channel:
    """One channel of a file; its numbers are read when asked for.

    Parameters
    ----------
    name : str
        As the file has it, with its unit; empty if the file has no names.
    also : tuple of str
        What it may be called as well: its name without the unit.
    unit : Unit or None
        The unit that the file states, if it is known.
    stated : str
        The text that stands where the unit should, known or not; empty if there is none.
    length : int
        Number of samples.
    load : callable
        Returns the numbers, shape (length,), in the unit of the file unless `is_si`.
    clock : callable, optional
        Returns the instants in s, shape (length,), of a channel that has its own.
    is_si : bool
        The reader has turned the numbers into SI units already.
    is_ground : bool
        The file is an accelerogram: it holds the motion of the ground.
    is_main : bool
        It is meant if none is named and no other one is main.
    is_fraction : bool
        The numbers are fractions of full scale, which the file does not state.
    """

    name: str
    also: tuple[str, ...]
    unit: Unit | None
    stated: str
    length: int
    load: Callable[[], NDArray[np.float64]]
    clock: Callable[[], NDArray[np.float64]] | None = None
    is_si: bool = False
    is_ground: bool = False
    is_main: bool = False
    is_fraction: bool = False

    @property
    def is_time(self) -> bool:
        """Whether it holds instants, by its unit or, without one, by its name."""
        return is_clock(self.name, self.stated, self.unit)


def is_clock(name: str, stated: str, unit: Unit | None) -> bool:
    """Return whether a channel holds instants, by its unit or, without one, by its name.

    Examples
    --------
    >>> is_clock("rig.Time", "", None), is_clock("Time", "V", None)
    (True, False)
    """
    if unit is not None:
        return unit.quantity == "time"
    return not stated and name.rpartition(".")[2].casefold() in CLOCKS


def listed(channels: Sequence[Channel]) -> str:
    """Return the names of some channels for a message, or their indices if they have none."""
    if not any(channel.name for channel in channels):
        most = len(channels) - 1
        return "columns without names, 0" + (f" to {most}" if most else "")
    names = [repr(channel.name) for channel in channels[:FEW]]
    more = f" and {len(channels) - FEW} more" if len(channels) > FEW else ""
    return ", ".join(names) + more


def found(field: str, key: object, channels: Sequence[Channel]) -> Channel:
    """Return the channel that a name or an index means.

    Parameters
    ----------
    field : str
        Name of the argument, for messages.
    key : str or int
        A name with or without its unit, or an index from 0.
    channels : sequence of Channel
        All of the file.

    Raises
    ------
    TypeError
        If the key is neither.
    ValueError
        If there is no such channel, or several have the name.
    """
    if isinstance(key, str):
        return named(field, key, channels)
    try:
        if isinstance(key, bool):
            raise TypeError
        index = operator.index(key)  # type: ignore[arg-type]  # asks whether it has one
    except TypeError:
        raise TypeError(
            f"{field} = {shown(key)}: give the name of a column, or its index"
        ) from None
    if not 0 <= index < len(channels):
        raise ValueError(
            f"{field} = {index}: give an index from 0 to {len(channels) - 1}; there is "
            f"{listed(channels)}"
        )
    return channels[index]


def named(field: str, name: str, channels: Sequence[Channel]) -> Channel:
    """Return the channel with a name, its full name before one without the unit."""
    wanted = " ".join(name.split())
    same = [channel for channel in channels if channel.name == wanted]
    same = same or [channel for channel in channels if wanted in channel.also]
    if wanted and len(same) == 1:
        return same[0]
    if wanted and same:
        places = ", ".join(str(channels.index(channel)) for channel in same)
        raise ValueError(f"{field} = {name!r}: columns {places} have this name, give an index")
    known = [channel.name for channel in channels] + [
        other for channel in channels for other in channel.also
    ]
    raise ValueError(
        f"{field} = {name!r}: no such column{hint(name, filter(None, known))}; there is "
        f"{listed(channels)}"
    )


def struct_of(channel: Channel) -> str:
    """Return the name of the struct that a channel of a MAT file is in, '' if in none."""
    return channel.name.rpartition(".")[0]


def measured(column: object, channels: Sequence[Channel]) -> Channel:
    """Return the channel of the sensor: the one that is named, else the only one or the main one.

    Raises
    ------
    TypeError, ValueError
        As :func:`found`; or if it holds the time, or none is named and there are several.
    """
    if column is not None:
        channel = found("column", column, channels)
        if channel.is_time:
            raise ValueError(f"column = {shown(column)}: this column holds the time, not a motion")
        return channel
    sensors = [channel for channel in channels if not channel.is_time]
    sensors = [channel for channel in sensors if channel.is_main] or sensors
    if len(sensors) != 1:
        raise ValueError(f"column = None: name one column; there is {listed(channels)}")
    return sensors[0]


def timed(time: object, channels: Sequence[Channel], channel: Channel) -> Channel | None:
    """Return the channel of the instants of another: the one named, else the only one, or none.

    Raises
    ------
    TypeError, ValueError
        As :func:`found`; or if it states a unit of something else or is of another length, or none
        is named and there are several.
    """
    if time is None:
        clocks = [one for one in channels if one.is_time and one.length == channel.length]
        # Of a struct in a MAT file it is the one beside the values.
        beside = [one for one in clocks if struct_of(one) == struct_of(channel)]
        clocks = beside or clocks
        if len(clocks) > 1:
            raise ValueError(f"time = None: name one column; there is {listed(clocks)}")
        return clocks[0] if clocks else None
    clock = found("time", time, channels)
    if clock is channel:
        raise ValueError(f"time = {shown(time)}: this is the column of the values")
    if clock.stated and not clock.is_time:
        raise ValueError(
            f"time = {shown(time)}: this column is in {clock.stated!r}; give one in s, ms or us"
        )
    if clock.length != channel.length:
        raise ValueError(
            f"time = {shown(time)}: it has {clock.length} samples, but {channel.name!r} has "
            f"{channel.length}"
        )
    return clock
