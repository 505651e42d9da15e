"""The best points of a sweep, what they trade, and whether they stand up to small changes.

All take the summary of a sweep as a polars frame, lazy or not, or a whole :class:`iva.Table`, and
give back a frame of the same kind (of a table, a :class:`polars.DataFrame`, but :func:`robust` a
table). What is lazy stays so: of ``iva.best(iva.scan("results/map").summary)`` only what it needs
is read.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral
from typing import TYPE_CHECKING, TypeVar, cast, overload

from iva import _iva
from iva.frames import Frames
from iva.parameters import number, percentage, shown
from iva.spelling import no_column, spell_checked
from iva.tables import Table

if TYPE_CHECKING:
    import polars as pl

    Frame = TypeVar("Frame", pl.DataFrame, pl.LazyFrame)

#: The end of a column of :func:`robust`.
JUDGED = re.compile(r"_(?:worst|q[0-9.]+)$")

#: The first column behind the swept ones.
BEHIND_SWEPT = "outcome"


@spell_checked
def best(
    table: Frame | Table,
    by: str | None = None,
    *,
    where: pl.Expr | Sequence[pl.Expr] | None = None,
    count: int = 10,
) -> Frame:
    """Return the best points of a sweep, the best first.

    Parameters
    ----------
    table : polars.DataFrame, polars.LazyFrame or Table
        Summary of a sweep, a row a point.
    by : str, optional
        The column to rank by: by default ``settling_time_5``, and of what :func:`robust` returns
        its last column, the strictest quantile. Of damping ratios and `reduction` the largest is
        the best, of every other the smallest. Points without a value (null: never settled) are left
        out.
    where : polars expression or a sequence of them, optional
        Only points of which these hold, for example ``pl.col("mass_ratio") < 0.1``.
    count : int
        So many points at most.

    Returns
    -------
    polars.DataFrame or polars.LazyFrame
        Rows of the table; of equal ones that which comes first.

    Raises
    ------
    TypeError
        If `table` is no table, `by` no column of numbers, `count` no whole number, or something in
        `where` no expression.
    ValueError
        If there is no such column, or `count` is below 1.

    Examples
    --------
    >>> import numpy as np
    >>> table = iva.sweep(
    ...     iva.Siva(mass_ratio=0.1, restitution=0.6),
    ...     iva.Primary(damping_ratio=0.01),
    ...     over={"relative_clearance": np.linspace(0.2, 1.4, 61)},
    ...     start=iva.Start(displacement=1.0),
    ...     periods=40,
    ... )
    >>> first = iva.best(table, "damping_ratio_3", count=3)
    >>> first["damping_ratio_3"].is_sorted(descending=True)
    True
    """
    import polars as pl

    frame = _frame(table)
    if by is None:
        judged = [name for name in frame.lazy().collect_schema().names() if JUDGED.search(name)]
        by = judged[-1] if judged else "settling_time_5"
    _check(frame, by=[by])
    _check_count(count)
    chosen = frame.filter(pl.col(by).is_not_null() & pl.col(by).is_not_nan())
    for condition in _conditions(where):
        chosen = chosen.filter(condition)
    larger = JUDGED.sub("", by) in _iva.larger_is_better()
    return cast("Frame", chosen.sort(by, descending=larger, maintain_order=True).head(count))


@spell_checked
def pareto(
    table: Frame | Table,
    by: Sequence[str],
    *,
    larger: Sequence[str] = (),
    where: pl.Expr | Sequence[pl.Expr] | None = None,
) -> Frame:
    """Return the points that no other beats: better in one column and not worse in any.

    Parameters
    ----------
    table : polars.DataFrame, polars.LazyFrame or Table
        Summary of a sweep, a row a point.
    by : sequence of str
        The columns to weigh against each other, for example ``["settling_time_5", "mass_ratio"]``.
        Points that lack one of these values are left out.
    larger : sequence of str
        Those of which the larger is the better; damping ratios and `reduction` always are.
    where : polars expression or a sequence of them, optional
        Only points of which these hold.

    Returns
    -------
    polars.DataFrame or polars.LazyFrame
        Rows of the table, sorted by the first of the columns, the best first. Points that are equal
        in all of these columns are all there.

    Raises
    ------
    TypeError
        If `table` is no table, `by` or `larger` not a list of columns of numbers, or something in
        `where` no expression.
    ValueError
        If a column does not exist, or none is given.

    Notes
    -----
    The front is found by looking at these columns alone, which for a lazy frame are read at once.

    Examples
    --------
    >>> import polars as pl
    >>> points = pl.DataFrame({"cost": [1, 2, 3, 4], "time": [9.0, 9.0, 5.0, 6.0]})
    >>> iva.pareto(points, ["cost", "time"])["cost"].to_list()
    [1, 3]
    """
    import polars as pl

    frame = _frame(table)
    for field, columns in (("by", by), ("larger", larger)):
        _check_list(field, columns, "columns")
    _check(frame, by=by, larger=larger)
    if not by:
        raise ValueError("by = []: name at least one column")
    valued = frame.filter(*(pl.col(name).is_not_null() & pl.col(name).is_not_nan() for name in by))
    for condition in _conditions(where):
        valued = valued.filter(condition)
    upwards = {*larger, *_iva.larger_is_better()}
    signed = [-pl.col(name) if name in upwards else pl.col(name) for name in by]
    left = valued.lazy().select(by).unique().sort(signed).collect()
    beaten_by_none = []
    # The first in this order is beaten by none; then whatever it does not beat is left.
    while left.height:
        first = left.head(1)
        beaten_by_none.append(first)
        row = first.row(0, named=True)
        better = [
            pl.col(name) > row[name] if name in upwards else pl.col(name) < row[name] for name in by
        ]
        left = left.filter(pl.any_horizontal(better))
    front = pl.concat(beaten_by_none) if beaten_by_none else left
    found = (
        valued.lazy().join(front.lazy(), on=list(by), how="semi").sort(signed, maintain_order=True)
    )
    return cast("Frame", found if isinstance(frame, pl.LazyFrame) else found.collect())


@overload
def robust(
    table: Table,
    by: str = ...,
    *,
    within: Mapping[str, float | str],
    quantiles: Sequence[float] = ...,
    where: pl.Expr | Sequence[pl.Expr] | None = ...,
) -> Table: ...


@overload
def robust(
    table: Frame,
    by: str = ...,
    *,
    within: Mapping[str, float | str],
    quantiles: Sequence[float] = ...,
    where: pl.Expr | Sequence[pl.Expr] | None = ...,
) -> Frame: ...


@spell_checked
def robust(
    table: pl.DataFrame | pl.LazyFrame | Table,
    by: str = "settling_time_5",
    *,
    within: Mapping[str, float | str],
    quantiles: Sequence[float] = (0.5, 0.9),
    where: pl.Expr | Sequence[pl.Expr] | None = None,
) -> pl.DataFrame | pl.LazyFrame | Table:
    """Return what becomes of a measure where parameters are a little off.

    For every point all points of the sweep are looked up whose parameters lie within the given
    distances of its own and equal it in the other swept ones.

    Parameters
    ----------
    table : polars.DataFrame, polars.LazyFrame or Table
        Summary of a sweep, a row a point.
    by : str
        The measure.
    within : mapping of str to float or str
        Swept columns, and how far off each may be: a distance in the unit of the column, or a
        percentage of the value at the point, such as ``"20%"``.
    quantiles : sequence of float
        Shares of the neighbours, in [0, 1], that are at least as good.
    where : polars expression or a sequence of them, optional
        Judge only the points of which these hold. All points are neighbours.

    Returns
    -------
    Table, polars.DataFrame or polars.LazyFrame
        Of a table a table, for :func:`iva.plots.heatmap`, swept over what still varies among the
        points that were judged; of a frame a frame. The summary has the columns ``neighbours``
        (their number, the point included), ``<by>_worst`` and for a quantile of 0.9 ``<by>_q90``. A
        value that is missing (null: never settled) counts as worse than any other; where such a one
        is the worst, or the quantile, the result is null.

    Raises
    ------
    TypeError
        If `table` is no table, `by` no column of numbers, a distance or quantile no number, or
        something in `where` no expression.
    ValueError
        If a column does not exist or was not swept, a distance is not a number ≥ 0 or a percentage
        below 100, or a quantile lies outside [0, 1].

    Notes
    -----
    Every pair of neighbours is a row in memory for a while: with ``n`` points judged and ``k``
    neighbours of each some 50 n k bytes.

    Examples
    --------
    >>> import polars as pl
    >>> points = pl.DataFrame(
    ...     {
    ...         "point": [0, 1, 2],
    ...         "gap": [1.0, 2.0, 3.0],
    ...         "outcome": ["finished"] * 3,
    ...         "settling_time_5": [4.0, 1.0, None],
    ...     }
    ... )
    >>> iva.robust(points, within={"gap": 1.0}, quantiles=[])["settling_time_5_worst"].to_list()
    [4.0, None, None]
    >>> few = iva.robust(points, within={"gap": "50%"}, where=pl.col("gap") < 3)
    >>> few["neighbours"].to_list()
    [1, 3]
    """
    import polars as pl

    frame = _frame(table)
    names = _check(frame, by=[by])
    behind = names.index(BEHIND_SWEPT) if BEHIND_SWEPT in names else 0
    swept = [name for name in names[:behind] if name != "point"]
    reaches = _reaches(within, names, swept)
    _check_list("quantiles", quantiles, "numbers from 0 to 1")
    for share in quantiles:
        if not 0 <= number("quantiles", share) <= 1:
            raise ValueError(f"quantiles: {share} does not lie between 0 and 1")
    larger = by in _iva.larger_is_better()
    # The worst is last, what is missing behind it.
    missing = float("inf")
    badness = (-pl.col(by) if larger else pl.col(by)).cast(pl.Float64).fill_nan(None)
    all_points = frame.lazy().with_row_index("_row")
    asked = all_points.filter(*_conditions(where))
    others = all_points.select(
        *(pl.col(name).alias(f"_{name}") for name in swept),
        badness.fill_null(missing).alias("_bad"),
    )
    pairs = _neighbours(asked.select("_row", *swept), others, swept, reaches)
    bad = pl.col("_bad")

    def judged_by(value: pl.Expr) -> pl.Expr:
        finite = pl.when(value < missing).then(value)
        return -finite if larger else finite

    judged = pairs.group_by("_row").agg(
        pl.len().alias("neighbours"),
        judged_by(bad.max()).alias(f"{by}_worst"),
        *(
            judged_by(bad.quantile(share, "higher")).alias(f"{by}_q{100 * share:g}")
            for share in quantiles
        ),
    )
    found = asked.join(judged, on="_row", how="left").sort("_row").drop("_row")
    if isinstance(frame, pl.LazyFrame):
        return found
    summary = found.collect()
    if not isinstance(table, Table):
        return summary
    varied = tuple(key for key in table.swept if summary[key].n_unique() > 1)
    return Table(varied, table.units, Frames({"summary": lambda: summary}))


def _reaches(
    within: Mapping[str, float | str], names: Sequence[str], swept: Sequence[str]
) -> dict[str, pl.Expr]:
    """Return for each swept column how far off it may be at a point."""
    import polars as pl

    if not isinstance(within, Mapping):
        raise TypeError(f"within = {shown(within)}: give a mapping of columns to distances")
    reaches = {}
    for name, distance in within.items():
        _check_name(name)
        if name not in names:
            raise ValueError(f"within[{name!r}]: {no_column(name, swept)}")
        if name not in swept:
            raise ValueError(
                f"within: {name!r} was not swept; there is {', '.join(swept) or 'none'}"
            )
        if isinstance(distance, str):
            reaches[name] = pl.col(name).abs() * percentage(f"within[{name!r}]", distance)
            continue
        if not number(f"within[{name!r}]", distance) >= 0:
            raise ValueError(f"within: {name!r} = {distance}: give a number of 0 or more")
        reaches[name] = pl.lit(float(distance))
    return reaches


def _neighbours(
    points: pl.LazyFrame, others: pl.LazyFrame, swept: Sequence[str], within: Mapping[str, pl.Expr]
) -> pl.LazyFrame:
    """Return pairs of `points` and those of `others` close to them, whose columns begin with _."""
    import polars as pl

    def near(name: str) -> list[pl.Expr]:
        # A step of the grid may be longer than the same distance by rounding.
        reach = within[name] * (1 + 1e-9)
        there = pl.col(f"_{name}")
        return [there >= pl.col(name) - reach, there <= pl.col(name) + reach]

    counts = (
        others.select(pl.len(), *(pl.col(f"_{name}").n_unique() for name in swept)).collect().row(0)
    )
    if math.prod(counts[1:]) > 2 * counts[0]:
        same = [pl.col(name) == pl.col(f"_{name}") for name in swept if name not in within]
        return points.join_where(
            others, *same, *(condition for name in within for condition in near(name))
        )
    # On a grid what is near is looked up axis by axis.
    for name in swept:
        values = points.select(name).unique()
        close = values.with_columns(pl.col(name).alias(f"_{name}"))
        if name in within:
            there = others.select(f"_{name}").unique()
            close = values.join_where(there, *near(name))
        points = points.join(close, on=name)
    return points.join(others, on=[f"_{name}" for name in swept])


def _frame(table: object) -> pl.DataFrame | pl.LazyFrame:
    import polars as pl

    found = table.summary if isinstance(table, Table) else table
    if not isinstance(found, (pl.DataFrame, pl.LazyFrame)):
        raise TypeError(f"table = {shown(table)}: give an iva.Table or a polars frame")
    return found


def _check(frame: pl.DataFrame | pl.LazyFrame, **asked: Sequence[str]) -> list[str]:
    """Return the names of the columns, after a check of those that are asked for, by argument.

    Raises
    ------
    TypeError
        If one is no text, or a column that is not of numbers.
    ValueError
        If there is no such column.
    """
    schema = frame.lazy().collect_schema()
    for field, columns in asked.items():
        for name in columns:
            _check_name(name)
            if name not in schema:
                there = (key for key, kind in schema.items() if kind.is_numeric())
                raise ValueError(f"{field} = {name!r}: {no_column(name, there)}")
            if not schema[name].is_numeric():
                raise TypeError(f"the column {name!r} is of {schema[name]}: give one of numbers")
    return schema.names()


def _check_name(name: object) -> None:
    if not isinstance(name, str):
        raise TypeError(f"{shown(name)} is no name of a column: give a text")


def _check_count(count: object) -> None:
    if not isinstance(count, Integral) or isinstance(count, bool):
        raise TypeError(f"count = {shown(count)}: give a whole number, 1 or greater")
    if int(count) < 1:
        raise ValueError(f"count = {shown(count)}: ask for at least one point")


def _check_list(field: str, values: object, of: str) -> None:
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise TypeError(f"{field} = {shown(values)}: give a list of {of}")


def _conditions(where: pl.Expr | Sequence[pl.Expr] | None) -> Sequence[pl.Expr]:
    if where is None:
        return ()
    import polars as pl

    conditions = where if isinstance(where, Sequence) else (where,)
    for condition in conditions:
        if not isinstance(condition, pl.Expr):
            raise TypeError(f"where = {shown(condition)}: give expressions of polars")
    return conditions
