"""Bifurcation diagrams, Poincaré sections and basins of attraction."""

from __future__ import annotations

from functools import partial

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from iva import _iva, dynamics
from iva.dynamics.basin_maps import CANCELLED, NO_IMPACTS, UNDECIDED, Basins
from iva.dynamics.diagrams import Diagram
from iva.parameters import Primary, shown, spec
from iva.plots.arguments import checked_run
from iva.plots.axis_units import fields_of, in_millimetres, name_axis
from iva.plots.labels import labelled, of_column
from iva.plots.legends import legend_above
from iva.plots.styles import (
    BLACK,
    BLUE,
    CURVES,
    GREY,
    SHADES,
    VERMILLION,
    WALLS,
    drawing_on,
)
from iva.simulation import Run
from iva.spelling import spell_checked

#: Numbers of a strobe → words, symbol and quantity.
NUMBERS = {
    "displacement": ("displacement", "x", "displacement"),
    "velocity": ("velocity", "ẋ", "velocity"),
    "gap_displacement": ("gap displacement", "y", "displacement"),
    "gap_velocity": ("gap velocity", "w", "velocity"),
    "impacts": ("impacts per period", "", ""),
}
#: Instants of a section → words.
WORDS = {"strobe": "strobes", "wall+": "at the wall +", "wall-": "at the wall −", "peak": "peaks"}


@spell_checked
def diagram(diagram: Diagram, y: str = "displacement", *, ax: Axes | None = None) -> Axes:
    """Draw the strobes of a bifurcation diagram over the number that is changed.

    Parameters
    ----------
    diagram : Diagram
        The diagram; the way down is drawn below the way up.
    y : str, default "displacement"
        What is drawn: ``displacement``, ``velocity``, ``gap_displacement``, ``gap_velocity`` or
        ``impacts``.
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
        If there is no such number.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> clearances = {"clearance": [3.7, 4.1, 4.5]}
    >>> found = iva.dynamics.diagram(siva, primary, force=force, over=clearances)
    >>> axes = diagram(found)
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('clearance d (unit of length)', 'x at the strobes (unit of length)')
    """
    if not isinstance(diagram, Diagram):
        raise TypeError(f"diagram = {shown(diagram)}: give that of iva.dynamics.diagram")
    words, symbol, of = number(y)
    units = units_of(diagram.primary, diagram.over)
    frame = diagram.table
    with drawing_on(ax) as axes:
        looks = {"down": (VERMILLION, 2.0), "up": (BLUE, 1.1)}
        for way, (colour, size) in looks.items():
            part = frame.filter(pl.col("direction") == way)
            if part.height > 0:
                x, up = (part[name].to_numpy() for name in ("value", y))
                axes.plot(
                    x,
                    up,
                    ".",
                    color=colour,
                    markersize=size,
                    markeredgewidth=0.0,
                    rasterized=True,
                    label=f"{way}wards",
                )
        over = diagram.over
        given = fields_of(diagram.absorber, diagram.primary, diagram.force, diagram.start)
        # Words and symbol together are longer than the axis.
        name = f"{symbol} at the strobes" if symbol else words
        for axis, label, unit in (
            (axes.xaxis, partial(of_column, over), units.get(over, "")),
            (axes.yaxis, partial(labelled, name, ""), units.get(of, "")),
        ):
            name_axis(axis, label, unit, millimetres=in_millimetres([*given, over]))
        legend_above(axes, axes.get_legend_handles_labels()[0][::-1], markerscale=6)
    return axes


@spell_checked
def section(
    run: Run,
    at: str = "strobe",
    *,
    x: str = "displacement",
    y: str = "velocity",
    discard: int = 0,
    ax: Axes | None = None,
) -> Axes:
    """Draw a Poincaré section of a run: one number of its states over another.

    Parameters
    ----------
    run : Run
        The run.
    at : {"strobe", "wall+", "wall-", "peak"}, default "strobe"
        The instants, as for :func:`iva.dynamics.section`.
    x, y : str
        The numbers across and up: ``displacement``, ``velocity``, ``gap_displacement`` or
        ``gap_velocity``.
    discard : int, default 0
        Number of states to leave out at the begin.
    ax : matplotlib axes, optional
        Where to draw; axes of their own by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError, ValueError
        As :func:`iva.dynamics.section`, or if there is no such number.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.85),
    ...     iva.Primary(damping_ratio=0.05),
    ...     start=iva.Start(gap_velocity=0.1),
    ...     force=iva.Harmonic(amplitude=1.0, frequency=1.0),
    ...     cycles=400,
    ... )
    >>> section(run, discard=100).get_xlabel()
    'displacement x (unit of length)'
    """
    frame = dynamics.section(checked_run(run), at, discard=discard)  # type: ignore[arg-type]
    units = run.units["trajectory"]
    with drawing_on(ax) as axes:
        across, up = (frame[name].to_numpy() for name in (plain(x), plain(y)))
        colour = {"wall+": WALLS[1], "wall-": WALLS[-1]}.get(at, BLACK)
        axes.plot(
            across, up, ".", color=colour, markersize=1.5, markeredgewidth=0.0, label=WORDS[at]
        )
        for name, axis in ((x, axes.xaxis), (y, axes.yaxis)):
            words, symbol, _ = NUMBERS[name]
            label, in_mm = partial(labelled, words, symbol), in_millimetres(run)
            name_axis(axis, label, units[name], millimetres=in_mm)
        legend_above(axes, markerscale=3)
    return axes


