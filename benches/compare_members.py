"""Pendulums, stops on the ground and masses that ride on masses: iva and heyoka.

Usage: compare_members.py [--quick] [KIND ...]

Each kind is a scene with equations of its own, run for 96 coefficients of restitution as in
compare_terms.py, whose columns are those of this table. Needs the extra ``bench``.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

os.environ.setdefault("RAYON_NUM_THREADS", "1")
import heyoka as hy
import numpy as np
from compare_terms import DAMPING_RATIO, MODES, MOST, RESTITUTIONS, compared, table

import iva

DURATION = 120.0
#: An impact law: changes a state in place, with this coefficient of restitution.
Law = Callable[[Any, float], None]


@dataclass(frozen=True)
class Kind:
    """A scene: its equations and events for heyoka, its first state, and its sweep in iva."""

    system: Callable[[], tuple[list[tuple[Any, Any]], list[tuple[Any, Law]]]]
    begin: tuple[float, ...]
    absorber: Any
    start: iva.Start
    force: Any = None


def pull(x: Any, v: Any) -> Any:
    """Return what spring and damper of the structure do, over its mass."""
    return -x - 2.0 * DAMPING_RATIO * v


def mass_and_pendulum() -> tuple[list[tuple[Any, Any]], list[tuple[Any, Law]]]:
    """Return a free mass (y in space) and a pendulum (angle q, rate o) on one oscillator."""
    mu, other, d, reach, ratio, length = 0.08, 0.05, 0.7, 1.2, 0.4, 7.3
    x, v, y, w, q, o = hy.make_vars("x", "v", "y", "w", "q", "o")
    sine, cosine = hy.sin(q), hy.cos(q)
    swung = other * length * sine * (o * o + ratio**2 * cosine)
    a = (pull(x, v) + swung) / (1.0 + other * sine * sine)
    turned = -(ratio**2) * sine - a * cosine / length
    equations = [(x, v), (v, a), (y, w), (w, hy.expression(0.0)), (q, o), (o, turned)]

    def struck(z: Any, e: float) -> None:
        cosine = math.cos(z[4])
        inertia = 1.0 + other * (1.0 - cosine * cosine)
        impulse = (1.0 + e) * (z[3] - z[1]) / (1.0 / mu + 1.0 / inertia)
        z[1] += impulse / inertia
        z[3] -= impulse / mu
        z[5] -= impulse / inertia * cosine / length

    def stopped(z: Any, e: float) -> None:
        z[1] += other * (1.0 + e) / (1.0 + other) * length * math.cos(z[4]) * z[5]
        z[5] *= -e

    walls = [(y - x - d, struck), (x - y - d, struck)]
    stops = [(side * length * sine - reach, stopped) for side in (1.0, -1.0)]
    return equations, walls + stops


def upright_pendulum() -> tuple[list[tuple[Any, Any]], list[tuple[Any, Law]]]:
    """Return a pendulum whose pivot moves up and down with a driven oscillator."""
    mu, d, ratio, length = 0.05, 1.0, 0.5, 3.0
    x, v, q, o = hy.make_vars("x", "v", "q", "o")
    sine, cosine = hy.sin(q), hy.cos(q)
    push = 0.1 * hy.cos(hy.time)
    swung = mu * length * (ratio**2 * sine * sine - o * o * cosine)
    a = (push + pull(x, v) + swung) / (1.0 + mu - mu * sine * sine)
    equations = [(x, v), (v, a), (q, o), (o, -(ratio**2 + a / length) * sine)]

    def stopped(z: Any, e: float) -> None:
        z[1] += mu * length * math.sin(z[2]) * (1.0 + e) * z[3] / (1.0 + mu)
        z[3] *= -e

    return equations, [(side * length * sine - d, stopped) for side in (1.0, -1.0)]


def stop_on_the_ground() -> tuple[list[tuple[Any, Any]], list[tuple[Any, Law]]]:
    """Return a driven oscillator before one wall."""
    x, v = hy.make_vars("x", "v")

    def struck(z: Any, e: float) -> None:
        z[1] *= -e

    return [(x, v), (v, 0.5 * hy.cos(0.8 * hy.time) + pull(x, v))], [(x - 0.5, struck)]


KINDS = {
    "mass and pendulum": Kind(
        mass_and_pendulum,
        (1.0, 0.0, 1.0, 0.0, 0.0, 0.0),
        [
            iva.Siva(mass_ratio=0.08, clearance=0.7, restitution=0.5),
            iva.Piva(
                mass_ratio=0.05, clearance=1.2, restitution=0.5, frequency_ratio=0.4, length=7.3
            ),
        ],
        iva.Start(displacement=1.0),
    ),
    "upright pendulum, driven": Kind(
        upright_pendulum,
        (1.0, 0.0, 0.1, 0.0),
        iva.Piva(
            mass_ratio=0.05,
            clearance=1.0,
            restitution=0.5,
            frequency_ratio=0.5,
            length=3.0,
            inclination_deg=90,
        ),
        iva.Start(displacement=1.0, angle=0.1),
        iva.Harmonic(amplitude=0.1, frequency=1.0),
    ),
    "one stop on the ground, driven": Kind(
        stop_on_the_ground,
        (0.0, 0.0),
        iva.Stop(clearance=0.5, restitution=0.5, walls="plus"),
        iva.Start(),
        iva.Harmonic(amplitude=0.5, frequency=0.8),
    ),
}


def with_heyoka(kind: Kind, tolerance: float, lanes: int) -> Callable[[], list[int]]:
    """Return the sweep of heyoka, which gives the number of impacts of each scene."""
    equations, events = kind.system()
    count = hy.make_vars("count")
    size = len(equations) + 1

    def callback(law: Law) -> Callable[..., bool]:
        def met(integrator: Any, _: int, lane: int) -> bool:
            law(integrator.state[:, lane], integrator.pars[0, lane])
            integrator.state[-1, lane] += 1
            return bool(integrator.state[-1, lane] < MOST)

        return met

    integrator = hy.taylor_adaptive_batch(
        [*equations, (count, hy.par[1])],
        np.zeros((size, lanes)),
        tol=tolerance,
        pars=np.ones((2, lanes)),
        t_events=[
            hy.t_event_batch(gap, callback=callback(law), direction=hy.event_direction.positive)
            for gap, law in events
        ],
    )

    def sweep() -> list[int]:
        counts: list[int] = []
        for first in range(0, len(RESTITUTIONS), lanes):
            integrator.set_time(0.0)
            integrator.state[:] = np.tile(np.array([*kind.begin, 0.0])[:, None], lanes)
            integrator.pars[0] = RESTITUTIONS[first : first + lanes]
            integrator.pars[1] = 0.0
            integrator.reset_cooldowns()
            integrator.propagate_until(DURATION)
            counts += integrator.state[-1].astype(int).tolist()
        return counts

    return sweep


def with_iva(kind: Kind, **asked: Any) -> Callable[[], Any]:
    """Return the sweep of iva, on one thread."""
    return lambda: (
        iva.sweep(
            kind.absorber,
            iva.Primary(damping_ratio=DAMPING_RATIO),
            over={"restitution": RESTITUTIONS},
            start=kind.start,
            force=kind.force,
            duration=DURATION,
            tables=("summary",),
            threads=1,
            **asked,
        ).summary
    )


def row(kind: Kind, calls: int) -> str:
    """Return the row of a kind."""
    ours = (with_iva(kind, measures=("impacts", "episodes")), with_iva(kind))
    return compared(ours, [with_heyoka(kind, *mode) for mode in MODES], calls)


if __name__ == "__main__":
    table(KINDS, row)
