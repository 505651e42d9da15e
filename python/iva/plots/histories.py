"""Motion over time: the decay of the structure, velocities and accelerations of both masses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes

from iva.design import design_of
from iva.forces import Impulse, listed
from iva.parameters import numbers, shown
from iva.plots.arguments import Numbers, checked_run, frame_of, motion_of, values_of
from iva.plots.axis_units import in_millimetres, name_axis
from iva.plots.impact_ticks import impact_ticks
from iva.plots.labels import labelled
from iva.plots.legends import legend_above
from iva.plots.level_labels import label_levels
from iva.plots.styles import (
    ABSORBER,
    GREEN,
    GREY,
    PURPLE,
    SKY_BLUE,
    STRUCTURE,
    drawing_on,
)
from iva.scenes import seen_with_absorbers
from iva.simulation import Run, truth
from iva.spelling import spell_checked

#: Levels in percent whose settling times the summary has.
SETTLED = (10.0, 5.0, 2.0)


@spell_checked
def decay(
    run: Run,
    *,
    bare: Run | None = None,
    relative: bool = True,
    until: float | None = None,
    settle: Sequence[float] = (10, 5, 2),
    impacts: bool = True,
    envelope: bool = True,
    label: str | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the displacement of the structure over time, with its envelope and all impacts.

    Parameters
    ----------
    run : Run
        The run.
    bare : Run, optional
        A run of the same structure without absorber (``None`` in its place), drawn thinly behind;
        in the same units.
    relative : bool, default True
        Draw x/A₀, A₀ = |x(0)| (the first peak where x(0) = 0), instead of x in its unit.
    until : float, optional
        Last instant to draw, in the unit of time of the run; all of it by default.
    settle : sequence of float, default (10, 5, 2)
        Levels in percent of A₀ at which to draw lines; where the run settles to 10, 5 or 2 % there
        is a dot. Left out under a lasting force, for there nothing settles.
    impacts : bool, default True
        Draw a tick for every impact: wall + at the upper edge, wall − at the lower one. The run
        needs its table ``impacts``. Without absorber there is none.
    envelope : bool, default True
        Draw lines through the peaks. The run needs its table ``envelope``.
    label : str, optional
        What the legend calls the curve.
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
        If a value is out of range, a table is missing, `bare` has other units, or there is no A₀ to
        relate to: under a lasting force, or where nothing moves.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     start=iva.Start(displacement=1.0),
    ...     periods=6,
    ... )
    >>> axes = decay(run)
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('time ωₙt', 'displacement x/A₀')
    """
    motion, end = motion_of(checked_run(run, several=True, modes=True), until)
    for field, value in (("relative", relative), ("impacts", impacts), ("envelope", envelope)):
        truth(field, value)
    units = run.units["trajectory"]
    if bare is not None and checked_run(bare, "bare", modes=True).units.system != run.units.system:
        raise ValueError(f"bare is in other units ({bare.units}): give a run in {run.units}")
    lasting = any(not isinstance(force, Impulse) for force in listed(run.force))
    if relative and lasting:
        raise ValueError("relative = True: nothing decays under a lasting force; give False")
    levels = [] if lasting else numbers("settle", settle)
    for level in levels:
        if not 0.0 < level < 100.0:
            raise ValueError(f"settle has {shown(level)} in it: give percentages from 0 to 100")
    reference = reference_amplitude(run) if relative or levels else 1.0
    scale = reference if relative else 1.0
    peaks = frame_of(run, "envelope") if envelope else None
    alone = run.absorber is None
    hits = frame_of(run, "impacts") if impacts and not alone else None
    with drawing_on(ax) as axes:
        if bare is not None:
            behind, _ = motion_of(bare, until)
            axes.plot(
                behind["time"],
                behind["displacement"] / scale,
                color=GREY,
                linewidth=0.6,
                label="without absorber",
            )
        axes.plot(
            motion["time"],
            motion["displacement"] / scale,
            color=STRUCTURE,
            label=label or ("structure" if bare is None or alone else "with absorber"),
        )
        if peaks is not None:
            drawn = peaks.filter(peaks["time"] <= end)
            times, sizes = drawn["time"].to_numpy(), drawn["amplitude"].to_numpy() / scale
            for sign, name in ((1.0, "envelope"), (-1.0, "_lower envelope")):
                axes.plot(
                    times, sign * sizes, "--", color=GREY, linewidth=0.7, label=name, dashes=(4, 2)
                )
        settle_lines(axes, run, levels, reference, scale, end)
        if hits is not None:
            impact_ticks(axes, hits, end)
        axes.set_xlim(motion["time"][0], end)
        axes.margins(y=0.08)
        name_axis(axes.xaxis, partial(labelled, "time", "t"), units["time"])
        symbol, unit = ("x/A₀", "1") if relative else ("x", units["displacement"])
        in_mm = in_millimetres(run) or (bare is not None and in_millimetres(bare))
        label_of = partial(labelled, "displacement", symbol)
        name_axis(axes.yaxis, label_of, unit, millimetres=in_mm)
        legend_above(axes)
    return axes


