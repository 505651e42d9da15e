"""The phase plane of the structure, and that of the gap."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from iva.design import design_of
from iva.plots.arguments import Numbers, checked_absorber, checked_run, motion_of
from iva.plots.axis_units import in_millimetres, name_axis
from iva.plots.labels import labelled
from iva.plots.legends import legend_above
from iva.plots.styles import STRUCTURE, WALLS, drawing_on
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
    """Draw velocity over displacement; impacts are vertical jumps in the colour of their wall.

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
    'gap displacement y (unit of length)'
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
            walls(axes, design.clearance, design.gap_offset, design.walls)
        axes.plot(
            np.insert(x, jumps + 1, np.nan),
            np.insert(y, jumps + 1, np.nan),
            color=STRUCTURE,
            linewidth=0.7,
            label="flight",
        )
        own = [place] if relative else range(design_of(run).absorbers)
        impacts(axes, run, until, own, (across, up))
        axes.plot(x[0], y[0], "o", color=STRUCTURE, label="start", markersize=3)
        words, in_mm = "gap " if relative else "", in_millimetres(run)
        for axis, name, symbol, of in (
            (axes.xaxis, "displacement", symbols[0], across),
            (axes.yaxis, "velocity", symbols[1], up),
        ):
            label = partial(labelled, words + name, symbol)
            name_axis(axis, label, units[of], millimetres=in_mm)
        legend_above(axes)
    return axes


def impacts(
    axes: Axes, run: Run, until: float | None, absorbers: Iterable[int], columns: tuple[str, str]
) -> None:
    """Draw the jumps at the impacts of some absorbers, in the colour of the wall."""
    jumps: dict[int, list[Numbers]] = {1: [], -1: []}
    for absorber in absorbers:
        motion, _ = motion_of(run, until, absorber)
        struck = np.diff(motion["gap_velocity"]) != 0.0
        before = np.flatnonzero(struck & (np.diff(motion["time"]) == 0.0))
        side = motion["gap_displacement"][before] > design_of(run, absorber).gap_offset
        states = np.column_stack([motion[name] for name in columns])
        ends = np.stack([states[before], states[before + 1]], axis=1)
        for wall, of_wall in ((1, side), (-1, ~side)):
            jumps[wall].append(ends[of_wall])
    for wall, name in ((1, "wall +"), (-1, "wall −")):
        if jumps[wall]:
            drawn = LineCollection(
                list(np.concatenate(jumps[wall])),
                colors=WALLS[wall],
                linewidths=0.7,
                linestyles=[(0, (2, 1))],
                zorder=2.5,
                label=f"impacts, {name}",
            )
            axes.add_collection(drawn)


def walls(axes: Axes, clearance: float, middle: float, there: tuple[bool, bool]) -> None:
    """Draw the walls of the gap that there are, hatched on the side where the absorber never is."""
    outside = 1.12 * clearance
    for sign, exists in ((1.0, there[1]), (-1.0, there[0])):
        if not exists:
            continue
        name = "walls" if sign > 0.0 or not there[1] else "_wall −"
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
