"""A loop of one's own compiled by numba: fixed steps, bisection where one ends behind a wall.

``rk4 h`` steps by the classical Runge–Kutta method; ``closed h``, for free masses, evaluates the
closed form from the begin of the flight at every h, which is what `iva` does without its proof. The
rule for chatter is that of :mod:`.flights`.
"""

from __future__ import annotations

import math
import time

import numpy as np
from numba import njit
from numpy.typing import NDArray

from work_precision.flights import MAX_EVENTS, STICK
from work_precision.results import FINISHED, Event, Motion
from work_precision.scenes import Scene

SETTINGS = ("rk4 0.03", "rk4 0.01", "rk4 0.003", "rk4 0.001", "closed 0.1", "closed 0.01")
KINDS = ("impact", "stick", "release")
BISECTIONS = 60

Array = NDArray[np.float64]
# Places in the array of parameters.
MU, WALL, E, DAMPING, LENGTH, GRAVITY, FORCE, OMEGA, REACH, COS, SIN = range(11)


def settings(scene: Scene) -> tuple[str, ...]:
    """Return the settings that apply to a scene."""
    return tuple(name for name in SETTINGS if not (scene.pendulum and name.startswith("closed")))


@njit
def _rates(stuck, p, t, y, out):
    push = p[FORCE] * math.cos(p[OMEGA] * t) - p[DAMPING] * y[1] - y[0]
    out[0], out[2] = y[1], y[3]
    if stuck:
        out[1], out[3] = push / (1 + p[MU]), 0.0
    elif p[LENGTH] == 0:
        out[1], out[3] = push, -push
    else:
        s, c = math.sin(y[2]), math.cos(y[2])
        swing = p[MU] * s * (p[LENGTH] * y[3] * y[3] + p[GRAVITY] * c)
        out[1] = (push + swing) / (1 + p[MU] * s * s)
        out[3] = -(out[1] * c + p[GRAVITY] * s) / p[LENGTH]


@njit
def _rk4(stuck, p, t, y, h, out, k):
    _rates(stuck, p, t, y, k[0])
    for stage, part in ((1, 0.5), (2, 0.5), (3, 1.0)):
        for i in range(4):
            out[i] = y[i] + part * h * k[stage - 1, i]
        _rates(stuck, p, t + part * h, out, k[stage])
    for i in range(4):
        out[i] = y[i] + h / 6 * (k[0, i] + 2 * (k[1, i] + k[2, i]) + k[3, i])


@njit
def _closed(stuck, p, t, y, h, out):
    mass = 1 + p[MU] if stuck else 1.0
    c, k, force, omega = p[DAMPING] / mass, 1 / mass, p[FORCE] / mass, p[OMEGA]
    scale = (k - omega * omega) ** 2 + (c * omega) ** 2
    a, b = 0.0, 0.0
    if force != 0:
        a, b = force * (k - omega * omega) / scale, force * c * omega / scale
    cos, sin = math.cos(omega * t), math.sin(omega * t)
    beta = c / 2
    root = math.sqrt(abs(k - beta * beta))
    first = y[0] - (a * cos + b * sin)
    second = (y[1] - omega * (b * cos - a * sin) + beta * first) / root
    decay = math.exp(-beta * h)
    if k > beta * beta:
        even, odd, sign = decay * math.cos(root * h), decay * math.sin(root * h), -1.0
    else:
        even, odd, sign = decay * math.cosh(root * h), decay * math.sinh(root * h), 1.0
    free = first * even + second * odd
    cos, sin = math.cos(omega * (t + h)), math.sin(omega * (t + h))
    out[0] = free + a * cos + b * sin
    slope = root * (sign * first * odd + second * even) - beta * free
    out[1] = slope + omega * (b * cos - a * sin)
    if stuck:
        out[2], out[3] = y[2], 0.0
    else:
        out[2] = y[0] + y[2] + (y[1] + y[3]) * h - out[0]
        out[3] = y[1] + y[3] - out[1]


@njit
def _pull(p, t, y, side, k):
    _rates(True, p, t, y, k[0])
    return side * k[0, 1] * p[COS] + p[GRAVITY] * p[SIN]


