"""The record that a sensor would have made of a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import polars as pl
from numpy.typing import NDArray

from iva.measured.filters import KINDS, passed
from iva.measured.records import Measured, Quantity
from iva.measured.stated import quantity_of
from iva.parameters import number, shown
from iva.sampling import whole
from iva.spelling import hint

if TYPE_CHECKING:
    from iva.simulation import Run

#: Points a sample on which the motion is filtered.
FINE = 16
#: Samples that are added on both sides while it is filtered.
BESIDE = 128
#: Corner of a filter over the sampling rate, by default.
CORNER = 0.42
#: Most samples of a record.
MOST = 2_000_000


def recorded(
    run: Run,
    rate_hz: float,
    quantity: Quantity,
    contact_time: float,
    filter: str | None,  # noqa: A002 (the word of the field)
    cutoff_hz: float | None,
    before: float,
    noise: float,
    seed: int,
) -> Measured:
    """Return the record of a run, as :meth:`iva.Run.recorded` says.

    Raises
    ------
    TypeError, ValueError
        As there.
    """
    quantity_of(quantity)
    rate = positive("rate_hz", rate_hz)
    contact = at_least_zero("contact_time", contact_time)
    quiet, sigma = at_least_zero("before", before), at_least_zero("noise", noise)
    whole("seed", seed, 0, 1 << 53)
    kind = "none" if filter is None else filter
    if kind not in KINDS:
        rule = f"{hint(str(kind), KINDS)}; give one of {', '.join(KINDS)}"
        raise ValueError(f"filter = {shown(filter)}: there is no such filter{rule}")
    corner = CORNER * rate if cutoff_hz is None else positive("cutoff_hz", cutoff_hz)
    if run.units.system != "si":
        raise ValueError(
            "recorded: lengths are in no unit of their own here; give primary.mass with stiffness "
            "or natural_frequency for SI units"
        )
    if quantity == "acceleration" and kind == "none" and contact * rate < 1:
        raise ValueError(
            f"contact_time = {contact:g}: without a filter a pulse falls between two samples; give "
            f"at least {1 / rate:.3g} s, or a filter"
        )
    begin, end = ends(run)
    count = int((end - begin + quiet) * rate * (1 + 1e-12)) + 1
    if not 16 <= count <= MOST:
        raise ValueError(
            f"rate_hz = {rate:g}: the record would have {count} samples; give a rate that makes 16 "
            f"to {MOST:.0e}"
        )
    first = begin - quiet
    step = 1 / rate / FINE
    ticks = np.arange(-BESIDE * FINE, (count + BESIDE) * FINE)
    fine: NDArray[np.float64] = (first + ticks * step).astype(np.float64)
    moved = motion(run, quantity, fine, begin, end)
    if quantity == "acceleration":
        moved += pulses(run, fine, max(contact, step))
    # The transform takes the end for the neighbour of the begin: lead from one to the other.
    back = np.cos(np.linspace(0.0, np.pi, BESIDE * FINE)) / 2
    moved = np.concatenate([moved, moved[0] + (moved[-1] - moved[0]) * (0.5 + back)])
    frequency = np.fft.rfftfreq(moved.size, step).astype(np.float64)
    filtered = np.fft.irfft(np.fft.rfft(moved) * passed(kind, frequency / corner), moved.size)
    values = filtered[BESIDE * FINE : (BESIDE + count) * FINE : FINE]
    values = values + sigma * np.random.default_rng(seed).standard_normal(count)
    return Measured(first + np.arange(count) / rate, values, quantity, name=quantity)


def ends(run: Run) -> tuple[float, float]:
    """Return the first and the last instant of a run, in s.

    Raises
    ------
    ValueError
        If it has ended early.
    """
    if run.summary["outcome"].item() != "finished":
        raise ValueError(
            f"recorded: the run ended early ({run.summary['outcome'].item()}); give one that "
            "finishes"
        )
    time = run.trajectory(2)["time"]
    return float(time[0]), float(time[-1])


def motion(
    run: Run, quantity: str, fine: NDArray[np.float64], begin: float, end: float
) -> NDArray[np.float64]:
    """Return a quantity of the structure at rising instants, impacts apart, shape (n,).

    Before the run the structure is at rest where the run begins; after it, as it ends.
    """
    inside = (fine >= begin) & (fine <= end)
    asked = fine[inside]
    frame = run.at(asked)
    if frame.height > asked.size:  # of several absorbers each has rows: the first one's will do
        frame = frame.filter(pl.col("absorber") == frame["absorber"][0])
    values: NDArray[np.float64] = frame[quantity].to_numpy()
    ahead = float(values[0]) if quantity == "displacement" else 0.0
    count = int(np.sum(fine < begin)), int(np.sum(fine > end))
    return np.concatenate([np.full(count[0], ahead), values, np.full(count[1], values[-1])])


def pulses(run: Run, fine: NDArray[np.float64], contact: float) -> NDArray[np.float64]:
    """Return the half sines that contacts leave in an acceleration, shape (n,).

    Each has the area of the jump of the structure's velocity, and its middle at the impact.
    """
    step = float(fine[1] - fine[0])
    made = np.zeros(fine.size)
    impacts = run.impacts
    jumps = (impacts["velocity_after"] - impacts["velocity_before"]).to_numpy()
    for time, jump in zip(impacts["time"].to_numpy(), jumps, strict=True):
        low = max(int((time - contact / 2 - fine[0]) / step) - 1, 0)
        high = min(int((time + contact / 2 - fine[0]) / step) + 3, fine.size)
        edges = fine[0] + (np.arange(low, high + 1) - 0.5) * step
        share = np.sin(np.pi * np.clip((edges - time) / contact, -0.5, 0.5)) / 2
        made[low:high] += jump * np.diff(share) / step
    return made


def positive(field: str, value: object) -> float:
    """Return a finite number greater than 0.

    Raises
    ------
    ValueError
        If it is not.
    """
    read = number(field, value)
    if not (read > 0 and math.isfinite(read)):
        raise ValueError(f"{field} = {read!r}: give a number greater than 0")
    return read


def at_least_zero(field: str, value: object) -> float:
    """Return a finite number, 0 or greater.

    Raises
    ------
    ValueError
        If it is not.
    """
    read = number(field, value)
    if not (read >= 0 and math.isfinite(read)):
        raise ValueError(f"{field} = {read!r}: give a number, 0 or greater")
    return read


__all__ = ["recorded"]
