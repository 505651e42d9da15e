"""The measures that a "damping ratio" or "settling time" of the paper may mean.

All are turned into a damping ratio, larger is better: a settling time to p of the start is read as
that of an exponential decay, ζ = ln(1/p)/(ωn t). Not settled within the run is 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import numpy as np
import polars as pl
from numpy.typing import NDArray

from iva.simulation import Run
from iva.tables import Table

Curve = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Measure:
    """One measure of damping: a column of the summary, a sign for it, and a name for people."""

    column: str
    symbol: str
    label: str
    level: float | None = None

    def of(self, summary: pl.DataFrame) -> Curve:
        """Return it for each row as a damping ratio, NaN where it is not defined."""
        column = summary[self.column]
        if self.level is None:
            return column.fill_null(float("nan")).to_numpy()
        return (log(1.0 / self.level) / column).fill_null(0.0).to_numpy()


FIRST = Measure("damping_ratio_1", "ζ₁", "decrement, 1 cycle")
THREE = Measure("damping_ratio_3", "ζ₃", "decrement, 3 cycles")
TEN = Measure("damping_ratio_10", "ζ₁₀", "decrement, 10 cycles")
FIT = Measure("damping_ratio_fit", "fit", "fit of ln of the peaks")
TO_10 = Measure("settling_time_10", "t₁₀", "settling to 10 %", 0.10)
TO_5 = Measure("settling_time_5", "t₅", "settling to 5 %", 0.05)
TO_2 = Measure("settling_time_2", "t₂", "settling to 2 %", 0.02)

SETTLING = (TO_10, TO_5, TO_2)
MEASURES = (FIRST, THREE, TEN, FIT, *SETTLING)


def smoothed(curve: Curve, window: int = 5) -> Curve:
    """Return the running mean over a few neighbours: late measures are jagged in a free mass."""
    mean = pl.Series(curve).fill_nan(None).rolling_mean(window, center=True, min_samples=1)
    return mean.fill_null(float("nan")).to_numpy()


def best(at: Curve, curve: Curve) -> float:
    """Return where a curve is highest, NaN where it has no value above 0."""
    known = np.where(np.isnan(curve), 0.0, curve)
    return float(at[int(np.argmax(known))]) if known.max() > 0.0 else float("nan")


def within(value: float, low: float, high: float) -> bool | None:
    """Tell whether a number lies between two others; ``None`` if it is NaN."""
    return None if np.isnan(value) else bool(low <= value <= high)


def less(one: float, other: float) -> bool | None:
    """Tell whether a number is less than another; ``None`` if one is NaN, or both are infinite."""
    if np.isnan(one) or np.isnan(other) or (np.isinf(one) and np.isinf(other)):
        return None
    return bool(one < other)


def worse(one: float, other: float) -> bool | None:
    """Tell whether a damping is less than another; ``None`` if both are 0, or one undefined."""
    return None if one == other == 0.0 else less(one, other)


def mean_over(values: Curve) -> Curve:
    """Return the mean along the last axis, without NaN; NaN where there is nothing else."""
    known = ~np.isnan(values)
    count = known.sum(axis=-1)
    total = np.where(known, values, 0.0).sum(axis=-1)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def shown(value: float, digits: int) -> str:
    """Return a number with some decimals, a dash where there is none."""
    return f"{value:.{digits}f}" if np.isfinite(value) else "–"


def until_settled(run: Run) -> pl.DataFrame:
    """Return the impacts until |x| stays below 5 %, all if it does not."""
    settled = run.summary["settling_time_5"].item()
    return run.impacts if settled is None else run.impacts.filter(pl.col("time") <= settled)


def decrement(table: Table, cycles: int) -> Curve:
    """Return the damping ratio over some cycles for each point, NaN with fewer peaks."""
    ends = (
        table.envelope.filter(pl.col("peak").is_in([0, 2 * cycles]))
        .group_by("point", maintain_order=True)
        .agg(pl.col("amplitude"))
        .filter(pl.col("amplitude").list.len() == 2)
    )
    first, last = pl.col("amplitude").list.first(), pl.col("amplitude").list.last()
    known = ends.select("point", delta=(first / last).log() / cycles)
    points = table.summary.select("point")
    delta = points.join(known, on="point", how="left", maintain_order="left")["delta"]
    values = delta.fill_null(float("nan")).to_numpy()
    return values / np.sqrt(4.0 * np.pi**2 + values**2)


def by_measure(table: Table, cycles: Sequence[int]) -> dict[str, Curve]:
    """Return the damping of each point by every measure, and over further numbers of cycles."""
    windows = {f"decrement, {n} cycles": decrement(table, n) for n in cycles}
    decrements = {measure.label: measure.of(table.summary) for measure in MEASURES[:3]}
    later = {measure.label: measure.of(table.summary) for measure in MEASURES[3:]}
    return decrements | windows | later


def mean_size(values: pl.Series) -> float:
    """Return the mean of the sizes of some values, NaN without any."""
    sizes = values.abs().to_numpy()
    return float(sizes.mean()) if sizes.size else float("nan")


def percent(ratio: float) -> str:
    """Return a ratio in per cent, without decimals."""
    return f"{100.0 * ratio:.0f} %" if np.isfinite(ratio) else "–"
