"""A measured decay and the model that was identified from it."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np
from matplotlib.axes import Axes

from iva.identification import Fit
from iva.parameters import shown
from iva.plots.arguments import values_of
from iva.plots.axis_units import name_axis
from iva.plots.labels import labelled
from iva.plots.legends import legend_above
from iva.plots.styles import CURVES, WALLS, drawing_on
from iva.spelling import spell_checked

#: What was measured → symbol and unit.
MEASURED = {"displacement": ("x", "m"), "velocity": ("v", "m/s"), "acceleration": ("a", "m/s²")}
View = Literal["record", "residual", "restitution"]
VIEWS: tuple[View, ...] = ("record", "residual", "restitution")


@spell_checked
def fit(
    found: Fit,
    show: View = "record",
    *,
    until: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a record and the model, what is left between them, or the restitution of the impacts.

    Parameters
    ----------
    found : Fit
        Of :func:`iva.identify`.
    show : {"record", "residual", "restitution"}, default "record"
        "record": what was measured and the model's 90 % band, with ticks at the impacts, those on
        wall + above. "residual": measured less modelled over the standard deviation of the noise;
        samples that were masked are grey. "restitution": that of each impact against its approach
        speed, with 90 % intervals: one law of contact has them scattered about one line.
    until : float, optional
        Last instant to draw, in s on the clock of the record.
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
        If there is no such view, or the fit has no impacts to show.
    """
    if not isinstance(found, Fit):
        raise TypeError(f"found = {shown(found)}: give an iva.Fit, of iva.identify")
    if show not in VIEWS:
        raise ValueError(f"show = {shown(show)}: give one of {', '.join(VIEWS)}")
    if show == "restitution" and not found.impacts.height:
        raise ValueError('show = "restitution": the fit has no impacts; give record or residual')
    with drawing_on(ax) as axes:
        if show == "restitution":
            of_impacts(found, axes)
        else:
            (of_record if show == "record" else of_residual)(found, axes)
            end = found.time[-1] if until is None else until
            axes.set_xlim(found.time[0], end)
            name_axis(axes.xaxis, partial(labelled, "time", "t"), "s")
    return axes


def of_record(found: Fit, axes: Axes) -> None:
    """Draw what was measured, the band of the model, and the impacts."""
    # Wide and pale, so that it is seen on both sides of the model.
    axes.plot(found.time, found.values, color="0.75", linewidth=2.0, label="measured")
    axes.fill_between(
        found.time, found.low, found.high, color=CURVES[0], alpha=0.35, linewidth=0.0, label="_90 %"
    )
    axes.plot(found.time, found.prediction, color=CURVES[0], linewidth=0.7, label="model")
    for wall, marker, place in ((1, "v", 0.98), (-1, "^", 0.02)):
        at = found.impacts.filter(found.impacts["wall"] == wall)["time"]
        if not len(at):
            continue
        axes.plot(
            at,
            np.full(len(at), place),
            marker,
            color=WALLS[wall],
            markersize=3,
            transform=axes.get_xaxis_transform(),
            label=f"impact on wall {'+' if wall > 0 else '−'}",
        )
    # Pulses of contacts are many times as high as the motion: they do not take the whole axis.
    finite = found.values[np.isfinite(found.values)]
    inside = np.quantile(np.abs(finite - np.median(finite)), 0.99)
    middle = float(np.median(finite))
    axes.set_ylim(middle - 1.5 * inside, middle + 1.5 * inside)
    symbol, unit = MEASURED[found.quantity]
    name_axis(axes.yaxis, partial(labelled, found.quantity, symbol), unit)
    legend_above(axes)


def of_residual(found: Fit, axes: Axes) -> None:
    """Draw what is left over the noise."""
    left = found.residual / found.noise
    axes.plot(found.time[~found.mask], left[~found.mask], ",", color="0.75", label="_masked")
    axes.plot(found.time[found.mask], left[found.mask], ",", color=CURVES[0])
    bound = max(5.0, float(np.nanquantile(np.abs(left[found.mask]), 0.999)) * 1.2)
    axes.set_ylim(-bound, bound)
    axes.set_ylabel("residual over noise")


def of_impacts(found: Fit, axes: Axes) -> None:
    """Draw the restitution of each impact against its approach speed."""
    columns = {name: values_of(found.impacts[name]) for name in found.impacts.columns}
    middle, at = columns["restitution"], columns["approach_speed"]
    axes.errorbar(
        at,
        middle,
        yerr=np.maximum(
            [middle - columns["restitution_low"], columns["restitution_high"] - middle], 0.0
        ),
        xerr=np.maximum(
            [at - columns["approach_speed_low"], columns["approach_speed_high"] - at], 0.0
        ),
        fmt="o",
        markersize=3,
        elinewidth=0.6,
        color=CURVES[0],
        label="an impact, 90 %",
    )
    row = found.parameters.filter(found.parameters["parameter"] == "restitution").row(0, named=True)
    axes.axhspan(row["low"], row["high"], color="0.85", zorder=0, label="the model's, 90 %")
    axes.axhline(row["value"], color="0.4", linewidth=0.8)
    axes.set_ylim(0.0, 1.05)
    axes.set_xlim(left=0.0)
    name_axis(axes.xaxis, partial(labelled, "approach speed", ""), "m/s")
    axes.set_ylabel("restitution e")
    legend_above(axes)