def settle_lines(
    axes: Axes, run: Run, levels: Sequence[float], reference: float, scale: float, end: float
) -> None:
    """Draw the levels on both sides of rest, and dots where the run settles to them."""
    summary = run.summary.row(0, named=True)
    for level in levels:
        size = level / 100.0 * reference / scale
        for height in (-size, size):
            axes.axhline(height, color=GREY, linewidth=0.4, linestyle=":", zorder=1)
        time = summary[f"settling_time_{level:g}"] if level in SETTLED else None
        if time is not None and time <= end:
            height = values_of(run.at([time])["displacement"])[0] / scale
            axes.plot(
                time, height, "o", color=STRUCTURE, markersize=3, label=f"_settled to {level:g} %"
            )
    label_levels(axes, {level / 100.0 * reference / scale: f"±{level:g} %" for level in levels})


def reference_amplitude(run: Run) -> float:
    """Return A₀ = |x| at the begin of the run, or the first peak where that is 0.

    Raises
    ------
    ValueError
        If nothing moves.
    """
    start = abs(float(run.at([run.start.time or 0.0])["displacement"][0]))
    if start == 0.0:
        start = float(frame_of(run, "envelope")["amplitude"][0])
    if start == 0.0:
        raise ValueError("nothing moves in this run: there is no A₀ to relate displacements to")
    return start


#: Colours of the absorbers of a run, none that a wall has; after the last dashed from the first on.
EACH = (ABSORBER, PURPLE, SKY_BLUE, GREEN)


@spell_checked
def velocities(run: Run, *, until: float | None = None, ax: Axes | None = None) -> Axes:
    """Draw the velocities of structure and absorbers, which jump at every impact.

    Without absorber it is the velocity of the structure alone.

    Parameters
    ----------
    run : Run
        The run.
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
        If `until` is not greater than 0.

    Notes
    -----
    That of the absorber is ẋ₁ = ẋ + w; of a pendulum ẋ + (L/b) w, the horizontal velocity of its
    centre of mass. Jumps are vertical: both velocities of every impact are points of the line.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0),
    ...     iva.Primary(mass=3.0, stiffness=12_000.0),
    ...     start=iva.Start(displacement_mm=4.0),
    ...     duration=1.0,
    ... )
    >>> axes = velocities(run, until=0.5)
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('time t (s)', 'velocity ẋ, ẋ₁ (m/s)')
    """
    seen_with_absorbers(checked_run(run, several=True, modes=True))
    units = run.units["trajectory"]
    symbols = "ẋ" if run.absorber is None else "ẋ, ẋ₁"
    with drawing_on(ax) as axes:
        for place, own in enumerate(own_motions(run, until)):
            _, beside = design_of(run, place).beside(own)
            line_of_absorber(axes, run, place, own["time"], own["velocity"] + beside, "ẋ₁")
        line_of_structure(axes, run, until, "velocity", "ẋ")
        name_axis(axes.yaxis, partial(labelled, "velocity", symbols), units["velocity"])
        legend_above(axes)
    return axes


