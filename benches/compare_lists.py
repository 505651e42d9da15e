"""Several absorbers on one structure, and a dashpot in the gap: iva and SciPy.

Usage: compare_lists.py [--quick]

SciPy integrates by DOP853 from impact to impact, with one terminal event for each wall and plain
numbers in the equations, the way most people write it. Its tolerance and its longest step are
varied, and its error is the largest one of its impact times over those of iva: only impacts before
the first one that it misses count, and are told. The motion forgets its start, so that late impacts
tell more of the scene than of the tool; a scene ends after 40 impacts. Times are CPU time, those of
iva the median of some calls.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import iva

IMPACTS = 40
#: Tolerance and longest step: SciPy passes over a return to the wall within a step.
SETTINGS = ((1e-6, math.inf), (1e-9, 0.3), (1e-12, 0.1))
CALLS = 15


@dataclass(frozen=True)
class One:
    """A free mass, or a pendulum of a length; a dashpot is one of a free mass."""

    mu: float
    e: float
    d: float
    length: float | None = None
    r: float = 0.0
    dashpot: float = 0.0

    def absorber(self) -> iva.Siva | iva.Piva:
        """Return the absorber of a run."""
        common: dict[str, Any] = {
            "mass_ratio": self.mu,
            "restitution": self.e,
            "clearance": self.d,
        }
        if self.length is not None:
            return iva.Piva(**common, frequency_ratio=self.r, length=self.length)
        return iva.Siva(**common, gap_damping_ratio=self.dashpot or None)


@dataclass(frozen=True)
class Scene:
    """Absorbers on a structure that is let go from 1, or driven at its natural frequency."""

    name: str
    absorbers: tuple[One, ...]
    amplitude: float = 0.0
    zeta: float = 0.01


MASSES = (One(0.05, 0.8, 0.54), One(0.05, 0.8, 0.66))
MIXED = (One(0.05, 0.8, 0.54), One(0.05, 0.8, 0.66, length=5.0, r=0.4))
DASHPOT = (One(0.1, 0.8, 0.6, dashpot=0.002),)
SCENES = (
    Scene("two masses, decay", MASSES),
    Scene("two masses, driven", MASSES, 0.1),
    Scene("mass and pendulum, decay", MIXED),
    Scene("mass and pendulum, driven", MIXED, 0.1),
    Scene("mass with dashpot, driven", DASHPOT, 0.1),
)

#: Time, absorber and wall of an impact.
Hit = tuple[float, int, int]


def with_iva(scene: Scene) -> tuple[list[Hit], float]:
    """Return the impacts, and the median of the CPU seconds of some calls."""
    drive: dict[str, Any] = {}
    if scene.amplitude:
        drive["force"] = iva.Harmonic(amplitude=scene.amplitude, frequency=1.0)
    absorbers = [one.absorber() for one in scene.absorbers]
    spent = []
    for _ in range(CALLS):
        begin = time.process_time()
        run = iva.simulate(
            absorbers if len(absorbers) > 1 else absorbers[0],
            iva.Primary(damping_ratio=scene.zeta),
            start=iva.Start(displacement=1.0),
            periods=200,
            max_impacts=IMPACTS,
            measures=[],
            tables=["impacts"],
            **drive,
        )
        spent.append(time.process_time() - begin)
    return run.impacts.select("time", "absorber", "wall").rows(), statistics.median(spent)


def equations(scene: Scene) -> Callable[[float, np.ndarray], list[float]]:
    """Return the equations of motion: x and its rate, then y or the angle of each and its rate."""

    def rates(t: float, state: np.ndarray) -> list[float]:
        x, v, *gaps = state.tolist()
        push = scene.amplitude * math.cos(t) - x - 2 * scene.zeta * v
        inertia, own = 1.0, []
        for one, q, u in zip(scene.absorbers, gaps[::2], gaps[1::2], strict=True):
            if one.length is None:
                # Of the absolute acceleration, which the dashpot alone gives to it.
                pull = 2 * one.dashpot * u
                push += pull
                own.append((-pull / one.mu, 1.0))
                continue
            sine, cosine = math.sin(q), math.cos(q)
            pull = -one.length * one.r**2 * sine
            inertia += one.mu * sine**2
            push += one.mu * (one.length * sine * u * u - cosine * pull)
            own.append((pull / one.length, cosine / one.length))
        a = push / inertia
        found = [v, a]
        for (alone, coupled), u in zip(own, gaps[1::2], strict=True):
            found += [u, alone - coupled * a]
        return found

    return rates


def with_scipy(scene: Scene, tolerance: float, longest: float) -> tuple[list[Hit], float]:
    """Return the impacts, and the CPU seconds."""
    begin = time.process_time()
    rates, events = equations(scene), []
    for k, one in enumerate(scene.absorbers):
        for wall in (1, -1):
            top = one.d if one.length is None else math.asin(one.d / one.length)

            def distance(_: float, y: np.ndarray, k: int = k, to: float = wall * top) -> float:
                return float(y[2 + 2 * k] - to)

            distance.terminal, distance.direction = True, wall  # type: ignore[attr-defined]
            events.append((distance, k, wall))
    state, now = np.array([1.0, 0.0] + [0.0] * 2 * len(scene.absorbers)), 0.0
    hits: list[Hit] = []
    while len(hits) < IMPACTS:
        found = solve_ivp(
            rates,
            (now, 200 * 2 * math.pi),
            state,
            method="DOP853",
            events=[event[0] for event in events],
            rtol=tolerance,
            atol=tolerance,
            max_step=longest,
        )
        now, state = float(found.t[-1]), found.y[:, -1].copy()
        ended = [event for event, at in zip(events, found.t_events, strict=True) if len(at)]
        if not ended:
            break
        for _, k, wall in ended:
            one, q, u = scene.absorbers[k], state[2 + 2 * k], state[3 + 2 * k]
            cosine = 1.0 if one.length is None else math.cos(q)
            reach = 1.0 if one.length is None else one.length
            # The others follow the structure as it jumps, pendulums by their cosines.
            total = 1.0 + one.mu
            for j, other in enumerate(scene.absorbers):
                if j != k and other.length is not None:
                    total += other.mu * math.sin(state[2 + 2 * j]) ** 2
            gained = one.mu * (1 + one.e) * reach * cosine * u / total
            state[1] += gained
            for j, other in enumerate(scene.absorbers):
                if j == k:
                    state[3 + 2 * j] = -one.e * u
                elif other.length is None:
                    state[3 + 2 * j] -= gained
                else:
                    state[3 + 2 * j] -= math.cos(state[2 + 2 * j]) * gained / other.length
            hits.append((now, k, wall))
    return hits, time.process_time() - begin


def compared(found: list[Hit], truth: list[Hit]) -> tuple[int, float]:
    """Return the number of impacts before the first wrong one, and their largest error."""
    same, worst = 0, 0.0
    for one, true in zip(found, truth, strict=False):
        if one[1:] != true[1:]:
            break
        same, worst = same + 1, max(worst, abs(one[0] - true[0]) / true[0])
    return same, worst


def main() -> None:
    """Print the table."""
    settings = SETTINGS[1:2] if "--quick" in sys.argv else SETTINGS
    print("| scene | tool | µs per impact | over iva | impacts of", IMPACTS, "| largest error |")
    print("|---|---|--:|--:|--:|--:|")
    for scene in SCENES:
        truth, spent = with_iva(scene)
        own = spent / len(truth)
        print(f"| {scene.name} | iva | {1e6 * own:.1f} | 1 | {len(truth)} | – |", flush=True)
        for tolerance, longest in settings:
            hits, seconds = with_scipy(scene, tolerance, longest)
            same, worst = compared(hits, truth)
            each = seconds / len(hits)
            row = f"{1e6 * each:.0f} | {each / own:.0f} | {same} | {worst:.1e}"
            print(f"| {scene.name} | DOP853, {tolerance:g}, {longest:g} | {row} |", flush=True)


if __name__ == "__main__":
    main()
