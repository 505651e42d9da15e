"""Flight, impact, ride: the loop around an integrator that stops at an event.

The rule for chatter, the same for every such tool: a rebound slower than ``STICK`` on a wall that
presses is taken for the end of the chatter. The absorber then has the common velocity that momentum
demands, and rides until the pressure changes sign. The stick is reported at the estimated limit of
the rebounds left out, 2w/(a(1 − e)) later. Where the wall presses, the first step of a flight is
half of what the rebound is going to last, so that it is not stepped over.

Some integrators lose the first contact of a flight that starts exactly on a wall; those start
``INSIDE`` of it, some rounding errors.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from work_precision.results import FINISHED, Event, Motion
from work_precision.scenes import Scene, State

#: Rebound speed, in units of ωn x0.
STICK = 1e-6
INSIDE = 1e-15
#: First step after an impact on a wall that presses: half of what the rebound lasts, at most this.
LONGEST_FIRST = 0.1
MAX_EVENTS = 5000
MAX_SECONDS = 20.0


@dataclass(slots=True)
class Leg:
    """A stretch between two events: where it ended, at which wall (0: at the end of the run).

    `farthest` is the largest |q| sampled.
    """

    time: float
    state: State
    wall: int
    farthest: float = 0.0


#: fly(t, state, first step or 0 for the integrator's own choice)
Fly = Callable[[float, State, float], Leg]
#: ride(t, (x, ẋ), wall)
Ride = Callable[[float, tuple[float, float], int], Leg]


def inside(scene: Scene, state: State) -> State:
    """Return the state, moved off the wall if it is exactly on one."""
    x, v, q, rate = state
    return x, v, q * (1 - INSIDE) if abs(q) == scene.wall else q, rate


def after_impact(scene: Scene, state: State, wall: int) -> State:
    """Return the state just after an impact, exactly on the wall."""
    x, v, _, rate = state
    mu, e = scene.mass_ratio, scene.restitution
    gain = mu * (1 + e) / (1 + mu) * scene.reach * rate
    return x, v + gain, wall * scene.wall, -e * rate


def common_velocity(scene: Scene, state: State) -> float:
    """Return the velocity of the primary once the absorber has stopped in the gap."""
    mu = scene.mass_ratio
    return state[1] + mu / (1 + mu) * scene.reach * state[3]


def simulate(scene: Scene, fly: Fly, ride: Ride) -> Motion:
    """Run a scene to its end, or until the integrator gives up."""
    motion, begin = Motion(), time.perf_counter()
    derivative, riding = scene.derivative(), scene.riding()
    t, state, first, farthest = 0.0, scene.start, 0.0, 0.0
    while t < scene.end:
        if len(motion.events) > MAX_EVENTS or time.perf_counter() - begin > MAX_SECONDS:
            motion.outcome = f"gave up at τ = {t:.6g}"
            break
        try:
            leg = fly(t, state, first)
            farthest = max(farthest, leg.farthest)
            t, state, first = leg.time, leg.state, 0.0
            if not leg.wall:
                break
            speed = abs(scene.reach * state[3])
            motion.events.append(Event("impact", t, leg.wall, speed))
            state = after_impact(scene, state, leg.wall)
            acceleration = scene.reach * leg.wall * derivative(t, state)[3]
            rebound = scene.restitution * speed
            if acceleration > 0:
                first = min(rebound / acceleration, LONGEST_FIRST)
            if rebound < STICK:
                v = common_velocity(scene, state)
                if scene.pull(riding(t, (state[0], v))[1], leg.wall) < 0:
                    left = 0.0
                    if acceleration > 0 and rebound > 0:
                        left = 2 * rebound / (acceleration * (1 - scene.restitution))
                    motion.events.append(Event("stick", t + left, leg.wall, 0.0))
                    wall = leg.wall
                    leg = ride(t, (state[0], v), wall)
                    t, state, first = leg.time, leg.state, 0.0
                    if not leg.wall:
                        break
                    motion.events.append(Event("release", t, wall, 0.0))
        except (RuntimeError, ValueError) as error:
            motion.outcome = f"stopped at τ = {t:.6g}: {error}"[:120]
            break
    motion.seconds = time.perf_counter() - begin
    if motion.outcome == FINISHED:
        motion.final = scene.gap_state(state)
    farthest_gap = abs(scene.gap_state((0.0, 0.0, farthest, 0.0))[2])
    motion.largest_gap = farthest_gap / scene.clearance
    return motion
