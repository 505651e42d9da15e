"""CVODE of SUNDIALS by scikit-sundae: a call a flight, its own root finding, atol = rtol.

Flights start inside of the wall, see :mod:`.flights`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sksundae.cvode import CVODE

from work_precision.flights import Leg, inside, simulate
from work_precision.results import Motion
from work_precision.scenes import Scene, State

SETTINGS = tuple(
    f"{method} {rtol}" for method in ("Adams", "BDF") for rtol in ("1e-6", "1e-9", "1e-12")
)
EVENT = 2  # status of a result that ends at an event

Array = NDArray[np.float64]


def solve(scene: Scene, setting: str, spacing: float | None = None) -> Motion:
    """Run a scene; setting: method and rtol."""
    method, rtol = setting.split()
    tolerance = float(rtol)
    options = {
        "method": method,
        "rtol": tolerance,
        "atol": tolerance,
        "max_num_steps": 1_000_000,
    }
    flight, riding, end, wall = scene.derivative(), scene.riding(), scene.end, scene.wall

    def rates(t: float, state: Array, out: Array) -> None:
        out[:] = flight(t, state)  # type: ignore[arg-type]

    def gaps(_: float, state: Array, out: Array) -> None:
        out[0] = state[2] - wall
        out[1] = -state[2] - wall

    gaps.terminal, gaps.direction = [True, True], [1, 1]  # type: ignore[attr-defined]

    def span(t: float) -> Array:
        if spacing is None:
            return np.array([t, end])
        return np.linspace(t, end, 3 + int((end - t) / spacing))

    def fly(t: float, state: State, first: float) -> Leg:
        # The first step is of order 1: a longer one only fails its error test, and too often.
        first_step = min(first, end - t, tolerance**0.5)
        solver = CVODE(rates, eventsfn=gaps, num_events=2, first_step=first_step, **options)
        found = solver.solve(span(t), np.array(inside(scene, state)))
        if not found.success:
            raise RuntimeError(found.message)
        x, v, q, rate = found.y[-1].tolist()
        side = 0 if found.status != EVENT else 1 if q > 0 else -1
        farthest = float(np.abs(found.y[:, 2]).max()) if spacing is not None else 0.0
        return Leg(float(found.t[-1]), (x, v, q, rate), side, farthest)

    def both(t: float, state: Array, out: Array) -> None:
        out[:] = riding(t, state)  # type: ignore[arg-type]

    def ride(t: float, state: tuple[float, float], side: int) -> Leg:
        def pull(t: float, state: Array, out: Array) -> None:
            out[0] = scene.pull(riding(t, state)[1], side)  # type: ignore[arg-type]

        pull.terminal, pull.direction = [True], [1]  # type: ignore[attr-defined]
        found = CVODE(both, eventsfn=pull, num_events=1, **options).solve(
            np.array([t, end]), np.array(state)
        )
        if not found.success:
            raise RuntimeError(found.message)
        x, v = found.y[-1].tolist()
        return Leg(
            float(found.t[-1]), (x, v, side * wall, 0.0), side if found.status == EVENT else 0
        )

    return simulate(scene, fly, ride)
