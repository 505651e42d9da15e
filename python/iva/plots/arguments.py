"""What functions are given: runs, tables and columns, each refused with one sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import polars as pl
from numpy.typing import NDArray

from iva.design import design_of
from iva.parameters import number, shown
from iva.simulation import Run
from iva.spelling import no_column
from iva.structures import Structure
from iva.tables import Table

Numbers = NDArray[np.float64]


def checked_run(
    run: object, field: str = "run", *, several: bool = False, modes: bool = False
) -> Run:
    """Return a run.

    Parameters
    ----------
    run : Run
        The run.
    field : str
        Its name for messages.
    several : bool, default False
        Whether it may have several absorbers.
    modes : bool, default False
        Whether its structure may have several modes.

    Raises
    ------
    TypeError
        If it is none.
    ValueError
        If it has several absorbers, or a structure with several modes, that are not drawn here.
    """
    if not isinstance(run, Run):
        raise TypeError(f"{field} = {shown(run)}: give an iva.Run, of iva.simulate")
    count = design_of(run).absorbers
    if count > 1 and not several:
        raise ValueError(f"{field} has {count} absorbers: this is drawn for one; give such a run")
    if isinstance(run.primary, Structure) and not modes:
        raise ValueError(f"{field} has a structure with several modes: this is drawn for one")
    return run


def checked_absorber(run: Run, absorber: object) -> int:
    """Return the number of an absorber of a run.

    Raises
    ------
    TypeError, ValueError
        If the run has none of this number.
    """
    place, count = number("absorber", absorber), design_of(run).absorbers
    if place not in range(count):
        there = (
            f"the run has {count}, numbered from 0" if count > 1 else "the run has one, number 0"
        )
        raise ValueError(f"absorber = {shown(absorber)}: {there}")
    return int(place)


def checked_table(table: object) -> Table:
    """Return the tables of a sweep.

    Raises
    ------
    TypeError
        If it is something else.
    """
    if not isinstance(table, Table):
        raise TypeError(f"table = {shown(table)}: give an iva.Table, of iva.sweep or iva.read")
    return table


def frame_of(result: Run | Table, name: str) -> pl.DataFrame:
    """Return a table of a result.

    Raises
    ------
    ValueError
        If it was not asked for.
    """
    try:
        frame: pl.DataFrame = getattr(result, name)
    except AttributeError as error:
        raise ValueError(str(error)) from None
    return frame


def limit(until: float | None) -> float:
    """Return the last instant to draw; infinite for ``None``.

    Raises
    ------
    TypeError, ValueError
        If it is no number greater than 0.
    """
    if until is None:
        return math.inf
    end = number("until", until)
    if not end > 0.0:
        raise ValueError(f"until = {shown(until)}: give a time greater than 0")
    return end


def motion_of(
    run: Run, until: float | None, absorber: int | None = None
) -> tuple[Mapping[str, Numbers], float]:
    """Return the columns of the motion up to an instant, and the last instant to draw.

    Both states of every impact are among them: of several absorbers the impacts of one, or without
    its number those of all, where the gap is that of any.

    Raises
    ------
    TypeError, ValueError
        If `until` is no number greater than 0, or not after the begin of the run.
    """
    motion = run.trajectory()
    begin = float(motion["time"][0])
    if not limit(until) > begin:
        rule = f"the run begins at {begin:.6g}; give a later time"
        raise ValueError(f"until = {shown(until)}: {rule}")
    if design_of(run).absorbers > 1:
        if absorber is None:
            once = ["time", "displacement", "velocity"]
            motion = motion.unique(once, keep="first", maintain_order=True)
        else:
            motion = motion.filter(pl.col("absorber") == absorber)
    end = min(limit(until), float(motion["time"][-1]))
    part = motion.filter(pl.col("time") <= end)
    return {name: values_of(part[name]) for name in part.columns}, end


def values_of(column: pl.Series) -> Numbers:
    """Return numbers, NaN where there is none."""
    return column.cast(pl.Float64).fill_null(math.nan).to_numpy()


def numeric(frame: pl.DataFrame, field: str, name: object) -> Numbers:
    """Return a column of numbers, NaN where there is none.

    Raises
    ------
    TypeError
        If the name is no text.
    ValueError
        If there is no such column, or it has no numbers.
    """
    if not isinstance(name, str):
        raise TypeError(f"{field} = {shown(name)}: give the name of a column")
    if name not in frame.columns:
        there = (key for key, kind in frame.schema.items() if kind.is_numeric())
        raise ValueError(f"{field} = {name!r}: {no_column(name, there)}")
    kind = frame.schema[name]
    if not kind.is_numeric() and kind != pl.Null:
        raise ValueError(f"{field} = {name!r}: it holds {kind}, give a column of numbers")
    values = values_of(frame[name])
    if not np.isfinite(values).any():
        raise ValueError(f"{field} = {name!r}: it is null at every point")
    return values


def swept_key(table: Table, field: str, name: object, taken: object = None) -> str:
    """Return the column that was named, else the first swept key that is not taken.

    Raises
    ------
    TypeError
        If the name is no text.
    ValueError
        If nothing is left, or it is taken.
    """
    if name is None:
        left = [key for key in table.swept if key != taken]
        if not left:
            swept = ", ".join(table.swept) or "nothing"
            raise ValueError(f"{field} = None: the table is swept over {swept} only; name a column")
        return left[0]
    if not isinstance(name, str):
        raise TypeError(f"{field} = {shown(name)}: give the name of a column")
    if name == taken:
        raise ValueError(f"{field} = {name!r}: it is on the other axis; name another column")
    return name


def once(rows: int, distinct: int, table: Table, axes: str) -> None:
    """Check that no two points fall on the same place.

    Raises
    ------
    ValueError
        If some do.
    """
    if rows > distinct:
        swept = ", ".join(table.swept)
        raise ValueError(
            f"{rows} points have {distinct} different values of {axes}: the table is swept over "
            f"{swept}; sweep no more axes than are drawn, or draw `table.filter(…)`"
        )
