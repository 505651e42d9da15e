"""What a channel of a file drives: kind, unit and points of a recorded force."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from iva import _iva
from iva.measured.channels import Channel, found, measured, timed
from iva.measured.clocks import rate
from iva.measured.files import channels_of
from iva.measured.sensor_units import FORCES, OF_FORCES, Unit, unit_called
from iva.measured.stated import scale_of
from iva.parameters import shown

#: What the values of each kind are, for their units.
KINDS = {"force": "acceleration", "force_newtons": "force", "base_acceleration": "acceleration"}

#: The end of the name of a force, since N behind another name is north.
FORCE_IN = re.compile(rf".*(?:{'|'.join(OF_FORCES)}).*_(?P<unit>{'|'.join(FORCES)})", re.IGNORECASE)

#: Units for messages, in a spelling that is common.
COMMON = 'm/s^2, mm/s^2, g or Gal of acceleration, N or kN of force, or "1" for those of the scene'

#: The unit of numbers that are in those of the scene, and what stands for it in heads.
OF_SCENE, WITHOUT = "1", {"1", "-", ""}

#: Accelerations without a unit that are not larger may be in g: hardly an earthquake exceeds 2 g.
AS_G = 2.0

#: Those that are larger than this are hardly in m/s²: the ground never reached 5 g.
AS_MILLIMETRES = 50.0

#: Factors that make an earthquake weaker or stronger; others turn a unit into another one.
STRENGTHS = (0.1, 8.0)

#: Names of columns of accelerations.
ACCELERATION = re.compile(r"acc|beschl", re.IGNORECASE)


def record_of(
    path: object,
    kind: str | None,
    *,
    column: object = None,
    time: object = None,
    unit: object = None,
    scale: float | None = None,
    sampling_hz: object = None,
) -> _iva.Record:
    """Return the points of a recorded force in a file, in SI units if it or the caller states some.

    Parameters
    ----------
    path : path-like
        The file.
    kind : {"force", "force_newtons", "base_acceleration"}, optional
        What the values are.
    column, time : str or int, optional
        Names or indices of the columns.
    unit : str, optional
        Unit of the values.
    scale : float, optional
        Factor on the values, which is not applied here.
    sampling_hz : float, optional
        Sampling rate in Hz of a file without instants.

    Raises
    ------
    TypeError, ValueError, ImportError, iva.IvaError
        As :meth:`iva.Recorded.read`.
    """
    hz = rate(sampling_hz)
    source, channels = channels_of(path, of_force=True)
    channel, clock = columns_of(column, time, channels)
    sensor = unit_of_force(channel, source, unit)
    kind = kind_for(channel, sensor, kind)
    factor = sensor.factor if sensor and not channel.is_si else 1.0
    with np.errstate(over="ignore"):  # what is too large then is refused below
        values = channel.load() * factor
    if channel.is_fraction or scale is None:
        scale = scale_of(channel, source, scale)
    times = instants(channel, clock, hz, source)
    check_finite(source, times, values)
    if not stated_by(channel)[1] and unit is None and STRENGTHS[0] <= abs(scale) <= STRENGTHS[1]:
        check_size(float(np.abs(values).max(initial=0.0)) * abs(scale), source, channel, kind)
    is_metric = sensor is not None and sensor.quantity == "acceleration"
    return _iva.Record(times.tolist(), values.tolist(), kind, is_metric)


def columns_of(
    column: object, time: object, channels: Sequence[Channel]
) -> tuple[Channel, Channel | None]:
    """Return the channel of the values and that of their instants, if the file has one.

    Of two columns of which none is known to be the time, the first one is.

    Raises
    ------
    TypeError, ValueError
        If columns are unknown, or several may be meant.
    """
    has_clock = any(channel.is_time or channel.clock is not None for channel in channels)
    if len(channels) == 2 and not has_clock and time is None:
        first, second = channels
        if column is None or found("column", column, channels) is second:
            return second, first
    channel = measured(column, channels)
    return channel, timed(time, channels, channel)


def unit_of_force(channel: Channel, source: str, given: object) -> Unit | None:
    """Return the unit of the values, or none if they are in those of the scene or it is not known.

    Raises
    ------
    TypeError
        If the one given is no word.
    ValueError
        If it is unknown or not that of the file, or that of the file is unknown and none is given.
    """
    if given is not None and not isinstance(given, str):
        raise TypeError(f"unit = {shown(given)}: give a word")
    name = shown(channel.name) if channel.name else "its values"
    stated, text = stated_by(channel)
    if given is None:
        if not is_of_force(stated) and text not in WITHOUT:
            raise ValueError(
                f"unit = None: {Path(source).name} states unit {text!r} for {name}, which is none "
                f"of a force; give one, such as {COMMON}"
            )
        return stated
    unit = unit_called(given)
    if given != OF_SCENE and not is_of_force(unit):
        raise ValueError(f"unit = {given!r}: give a unit of a force, such as {COMMON}")
    if stated and not (unit and unit.is_same(stated)):
        raise ValueError(
            f"unit = {given!r}: the file says that {name} is in {stated.text}; leave unit out, or "
            "correct the file"
        )
    return unit


def stated_by(channel: Channel) -> tuple[Unit | None, str]:
    """Return the unit that a file states for a channel, if it is known, and its text."""
    suffix = FORCE_IN.fullmatch(channel.name)
    text = channel.stated or (suffix["unit"] if suffix else "")
    return channel.unit or unit_called(text), text


def is_of_force(unit: Unit | None) -> bool:
    """Return whether a unit is known, and that of a force or of an acceleration."""
    return unit is not None and unit.quantity in KINDS.values()


def kind_for(channel: Channel, unit: Unit | None, given: str | None) -> str:
    """Return what the values are: as given, or as the file tells.

    Raises
    ------
    ValueError
        If they are in a unit of something else.
    """
    if given is None:
        if unit is not None and unit.quantity == "force":
            return "force_newtons"
        return "base_acceleration" if channel.is_ground else "force"
    if unit is not None and given in KINDS and KINDS[given] != unit.quantity:
        fitting = " or ".join(f'"{kind}"' for kind, of in KINDS.items() if of == unit.quantity)
        raise ValueError(
            f'kind = "{given}": the values are in {unit.text}, a unit of {unit.quantity}; give '
            f"{fitting}"
        )
    return given


def check_finite(source: str, times: NDArray[np.float64], values: NDArray[np.float64]) -> None:
    """Check that no time and no value is missing.

    Raises
    ------
    ValueError
        If one is.
    """
    finite = np.isfinite(times) & np.isfinite(values)
    if not finite.all():
        lost, first = int(len(finite) - finite.sum()), int(np.argmin(finite))
        raise ValueError(
            f"{_iva.visible(source)}: {lost} of {len(finite)} points are missing or not finite, "
            f"the first is sample {first}; give a record without dropouts"
        )


def check_size(peak: float, source: str, channel: Channel, kind: str) -> None:
    """Check that the peak of accelerations without a unit is as large as in m/s².

    Those of the base are looked at, and forces in a column that is called an acceleration.

    Raises
    ------
    ValueError
        If they may be in g, or in mm/s² or cm/s².
    """
    if kind != "base_acceleration" and not (kind == "force" and ACCELERATION.search(channel.name)):
        return
    if not 0.0 < peak <= AS_G and not peak > AS_MILLIMETRES:
        return
    others = "g" if peak <= AS_G else "mm/s^2 or Gal"
    raise ValueError(
        f"unit = None: {Path(source).name} states no unit, and accelerations of up to {peak:.4g} "
        f'may be in m/s^2 or in {others}; give unit, or "1" for that of the scene, or write it '
        'behind the name of the column: "acceleration (g)"'
    )


def instants(
    channel: Channel, clock: Channel | None, hz: float | None, source: str
) -> NDArray[np.float64]:
    """Return the instants of a channel, in s where they have a unit.

    Raises
    ------
    ValueError
        If the file has none and no rate is given, or it has some and one is given; or if they are
        in a unit that is not known.
    """
    has_own = clock is not None or channel.clock is not None
    if has_own and hz is not None:
        raise ValueError(
            f"sampling_hz = {hz:.9g}: {Path(source).name} has instants of its own; leave it out"
        )
    if clock is not None:
        if clock.stated not in WITHOUT and not clock.is_time:
            raise ValueError(
                f"time: {clock.name!r} is in {clock.stated!r}; give a column in s, ms or us"
            )
        return clock.load() * (clock.unit.factor if clock.unit else 1.0)
    if channel.clock is not None:
        return channel.clock()
    if hz is None:
        raise ValueError(
            f"sampling_hz = None: {Path(source).name} has no column of time; give sampling_hz, or "
            "name the column with time"
        )
    return np.arange(channel.length) / hz
