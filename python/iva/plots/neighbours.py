"""Medians of neighbouring points of a grid, for measures that jump from point to point."""

from __future__ import annotations

import numpy as np

from iva.parameters import number, shown
from iva.plots.arguments import Numbers


def checked_window(field: str, points: object) -> int:
    """Return the number of points along each side of a window.

    Raises
    ------
    TypeError, ValueError
        If it is no odd whole number from 1 on.
    """
    given = number(field, points)
    if not (given >= 1.0 and given % 2.0 == 1.0):
        raise ValueError(f"{field} = {shown(points)}: give an odd whole number from 1 on")
    return int(given)


def medians(grid: Numbers, points: int, missing: float = np.nan) -> Numbers:
    """Return for each point the median of a square window around it.

    At the edges of the grid the window is cut. A value that is missing (NaN) counts as `missing`:
    infinite where it is worse than any other, as that of what never settles. By default it does not
    count; where more than half of a window is missing so is the median.

    Examples
    --------
    >>> jumping = np.array([[1.0, 9.0, 2.0, np.nan, np.nan]])
    >>> medians(jumping, 3).tolist(), medians(jumping, 3, np.inf).tolist()
    ([[5.0, 2.0, 5.5, nan, nan]], [[5.0, 2.0, 9.0, nan, nan]])
    """
    half = points // 2
    filled = np.where(np.isnan(grid), missing, grid)
    padded = np.pad(filled, half, constant_values=np.nan)
    inside = np.pad(np.ones_like(grid), half)
    shape = (points, points)
    windows = np.lib.stride_tricks.sliding_window_view(padded, shape).reshape(*grid.shape, -1)
    there = np.lib.stride_tricks.sliding_window_view(inside, shape).sum(axis=(2, 3))
    # NaN is sorted to the end.
    ordered = np.sort(windows, axis=-1)
    known = (~np.isnan(ordered)).sum(axis=-1)
    low, high = np.maximum(known - 1, 0) // 2, known // 2
    pairs = np.take_along_axis(ordered, np.stack([low, high], axis=-1), axis=-1)
    middle = pairs.mean(axis=-1)
    return np.where((2 * known >= there) & np.isfinite(middle), middle, np.nan)
