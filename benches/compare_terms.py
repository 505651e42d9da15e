"""Terms of free masses, alone and together: iva and heyoka.

Usage: compare_terms.py [--quick] [KIND ...]

Each kind is a scene with one term or with several, run for 96 coefficients of restitution. heyoka
is compiled once a kind, with terminal events whose callbacks apply impacts, stops and slips; it
runs batches of 8 at 1e-9 and of 4 at 1e-16 and keeps counts and the last state. iva runs its sweep
on one thread, with counts alone and with all measures. Times are CPU time, the best of some calls.
Told are heyoka's fastest time over both of iva's, and how many of the scenes without stick episodes
have another number of impacts with heyoka at 1e-16. Needs the extra ``bench``.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

os.environ.setdefault("RAYON_NUM_THREADS", "1")
import heyoka as hy
import numpy as np

import iva

RESTITUTIONS = np.linspace(0.42, 0.83, 96)
DAMPING_RATIO = 0.0085
CALLS = 3
#: Callbacks after which a scene ends: without a law for chatter some would go on for ever.
MOST = 4000
MODES = ((1e-9, 8), (1e-16, 4))


@dataclass(frozen=True)
class Mass:
    """A free mass: mass ratio, clearance, spring and dashpot in its gap, slowed by friction."""

    mu: float
    d: float
    spring: float = 0.0
    damping: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class Push:
    """A harmonic force in N at a point with its shape."""

    amplitude: float
    frequency: float
    phase: float
    shape: tuple[float, ...]


@dataclass(frozen=True)
class Kind:
    """Masses at points with their shapes, on modes; a force on the first one, or some at points."""

    masses: tuple[Mass, ...]
    frequencies: tuple[float, ...] = (1.0,)
    shapes: tuple[tuple[float, ...], ...] = ()
    amplitude: float = 0.0
    pushes: tuple[Push, ...] = ()
    duration: float = 120.0

    def shape(self, mass: int) -> Sequence[float]:
        """Return the shape at the point of a mass."""
        return self.shapes[mass] if self.shapes else (1.0,)


TWENTY = np.random.default_rng(3).normal(size=(5, 20)) * 0.5
KINDS = {
    "mass": Kind((Mass(0.1, 0.7),)),
    "dashpot": Kind((Mass(0.1, 0.7, damping=0.008),)),
    "spring": Kind((Mass(0.1, 0.7, spring=0.06),)),
    "spring and dashpot": Kind((Mass(0.1, 0.7, spring=0.06, damping=0.008),)),
    "friction": Kind((Mass(0.1, 0.7, friction=0.02),)),
    "two masses": Kind((Mass(0.08, 0.7), Mass(0.05, 0.9))),
    "four masses": Kind(tuple(Mass(0.04, 0.6 + 0.1 * k) for k in range(4))),
    "four masses, force": Kind(tuple(Mass(0.04, 0.6 + 0.1 * k) for k in range(4)), amplitude=0.03),
    "dashpot, force": Kind((Mass(0.1, 0.7, damping=0.008),), amplitude=0.03),
    "three modes": Kind((Mass(0.1, 0.7),), (1.0, 2.7, 5.1), ((1.0, 0.7, 0.4),)),
    "three modes, forces at three points": Kind(
        (Mass(0.1, 0.7),),
        (1.0, 2.7, 5.1),
        ((1.0, 0.7, 0.4),),
        pushes=(
            Push(0.03, 0.98, 0.0, (1.0, 0.7, 0.4)),
            Push(0.1, 2.3, 0.8, (0.6, -0.9, 0.5)),
            Push(0.2, 0.6, -1.9, (0.3, 0.8, -1.0)),
        ),
    ),
    "five masses, 20 modes": Kind(
        (Mass(0.05, 0.4),) * 5,
        tuple(np.sqrt(np.linspace(1, 400, 20)).tolist()),
        tuple(map(tuple, TWENTY.tolist())),
        duration=30.0,
    ),
}
#: Gap velocity with which masses of heyoka slide off, or their stop would be found again at once.
NUDGE = 1e-12
#: Frequency of the force.
OMEGA = 0.98


@dataclass
class Equations:
    """The equations of a kind for heyoka, with the places of its variables and parameters.

    Parameters are e, one that is 0, and of each mass that rubs the sign of its slide and whether
    friction holds it.
    """

    kind: Kind
    modes: int = field(init=False)

    def __post_init__(self) -> None:
        """Name the variables."""
        self.modes = len(self.kind.frequencies)
        n, count = self.modes, len(self.kind.masses)
        self.q, self.p = names("q", n), names("p", n)
        self.x, self.w = names("x", count), names("w", count)
        self.count = hy.make_vars("count")

    def rubs(self, k: int) -> tuple[Any, Any]:
        """Return sign and hold of a mass as parameters; of one that does not rub numbers."""
        if not self.kind.masses[k].friction:
            return 0.0, 0.0
        return hy.par[2 + 2 * k], hy.par[3 + 2 * k]

    def along(self, k: int, parts: list[Any]) -> Any:
        """Return the displacement or velocity of the point of a mass."""
        return hy.sum([phi * part for phi, part in zip(self.kind.shape(k), parts, strict=True)])

    def gaps(self) -> list[tuple[Any, Any]]:
        """Return gap displacement and gap velocity of each mass."""
        return [
            (self.x[k] - self.along(k, self.q), self.w[k] - self.along(k, self.p))
            for k in range(len(self.x))
        ]

    def accelerations(self) -> list[Any]:
        """Return q̈ of all modes. Masses that rub ride on one mode of shape 1."""
        pulls = []
        for k, (mass, (y, rate)) in enumerate(zip(self.kind.masses, self.gaps(), strict=True)):
            sign, held = self.rubs(k)
            force = mass.spring * y + mass.damping * rate + mass.mu * mass.friction * sign
            pulls.append((1.0 - held) * force)
        inertia = 1.0 + sum(
            (mass.mu * self.rubs(k)[1] for k, mass in enumerate(self.kind.masses)), 0.0
        )
        made = []
        for j, omega in enumerate(self.kind.frequencies):
            a = -2 * DAMPING_RATIO * omega * self.p[j] - omega**2 * self.q[j]
            if j == 0 and self.kind.amplitude:
                a = a + self.kind.amplitude * hy.cos(OMEGA * hy.time)
            for push in self.kind.pushes:
                wave = hy.cos(push.frequency * hy.time + push.phase)
                a = a + push.shape[j] * push.amplitude * wave
            for k, pull in enumerate(pulls):
                a = a + self.kind.shape(k)[j] * pull
            made.append(a / inertia)
        return made

    def system(self) -> list[Any]:
        """Return the system of first order."""
        bent = self.accelerations()
        made = []
        for j in range(self.modes):
            made += [(self.q[j], self.p[j]), (self.p[j], bent[j])]
        for k, (mass, (y, rate)) in enumerate(zip(self.kind.masses, self.gaps(), strict=True)):
            sign, held = self.rubs(k)
            tied = (mass.spring * y + mass.damping * rate) / mass.mu
            free = -tied - mass.friction * sign + 0.0 * self.x[k]
            made += [(self.x[k], self.w[k]), (self.w[k], (1.0 - held) * free + held * bent[0])]
        return [*made, (self.count, hy.par[1])]

    def events(self) -> list[tuple[Any, Any, Any]]:
        """Return the function, direction and callback of each event."""
        up, down = hy.event_direction.positive, hy.event_direction.negative
        made = []
        bent = self.accelerations()[0]
        for k, (mass, (y, rate)) in enumerate(zip(self.kind.masses, self.gaps(), strict=True)):
            made += [(side * y - mass.d, up, self.impact(k)) for side in (1.0, -1.0)]
            if mass.friction:
                _, held = self.rubs(k)
                made.append((held + (1.0 - held) * rate, hy.event_direction.any, self.stop(k)))
                needed = bent + mass.spring / mass.mu * y
                for side in (1.0, -1.0):
                    left = held * (mass.friction - side * needed) + (1.0 - held)
                    made.append((left, down, self.slip(k, -side)))
        return made

    def impact(self, k: int) -> Callable[..., bool]:
        """Return Newton's law of a mass."""
        mu, phi, n = self.kind.masses[k].mu, np.array(self.kind.shape(k)), self.modes
        reduced = 1.0 / (1.0 / mu + phi @ phi)

        def hit(integrator: Any, _: int, lane: int) -> bool:
            state, pars = integrator.state[:, lane], integrator.pars[:, lane]
            v = state[1 : 2 * n : 2]
            rate = state[2 * n + 2 * k + 1] - phi @ v
            pushed = (1 + pars[0]) * reduced * rate
            state[1 : 2 * n : 2] = v + pushed * phi
            state[2 * n + 2 * k + 1] -= pushed / mu
            state[-1] += 1
            if self.kind.masses[k].friction:
                pars[2 + 2 * k], pars[3 + 2 * k] = -math.copysign(1.0, rate), 0.0
            return bool(state[-1] < MOST)

        return hit

    def stop(self, k: int) -> Callable[..., bool]:
        """Return what happens where a mass stops in its gap: it is held, or slides back."""
        mass = self.kind.masses[k]

        def stopped(integrator: Any, _: int, lane: int) -> bool:
            state, pars = integrator.state[:, lane], integrator.pars[:, lane]
            x, v, y = state[0], state[1], state[2 * k + 2] - state[0]
            push = self.kind.amplitude * math.cos(OMEGA * integrator.time[lane])
            bent = (push - 2 * DAMPING_RATIO * v - x) / (1.0 + mass.mu)
            held = abs(bent + mass.spring / mass.mu * y) <= mass.friction
            pars[3 + 2 * k] = float(held)
            pars[2 + 2 * k] *= 0.0 if held else -1.0
            state[2 * k + 3] = v + NUDGE * pars[2 + 2 * k]
            return True

        return stopped

    def slip(self, k: int, sign: float) -> Callable[..., bool]:
        """Return what happens where friction no longer holds a mass."""

        def slipped(integrator: Any, _: int, lane: int) -> bool:
            integrator.pars[2 + 2 * k, lane], integrator.pars[3 + 2 * k, lane] = sign, 0.0
            integrator.state[2 * k + 3, lane] = integrator.state[1, lane] + NUDGE * sign
            return True

        return slipped


