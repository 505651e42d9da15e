"""SciPy ``solve_ivp``: a call a flight, terminal events at both walls, atol = rtol.

LSODA starts its flights inside of the wall, see :mod:`.flights`.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from work_precision.flights import Leg, inside, simulate
from work_precision.results import Motion
from work_precision.scenes import Scene, State

METHODS = ("RK45", "DOP853", "LSODA")
SETTINGS = tuple(
    f"{method} {rtol}{step}"
    for method in METHODS
    for step in ("", " max_step=0.1")
    for rtol in ("1e-6", "1e-9", "1e-12")
)


def solve(scene: Scene, setting: str, spacing: float | None = None) -> Motion:
    """Run a scene; setting: method, rtol and possibly the largest step."""
    method, rtol, *limit = setting.split()
    longest = float(limit[0].removeprefix("max_step=")) if limit else np.inf
    options = {"method": method, "rtol": float(rtol), "atol": float(rtol), "max_step": longest}
    flight, riding, end, wall = scene.derivative(), scene.riding(), scene.end, scene.wall

    def above(_: float, state: State) -> float:
        return state[2] - wall

    def below(_: float, state: State) -> float:
        return -state[2] - wall

    for event in (above, below):
        event.terminal, event.direction = True, 1  # type: ignore[attr-defined]

    def fly(t: float, state: State, first: float) -> Leg:
        first_step = min(first, longest, end - t) if first else None
        if method == "LSODA":  # starts at order 1
            state = inside(scene, state)
            first_step = min(first_step, float(rtol) ** 0.5) if first_step else None
        found = solve_ivp(
            flight,
            (t, end),
            state,
            events=(above, below),
            first_step=first_step,
            dense_output=spacing is not None,
            **options,
        )
        if found.status < 0:
            raise RuntimeError(found.message)
        farthest = 0.0
        if spacing is not None:
            reached = found.t[-1]
            times = np.linspace(t, reached, 2 + int((reached - t) / spacing))
            farthest = float(np.abs(found.sol(times)[2]).max())
        side = 0 if found.status == 0 else 1 if len(found.t_events[0]) else -1
        x, v, q, rate = found.y[:, -1].tolist()
        return Leg(float(found.t[-1]), (x, v, q, rate), side, farthest)

    def ride(t: float, state: tuple[float, float], side: int) -> Leg:
        def pull(t: float, state: tuple[float, float]) -> float:
            return scene.pull(riding(t, state)[1], side)

        pull.terminal, pull.direction = True, 1  # type: ignore[attr-defined]
        found = solve_ivp(riding, (t, end), state, events=(pull,), **options)
        if found.status < 0:
            raise RuntimeError(found.message)
        x, v = found.y[:, -1].tolist()
        side_left = side if found.status == 1 else 0
        return Leg(float(found.t[-1]), (x, v, side * wall, 0.0), side_left)

    return simulate(scene, fly, ride)