@spell_checked
def accelerations(
    run: Run, *, until: float | None = None, impacts: bool = True, ax: Axes | None = None
) -> Axes:
    """Draw the absolute accelerations of structure and absorbers between impacts.

    That of the base is included, where it moves: this is what an accelerometer on the structure
    shows between impacts. An impact is an impulse: the acceleration at that instant is infinite and
    is not drawn, and ticks at the edges say when it was. What an impact does is in
    :func:`velocities`. Without absorber it is the acceleration of the structure alone.

    Parameters
    ----------
    run : Run
        The run.
    until : float, optional
        Last instant to draw, in the unit of time of the run; all of it by default.
    impacts : bool, default True
        Draw a tick for every impact: wall + at the upper edge, wall − at the lower one. The run
        needs its table ``impacts``. Without absorber there is none.
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
        If `until` is not greater than 0, a table is missing, or the run sees its structure where
        its absorbers are not.

    Notes
    -----
    They are the columns ``acceleration`` and ``absorber_acceleration`` of ``run.trajectory()``. At
    an impact both lines are broken, for there the accelerations on either side belong to different
    velocities.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0),
    ...     iva.Primary(mass=3.0, stiffness=12_000.0),
    ...     start=iva.Start(displacement_mm=4.0),
    ...     duration=1.0,
    ... )
    >>> axes = accelerations(run, until=0.5)
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('time t (s)', 'acceleration a, a₁ (m/s²)')
    """
    seen_with_absorbers(checked_run(run, several=True, modes=True))
    truth("impacts", impacts)
    hits = frame_of(run, "impacts") if impacts and run.absorber is not None else None
    units = run.units["trajectory"]
    symbols = "a" if run.absorber is None else "a, a₁"
    with drawing_on(ax) as axes:
        for place, own in enumerate(own_motions(run, until)):
            time, values = broken(own["time"], own["absorber_acceleration"])
            line_of_absorber(axes, run, place, time, values, "a₁")
        end = line_of_structure(axes, run, until, "acceleration", "a", at_impacts=broken)
        if hits is not None:
            impact_ticks(axes, hits, end)
        name_axis(axes.yaxis, partial(labelled, "acceleration", symbols), units["acceleration"])
        legend_above(axes)
    return axes


def own_motions(run: Run, until: float | None) -> Iterator[Mapping[str, Numbers]]:
    """Yield the motion of each absorber with both states of its own impacts."""
    for place in range(design_of(run).absorbers):
        yield motion_of(run, until, place)[0]


def line_of_absorber(
    axes: Axes, run: Run, place: int, time: Numbers, values: Numbers, symbol: str
) -> None:
    """Draw something of one absorber over time."""
    name = f"absorber {symbol}" if design_of(run).absorbers == 1 else f"absorber {place}"
    dashes, colour = divmod(place, len(EACH))
    dashed = "-" if dashes == 0 else (0, (3, 1))
    axes.plot(time, values, color=EACH[colour], linestyle=dashed, linewidth=0.8, label=name)


def line_of_structure(
    axes: Axes,
    run: Run,
    until: float | None,
    column: str,
    symbol: str,
    at_impacts: Callable[[Numbers, Numbers], tuple[Numbers, Numbers]] | None = None,
) -> float:
    """Draw something of the structure over time, name that axis, and return the last instant."""
    motion, end = motion_of(run, until)
    time, values = motion["time"], motion[column]
    drawn = (time, values) if at_impacts is None else at_impacts(time, values)
    axes.plot(*drawn, color=STRUCTURE, label=f"structure {symbol}")
    axes.set_xlim(time[0], end)
    name_axis(axes.xaxis, partial(labelled, "time", "t"), run.units["trajectory"]["time"])
    return end


def broken(time: Numbers, values: Numbers) -> tuple[Numbers, Numbers]:
    """Return a line that is lifted where time stands still: at impacts."""
    jumps = np.flatnonzero(np.diff(time) == 0.0) + 1
    return np.insert(time, jumps, time[jumps]), np.insert(values, jumps, np.nan)
