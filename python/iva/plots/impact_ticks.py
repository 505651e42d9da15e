"""Ticks at the edges of axes over time: when there were impacts, and on which wall."""

from __future__ import annotations

import numpy as np
import polars as pl
from matplotlib.axes import Axes

from iva.plots.styles import WALLS


def impact_ticks(axes: Axes, hits: pl.DataFrame, end: float) -> None:
    """Draw a tick for each impact up to an instant: wall + at the upper edge, wall − below."""
    for wall, edge, name in ((1, 1.0, "wall +"), (-1, 0.0, "wall −")):
        side = hits.filter((hits["wall"] == wall) & (hits["time"] <= end))
        axes.plot(
            side["time"].to_numpy(),
            np.full(side.height, edge),
            linestyle="none",
            marker="|",
            markersize=6,
            markeredgewidth=0.7,
            color=WALLS[wall],
            transform=axes.get_xaxis_transform(),
            label=f"impacts, {name}",
        )
