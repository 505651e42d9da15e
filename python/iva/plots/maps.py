"""A column of the summary over two swept parameters, as a map."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from iva import _iva
from iva.parameters import number, shown
from iva.plots.arguments import (
    Numbers,
    checked_table,
    frame_of,
    numeric,
    once,
    swept_key,
)
from iva.plots.axis_units import ROUNDING, colour_bar, in_millimetres, name_axis
from iva.plots.labels import judgement, of_column, symbol_of
from iva.plots.legends import legend_above
from iva.plots.neighbours import checked_window, medians
from iva.plots.styles import drawing_on
from iva.spelling import spell_checked
from iva.tables import Table

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

#: The ridge is that of medians over so many points along each side of a window …
STEADY = 5
#: … where the grid has at least so many values each way: fewer are no neighbours.
FEWEST = 8
#: Begins of the names of columns of which the smallest is the best.
SMALL = ("settling_time_", "residual_amplitude", "amplitude_")


@spell_checked
def heatmap(
    table: Table,
    value: str,
    *,
    x: str | None = None,
    y: str | None = None,
    best: Literal["max", "min", "none"] | None = None,
    limits: tuple[float | None, float | None] | Literal["robust", "all"] = "robust",
    median_of: int = 1,
    ax: Axes | None = None,
) -> Axes:
    """Draw a column of the summary over two swept parameters, with the ridge of the optimum.

    Parameters
    ----------
    table : Table
        Tables of a grid over two parameters.
    value : str
        The column to draw. Where it is null the map is hatched in grey.
    x : str, optional
        The parameter across; by default that of the two swept ones which comes first.
    y : str, optional
        The parameter up; by default the other one.
    best : {"max", "min", "none"}, optional
        Whether the ridge joins, for each x, the y of the largest or of the smallest value; "none"
        for no ridge. By default the column decides: of damping ratios and `reduction` the largest
        is the best, of settling times, `residual_amplitude` and amplitudes the smallest, and others
        have no ridge. So that luck at single points does not make it zigzag, it is steadied where
        the grid has at least 8 values each way, and its legend says so: the best of the medians of
        5 × 5 neighbours, and of that the running median over 5 values across. That of a column of
        :func:`iva.robust` is left as it is: its neighbours are in it. The ridge has a gap where the
        best value is that of several y at which nothing impacts: the absorber does nothing there,
        and no y is the best.
    limits : {"robust", "all"} or (float, float), default "robust"
        The values at the ends of the colours, ``None`` for the smallest or largest there is.
        "robust": where `best` says what is good, the colours reach from the best value to three
        times as far from it as the median lies, so that a few points that hardly settle do not take
        the whole scale; an arrow on the colour bar shows that there are values beyond. "all": from
        the smallest to the largest value.
    median_of : int, default 1
        How many points along each side of a window, an odd number: draw the median of the points
        around each one, 3 × 3 for 3, and its ridge. For measures that jump from point to point. At
        the edges the window is cut. Where `best` says what is good a null counts as worse than any
        value, else it does not count; where half of a window or more is null it may be hatched.
    ax : matplotlib axes, optional
        Where to draw; axes of their own by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If there is no such column of numbers, it is null everywhere, the points are no grid over
        `x` and `y`, `limits` are none, or `median_of` is not odd.

    Examples
    --------
    >>> table = iva.sweep(
    ...     iva.Siva(restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     over={"mass_ratio": [0.05, 0.1, 0.15], "relative_clearance": [0.2, 0.4, 0.6, 0.8]},
    ...     start=iva.Start(displacement=1.0),
    ...     periods=20,
    ... )
    >>> axes = heatmap(table, "damping_ratio_3")
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('mass ratio μ = m/M', 'relative clearance γ = d/x₀')
    """
    summary = frame_of(checked_table(table), "summary")
    x = swept_key(table, "x", x, taken=y)
    y = swept_key(table, "y", y, taken=x)
    across, up, values = (
        numeric(summary, field, name) for field, name in (("x", x), ("y", y), ("value", value))
    )
    direction, points = direction_of(value, best), checked_window("median_of", median_of)
    columns, column = np.unique(across, return_inverse=True)
    rows, row = np.unique(up, return_inverse=True)
    once(summary.height, columns.size * rows.size, table, f"{x} and {y}")
    if summary.height < columns.size * rows.size:
        raise ValueError(
            f"{summary.height} points are no grid of {columns.size} values of {x} and {rows.size} "
            f"of {y}: sweep a grid"
        )
    grid = np.full((rows.size, columns.size), np.nan)
    grid[row, column] = values
    # What is judged together with its neighbours is no luck.
    steadied = points == 1 and min(grid.shape) >= FEWEST and not judgement(value)[1]
    grid = medians(grid, points, WORST[direction])
    idle = np.zeros(grid.shape, dtype=bool)
    idle[row, column] = without_impacts(summary)
    best_rows = None if direction is None else ridge(rows, grid, direction, idle, steadied)
    if np.isnan(grid).all():
        rule = "most values are null around every point; give 1"
        raise ValueError(f"median_of = {points}: {rule}")
    units, in_mm = table.units["summary"], in_millimetres(table)
    with drawing_on(ax) as axes:
        entries: list[Line2D | Patch] = []
        low, high = limits_of(grid, limits, direction)
        mesh = axes.pcolormesh(
            columns,
            rows,
            np.ma.masked_invalid(grid),
            shading="nearest",
            cmap="viridis",
            vmin=low,
            vmax=high,
            rasterized=True,
        )
        if np.isnan(grid).any():
            axes.patch.set(facecolor="0.85", edgecolor="0.55", hatch="/////")
            entries.append(
                Patch(facecolor="0.85", edgecolor="0.55", hatch="/////", label="no value (null)")
            )
        of_median = "" if points == 1 else f"\nmedian of {points} × {points} neighbours"
        colour_bar(
            axes,
            mesh,
            partial(measured, value, of_median),
            units.get(judgement(value)[0], ""),
            millimetres=in_mm,
            extend=beyond(grid, low, high),
        )
        if best_rows is not None and not np.isnan(best_rows).all():
            word = "smallest" if direction == "min" else "largest"
            of = f" (medians of {STEADY} × {STEADY})" if steadied else ""
            outline = [patheffects.withStroke(linewidth=2.4, foreground="white")]
            entries += axes.plot(
                columns,
                best_rows,
                color="black",
                linewidth=1.0,
                marker=".",
                markersize=2,
                path_effects=outline,
                label=f"{word} at each {symbol_of(x, units.get(x, ''))}{of}",
            )
        for axis, name in ((axes.xaxis, x), (axes.yaxis, y)):
            name_axis(axis, partial(of_column, name), units.get(name, ""), millimetres=in_mm)
        legend_above(axes, entries)
    return axes


def measured(value: str, of_median: str, unit: str) -> str:
    """Return what stands at the colours."""
    base, judged = judgement(value)
    return of_column(base, unit) + judged.replace(", ", "\n") + of_median


#: What a missing value counts as in a median, by what is good.
WORST = {"min": np.inf, "max": -np.inf, None: np.nan}


def direction_of(value: str, best: object) -> Literal["max", "min"] | None:
    """Return what is best of a column, as chosen or by its name.

    Raises
    ------
    ValueError
        If the choice is unknown.
    """
    value, _ = judgement(value)
    if best is None:
        if value in _iva.larger_is_better():
            return "max"
        return "min" if value.startswith(SMALL) else None
    if best == "max":
        return "max"
    if best == "min":
        return "min"
    if best == "none":
        return None
    raise ValueError(f"best = {shown(best)}: give 'max', 'min' or 'none'")


#: The colours reach so many times as far from the best value as the median lies.
REACH = 3.0


def limits_of(
    grid: Numbers, limits: object, direction: Literal["max", "min"] | None
) -> tuple[float, float]:
    """Return the values at the ends of the colours.

    Raises
    ------
    TypeError
        If they are given as something else than two numbers or a word.
    ValueError
        If the word is unknown, or the first is not smaller than the second.
    """
    low, high = float(np.nanmin(grid)), float(np.nanmax(grid))
    rule = "give 'robust', 'all' or two numbers, the smaller first"
    if isinstance(limits, str):
        if limits not in ("robust", "all"):
            raise ValueError(f"limits = {shown(limits)}: {rule}")
        if limits == "robust":
            median = float(np.nanmedian(grid))
            if direction == "min" and median > low:
                high = min(high, low + REACH * (median - low))
            if direction == "max" and median < high:
                low = max(low, high - REACH * (high - median))
        return low, high
    if not isinstance(limits, tuple) or len(limits) != 2:
        raise TypeError(f"limits = {shown(limits)}: {rule}")
    first, last = limits
    low = low if first is None else number("limits[0]", first)
    high = high if last is None else number("limits[1]", last)
    if not low < high:
        raise ValueError(f"limits = {shown(limits)}: {rule}")
    return low, high


def beyond(grid: Numbers, low: float, high: float) -> Literal["neither", "min", "max", "both"]:
    """Return on which sides there are values beyond the ends of the colours."""
    below, above = bool(np.nanmin(grid) < low), bool(np.nanmax(grid) > high)
    if below and above:
        return "both"
    return "min" if below else "max" if above else "neither"


def without_impacts(summary: pl.DataFrame) -> NDArray[np.bool_]:
    """Return which points of a summary have no impacts, as far as it tells.

    Of a driven run those are meant that its measures are of, not those of the transient before.
    """
    import polars as pl

    names = [name for name in ("impacts_per_cycle", "impacts") if name in summary.columns]
    if not names:
        return np.zeros(summary.height, dtype=bool)
    counted = pl.coalesce(pl.col(name).cast(pl.Float64) for name in names)
    idle: NDArray[np.bool_] = summary.select((counted == 0).fill_null(False)).to_series().to_numpy()
    return idle


def ridge(
    rows: Numbers,
    grid: Numbers,
    direction: Literal["max", "min"],
    idle: NDArray[np.bool_],
    steadied: bool,
) -> Numbers:
    """Return for each column of a grid the row of its best value, NaN where it has none.

    Parameters
    ----------
    rows : numpy.ndarray, shape (m,)
        What the rows stand for.
    grid : numpy.ndarray, shape (m, n)
        The values.
    direction : {"max", "min"}
        Which is the best.
    idle : numpy.ndarray of bool, shape (m, n)
        Where there are no impacts. Rows there that are equally good are no optimum.
    steadied : bool
        Take what luck at single points moves little.
    """
    judged = medians(grid, STEADY, WORST[direction]) if steadied else grid
    filled = np.where(np.isnan(judged), WORST[direction], judged)
    index = filled.argmax(axis=0) if direction == "max" else filled.argmin(axis=0)
    columns = np.arange(index.size)
    off = ROUNDING * np.nanmax(np.abs(grid), initial=0.0)
    alike = idle & (np.abs(grid - grid[index, columns]) <= off)
    no_optimum = idle[index, columns] & (alike.sum(axis=0) > 1)
    best = np.where(np.isnan(judged).all(axis=0) | no_optimum, np.nan, rows[index])
    if not steadied:
        return best
    running: Numbers = medians(best[np.newaxis], STEADY)[0]
    return np.where(np.isnan(best), np.nan, running)
