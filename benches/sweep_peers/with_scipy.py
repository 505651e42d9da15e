"""SciPy ``solve_ivp``: DOP853 with rtol = atol = 1e-9, the loop of :mod:`work_precision`."""

from __future__ import annotations

import numpy as np
from work_precision.scenes import Scene
from work_precision.with_scipy import solve

from sweep_peers.grid import DAMPING_RATIO, END, Grid


def scene(grid: Grid, point: int) -> Scene:
    """Return a point as a scene."""
    mass_ratio, clearance, restitution = grid.points()[point]
    return Scene(
        name=f"{grid.kind} {point}",
        mass_ratio=mass_ratio,
        clearance=clearance,
        restitution=restitution,
        damping_ratio=DAMPING_RATIO,
        frequency_ratio=grid.frequency_ratio,
        length=grid.length,
        amplitude=0.0,
        frequency=1.0,
        start=(1.0, 0.0, 0.0, 0.0),
        end=END,
        events=(),
        final=(),
    )


def sweep(grid: Grid, points: np.ndarray) -> list[int]:
    """Run points one by one."""
    runs = [solve(scene(grid, int(point)), "DOP853 1e-9") for point in points]
    return [sum(event.kind == "impact" for event in run.events) for run in runs]
