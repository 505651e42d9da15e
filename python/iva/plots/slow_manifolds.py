"""A run over the slow manifold of its absorber."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from iva import theory
from iva.design import design_of
from iva.dynamics.search import whole
from iva.parameters import Siva
from iva.plots.arguments import checked_run, frame_of
from iva.plots.axis_units import name_axis
from iva.plots.labels import labelled
from iva.plots.legends import legend_above
from iva.plots.styles import BLACK, BLUE, GREY, drawing_on
from iva.simulation import Run
from iva.spelling import spell_checked

#: Number of points of the curve.
POINTS = 400


@spell_checked
def slow_manifold(run: Run, *, discard: int = 0, ax: Axes | None = None) -> Axes:
    """Draw the half cycles of a run over the slow manifold of its absorber.

    A half cycle is a flight from one wall to the other. Across is θ, the amplitude of a zigzag of
    the speed of that flight at ωn, over the clearance d; up is ξ, the peak of the structure that is
    nearest in time, over d. A strongly modulated response goes along the stable part of the
    manifold, falls off it where it folds, and comes back after a time without regular impacts.

    Parameters
    ----------
    run : Run
        A run of a free mass with the tables ``impacts`` and ``envelope``.
    discard : int, default 0
        Number of impacts to leave out at the begin.
    ax : matplotlib axes, optional
        Where to draw; axes of their own by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError
        If an argument is of the wrong class, or the absorber is not a free mass.
    ValueError
        If the clearance is relative to a start, or the run was made without one of the tables.

    Notes
    -----
    :func:`iva.theory.slow_manifold`: to first order in μ, for a vibration near ωn.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.02, restitution=0.6, clearance=1.0),
    ...     iva.Primary(damping_ratio=0.01),
    ...     force=iva.Harmonic(amplitude=0.008, frequency=1.0),
    ...     start=iva.Start(gap_velocity=0.1),
    ...     cycles=100,
    ... )
    >>> slow_manifold(run).get_xlabel()
    'amplitude of the absorber θ'
    """
    absorber = checked_run(run).absorber
    manifold = theory.slow_manifold(absorber, run.primary)  # type: ignore[arg-type]
    assert isinstance(absorber, Siva)
    theta, xi = half_cycles(run, whole("discard", discard, 0, 10**12))
    most = 1.15 * max([1.2, *theta])
    top = 1.5 * max([manifold.activation, *xi])
    curve = np.linspace(most / POINTS, most, POINTS)
    height = np.array([manifold.amplitude(one) for one in curve])
    low, high = manifold.stable_theta
    stable = (curve >= low) & (curve <= high)
    with drawing_on(ax) as axes:
        axes.plot(theta, xi, ".", color=BLACK, markersize=3.5, markeredgewidth=0.0, label="run")
        axes.plot(
            curve, np.where(stable, np.nan, height), color=GREY, linestyle="--", label="unstable"
        )
        axes.plot(curve, np.where(stable, height, np.nan), color=BLUE, label="stable")
        axes.set_xlim(0.0, most)
        axes.set_ylim(0.0, top)
        name_axis(axes.xaxis, partial(labelled, "amplitude of the absorber", "θ"), "1")
        name_axis(axes.yaxis, partial(labelled, "amplitude of the structure", "ξ"), "1")
        legend_above(axes)
    return axes


def half_cycles(run: Run, discard: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return θ and ξ of each flight from one wall to the other.

    Raises
    ------
    ValueError
        If the run was made without a table.
    """
    hits, peaks = frame_of(run, "impacts")[discard:], frame_of(run, "envelope")
    design = design_of(run)
    assert design.clearance is not None
    if hits.height < 2 or peaks.height == 0:
        return np.empty(0), np.empty(0)
    wall, time = hits["wall"].to_numpy(), hits["time"].to_numpy()
    across = wall[1:] != wall[:-1]
    speed = np.abs(hits["absorber_velocity_after"].to_numpy()[:-1][across])
    middle = (0.5 * (time[1:] + time[:-1]))[across]
    at = peaks["time"].to_numpy()
    later = np.clip(np.searchsorted(at, middle), 1, max(at.size - 1, 1)) if at.size > 1 else 0
    earlier = np.maximum(later - 1, 0)
    nearest = np.where(middle - at[earlier] < at[later] - middle, earlier, later)
    xi = peaks["amplitude"].to_numpy()[nearest] / design.clearance
    return speed * math.pi / (2.0 * design.clearance * design.natural_frequency), xi
