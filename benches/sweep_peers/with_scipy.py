"""SciPy ``solve_ivp``: DOP853 with rtol = atol = 1e-9, the loop of :mod:`work_precision`."""

from __future__ import annotations

import numpy as np
from work_precision.results import FINISHED, Motion
from work_precision.scenes import Scene
from work_precision.with_scipy import solve

from sweep_peers.grid import UNFINISHED, Grid


def scene(grid: Grid, point: int) -> Scene:
    """Return a point as a scene."""
    one = grid.points()[point]
    return Scene(
        name=str(point),
        mass_ratio=one.mass_ratio,
        clearance=one.clearance,
        restitution=one.restitution,
        damping_ratio=grid.damping_ratio,
        frequency_ratio=grid.frequency_ratio,
        length=grid.length,
        amplitude=grid.amplitude,
        frequency=one.frequency,
        start=(grid.displacement, 0.0, 0.0, 0.0),
        end=grid.end,
        events=(),
        final=(),
    )


def impacts(run: Motion) -> int:
    """Return the number of impacts of a run, if it reached its end."""
    if run.outcome != FINISHED:
        return UNFINISHED
    return sum(event.kind == "impact" for event in run.events)


def sweep(grid: Grid, points: np.ndarray) -> list[int]:
    """Run points one by one."""
    return [impacts(solve(scene(grid, int(point)), "DOP853 1e-9")) for point in points]
