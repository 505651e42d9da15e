"""A free mass on a structure with two modes: by SciPy's DOP853, then to 30 digits with mpmath.

Usage: two_modes.py > two_modes.json

The structure has mass-normalised modes q_i'' + 2 zeta_i omega_i q_i' + omega_i^2 q_i = 0, and
x = sum phi_i q_i where the absorber is. In flight the absorber moves uniformly. An impact with the
gap velocity w has the impulse P = (1 + e) w / (1/mu + sum phi_i^2) on the structure, so each q_i'
gains phi_i P and the absorber loses P/mu.

The integrator finds the impacts: an event is looked for on the dense output of short steps. Their
instants are then solved with 40 digits from the closed form of the flights between them, and must
agree within 1e-9. Prints instant, wall, x and approach speed of the first impacts. Needs scipy and
mpmath.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

mp.mp.dps = 40
OMEGA, ZETA, PHI = ([mp.mpf(it) for it in its.split()] for its in ("1 2.7", "0.02 0.03", "1 0.6"))
MU, E, D = map(mp.mpf, ("0.1", "0.7", "0.4"))
MOBILITY = sum(phi**2 for phi in PHI)
START = (mp.mpf(1), mp.mpf("-0.3"))
COUNT = 20
STEP = 0.02

Modes = list[tuple[Any, Any]]


def rates(_t: float, z: np.ndarray) -> np.ndarray:
    """Return the derivatives of q, q', the absorber's displacement and its velocity."""
    omega, zeta = np.array(OMEGA, float), np.array(ZETA, float)
    return np.concatenate([z[2:4], -2 * zeta * omega * z[2:4] - omega**2 * z[:2], [z[5], 0.0]])


def integrated() -> Iterator[tuple[float, int]]:
    """Yield instant and wall of each impact, as the integrator finds them."""
    phi, clearance = np.array(PHI, float), float(D)

    def beyond(z: np.ndarray) -> float:
        return abs(z[4] - phi @ z[:2]) - clearance

    def run(z: np.ndarray, h: float) -> Any:
        return solve_ivp(rates, (0.0, h), z, "DOP853", rtol=2.3e-14, atol=1e-16, dense_output=True)

    places = np.array(START, float)
    z, t, found = np.array([*places, 0.0, 0.0, phi @ places, 0.0]), 0.0, 0
    while found < COUNT:
        step = run(z, STEP).sol
        # Right after an impact the distance begins at 0, on either side of it.
        times = [1e-9, *np.linspace(0.0, STEP, 21)[1:]]
        hits = ((a, b) for a, b in pairwise(times) if beyond(step(a)) < 0.0 < beyond(step(b)))
        pair = next(hits, None)
        if pair is None:
            z, t = step(STEP), t + STEP
            continue
        h = brentq(lambda h, step=step: beyond(step(h)), *pair, xtol=1e-16, rtol=1e-15)
        z, t, found = run(z, h).y[:, -1], t + h, found + 1
        yield t, 1 if z[4] > phi @ z[:2] else -1
        impulse = (1 + E) * (z[5] - phi @ z[2:4]) / (1 / MU + MOBILITY)
        z[2:4] += phi * float(impulse)
        z[5] -= float(impulse / MU)


def flown(modes: Modes, h: Any) -> Modes:
    """Return q_i and q_i' after a time h of free motion."""
    later = []
    for (q, v), omega, zeta in zip(modes, OMEGA, ZETA, strict=True):
        rate, damped = zeta * omega, omega * mp.sqrt(1 - zeta**2)
        decay, c, s = mp.exp(-rate * h), mp.cos(damped * h), mp.sin(damped * h)
        x = decay * (q * c + (v + rate * q) / damped * s)
        later.append((x, decay * (v * c - (omega**2 * q + rate * v) / damped * s)))
    return later


def seen(modes: Modes, k: int) -> Any:
    """Return x (k = 0) or its rate (k = 1)."""
    return sum(phi * mode[k] for phi, mode in zip(PHI, modes, strict=True))


def solved() -> Iterator[list[float]]:
    """Yield instant, wall, x and approach speed of each impact."""
    modes: Modes = [(place, mp.mpf(0)) for place in START]
    place, speed, t = seen(modes, 0), mp.mpf(0), mp.mpf(0)
    for near, wall in integrated():

        def left(h: Any, flight: Any = (modes, place, speed, wall)) -> Any:
            modes, place, speed, wall = flight
            return wall * (place + speed * h - seen(flown(modes, h), 0)) - D

        h = mp.findroot(left, near - t)
        assert abs(t + h - near) < 1e-9
        modes, place, t = flown(modes, h), place + speed * h, t + h
        w = speed - seen(modes, 1)
        yield [float(it) for it in (t, wall, seen(modes, 0), abs(w))]
        impulse = (1 + E) * w / (1 / MU + MOBILITY)
        modes = [(q, v + phi * impulse) for (q, v), phi in zip(modes, PHI, strict=True)]
        speed -= impulse / MU


if __name__ == "__main__":
    print(json.dumps(list(solved()), indent=1))