def names(letter: str, count: int) -> list[Any]:
    """Return so many variables."""
    made = hy.make_vars(*[f"{letter}{k}" for k in range(count)])
    return list(made) if count > 1 else [made]


def with_heyoka(kind: Kind, tolerance: float, lanes: int) -> Callable[[], list[int]]:
    """Return the sweep of heyoka, which gives the number of impacts of each scene."""
    equations = Equations(kind)
    size = 2 * (equations.modes + len(kind.masses)) + 1
    pars = 2 + 2 * sum(mass.friction > 0 for mass in kind.masses)
    events = [
        hy.t_event_batch(function, callback=callback, direction=direction)
        for function, direction, callback in equations.events()
    ]
    integrator = hy.taylor_adaptive_batch(
        equations.system(),
        np.zeros((size, lanes)),
        tol=tolerance,
        pars=np.ones((pars, lanes)),
        t_events=events,
        compact_mode=size > 20,
    )
    begin = np.zeros(size)
    begin[0] = 1.0
    for k in range(len(kind.masses)):
        begin[2 * (equations.modes + k)] = kind.shape(k)[0]
        begin[2 * (equations.modes + k) + 1] = START
    rows = np.zeros((pars, lanes))
    rows[2::2] = 1.0  # all slide upwards at first

    def sweep() -> list[int]:
        counts: list[int] = []
        for first in range(0, len(RESTITUTIONS), lanes):
            integrator.set_time(0.0)
            integrator.state[:] = np.tile(begin[:, None], lanes)
            integrator.pars[:] = rows
            integrator.pars[0] = RESTITUTIONS[first : first + lanes]
            integrator.reset_cooldowns()
            integrator.propagate_until(kind.duration)
            counts += integrator.state[-1].astype(int).tolist()
        return counts

    return sweep


