"""A column of the summary against a swept parameter."""

from __future__ import annotations

from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from iva.plots.arguments import Numbers, checked_table, frame_of, numeric, once, swept_key
from iva.plots.axis_units import colour_bar, in_millimetres, name_axis
from iva.plots.labels import of_column, symbol_of
from iva.plots.legends import legend_above
from iva.plots.styles import CURVES, SHADES, drawing_on
from iva.spelling import spell_checked
from iva.tables import Table


@spell_checked
def curves(
    table: Table,
    y: str,
    *,
    x: str | None = None,
    by: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a column of the summary against a swept parameter, one curve for each value of another.

    Parameters
    ----------
    table : Table
        Tables of a sweep over one or two parameters.
    y : str
        The column to draw, for example ``"damping_ratio_3"`` or ``"impacts"``. Where it is null the
        curve has a gap.
    x : str, optional
        The parameter across; the first swept one by default.
    by : str, optional
        The parameter of the curves; by default the first swept one that is not `x`, if there is
        any. Up to seven curves have a legend, more a colour bar.
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
        If there is no such column of numbers, it is null everywhere, or several points have the
        same place on the same curve.

    Examples
    --------
    >>> table = iva.sweep(
    ...     iva.Siva(restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     over={"relative_clearance": [0.2, 0.4, 0.6, 0.8], "mass_ratio": [0.05, 0.1]},
    ...     start=iva.Start(displacement=1.0),
    ...     periods=20,
    ... )
    >>> axes = curves(table, "damping_ratio_3")
    >>> [line.get_label() for line in axes.lines]
    ['0.05', '0.1']
    >>> axes.get_xlabel()
    'relative clearance γ = d/x₀'
    """
    summary = frame_of(checked_table(table), "summary")
    x = swept_key(table, "x", x)
    if by is None and any(key != x for key in table.swept):
        by = swept_key(table, "by", None, taken=x)
    across, up = numeric(summary, "x", x), numeric(summary, "y", y)
    groups = np.zeros_like(across) if by is None else numeric(summary, "by", by)
    places = np.unique(np.column_stack([across, groups]), axis=0)
    once(summary.height, len(places), table, x if by is None else f"{x} and {by}")
    units = table.units["summary"]
    values = np.unique(groups)
    with drawing_on(ax) as axes:
        few = len(values) <= len(CURVES)
        scale = Normalize(values[0], values[-1])
        for index, value in enumerate(values):
            rows = np.flatnonzero(groups == value)
            rows = rows[np.argsort(across[rows], kind="stable")]
            colour = CURVES[index] if few else SHADES(scale(value))
            label = "_only" if by is None else f"{value:g}"
            axes.plot(across[rows], up[rows], color=colour, label=label)
            dots = rows[alone(up[rows])]
            if dots.size:
                axes.plot(across[dots], up[dots], ".", color=colour, label="_between gaps")
        in_mm = in_millimetres(table)
        for axis, name in ((axes.xaxis, x), (axes.yaxis, y)):
            name_axis(axis, partial(of_column, name), units.get(name, ""), millimetres=in_mm)
        if by is not None:
            unit = units.get(by, "")
            if few:
                legend_above(axes, title=symbol_of(by, unit))
            else:
                shades = ScalarMappable(scale, SHADES)
                colour_bar(axes, shades, partial(of_column, by), unit, millimetres=in_mm)
    return axes


def alone(values: Numbers) -> NDArray[np.bool_]:
    """Return which points stand between gaps: no line would show them."""
    gap = np.isnan(np.concatenate([[np.nan], values, [np.nan]]))
    return np.asarray(gap[:-2] & ~gap[1:-1] & gap[2:])
