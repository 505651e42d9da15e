"""Branches of periodic orbits, their multipliers, and curves of their special points."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import partial
from itertools import cycle, groupby
from operator import attrgetter

import numpy as np
import polars as pl
from matplotlib.axes import Axes

from iva import _iva
from iva.dynamics.branches import Branch, Row
from iva.dynamics.changed_scenes import Scene
from iva.dynamics.curves import Curve
from iva.dynamics.orbits import in_units_of
from iva.parameters import shown, spec
from iva.plots.axis_units import fields_of, in_millimetres, name_axis
from iva.plots.labels import labelled, of_column
from iva.plots.legends import legend_above
from iva.plots.styles import BLACK, BLUE, CURVES, GREY, VERMILLION, drawing_on
from iva.scenes import absorbers
from iva.spelling import spell_checked
from iva.structures import Structure

#: Kind of a special point → marker and words.
MARKERS = {
    "fold": (">", "fold"),
    "pitchfork": ("s", "pitchfork"),
    "flip": ("D", "flip"),
    "neimark_sacker": ("o", "Neimark–Sacker"),
    "grazing": ("x", "grazing"),
    "impact_vanishes": ("+", "impact vanishes"),
    "stick_begins": ("v", "stick begins"),
    "impacts_coincide": ("*", "impacts coincide"),
    "slide_changes": ("^", "slide changes"),
}
#: Columns of a branch that are drawn → words, symbol and quantity.
COLUMNS = {
    "amplitude": ("amplitude", "max |x|", "displacement"),
    "largest_multiplier": ("largest multiplier", "|λ|", ""),
    "grazing_margin": ("margin to a grazing", "", "displacement"),
    "approach_speed_min": ("smallest approach speed", "", "velocity"),
}


#: The axis of multipliers ends here unless all are smaller.
MOST_MULTIPLIER = 10.0


@spell_checked
def branch(
    branches: Branch | Iterable[Branch],
    y: str = "amplitude",
    *,
    ax: Axes | None = None,
) -> Axes:
    """Draw branches of periodic orbits: full lines where they are stable, dashed where not.

    Parameters
    ----------
    branches : Branch or iterable of Branch
        Branches over the same number.
    y : str, default "amplitude"
        The column to draw: ``amplitude``, ``largest_multiplier``, ``grazing_margin`` or
        ``approach_speed_min``. Multipliers are drawn up to 10, for they have no bound where an
        impact vanishes; ``axes.set_ylim`` shows more or less of them.
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
        If there is no branch, the branches are over different numbers, or there is no such column.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> first = iva.dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    >>> found = iva.dynamics.follow(first, over="clearance", between=(3.0, 8.0))
    >>> axes = branch(found)
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('clearance d (unit of length)', 'amplitude max |x| (unit of length)')
    """
    given = listed(branches)
    if y not in COLUMNS:
        raise ValueError(f"y = {shown(y)}: give {', '.join(COLUMNS)}")
    words, symbol, of = COLUMNS[y]
    units = units_of(given[0])
    with drawing_on(ax) as axes:
        for one in given:
            lines(axes, one, y)
        marked(axes, given, y)
        over, in_mm = given[0].scene.over, any(scene_in_mm(one.scene) for one in given)
        for axis, label, unit in (
            (axes.xaxis, partial(of_column, over), units.get(over, "")),
            (axes.yaxis, partial(labelled, words, symbol), units.get(of, "")),
        ):
            name_axis(axis, label, unit, millimetres=in_mm)
        if y == "largest_multiplier" and axes.get_ylim()[1] > MOST_MULTIPLIER:
            axes.set_ylim(0.0, MOST_MULTIPLIER)
        axes.plot([], [], color=BLUE, label="stable")
        axes.plot([], [], color=GREY, linestyle="--", label="unstable")
        legend_above(axes)
    return axes


def lines(axes: Axes, one: Branch, y: str) -> None:
    """Draw a branch in stretches of equal stability, each up to the first point of the next."""
    frame = one.table
    across, up = (frame[name].cast(pl.Float64).to_numpy() for name in ("value", y))
    stable = frame["stable"].to_numpy()
    begin = 0
    for is_stable, group in groupby(stable):
        end = begin + len(list(group))
        part = slice(begin, min(end + 1, len(stable)))
        colour, dashes = (BLUE, "-") if is_stable else (GREY, "--")
        axes.plot(across[part], up[part], color=colour, linestyle=dashes, label="_branch")
        begin = end


def marked(axes: Axes, branches: Sequence[Branch], y: str) -> None:
    """Draw the special points, each kind with its marker and one entry in the legend."""
    points = [point for one in branches for point in one.points]
    by_kind = attrgetter("kind")
    for kind, group in groupby(sorted(points, key=by_kind), key=by_kind):
        rows = [point.row for point in group]
        marker, label = MARKERS[kind]
        up = [height(row, y) for row in rows]
        across = [row.value for row in rows]
        axes.plot(across, up, marker, color=VERMILLION, markersize=4, label=label, fillstyle="none")


def height(row: Row, y: str) -> float:
    """Return the value of a column at a special point."""
    if y == "largest_multiplier":
        return float(abs(row.multipliers[0]))
    value: float | None = getattr(row, y)
    return math.nan if value is None else value


@spell_checked
def multipliers(branches: Branch | Iterable[Branch], *, ax: Axes | None = None) -> Axes:
    """Draw the Floquet multipliers of branches in the complex plane, with the unit circle.

    Parameters
    ----------
    branches : Branch or iterable of Branch
        The branches; multipliers of size up to 2 are drawn.
    ax : matplotlib axes, optional
        Where to draw; axes of their own by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError, ValueError
        As :func:`branch`.
    """
    given = listed(branches)
    with drawing_on(ax) as axes:
        turn = np.linspace(0.0, 2.0 * math.pi, 361)
        axes.plot(np.cos(turn), np.sin(turn), color=BLACK, linewidth=0.6)
        every = np.array([row.multipliers for one in given for row in one.rows])
        stable = np.array([row.stable for one in given for row in one.rows])
        for which, colour, label in ((stable, BLUE, "stable"), (~stable, VERMILLION, "unstable")):
            values = every[which].ravel()
            axes.plot(values.real, values.imag, ".", color=colour, markersize=1.5, label=label)
        axes.set_xlim(-2.0, 2.0)
        axes.set_ylim(-1.3, 1.3)
        axes.set_aspect("equal")
        axes.set_xlabel("Re λ")
        axes.set_ylabel("Im λ")
        legend_above(axes)
    return axes


@spell_checked
def stability_chart(curves: Curve | Iterable[Curve], *, ax: Axes | None = None) -> Axes:
    """Draw curves of special points over the same two numbers: where steady states change.

    Parameters
    ----------
    curves : Curve or iterable of Curve
        The curves, of :func:`iva.dynamics.curve`.
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
        If there is no curve, or they are over different numbers.
    """
    given = [curves] if isinstance(curves, Curve) else list(curves)
    for one in given:
        if not isinstance(one, Curve):
            raise TypeError(f"curves: {shown(one)} is none; give those of iva.dynamics.curve")
    if len({one.over for one in given}) != 1:
        rule = "give curves over the same two numbers" if given else "give at least one"
        raise ValueError(f"curves: {rule}")
    across, up = given[0].over
    system = _iva.unit_system(spec(in_units_of(given[0].scene.primary)))
    units = _iva.column_units(system, [across, up])[1]["summary"]
    with drawing_on(ax) as axes:
        for colour, one in zip(cycle(CURVES), given, strict=False):
            columns = zip(*one.values, strict=True)
            axes.plot(
                *(list(column) for column in columns), color=colour, label=MARKERS[one.kind][1]
            )
        in_mm = any(scene_in_mm(one.scene) for one in given)
        for axis, name in ((axes.xaxis, across), (axes.yaxis, up)):
            name_axis(axis, partial(of_column, name), units.get(name, ""), millimetres=in_mm)
        legend_above(axes)
    return axes


def listed(branches: Branch | Iterable[Branch]) -> list[Branch]:
    """Return branches as a list.

    Raises
    ------
    TypeError
        If one is none.
    ValueError
        If there is none, or they are over different numbers.
    """
    given = [branches] if isinstance(branches, Branch) else list(branches)
    for one in given:
        if not isinstance(one, Branch):
            raise TypeError(f"branches: {shown(one)} is none; give those of iva.dynamics.follow")
    numbers = {one.scene.over for one in given}
    if len(numbers) != 1:
        rule = "give branches over one number" if numbers else "give at least one"
        raise ValueError(f"branches: {rule}")
    return given


def scene_in_mm(scene: Scene) -> bool:
    """Return whether lengths of a scene were given in mm."""
    primary = None if isinstance(scene.primary, Structure) else scene.primary
    given = fields_of(*absorbers(scene.absorber), primary, scene.force, scene.start)
    return in_millimetres([*given, scene.over])


def units_of(one: Branch) -> dict[str, str]:
    """Return the units of the number that is changed, of displacements and of velocities."""
    system = _iva.unit_system(spec(in_units_of(one.scene.primary)))
    _, tables = _iva.column_units(system, [one.scene.over])
    impacts = tables["impacts"]
    found: dict[str, str] = dict(tables["summary"])
    found["displacement"] = impacts["displacement"]
    found["velocity"] = impacts["velocity_before"]
    return found
