"""Orbits, diagrams, basins and exponents: `iva.dynamics` and what a researcher programs by hand.

Usage: compare_dynamics.py [--quick]

The scene is that of the orbits A of ``tests/reference/orbits.json``, with some two impacts a cycle.
By hand means heyoka (the fastest of the integrators that :mod:`compare_peers` runs) with events at
the walls, one by one or in batches of 4, at 1e-16; derivatives are differences of neighbouring
motions, and roots those of SciPy. Each line has the CPU seconds of both for the same result, and
their ratio. The peer does less: it has no error bounds, no identities, no undecided cells. Needs
the extra ``bench``.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from typing import Any

import heyoka as hy
import numpy as np
from scipy.optimize import fsolve

import iva
from iva import dynamics

MASS_RATIO, RESTITUTION, CLEARANCE, DAMPING = 0.2, 0.7, 4.5, 0.05
#: Of two masses: their mass ratio and clearances; those of the basin strike in either order.
PAIR = (0.2, (4.5, 6.0))
PAIR_OF_BASIN = (0.1, (4.5, 4.7))
PERIOD = 2 * math.pi
PRIMARY = iva.Primary(damping_ratio=DAMPING)
FORCE = iva.Harmonic(amplitude=1.0, frequency=1.0)
Integrator = Any  # the package has no types


def siva(clearance: float = CLEARANCE, mass_ratio: float = MASS_RATIO) -> iva.Siva:
    """Return the absorber."""
    return iva.Siva(mass_ratio=mass_ratio, restitution=RESTITUTION, clearance=clearance)


def impact(integrator: Integrator, _: int, lane: int | None = None) -> bool:
    """Apply the impact law to the state, of one lane where there are several."""
    state = integrator.state if lane is None else integrator.state[:, lane]
    state[1] += MASS_RATIO * (1 + RESTITUTION) / (1 + MASS_RATIO) * state[3]
    state[3] *= -RESTITUTION
    return True


def integrator(lanes: int | None = None) -> Integrator:
    """Compile an integrator; its parameter is the clearance."""
    x, v, y, w = hy.make_vars("x", "v", "y", "w")
    push = -2 * DAMPING * v - x + hy.cos(hy.time)
    equations = [(x, v), (v, push), (y, w), (w, -push)]
    event = hy.t_event if lanes is None else hy.t_event_batch
    rising = hy.event_direction.positive
    events = [event(side * y - hy.par[0], callback=impact, direction=rising) for side in (1, -1)]
    if lanes is None:
        return hy.taylor_adaptive(equations, np.zeros(4), tol=1e-16, pars=[1.0], t_events=events)
    return hy.taylor_adaptive_batch(
        equations, np.zeros((4, lanes)), tol=1e-16, pars=np.ones((1, lanes)), t_events=events
    )


def mapped(run: Integrator, state: np.ndarray, clearance: float) -> np.ndarray:
    """Return the state one cycle later; of a batch a column a lane."""
    if state.ndim == 2:
        run.set_time(0.0)
    else:
        run.time = 0.0
    run.state[:] = state
    run.pars[:] = clearance
    run.reset_cooldowns()
    run.propagate_until(PERIOD)
    return np.array(run.state)


def settled(run: Integrator, cycles: int) -> np.ndarray:
    """Return a state near the orbit."""
    state = np.array([0.0, 0.0, 0.0, 0.1])
    for _ in range(cycles):
        state = mapped(run, state, CLEARANCE)
    return state


def timed(work: Callable[[], object], rounds: int = 3) -> float:
    """Return the CPU seconds that work takes, the least of some rounds."""
    best = math.inf
    for _ in range(rounds):
        begin = time.process_time()
        work()
        best = min(best, time.process_time() - begin)
    return best


def line(what: str, ours: float, theirs: float) -> None:
    """Print a line."""
    print(f"{what:<48} {ours:10.2e} s {theirs:10.2e} s {theirs / ours:8.1f}")


def orbits(run: Integrator) -> None:
    """Find an orbit from a state 1e-3 away, with its multipliers."""
    start = settled(run, 300) + 1e-3

    def by_hand() -> np.ndarray:
        found = fsolve(lambda at: mapped(run, at, CLEARANCE) - at, start, xtol=1e-13)
        image = mapped(run, found, CLEARANCE)
        moved = [mapped(run, found + 1e-6 * unit, CLEARANCE) for unit in np.eye(4)]
        return np.linalg.eigvals(np.array([(one - image) / 1e-6 for one in moved]).T)

    ours = timed(lambda: dynamics.orbit(siva(), PRIMARY, force=FORCE, start=start.tolist()))
    line("an orbit with its multipliers", ours, timed(by_hand))


def of_pair(pair: tuple[float, tuple[float, float]], lanes: int | None = None) -> Integrator:
    """Compile an integrator of two masses on the same structure; its parameter is the force."""
    mass_ratio, clearances = pair
    x, v, *gaps = hy.make_vars("x", "v", "y0", "w0", "y1", "w1")
    push = -2 * DAMPING * v - x + hy.par[0] * hy.cos(hy.time)
    equations = [(x, v), (v, push)]
    events = []
    event = hy.t_event if lanes is None else hy.t_event_batch
    for k, clearance in enumerate(clearances):
        y, w = gaps[2 * k : 2 * k + 2]
        equations += [(y, w), (w, -push)]

        def struck(
            integrator: Integrator, _: int, lane: int | None = None, own: int = 2 * k + 3
        ) -> bool:
            state = integrator.state if lane is None else integrator.state[:, lane]
            gained = mass_ratio * (1 + RESTITUTION) / (1 + mass_ratio) * state[own]
            state[1] += gained
            rebound = -RESTITUTION * state[own]
            state[[3, 5]] -= gained
            state[own] = rebound
            return True

        rising = hy.event_direction.positive
        events += [
            event(side * y - clearance, callback=struck, direction=rising) for side in (1, -1)
        ]
    if lanes is None:
        return hy.taylor_adaptive(equations, np.zeros(6), tol=1e-16, pars=[1.0], t_events=events)
    return hy.taylor_adaptive_batch(
        equations, np.zeros((6, lanes)), tol=1e-16, pars=np.ones((1, lanes)), t_events=events
    )


def orbits_of_pairs(run: Integrator) -> None:
    """Find an orbit of two masses from a state 1e-3 away, with its multipliers."""
    masses = [siva(clearance, PAIR[0]) for clearance in PAIR[1]]
    settling = iva.Start(gap_velocity=[0.1, 0.2])
    # By hand impacts are missed on the way there.
    first = dynamics.orbit(masses, PRIMARY, force=FORCE, start=settling, settle=600)
    assert isinstance(first, dynamics.Orbit), first
    start = np.array(first.state) + 1e-3

    def by_hand() -> np.ndarray:
        found = fsolve(lambda at: mapped(run, at, 1.0) - at, start, xtol=1e-13)
        image = mapped(run, found, 1.0)
        moved = [mapped(run, found + 1e-6 * unit, 1.0) for unit in np.eye(6)]
        return np.linalg.eigvals(np.array([(one - image) / 1e-6 for one in moved]).T)

    x, v, *gaps = start.tolist()
    begin = iva.Start(
        displacement=x, velocity=v, gap_displacement=gaps[::2], gap_velocity=gaps[1::2]
    )
    found = dynamics.orbit(masses, PRIMARY, force=FORCE, start=begin)
    assert isinstance(found, dynamics.Orbit), found
    ours = timed(lambda: dynamics.orbit(masses, PRIMARY, force=FORCE, start=begin))
    line("the same of two masses", ours, timed(by_hand))


def along(run: Integrator, start: np.ndarray, values: np.ndarray) -> None:
    """Follow an orbit over the parameter by hand, one value after the other, with multipliers."""
    state = start
    for value in values:

        def off(at: np.ndarray, given: float = value) -> np.ndarray:
            return mapped(run, at, given) - at

        state = fsolve(off, state, xtol=1e-13)
        image = mapped(run, state, value)
        moved = [mapped(run, state + 1e-6 * unit, value) for unit in np.eye(len(state))]
        np.linalg.eigvals(np.array([(one - image) / 1e-6 for one in moved]).T)


def branches(run: Integrator, values: int) -> None:
    """Follow that orbit over the clearance."""
    start = settled(run, 300)
    first = dynamics.orbit(siva(), PRIMARY, force=FORCE, start=start.tolist())
    assert isinstance(first, dynamics.Orbit)

    def followed() -> dynamics.Branch:
        found = dynamics.follow(first, over="clearance", between=(4.5, 6.5))
        assert isinstance(found, dynamics.Branch)
        return found

    hand = timed(lambda: along(run, start, np.linspace(4.5, 6.5, values)), 1) / values
    line("a point of a branch", timed(followed) / len(followed().rows), hand)


def branches_of_pairs(run: Integrator, values: int) -> None:
    """Follow an orbit of two masses over the force."""
    masses = [siva(clearance, PAIR_OF_BASIN[0]) for clearance in PAIR_OF_BASIN[1]]
    begin = iva.Start(gap_velocity=[0.1, 0.2])
    first = dynamics.orbit(masses, PRIMARY, force=FORCE, start=begin, settle=600)
    assert isinstance(first, dynamics.Orbit), first

    def followed() -> dynamics.Branch:
        found = dynamics.follow(first, over="force.amplitude", between=(1.0, 1.1))
        assert isinstance(found, dynamics.Branch), found
        return found

    start, forces = np.array(first.state), np.linspace(1.0, 1.1, values)
    hand = timed(lambda: along(run, start, forces), 1) / values
    line("the same of two masses", timed(followed) / len(followed().rows), hand)


def diagrams(run: Integrator, values: int) -> None:
    """Follow steady states over the clearance."""
    grid = np.linspace(3.0, 6.0, values)
    asked: dict[str, Any] = {"over": {"clearance": grid}, "discard": 300, "keep": 60}
    start = iva.Start(gap_velocity=0.1)

    def by_hand() -> None:
        state = np.array([0.0, 0.0, 0.0, 0.1])
        for clearance in grid:
            for _ in range(360):
                state = mapped(run, state, clearance)

    ours = timed(
        lambda: dynamics.diagram(siva(), PRIMARY, force=FORCE, start=start, direction="up", **asked)
    )
    cycles = 360 * values
    line("a cycle of a diagram", ours / cycles, timed(by_hand, 1) / cycles)


def basins(batch: Integrator, side: int) -> None:
    """Decide where the starts of a grid end, within 150 cycles."""
    x, v = np.linspace(-6, 6, side), np.linspace(-6, 6, side)
    asked: dict[str, Any] = {"over": {"displacement": x, "velocity": v}, "most_cycles": 150}
    lanes = 4

    def by_hand() -> None:
        cells = np.array([(one, other, 0.0, 0.0) for one in x for other in v])
        for first in range(0, len(cells), lanes):
            state = np.resize(cells[first : first + lanes], (lanes, 4)).T
            for _ in range(150):
                state = mapped(batch, state, CLEARANCE)

    ours = timed(lambda: dynamics.basins(siva(), PRIMARY, force=FORCE, **asked))
    line("a cell of a basin", ours / side**2, timed(by_hand, 1) / side**2)


def basins_of_pairs(batch: Integrator, side: int) -> None:
    """Decide where the starts of a grid of two masses end, within 150 cycles."""
    lanes, finer = 4, 10

    def by_hand() -> None:
        x, y = np.linspace(-6, 6, side), np.linspace(-3, 3, side)
        cells = np.array([(one, 0.0, 0.0, 0.0, other, 0.0) for one in x for other in y])
        for first in range(0, len(cells), lanes):
            state = np.resize(cells[first : first + lanes], (lanes, 6)).T
            for _ in range(150):
                state = mapped(batch, state, 1.0)

    x, y = np.linspace(-6, 6, finer * side), np.linspace(-3, 3, finer * side)
    over = {"displacement": x, "gap_displacement.1": y}
    masses = [siva(clearance, PAIR_OF_BASIN[0]) for clearance in PAIR_OF_BASIN[1]]
    ours = timed(
        lambda: dynamics.basins(masses, PRIMARY, force=FORCE, over=over, most_cycles=150), 1
    )
    theirs = timed(by_hand, 1) / side**2
    line("a cell of a basin of two masses", ours / (finer * side) ** 2, theirs)


def exponents(batch: Integrator, cycles: int) -> None:
    """Follow four neighbours of a chaotic motion, made orthogonal after each cycle."""
    clearance, size = 3.85, 1e-7

    def by_hand() -> None:
        state, axes = np.zeros(4), np.eye(4)
        for _ in range(cycles):
            beside = [state[:, None] + size * axes, state[:, None] + np.zeros((4, 4))]
            moved, own = (mapped(batch, one, clearance) for one in beside)
            axes, _ = np.linalg.qr((moved - own) / size)
            state = own[:, 0]

    ours = timed(
        lambda: dynamics.lyapunov(
            siva(clearance), PRIMARY, force=FORCE, cycles=cycles, discard=0, seeds=1
        )
    )
    line("a cycle of exponents", ours / cycles, timed(by_hand, 1) / cycles)


def main() -> None:
    """Print a line for each."""
    share = 10 if "--quick" in sys.argv[1:] else 1
    run, batch = integrator(), integrator(4)
    print(f"{'':<48} {'iva':>12} {'by hand':>12} {'ratio':>8}")
    orbits(run)
    orbits_of_pairs(of_pair(PAIR))
    branches(run, 40 // share)
    branches_of_pairs(of_pair(PAIR_OF_BASIN), 40 // share)
    diagrams(run, 20 // share)
    basins(batch, 40 // share)
    basins_of_pairs(of_pair(PAIR_OF_BASIN, 4), 20 // share)
    exponents(batch, 2000 // share)


if __name__ == "__main__":
    main()