@njit
def _run(closed, p, y, end, step, kinds, times, walls, speeds):
    """Fill the lists of events; return their number, the time reached and the largest |q|."""
    k, new = np.zeros((4, 4)), np.zeros(4)
    # The closed form is evaluated at t + last … t + ahead, Runge–Kutta steps from t (last = 0).
    t, last, count, farthest, stuck, side = 0.0, 0.0, 0, 0.0, False, 0.0
    while t + last < end and count + 2 < times.size:
        ahead = min(last + step, end - t)
        if closed:
            _closed(stuck, p, t, y, ahead, new)
        else:
            _rk4(stuck, p, t, y, ahead, new, k)
        if not stuck:
            side = 1.0 if new[2] > 0 else -1.0
            found = side * new[2] > p[WALL]
        else:
            found = _pull(p, t + ahead, new, side, k) > 0
        if not found:
            farthest = max(farthest, abs(new[2]))
            over = t + ahead >= end
            if closed and not over:
                last = ahead
            else:
                t, last = end if over else t + ahead, 0.0
                y[:] = new
            continue
        low, high = last, ahead
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if closed:
                _closed(stuck, p, t, y, middle, new)
            else:
                _rk4(stuck, p, t, y, middle, new, k)
            beyond = side * new[2] > p[WALL]
            if stuck:
                beyond = _pull(p, t + middle, new, side, k) > 0
            if beyond:
                high = middle
            else:
                low = middle
        if closed:
            _closed(stuck, p, t, y, high, new)
        else:
            _rk4(stuck, p, t, y, high, new, k)
        t, last = t + high, 0.0
        y[:] = new
        y[2] = side * p[WALL]
        kinds[count], times[count], walls[count], speeds[count] = 2 * stuck, t, side, 0.0
        if stuck:
            y[3], stuck, count = 0.0, False, count + 1
            continue
        speed = abs(p[REACH] * y[3])
        speeds[count] = speed
        count += 1
        y[1] += p[MU] * (1 + p[E]) / (1 + p[MU]) * p[REACH] * y[3]
        y[3] *= -p[E]
        if p[E] * speed < STICK:
            _rates(False, p, t, y, k[0])
            inward = p[REACH] * side * k[0, 3]
            if inward > 0:
                left = 2 * p[E] * speed / (inward * (1 - p[E]))
                kinds[count], times[count], walls[count], speeds[count] = 1, t + left, side, 0.0
                count += 1
                y[1] += p[MU] / (1 + p[MU]) * p[REACH] * y[3]
                y[3], stuck = 0.0, True
    return count, t, farthest


def solve(scene: Scene, setting: str, spacing: float | None = None) -> Motion:  # noqa: ARG001
    """Run a scene; setting: method and step. Its own steps are the samples, at any `spacing`."""
    method, step = setting.split()
    tilt = scene.wall if scene.pendulum else 0.0
    parameters = np.array(
        [
            scene.mass_ratio,
            scene.wall,
            scene.restitution,
            2 * scene.damping_ratio,
            scene.length,
            scene.gravity,
            scene.amplitude,
            scene.frequency,
            scene.reach,
            math.cos(tilt),
            math.sin(tilt),
        ]
    )
    state = np.array(scene.start)
    begin = time.perf_counter()
    kinds = np.empty(MAX_EVENTS, np.int64)
    times, walls, speeds = (np.empty(MAX_EVENTS) for _ in range(3))
    count, reached, farthest = _run(
        method == "closed", parameters, state, scene.end, float(step), kinds, times, walls, speeds
    )
    motion = Motion(seconds=time.perf_counter() - begin)
    motion.events = [
        Event(KINDS[kind], t, int(wall), speed)
        for kind, t, wall, speed in zip(
            kinds[:count].tolist(),
            times[:count].tolist(),
            walls[:count].tolist(),
            speeds[:count].tolist(),
            strict=True,
        )
    ]
    x, v, q, rate = state.tolist()
    motion.final = scene.gap_state((x, v, q, rate))
    motion.outcome = FINISHED if reached >= scene.end else f"gave up at τ = {reached:.6g}"
    motion.largest_gap = abs(scene.gap_state((0, 0, farthest, 0))[2]) / scene.clearance
    return motion