#: Gap velocity of all masses at the start, so that those that rub slide.
START = 0.05


def with_iva(kind: Kind, **asked: Any) -> Callable[[], Any]:
    """Return the sweep of iva, on one thread."""
    alone = len(kind.frequencies) == 1
    masses = [
        iva.Siva(
            **({"mass_ratio": mass.mu} if alone else {"mass": mass.mu}),
            clearance=mass.d,
            restitution=0.5,
            **({"spring_ratio": math.sqrt(mass.spring / mass.mu)} if mass.spring else {}),
            **({"gap_damping_ratio": mass.damping / 2} if mass.damping else {}),
            **({"friction": mass.friction, "gravity": 1.0} if mass.friction else {}),
        )
        for mass in kind.masses
    ]
    if alone:
        structure: Any = iva.Primary(damping_ratio=DAMPING_RATIO)
        start = iva.Start(displacement=1.0, gap_velocity=START)
    else:
        riding = [f"p{k}" for k in range(len(masses))]
        pushed = [f"f{k}" for k in range(len(kind.pushes))]
        shapes = [kind.shape(k) for k in range(len(masses))] + [it.shape for it in kind.pushes]
        structure = iva.Structure(
            frequencies=list(kind.frequencies),
            damping_ratios=DAMPING_RATIO,
            points={name: list(of) for name, of in zip(riding + pushed, shapes, strict=True)},
            absorber_at=riding,
            force_at=pushed or None,
            seen_at="p0",
            start_displacements=[1.0] + [0.0] * (len(kind.frequencies) - 1),
        )
        start = iva.Start(gap_velocity=START)
    force: Any = None
    if kind.amplitude:
        force = iva.Harmonic(amplitude=kind.amplitude, frequency=OMEGA)
    elif kind.pushes:
        force = [
            iva.Harmonic(force=it.amplitude, frequency=it.frequency, phase=it.phase)
            for it in kind.pushes
        ]
    return lambda: (
        iva.sweep(
            masses if len(masses) > 1 else masses[0],
            structure,
            over={"restitution": RESTITUTIONS},
            start=start,
            force=force,
            duration=kind.duration,
            tables=("summary",),
            threads=1,
            **asked,
        ).summary
    )


