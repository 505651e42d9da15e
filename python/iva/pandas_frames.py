"""Frames of pandas as points; pandas itself is never imported."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from typing import TypeGuard

    import polars as pl


class PandasFrame(Protocol):
    """What is used of a frame of pandas."""

    def items(self) -> Iterable[tuple[Hashable, Any]]:
        """Return names and columns."""


def is_of_pandas(frame: object) -> TypeGuard[PandasFrame]:
    """Return whether something is a frame of pandas, which is not imported for that.

    Examples
    --------
    >>> is_of_pandas({"mass_ratio": [0.1]})
    False
    """
    made_by = type(frame)
    return made_by.__module__.partition(".")[0] == "pandas" and made_by.__name__ == "DataFrame"


def from_pandas(frame: PandasFrame) -> pl.DataFrame:
    """Return a frame of pandas as one of polars, without its index; what is missing is null.

    Raises
    ------
    TypeError
        If a column is not of numbers.
    """
    import polars as pl

    columns = []
    for name, series in frame.items():
        if series.dtype.kind not in "iuf":
            raise TypeError(f"over has the column {str(name)!r} of {series.dtype}: give numbers")
        values = series.to_numpy(dtype="float64", na_value=float("nan"))
        columns.append(pl.Series(str(name), values, nan_to_null=True))
    return pl.DataFrame(columns)
