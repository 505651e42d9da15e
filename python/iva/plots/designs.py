"""What an optimisation tried, what it chose, and what does as well."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from iva.optimisation import Optimum
from iva.parameters import shown
from iva.plots.arguments import Numbers, values_of
from iva.plots.axis_units import colour_bar, in_millimetres, name_axis
from iva.plots.labels import of_column
from iva.plots.legends import legend_above
from iva.plots.styles import CURVES, drawing_on
from iva.spelling import no_column, spell_checked

#: Share of the designs that the colours tell apart; the others have the last colour.
TOLD_APART = 0.6


@spell_checked
def design(
    found: Optimum, *, x: str | None = None, y: str | None = None, ax: Axes | None = None
) -> Axes:
    """Draw the designs that an optimisation tried, the best, and those that are as good.

    One chosen field: its value against what was minimised. Two or more: two of them, the value as
    colour. Several goals: the front, in two of them. What was tried stands where the few cases of
    the search put it, with their luck; front and best stand where fresh cases put them.

    Parameters
    ----------
    found : Optimum
        Of :func:`iva.optimise`.
    x, y : str, optional
        The columns of ``found.table`` across and up; by default the first two chosen fields, or the
        first two goals.
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
        If there is no such column.

    Examples
    --------
    >>> found = iva.optimise(
    ...     iva.Siva(mass_ratio=0.1, restitution=0.6), iva.Primary(damping_ratio=0.01),
    ...     choose={"relative_clearance": (0.2, 1.2)}, maximise="damping_ratio_3",
    ...     start=iva.Start(displacement=1.0), periods=20, runs=500)
    >>> design(found).get_xlabel()
    'relative clearance γ = d/x₀'
    """
    if not isinstance(found, Optimum):
        raise TypeError(f"found = {shown(found)}: give an iva.Optimum, of iva.optimise")
    goals, fields = found.goals, list(found.best)
    if len(goals) > 1:
        usual = (goals[0], goals[1])
    else:
        usual = (fields[0], fields[1] if len(fields) > 1 else goals[0])
    x, y = (column(found, *pair) for pair in (("x", x or usual[0]), ("y", y or usual[1])))
    units = found.units["summary"]
    tried, value = found.table, goals[0]
    in_mm = in_millimetres([*found._spec, *fields])
    with drawing_on(ax) as axes:
        across, up = values_of(tried[x]), values_of(tried[y])
        if value in (x, y):
            axes.plot(
                across, up, ".", color="0.7", markersize=3, label="tried, few cases", zorder=1
            )
        else:
            of_value = values_of(tried[value])
            low, high = limits(of_value, larger=found.maximised(value))
            scale = Normalize(low, high)
            colours = "viridis" if found.maximised(value) else "viridis_r"
            order = np.argsort(np.isfinite(of_value), kind="stable")
            axes.scatter(
                across[order], up[order], c=of_value[order], s=6, cmap=colours, norm=scale,
                plotnonfinite=False, zorder=1,
            )  # fmt: skip
            end: Literal["min", "max"] = "min" if found.maximised(value) else "max"
            colour_bar(
                axes, ScalarMappable(scale, colours),
                partial(judged, value, f"\n{found.criterion}"), unit_of(units, value),
                millimetres=in_mm, extend=end,
            )  # fmt: skip
        several = found.front if found.front.height else found.as_good[1:]
        label = "front, fresh cases" if found.front.height else "as good as the best"
        if several.height:
            line = "-o" if found.front.height else "o"
            axes.plot(
                values_of(several[x]), values_of(several[y]), line, color=CURVES[1],
                markerfacecolor="none", markersize=4, linewidth=0.8, label=label, zorder=2,
            )  # fmt: skip
        best = found.as_good[:1]
        axes.plot(
            values_of(best[x]), values_of(best[y]), "*", color="black", markeredgecolor="white",
            markersize=9, label="the best" if len(goals) == 1 else "in the middle", zorder=3,
        )  # fmt: skip
        for name, axis in ((x, axes.xaxis), (y, axes.yaxis)):
            words = partial(judged, name, f", {found.criterion}" if name == value else "")
            name_axis(axis, words, unit_of(units, name), millimetres=in_mm)
        legend_above(axes)
    return axes


def judged(name: str, criterion: str, unit: str) -> str:
    """Return the label of a measure, and by what its cases are judged together."""
    return of_column(name, unit) + criterion


def column(found: Optimum, field: str, name: object) -> str:
    """Return the name of a column of the designs.

    Raises
    ------
    TypeError
        If it is no text.
    ValueError
        If there is no such column of numbers.
    """
    if not isinstance(name, str):
        raise TypeError(f"{field} = {shown(name)}: give the name of a column")
    there = [key for key, kind in found.table.schema.items() if kind.is_float()]
    if name not in there:
        raise ValueError(f"{field} = {name!r}: {no_column(name, there)}")
    return name


def unit_of(units: Mapping[str, str], name: str) -> str:
    """Return the unit of a field or measure, also of one in millimetres."""
    return units.get(name, "mm" if name.endswith("_mm") else "")


def limits(values: Numbers, *, larger: bool) -> tuple[float, float]:
    """Return the ends of a scale of colours that a few bad values do not stretch."""
    finite = np.sort(values[np.isfinite(values)])
    if not finite.size:
        return 0.0, 1.0
    if larger:
        return float(np.quantile(finite, 1 - TOLD_APART)), float(finite[-1])
    return float(finite[0]), float(np.quantile(finite, TOLD_APART))