def fastest(call: Callable[[], Any], calls: int) -> float:
    """Return the least CPU time of some calls, after one."""
    call()
    spent = []
    for _ in range(calls):
        begin = time.process_time()
        call()
        spent.append(time.process_time() - begin)
    return min(spent)


def compared(
    ours: tuple[Callable[[], Any], Callable[[], Any]],
    theirs: list[Callable[[], list[int]]],
    calls: int,
) -> str:
    """Return the row of two sweeps of iva, counts alone and all measures, and those of heyoka."""
    summary = ours[0]()
    calm = (summary["episodes"] == 0).to_numpy()
    times, other = [], 0
    for peer in theirs:
        found = np.array(peer())
        other = int((found[calm] != summary["impacts"].to_numpy()[calm]).sum())
        times.append(fastest(peer, calls))
    counts, everything, best = *(fastest(sweep, calls) for sweep in ours), min(times)
    shown = [1e6 / len(RESTITUTIONS) * spent for spent in (counts, everything, best)]
    cells = [f"{micro:.1f}" for micro in shown]
    cells += [f"{best / spent:.2f}" for spent in (counts, everything)]
    return " | ".join([*cells, f"{other} of {calm.sum()} |"])


def table(kinds: dict[str, Any], row: Callable[[Any, int], str]) -> None:
    """Print a row for each kind that is asked for."""
    arguments = sys.argv[1:]
    calls = 1 if "--quick" in arguments else CALLS
    chosen = [argument for argument in arguments if argument in kinds] or list(kinds)
    head = "| kind | us a run, counts | all measures | heyoka | over counts | over all |"
    print(f"{head} other counts |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    for name in chosen:
        print(f"| {name} | {row(kinds[name], calls)}", flush=True)


def row(kind: Kind, calls: int) -> str:
    """Return the row of a kind."""
    ours = (with_iva(kind, measures=("impacts", "episodes")), with_iva(kind))
    return compared(ours, [with_heyoka(kind, *mode) for mode in MODES], calls)


if __name__ == "__main__":
    table(KINDS, row)
