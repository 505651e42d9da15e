"""diffsol by pydiffsol: equations in its language DiffSL, a call a flight, atol = rtol.

Its own ``reset`` knows no stick, so the loop around it is that of :mod:`.flights`. Flights start
inside of the wall.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
import pydiffsol

from work_precision.flights import Leg, inside, simulate
from work_precision.results import Motion
from work_precision.scenes import Scene, State

SETTINGS = tuple(
    f"{method} {rtol}" for method in ("tsit45", "bdf") for rtol in ("1e-6", "1e-9", "1e-12")
)

FLIGHT = """in_i {{ begin = 0, x0 = 1, v0 = 0, q0 = 0, r0 = 0 }}
u_i {{ x = x0, v = v0, q = q0, r = r0 }}
F_i {{ v, {a}, r, {b} }}
stop_i {{ {wall} - q, {wall} + q }}
"""
RIDE = """in_i {{ begin = 0, side = 1, x0 = 1, v0 = 0 }}
u_i {{ x = x0, v = v0 }}
F_i {{ v, {a} }}
stop_i {{ side*{a}*{cosine} + {weight} }}
"""
Ode = Any  # the package has no types


@lru_cache(maxsize=64)
def models(scene: Scene, method: str, rtol: float) -> tuple[Ode, Ode]:
    """Compile flight and ride."""
    mu, length, gravity = scene.mass_ratio, scene.length, scene.gravity
    push = f"(-{2 * scene.damping_ratio!r}*v - x)"
    if scene.amplitude:
        push = f"({scene.amplitude!r}*cos({scene.frequency!r}*(begin + t)) + {push})"
    a, b = push, f"-{push}"
    if scene.pendulum:
        swing = f"{mu!r}*sin(q)*({length!r}*r*r + {gravity!r}*cos(q))"
        a = f"(({push} + {swing})/(1.0 + {mu!r}*sin(q)*sin(q)))"
        b = f"-({a}*cos(q) + {gravity!r}*sin(q))/{length!r}"
    tilt = scene.wall if scene.pendulum else 0.0
    sources = (
        FLIGHT.format(a=a, b=b, wall=repr(scene.wall)),
        RIDE.format(
            a=f"({push}/{1 + mu!r})",
            cosine=repr(math.cos(tilt)),
            weight=repr(gravity * math.sin(tilt)),
        ),
    )
    made = []
    for source in sources:
        ode = pydiffsol.Ode(
            source,
            matrix_type=pydiffsol.nalgebra_dense,
            ode_solver=getattr(pydiffsol, method),
            linear_solver=pydiffsol.lu,
        )
        ode.rtol = ode.atol = rtol
        made.append(ode)
    return made[0], made[1]


def solve(scene: Scene, setting: str, spacing: float | None = None) -> Motion:
    """Run a scene; setting: method and rtol. Its own steps are the samples, at any `spacing`."""
    method, rtol = setting.split()
    flight, riding = models(scene, method, float(rtol))
    end, wall = scene.end, scene.wall

    def fly(t: float, state: State, first: float) -> Leg:
        start = np.array([t, *inside(scene, state)])
        flight.h0 = min(first or 0.01, end - t)
        found = flight.solve(start, end - t)
        reached = float(found.ts[-1])
        farthest = float(np.abs(found.ys[2]).max()) if spacing is not None else 0.0
        x, v, q, rate = found.ys[:, -1].tolist()
        side = 0 if reached >= end - t else 1 if q > 0 else -1
        return Leg(t + reached, (x, v, q, rate), side, farthest)

    def ride(t: float, state: tuple[float, float], side: int) -> Leg:
        riding.h0 = min(0.01, end - t)
        found = riding.solve(np.array([t, side, *state]), end - t)
        reached = float(found.ts[-1])
        x, v = found.ys[:, -1].tolist()
        return Leg(t + reached, (x, v, side * wall, 0.0), side if reached < end - t else 0)

    return simulate(scene, fly, ride)
