"""A measured record of the structure: its samples in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from iva.measured.channels import Channel, measured, timed
from iva.measured.clocks import cut, rate, uniform
from iva.measured.files import channels_of
from iva.measured.soundness import check_values
from iva.measured.stated import SI, quantity_of, scale_of, sign_of, unit_for
from iva.parameters import shown
from iva.spelling import spell_checked

#: What sensors measure.
Quantity = Literal["acceleration", "velocity", "displacement"]


@spell_checked
@dataclass(init=False, frozen=True, slots=True, eq=False, repr=False)
class Measured:
    """A measured record of the structure's motion: samples at equal steps, in SI units.

    Offset, drift and hum of the sensor stay in it. :meth:`read` makes one from a file.

    Parameters
    ----------
    time : sequence of float, shape (n,)
        Instants in s on the record's clock, n ≥ 16, increasing by equal steps: none may be further
        than a tenth of a step from its place. They are kept as the first one and multiples of
        1/`sampling_hz`.
    values : sequence of float, shape (n,)
        In m/s², m/s or m; finite, not all the same, without dropouts. A dropout is a value that is
        held for 8 samples or more between two jumps.
    quantity : {"acceleration", "velocity", "displacement"}
        What was measured, positive in the direction of x.
    name : str, optional
        Name of the channel.
    source : str, optional
        File that it is from.
    unit : str, optional
        Unit in which the file has it, the SI unit by default; `values` are in SI units anyway.

    Attributes
    ----------
    time, values : ndarray, shape (n,)
        Read-only.
    sampling_hz : float
        Sampling rate in Hz: that of the straight line through the instants, or the nearest whole
        number if the instants fit it as well.

    Raises
    ------
    TypeError
        If an argument is of the wrong type.
    ValueError
        If the quantity is unknown, there are fewer than 16 samples, steps are not equal, or values
        are missing, not finite, all the same, or a dropout.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(100) / 50
    >>> Measured(time, np.cos(20 * time), "displacement")
    Measured(100 samples of displacement at 50 Hz from 0 to 1.98 s)
    """

    time: NDArray[np.float64]
    values: NDArray[np.float64]
    quantity: Quantity
    sampling_hz: float
    name: str
    source: str | None
    unit: str

    def __init__(
        self,
        time: ArrayLike,
        values: ArrayLike,
        quantity: Quantity,
        *,
        name: str = "",
        source: str | None = None,
        unit: str = "",
    ) -> None:
        known = quantity_of(quantity)
        for key, word in (("name", name), ("unit", unit), ("source", source or "")):
            if not isinstance(word, str):
                raise TypeError(f"{key} = {shown(word)}: give a word")
        instants, read = samples("time", time), samples("values", values)
        if len(instants) != len(read):
            raise ValueError(f"time has {len(instants)} samples, values {len(read)}: give as many")
        cut(instants, None, None)
        self._word(quantity, name, source, unit or SI[known])
        self._hold(*uniform(instants, None), read)

    def _word(self, *words: str | None) -> None:
        for key, word in zip(("quantity", "name", "source", "unit"), words, strict=True):
            object.__setattr__(self, key, word)

    def _hold(
        self, times: NDArray[np.float64], sampling_hz: float, values: NDArray[np.float64]
    ) -> None:
        check_values(self.name or "values", times, values)
        times.flags.writeable = values.flags.writeable = False
        object.__setattr__(self, "time", times)
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "sampling_hz", sampling_hz)

    @classmethod
    def _made(
        cls,
        times: NDArray[np.float64],
        sampling_hz: float,
        values: NDArray[np.float64],
        words: tuple[str, str, str | None, str],
    ) -> Measured:
        """Return a record at instants whose steps are known to be equal."""
        made = cls.__new__(cls)
        made._word(*words)
        made._hold(times, sampling_hz, values)
        return made

    @classmethod
    @spell_checked
    def read(
        cls,
        path: str | PathLike[str],
        column: str | int | None = None,
        *,
        time: str | int | None = None,
        unit: str | None = None,
        scale: float | None = None,
        quantity: Quantity | None = None,
        sampling_hz: float | None = None,
        direction: int = 1,
        begin: float | None = None,
        end: float | None = None,
    ) -> Measured:
        """Read a record from a file.

        Parameters
        ----------
        path : path-like
            Text with columns (``.csv``, ``.txt``, ``.tsv``, ``.dat``, ``.asc``; divided by commas,
            semicolons, tabs or blanks, with decimal point or comma, a preamble, comments after
            ``#``, ``%`` or ``//``), an accelerogram of PEER (``.at2``), of CSMIP or in the COSMOS
            format (``.v2``, ``.v2c``), a file of LabVIEW (``.lvm``, or ``.tdms``, which needs
            npTDMS), a MAT file up to version 7 (``.mat``; needs SciPy), a universal file (``.uff``,
            ``.unv``, datasets 58; needs pyuff), or ``.wav``. Text is what its content says,
            whichever of the ends of texts its name has. The page on the study file has a table.
        column : str or int, optional
            The channel: its name with or without its unit, or its index from 0 among all columns.
            It may be left out if only one does not hold the time.
        time : str or int, optional
            The column of the time, by default the one that has a unit of time or is called time. A
            time that states no unit is in s.
        unit : str, optional
            Unit of the values, such as ``"g"``, ``"mm/s"``; by default the one that the file
            states. If the file states another one, that is refused.
        scale : float, optional
            Factor on the numbers of the file, which then are in `unit`; 1 by default. Of a ``.wav``
            file it must be given: what full scale is in `unit`.
        quantity : {"acceleration", "velocity", "displacement"}, optional
            What was measured. It follows from the unit, and must agree with it.
        sampling_hz : float, optional
            Sampling rate in Hz, needed if there is no column of the time; time then begins at 0. If
            there is one, it must agree, but may be rounded so far that instants are the same.
        direction : {1, -1}, default 1
            Sign of the sensor's axis against the positive direction of x.
        begin, end : float, optional
            The record is cut to the samples from `begin` to `end`, in s on its clock.

        Raises
        ------
        TypeError
            If an argument is of the wrong type.
        ValueError
            If a column is unknown, the unit is stated nowhere, or something in the file cannot be
            used, as with :class:`Measured`; the message names the line where there is one.
        ImportError
            If the package is missing that reads the file: pip install 'iva-dynamics[export]'.
        iva.IvaError
            If the file cannot be read.

        Examples
        --------
        >>> iva.Measured.read("decay.csv", "a1", unit="g")  # doctest: +SKIP
        Measured(7000 samples of acceleration at 2000 Hz from 12.4 to 15.8995 s, 'a1 [g]')
        """
        if quantity is not None:
            quantity_of(quantity)
        hz = rate(sampling_hz)
        sign = sign_of(direction)
        source, channels = channels_of(path)
        channel = measured(column, channels)
        sensor = unit_for(channel, source, unit, quantity)
        times, own_rate = instants(channel, timed(time, channels, channel), hz, source)
        kept = cut(times, begin, end)
        factor = sign * scale_of(channel, source, scale)
        if not channel.is_si:
            factor *= sensor.factor
        with np.errstate(over="ignore"):  # what is too large then is refused
            values = channel.load()[kept] * factor
        words = (sensor.quantity, channel.name, source, sensor.text)
        if own_rate is not None:
            return cls._made(times[kept], own_rate, values, words)
        return cls._made(*uniform(times[kept], hz), values, words)

    def __reduce__(self) -> tuple[object, ...]:
        """Say how to make it again."""
        words = (self.quantity, self.name, self.source, self.unit)
        return (Measured._made, (self.time, self.sampling_hz, self.values, words))

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.time)

    def __repr__(self) -> str:
        """Show what was measured, how many samples there are, when, and the channel."""
        name = f", {self.name!r}" if self.name else ""
        return (
            f"Measured({len(self)} samples of {self.quantity} at {self.sampling_hz:.6g} Hz from "
            f"{self.time[0]:.6g} to {self.time[-1]:.6g} s{name})"
        )


def samples(field: str, values: ArrayLike) -> NDArray[np.float64]:
    """Return a copy of real numbers, shape (n,); masked ones and nulls are NaN.

    Raises
    ------
    TypeError
        If they are not a one-dimensional sequence of real numbers.
    """
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    try:
        found = np.asarray(values)
    except ValueError:  # ragged
        found = np.empty(0, dtype=object)
    if found.ndim != 1 or found.dtype.kind not in "iuf":
        raise TypeError(
            f"{field} = {shown(values)}: give a one-dimensional sequence of real numbers"
        )
    return found.astype(np.float64)


def instants(
    channel: Channel, clock: Channel | None, hz: float | None, source: str
) -> tuple[NDArray[np.float64], float | None]:
    """Return the instants of a channel in s, and their rate in Hz if they are made from it.

    Raises
    ------
    ValueError
        If the file has none, and no rate is given.
    """
    if clock is not None:
        return clock.load() * (clock.unit.factor if clock.unit else 1.0), None
    if channel.clock is not None:
        return channel.clock(), None
    if hz is None:
        raise ValueError(
            f"sampling_hz = None: {Path(source).name} has no column of time; give sampling_hz, or "
            "name the column with time"
        )
    return np.arange(channel.length) / hz, hz
