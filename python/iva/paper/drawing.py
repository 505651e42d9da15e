"""How the paper's figures are drawn: with :mod:`iva.plots`, a panel for each run or measure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import iva
from iva import plots
from iva.paper import bands
from iva.paper.measures import FIRST, FIT, TEN, THREE, TO_5, TO_10
from iva.plots.axis_units import name_axis
from iva.plots.legends import legend_above
from iva.plots.styles import BLACK, BLUE, CURVES, GREEN, GREY, ORANGE, VERMILLION

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from iva.paper.table1 import Fit

#: What the panels of damping show, in their order.
PANELS = (FIRST, THREE, TEN, FIT, TO_10, TO_5)

#: Swept parameters as axes call them.
AXES = {
    "relative_clearance": "relative clearance γ = d/x₀",
    "frequency_ratio": "frequency ratio r = ωp/ωₙ",
    "mass_ratio": "mass ratio μ = m/M",
}
#: Two columns of a page; one of them.
WIDE, NARROW = 7.0, 3.35


def motions(runs: Mapping[str, iva.Run]) -> pl.DataFrame:
    """Return the trajectories of several runs in one table, told apart by ``curve``."""
    return pl.concat(
        [
            run.trajectory(60).drop("point").insert_column(0, pl.lit(name).alias("curve"))
            for name, run in runs.items()
        ]
    )


def decays(runs: Mapping[str, iva.Run], without: iva.Run, until: float) -> Figure:
    """Draw a panel for each run, the structure alone in grey behind it."""
    with plots.style():
        figure = Figure(figsize=(WIDE, 0.5 + 1.25 * len(runs)), layout="constrained")
        panels = figure.subplots(len(runs), sharex=True, sharey=True)
        for axes, (name, run) in zip(panels_of(panels), runs.items(), strict=True):
            plots.decay(run, bare=without, envelope=False, settle=(5,), until=until, ax=axes)
            legend = axes.get_legend()
            if legend:
                legend.remove()
            axes.set_title(name, loc="left")
            axes.label_outer()
        figure.suptitle(
            "grey: without absorber; ticks: impacts on either wall; dot: below 5 % from here on",
            fontsize=7,
            color=GREY,
        )
    return figure


def velocities(run: iva.Run) -> Figure:
    """Draw the velocities of both masses."""
    with plots.style():
        figure = Figure(figsize=(WIDE, 2.4), layout="constrained")
        plots.velocities(run, ax=figure.subplots())
    return figure


def phase(run: iva.Run) -> Figure:
    """Draw the phase plane of the structure and that of the gap."""
    with plots.style():
        figure = Figure(figsize=(WIDE, 3.1), layout="constrained")
        left, right = figure.subplots(1, 2)
        plots.phase(run, ax=left)
        plots.phase(run, relative=True, ax=right)
    return figure


def impact_curves(summary: pl.DataFrame, by: str, symbol: str) -> Figure:
    """Draw the number of impacts over the clearance, a curve for each value of a parameter."""
    with plots.style():
        figure = Figure(figsize=(NARROW, 2.6), layout="constrained")
        axes = figure.subplots()
        jumps = lines(axes, summary, "relative_clearance", by, symbol, summary["impacts_until_5"])
        axes.set_yscale("log")
        axes.set_ylabel("impacts until 5 %")
        legend_above(axes)
        noted(figure, jumps)
    return figure


def damping_panels(summary: pl.DataFrame, x: str, by: str, symbol: str) -> Figure:
    """Draw the damping over a parameter, a panel for each measure."""
    with plots.style():
        figure = Figure(figsize=(WIDE, 4.2), layout="constrained")
        panels, jump = figure.subplots(2, 3, sharex=True), False
        for axes, measure in zip(panels.flat, PANELS, strict=True):
            damping = pl.Series(measure.of(summary)).fill_nan(None)
            jumps = lines(axes, summary, x, by, symbol, damping)
            jump = jump or jumps
            axes.set_title(measure.label, loc="left")
            axes.set_ylim(0.0, highest(damping) if jumps else None)
        for axes in panels[:, 0]:
            axes.set_ylabel("damping ratio")
        for axes in panels[0]:
            axes.set_xlabel("")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
        noted(figure, jump)
    return figure


def highest(values: pl.Series) -> float:
    """Return the end of an axis that single high points do not stretch."""
    return 1.1 * float(np.nanquantile(values.cast(pl.Float64).fill_null(np.nan).to_numpy(), 0.99))


def noted(figure: Figure, jumps: bool) -> None:
    """Say above a figure what lines and bands are, if there are any."""
    if jumps:
        wide = figure.get_figwidth() > NARROW
        text = bands.NOTE if wide else bands.NOTE.replace("axis; ", "axis;\n", 1)
        figure.suptitle(text, fontsize=7, color=GREY)


def lines(
    axes: Axes, summary: pl.DataFrame, x: str, by: str, symbol: str, values: pl.Series
) -> bool:
    """Draw a curve for each value of a parameter; return whether they jump, and are banded."""
    drawn = summary.select(x, by).with_columns(values.cast(pl.Float64).alias("value"))
    parts = drawn.partition_by(by, maintain_order=True)
    curves = [part["value"].fill_null(np.nan).to_numpy() for part in parts]
    jump = any(bands.jumps(curve) for curve in curves)
    # Starts of different size give nearly the same curve: each is seen below the next.
    widths = (2.6, 1.6, 0.6) if by == "gravity" else 2 * len(CURVES) * (0.9,)
    for color, width, part, curve in zip(CURVES * 2, widths, parts, curves, strict=False):
        label = f"{symbol} = {part[by][0]:g}"
        at = part[x].to_numpy()
        if jump:
            bands.draw(axes, at, curve, color, label, width)
        else:
            axes.plot(at, curve, color=color, linewidth=width, label=label)
    name_axis(axes.xaxis, partial(named, AXES[x]), "1")
    return jump


def named(words: str, unit: str) -> str:  # noqa: ARG001 (these have none)
    """Return the label of a parameter without unit."""
    return words


def table1(
    printed: Sequence[tuple[float, float, float, float]], best: Fit, fits: Sequence[Fit]
) -> Figure:
    """Draw the eight rows beside the best fit, and how far every fit is off."""
    with plots.style():
        figure = Figure(figsize=(WIDE, 2.9), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.2))
        at = range(len(printed))
        left.plot(at, [row[2] for row in printed], "o", color=BLACK, label="experiment, printed")
        left.plot(at, [row[3] for row in printed], "_", color=GREY, label="simulation, printed")
        left.plot(at, best.rows, "x", color=VERMILLION, label="this model, fitted")
        left.set_xticks(at, [f"{row[0]:g}\n{row[1]:g}" for row in printed])
        left.set_xlabel("relative clearance γ, mass ratio μ")
        left.set_ylabel("“damping ratio” of Table 1")
        left.set_ylim(bottom=0.0)
        legend_above(left)
        spread(right, fits)
    return figure


def spread(axes: Axes, fits: Sequence[Fit]) -> None:
    """Draw the root mean square difference of every fit."""
    kinds = {
        ("logarithmic decrement", "consistent"): (BLUE, "o"),
        ("logarithmic decrement", "printed"): (ORANGE, "s"),
        ("damping ratio", "consistent"): (GREEN, "^"),
        ("damping ratio", "printed"): (VERMILLION, "v"),
    }
    measures = list(dict.fromkeys(fit.measure.label for fit in fits))
    for (reading, law), (color, marker) in kinds.items():
        chosen = [fit for fit in fits if (fit.reading, fit.impact_law) == (reading, law)]
        axes.plot(
            [fit.rms for fit in chosen],
            [measures.index(fit.measure.label) for fit in chosen],
            marker,
            color=color,
            label=f"{reading}, {law} law",
        )
    axes.set_yticks(range(len(measures)), measures)
    axes.invert_yaxis()
    axes.set_xlim(left=0.0)
    axes.set_xlabel("r.m.s. difference from the experiment, best ζ and e")
    legend_above(axes)


def panels_of(panels: object) -> list[Axes]:
    """Return the axes that ``subplots`` made, whether one or many."""
    return [panels] if isinstance(panels, Axes) else list(panels.flat)  # type: ignore[attr-defined]