@spell_checked
def basins(basins: Basins, *, likely: bool = True, ax: Axes | None = None) -> Axes:
    """Draw basins of attraction: each start in the colour of the orbit that it ends in.

    Parameters
    ----------
    basins : Basins
        The basins.
    likely : bool, default True
        Colour also the cells that rounding errors may have decided; otherwise they are white, as
        cells without label are. Cells that were not finished before Ctrl-C are light grey.
    ax : matplotlib axes, optional
        Where to draw; axes of their own by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError
        If an argument is of the wrong class.

    Examples
    --------
    >>> siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.4)
    >>> primary = iva.Primary(damping_ratio=0.05)
    >>> force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    >>> x, v = np.linspace(-4, 4, 12), np.linspace(-4, 4, 8)
    >>> over = {"displacement": x, "velocity": v}
    >>> found = iva.dynamics.basins(siva, primary, force=force, over=over)
    >>> axes = basins(found)
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('start displacement x₀ (unit of length)', 'start velocity ẋ₀ (unit of length · ωₙ)')
    """
    if not isinstance(basins, Basins):
        raise TypeError(f"basins = {shown(basins)}: give those of iva.dynamics.basins")
    labels = basins.likely if likely else basins.labels
    count = len(basins.attractors)
    others = (NO_IMPACTS, UNDECIDED, CANCELLED)
    present = [label for label in (*range(count), *others) if (labels == label).any()]
    some = CURVES[:-1]
    shades = SHADES(np.linspace(0.0, 1.0, max(count, 1)))
    special = {NO_IMPACTS: GREY, UNDECIDED: "white", CANCELLED: "0.9"}
    colours = [
        special[label] if label < 0 else some[label] if count <= len(some) else tuple(shades[label])
        for label in present
    ]
    places = np.select([labels == label for label in present], list(range(len(present))))
    edges = np.arange(len(present) + 1) - 0.5
    units = units_of(basins.primary, *basins.over)
    with drawing_on(ax) as axes:
        axes.pcolormesh(
            basins.x,
            basins.y,
            places,
            shading="nearest",
            cmap=ListedColormap(colours),
            norm=BoundaryNorm(edges, len(present)),
            rasterized=True,
        )
        entries = [
            Patch(facecolor=colour, edgecolor="0.5", linewidth=0.4, label=basins.name_of(label))
            for label, colour in zip(present, colours, strict=True)
        ]
        across, up = basins.over
        in_mm = in_millimetres([*fields_of(basins.absorber, basins.primary), across, up])
        for axis, name in ((axes.xaxis, across), (axes.yaxis, up)):
            name_axis(axis, partial(of_column, name), units.get(name, ""), millimetres=in_mm)
        legend_above(axes, entries)
    return axes


def plain(name: str) -> str:
    """Return the name of a number of a state.

    Raises
    ------
    ValueError
        If there is no such number.
    """
    if name == "impacts":
        raise ValueError("impacts: give a number of the state")
    number(name)
    return name


def number(name: str) -> tuple[str, str, str]:
    """Return words, symbol and quantity of a number.

    Raises
    ------
    ValueError
        If there is no such number.
    """
    if name not in NUMBERS:
        raise ValueError(f"{shown(name)}: give {', '.join(NUMBERS)}")
    return NUMBERS[name]


def units_of(primary: Primary, *names: str) -> dict[str, str]:
    """Return the units of swept numbers, of displacements and of velocities."""
    _, tables = _iva.column_units(_iva.unit_system(spec(primary)), list(names))
    found: dict[str, str] = dict(tables["summary"])
    impacts = tables["impacts"]
    for name, column in (("displacement", "displacement"), ("velocity", "velocity_before")):
        found[name] = impacts[column]
    return found
