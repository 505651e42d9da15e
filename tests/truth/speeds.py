"""How long it takes, beside goals for two cores. Machines differ: never a failure."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import iva
from iva import dynamics
from report import Report

SIVA = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
PRIMARY = iva.Primary(damping_ratio=0.05)
FORCE = iva.Harmonic(amplitude=1.0, frequency=1.0)


def seconds(call: Callable[[], object]) -> float:
    """Return how long a call takes."""
    begun = time.perf_counter()
    call()
    return time.perf_counter() - begun


def speeds(report: Report) -> None:
    """Time what the tool is for."""
    report.head("speeds, called from Python")
    orbit = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=(0, 0, 0, 0.1), settle=200)
    assert isinstance(orbit, dynamics.Orbit)
    x, v, y, w = orbit.state
    near = (x + 1e-3, v, y, w)
    calls = 200
    one = seconds(
        lambda: [dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=near) for _ in range(calls)]
    )
    report.told("an orbit from a good start", f"{1e6 * one / calls:.0f} µs", "goal: 50 µs")

    begun = time.perf_counter()
    branch = dynamics.follow(orbit, over="clearance", between=(0.5, 13.0), step=0.003)
    taken = time.perf_counter() - begun
    assert isinstance(branch, dynamics.Branch)
    taken *= 500 / len(branch.rows)
    report.told("a branch of 500 points with multipliers", f"{taken:.2f} s", "goal: 0.5 s")

    values = np.linspace(1.0, 6.0, 300)
    taken = seconds(
        lambda: dynamics.diagram(
            SIVA, PRIMARY, force=FORCE, over={"clearance": values}, direction="up"
        )
    )
    report.told("a diagram of 300 values x 360 cycles", f"{taken:.2f} s", "goal: 0.3 s")

    chaos = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.85)
    taken = seconds(lambda: dynamics.lyapunov(chaos, PRIMARY, force=FORCE, cycles=20_000, seeds=1))
    report.told("20,000 cycles of a spectrum", f"{taken:.2f} s", "goal: 0.3 s")

    axis = np.linspace(-4.0, 4.0, 200)
    mixed = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.4)
    over = {"displacement": axis, "velocity": axis}
    taken = seconds(lambda: dynamics.basins(mixed, PRIMARY, force=FORCE, over=over))
    report.told("a basin of 200 x 200, at most 150 cycles", f"{taken:.2f} s", "goal: 4 s")
