"""Labels of horizontal lines at the right edge of axes, apart from each other however close."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.transforms import Affine2D

from iva.plots.arguments import Numbers
from iva.plots.styles import figure_of

#: Space in points from the edge to the labels, and the height of a label over its size.
BESIDE, LINE = 7.0, 1.25


def label_levels(axes: Axes, levels: Mapping[float, str]) -> None:
    """Write a label for each of some heights, joined to its line.

    Parameters
    ----------
    axes : matplotlib axes
        The axes with the lines.
    levels : mapping of float to str
        Height in data coordinates → label.
    """
    heights, font = np.array(sorted(levels)), FontProperties(size="small")
    line = LINE * font.get_size_in_points()
    for index, height in enumerate(heights):
        axes.annotate(
            levels[float(height)],
            (1.0, height),
            (0.0, 0.0),
            xycoords=axes.get_yaxis_transform(),
            # When it is drawn, for only then the height of the axes is known.
            textcoords=partial(place, axes, heights, index, line),
            va="center",
            fontproperties=font,
            color="0.35",
            arrowprops={
                "arrowstyle": "-",
                "color": "0.6",
                "linewidth": 0.4,
                "shrinkA": 0.0,
                "shrinkB": 0.0,
                "relpos": (0.0, 0.5),
            },
        )


def place(
    axes: Axes,
    heights: Numbers,
    index: int,
    line: float,
    renderer: Any,  # noqa: ARG001 (of matplotlib)
) -> Affine2D:
    """Return the transform that has the place of a label as its origin."""
    point = figure_of(axes).dpi / 72.0
    up = axes.transData.transform(np.column_stack([np.zeros_like(heights), heights]))[:, 1]
    return Affine2D().translate(axes.bbox.x1 + BESIDE * point, spread(up, line * point)[index])


def spread(at: Numbers, least: float) -> Numbers:
    """Return places in the same order, at least so far apart, moved as little as can be.

    Examples
    --------
    >>> spread(np.array([0.0, 1.0, 2.0, 30.0]), 5.0).tolist()
    [-4.0, 1.0, 6.0, 30.0]
    """
    steps = least * np.arange(at.size)
    # The nearest series that never falls, by the means of stretches.
    free = at - steps
    count = free.size
    rising = [
        max(
            min(free[first : last + 1].mean() for last in range(index, count))
            for first in range(index + 1)
        )
        for index in range(count)
    ]
    apart: Numbers = steps + np.array(rising)
    return apart
