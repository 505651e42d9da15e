"""heyoka: Taylor series compiled by LLVM, terminal events with the impact law as their callback.

The callback stops the integration only where the rule of :mod:`.flights` ends a chatter; the ride
on the wall is a second integrator.
"""

from __future__ import annotations

import math
import time
from functools import lru_cache
from typing import Any

import heyoka as hy
import numpy as np

from work_precision.flights import MAX_EVENTS, STICK, after_impact, common_velocity
from work_precision.results import FINISHED, Event, Motion
from work_precision.scenes import Scene

SETTINGS = ("1e-6", "1e-9", "1e-12", "1e-16")
Integrator = Any  # the package has no types


class Impacts:
    """What happens at one of the walls."""

    def __init__(self, scene: Scene, wall: int) -> None:
        self.scene, self.wall, self.events = scene, wall, list[Event]()
        self.stuck = False
        self.derivative = scene.derivative()

    def __call__(self, integrator: Integrator, _: int) -> bool:
        """Apply the impact law; return whether to go on."""
        x, v, q, rate = integrator.state.tolist()
        scene, t = self.scene, integrator.time
        speed = abs(scene.reach * rate)
        self.events.append(Event("impact", t, self.wall, speed))
        state = after_impact(scene, (x, v, q, rate), self.wall)
        integrator.state[:] = state
        if scene.restitution * speed < STICK:
            rates = self.derivative(t, state)
            inward = scene.reach * self.wall * rates[3]
            if inward > 0:
                left = 2 * scene.restitution * speed / (inward * (1 - scene.restitution))
                self.events.append(Event("stick", t + left, self.wall, 0.0))
                self.stuck = True
                return False
        return len(self.events) < MAX_EVENTS


@lru_cache(maxsize=64)
def integrators(scene: Scene, tolerance: float) -> tuple[Integrator, tuple[Integrator, ...]]:
    """Compile flight and the rides on both walls."""
    x, v, q, rate = hy.make_vars("x", "v", "q", "rate")
    mu, length, gravity = scene.mass_ratio, scene.length, scene.gravity
    push = -2 * scene.damping_ratio * v - x
    if scene.amplitude:
        push = push + scene.amplitude * hy.cos(scene.frequency * hy.time)
    a, b = push, -push
    if scene.pendulum:
        s, c = hy.sin(q), hy.cos(q)
        a = (push + mu * s * (length * rate * rate + gravity * c)) / (1 + mu * s * s)
        b = -(a * c + gravity * s) / length
    rising = hy.event_direction.positive
    flight = hy.taylor_adaptive(
        [(x, v), (v, a), (q, rate), (rate, b)],
        np.zeros(4),
        tol=tolerance,
        t_events=[
            hy.t_event(wall * q - scene.wall, callback=Impacts(scene, wall), direction=rising)
            for wall in (1, -1)
        ],
    )
    tilt = scene.wall if scene.pendulum else 0.0
    both = push / (1 + mu)
    rides = tuple(
        hy.taylor_adaptive(
            [(x, v), (v, both)],
            np.zeros(2),
            tol=tolerance,
            t_events=[
                hy.t_event(
                    wall * both * math.cos(tilt) + gravity * math.sin(tilt), direction=rising
                )
            ],
        )
        for wall in (1, -1)
    )
    return flight, rides


def solve(scene: Scene, setting: str, spacing: float | None = None) -> Motion:
    """Run a scene; setting: the tolerance."""
    flight, rides = integrators(scene, float(setting))
    walls: list[Impacts] = [event.callback for event in flight.t_events]
    for wall in walls:
        wall.events.clear()
    releases: list[Event] = []
    motion, begin, farthest = Motion(), time.perf_counter(), 0.0
    flight.time, flight.state[:] = 0.0, scene.start
    while flight.time < scene.end:
        flight.reset_cooldowns()
        for wall in walls:
            wall.stuck = False
        if spacing is None:
            flight.propagate_until(scene.end)
        else:
            t = flight.time
            grid = np.linspace(t, scene.end, 2 + int((scene.end - t) / spacing))
            sampled = flight.propagate_grid(grid)[-1]
            farthest = max(farthest, float(np.nanmax(np.abs(sampled[:, 2]))))
        if not all(math.isfinite(value) for value in flight.state):
            motion.outcome = f"not finite at τ = {flight.time:.6g}"
            break
        at = next((wall for wall in walls if wall.stuck), None)
        if at is None:
            if flight.time < scene.end:
                motion.outcome = f"gave up at τ = {flight.time:.6g}"
            break
        ride = rides[0 if at.wall > 0 else 1]
        x, v, q, rate = flight.state.tolist()
        ride.time, ride.state[:] = flight.time, (x, common_velocity(scene, (x, v, q, rate)))
        ride.reset_cooldowns()
        ride.propagate_until(scene.end)
        flight.time = ride.time
        flight.state[:] = (*ride.state, at.wall * scene.wall, 0.0)
        if ride.time < scene.end:
            releases.append(Event("release", ride.time, at.wall, 0.0))
    motion.seconds = time.perf_counter() - begin
    motion.events = sorted(
        (event for part in (walls[0].events, walls[1].events, releases) for event in part),
        key=lambda event: event.time,
    )
    if motion.outcome == FINISHED:
        x, v, q, rate = flight.state.tolist()
        motion.final = scene.gap_state((x, v, q, rate))
    farthest_gap = abs(scene.gap_state((0.0, 0.0, farthest, 0.0))[2])
    motion.largest_gap = farthest_gap / scene.clearance
    return motion
