"""The impacts of many points: when, and on which wall."""

from __future__ import annotations

from functools import partial

import numpy as np
import polars as pl
from matplotlib.axes import Axes

from iva.parameters import shown
from iva.plots.arguments import Numbers, frame_of, limit, numeric
from iva.plots.axis_units import in_millimetres, name_axis
from iva.plots.labels import labelled, of_column
from iva.plots.legends import legend_above
from iva.plots.styles import WALLS, drawing_on
from iva.simulation import Run
from iva.spelling import spell_checked
from iva.tables import Table


@spell_checked
def raster(
    table: Table | Run,
    *,
    by: str | None = None,
    until: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a mark for every impact: time across, one line for each point of a sweep.

    Parameters
    ----------
    table : Table or Run
        Tables of a sweep with ``impacts`` among them, or a run.
    by : str, optional
        The column of the summary that tells the points apart, drawn up the axis; by default the
        swept parameter if there is one, else the number of the point. Points with the same value
        share a line.
    until : float, optional
        Last instant to draw, in the unit of time; all impacts by default.
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
        If there is no table ``impacts``, no such column, a value is out of range, or the run has no
        absorber.

    Examples
    --------
    >>> table = iva.sweep(
    ...     iva.Siva(mass_ratio=0.1, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     over={"relative_clearance": [0.2, 0.4, 0.6, 0.8]},
    ...     start=iva.Start(displacement=1.0),
    ...     periods=10,
    ...     tables=("summary", "impacts"),
    ... )
    >>> axes = raster(table)
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('time ωₙt', 'relative clearance γ = d/x₀')
    """
    if not isinstance(table, Table | Run):
        raise TypeError(f"table = {shown(table)}: give an iva.Table or an iva.Run")
    if isinstance(table, Run) and table.absorber is None:
        raise ValueError("this run has no absorber, and so no impacts to draw")
    impacts, summary = frame_of(table, "impacts"), frame_of(table, "summary")
    end = limit(until)
    if by is None:
        swept = table.swept if isinstance(table, Table) else ()
        by = swept[0] if len(swept) == 1 else "point"
    heights = numeric(summary, "by", by)
    units = table.units
    places = pl.DataFrame({"point": summary["point"], "height": heights})
    drawn = impacts.filter(pl.col("time") <= end).join(
        places, on="point", how="left", maintain_order="left"
    )
    half = 0.5 * line_height(heights)
    with drawing_on(ax) as axes:
        for wall, name in ((1, "wall +"), (-1, "wall −")):
            side = drawn.filter(pl.col("wall") == wall)
            at = side["height"].to_numpy()
            axes.vlines(
                side["time"].to_numpy(),
                at - half,
                at + half,
                colors=WALLS[wall],
                linewidth=0.6,
                # Snapped to whole pixels, the marks of many points would vanish in stripes.
                capstyle="projecting",
                snap=False,
                label=f"impacts, {name}",
                rasterized=side.height > 5_000,  # a page of vectors would be slow to turn
            )
        axes.set_ylim(heights.min() - 1.2 * half, heights.max() + 1.2 * half)
        begin = (table.start.time or 0.0) if isinstance(table, Run) else 0.0
        axes.set_xlim(begin, end if np.isfinite(end) else None)
        name_axis(axes.xaxis, partial(labelled, "time", "t"), units["impacts"]["time"])
        if isinstance(table, Run):
            axes.set(yticks=[], ylabel="")
        else:
            unit, in_mm = units["summary"].get(by, ""), in_millimetres(table)
            name_axis(axes.yaxis, partial(of_column, by), unit, millimetres=in_mm)
        legend_above(axes)
    return axes


def line_height(heights: Numbers) -> float:
    """Return the height of the marks, so that neighbouring lines stay apart."""
    steps = np.diff(np.unique(heights))
    return 0.8 * float(steps.min()) if steps.size else 1.0
