"""heyoka: one compiled integrator a kind, scenes as parameters; one by one or in batches of lanes.

The callback of an event is Python, as a user writes it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import heyoka as hy
import numpy as np

from sweep_peers.grid import UNFINISHED, Grid

#: An impact law without chatter would go on for ever.
MOST = 4000
Integrator = Any  # the package has no types


class Impact:
    """The impact law; counts in a fifth variable."""

    def __init__(self, length: float) -> None:
        self.length = length

    def __call__(self, integrator: Integrator, _: int, lane: int | None = None) -> bool:
        """Apply it to the state, of one lane where there are several."""
        state, (mu, _gap, e) = integrator.state, integrator.pars[:3]
        if lane is not None:
            state, mu, e = state[:, lane], mu[lane], e[lane]
        # Velocity of the absorber against the primary, along the gap.
        reach = self.length * math.cos(state[2]) if self.length else 1.0
        state[1] += mu * (1 + e) / (1 + mu) * reach * state[3]
        state[3] *= -e
        state[4] += 1
        return bool(state[4] < MOST)


def system(grid: Grid) -> tuple[list[Any], Any]:
    """Return the equations, and the gap displacement."""
    x, v, q, rate, count = hy.make_vars("x", "v", "q", "rate", "count")
    push = -2 * grid.damping_ratio * v - x
    if grid.amplitude:
        push = push + grid.amplitude * hy.cos(hy.par[3] * hy.time)
    # The last parameter is 0: with it in an equation heyoka has room for all of them.
    idle = (count, hy.par[4])
    if not grid.length:
        return [(x, v), (v, push), (q, rate), (rate, -push), idle], q
    mu, length = hy.par[0], grid.length
    gravity = grid.frequency_ratio**2 * length
    s, c = hy.sin(q), hy.cos(q)
    pull = push + mu * s * (length * rate * rate + gravity * c)
    spring = grid.spring_ratio**2 * q if grid.spring_ratio else 0.0
    if grid.spring_ratio:
        pull = pull + mu * length * c * spring
    a = pull / (1 + mu * s * s)
    b = -(a * c + gravity * s) / length - spring
    return [(x, v), (v, a), (q, rate), (rate, b), idle], length * s


@lru_cache
def integrator(grid: Grid, tolerance: float, lanes: int | None) -> Integrator:
    """Compile an integrator."""
    equations, gap = system(grid)
    law, rising = Impact(grid.length), hy.event_direction.positive
    event = hy.t_event if lanes is None else hy.t_event_batch
    events = [event(side * gap - hy.par[1], callback=law, direction=rising) for side in (1, -1)]
    if lanes is None:
        return hy.taylor_adaptive(
            equations, np.zeros(5), tol=tolerance, pars=np.ones(5), t_events=events
        )
    return hy.taylor_adaptive_batch(
        equations, np.zeros((5, lanes)), tol=tolerance, pars=np.ones((5, lanes)), t_events=events
    )


def start(grid: Grid) -> np.ndarray:
    """Return the state at time zero."""
    return np.array([grid.displacement, 0.0, 0.0, 0.0, 0.0])


def scalar(tolerance: float) -> Callable[[Grid, np.ndarray], list[int]]:
    """Return a sweep one by one."""

    def sweep(grid: Grid, points: np.ndarray) -> list[int]:
        run, begin = integrator(grid, tolerance, None), start(grid)
        counts = []
        for point in points:
            run.time, run.state[:] = 0.0, begin
            run.pars[:] = (*grid.points()[point], 0.0)
            run.reset_cooldowns()
            run.propagate_until(grid.end)
            counts.append(int(run.state[4]) if run.time == grid.end else UNFINISHED)
        return counts

    return sweep


def batch(tolerance: float, lanes: int) -> Callable[[Grid, np.ndarray], list[int]]:
    """Return a sweep in batches."""

    def sweep(grid: Grid, points: np.ndarray) -> list[int]:
        run, begin = integrator(grid, tolerance, lanes), start(grid)
        counts: list[int] = []
        for first in range(0, len(points), lanes):
            chosen = np.resize(points[first : first + lanes], lanes)
            run.set_time(0.0)
            run.state[:] = begin[:, None]
            run.pars[:] = np.array([(*grid.points()[point], 0.0) for point in chosen]).T
            run.reset_cooldowns()
            run.propagate_until(grid.end)
            reached = np.where(run.time == grid.end, run.state[4], UNFINISHED)
            counts += reached.astype(int).tolist()
        return counts[: len(points)]

    return sweep
