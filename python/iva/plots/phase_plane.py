"""The phase plane of the structure, and that of the gap."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from iva.design import design_of
from iva.plots.arguments import checked_absorber, checked_run, motion_of
from iva.plots.labels import labelled
from iva.plots.styles import STRUCTURE, VERMILLION, drawing_on, legend_above
from iva.simulation import Run, truth
from iva.spelling import spell_checked


@spell_checked
def phase(
    run: Run,
    *,
    relative: bool = False,
    absorber: int = 0,
    until: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw velocity over displacement; impacts are vertical jumps.

    Parameters
    ----------
    run : Run
        The run.
    relative : bool, default False
        Draw the absorber in its gap, w over y, with the walls at y = ±d; otherwise the structure,
        ẋ over x.
    absorber : int, default 0
        The number of the absorber whose gap is drawn, of several.
    until : float, optional
        Last instant to draw, in the unit of time of the run; all of it by default.
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
        If `until` is not greater than 0, or `relative` is asked of a run without this absorber.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     start=iva.Start(displacement=1.0),
    ...     periods=6,
    ... )
    >>> phase(run, relative=True).get_xlabel()
    'gap displacement y (unit of x₀)'
    """
    truth("relative", relative)
    if checked_run(run, several=True, modes=True).absorber is None and relative:
        raise ValueError("relative = True: this run has no absorber, and so no gap; give False")
    place = checked_absorber(run, absorber) if relative else 0
    motion, _ = motion_of(run, until, place if relative else None)
    units = run.units["trajectory"]
    across, up = ("gap_displacement", "gap_velocity") if relative else ("displacement", "velocity")
    symbols = ("y", "w") if relative else ("x", "ẋ")
    with drawing_on(ax) as axes:
        x, y = motion[across], motion[up]
        # Where time stands still the state has jumped: the line is lifted there.
        still = np.diff(motion["time"]) == 0.0
        # Without absorber the gap velocity is NaN, and no jump.
        jumps = np.flatnonzero(still & (np.abs(np.diff(motion["gap_velocity"])) > 0.0))
        if not relative and design_of(run).absorbers > 1:
            jumps = np.flatnonzero(still & (np.abs(np.diff(motion["velocity"])) > 0.0))
        if relative:
            design = design_of(run, place)
            assert design.clearance is not None
            walls(axes, design.clearance, design.gap_offset)
        axes.plot(
            np.insert(x, jumps + 1, np.nan),
            np.insert(y, jumps + 1, np.nan),
            color=STRUCTURE,
            linewidth=0.7,
            label="flight",
        )
        before, after = (np.column_stack([x[at], y[at]]) for at in (jumps, jumps + 1))
        axes.add_collection(
            LineCollection(
                list(np.stack([before, after], axis=1)),
                colors=VERMILLION,
                linewidths=0.7,
                linestyles=[(0, (2, 1))],
                zorder=2.5,
                label="impact" if run.absorber is not None else "_no impact",
            )
        )
        axes.plot(x[0], y[0], "o", color=STRUCTURE, label="start", markersize=3)
        words = "gap " if relative else ""
        axes.set_xlabel(labelled(f"{words}displacement", symbols[0], units[across]))
        axes.set_ylabel(labelled(f"{words}velocity", symbols[1], units[up]))
        legend_above(axes, 4 if relative else 3)
    return axes


def walls(axes: Axes, clearance: float, middle: float) -> None:
    """Draw the walls of the gap, hatched on the side where the absorber never is."""
    outside = 1.12 * clearance
    for sign, name in ((1.0, "walls"), (-1.0, "_wall −")):
        axes.axvline(middle + sign * clearance, color="0.3", linewidth=0.8, label=name)
        axes.axvspan(
            middle + sign * clearance,
            middle + sign * outside,
            facecolor="0.92",
            edgecolor="0.6",
            hatch="////",
            linewidth=0.0,
            zorder=0,
        )
    axes.set_xlim(middle - outside, middle + outside)
