"""Runs under force and base motion against an integration in the inertial frame by SciPy.

The expected numbers come from the mechanics alone. Coordinates are absolute, q = (X, X₁) of a free
mass and q = (X, θ) of a pendulum on a moving pivot, and a moving base only pulls at the spring and
the damper: there is no inertial force. With M(q) the mass matrix over the primary mass, Q the
generalised forces and n = ∂y/∂q of the gap displacement y, u = q̇:

    flight   M u̇ = Q             impact    u⁺ = u − (1+e) (n·u) M⁻¹n / (n·M⁻¹n)
    stuck    M u̇ = Q + λn        impulse   u⁺ = u + M⁻¹(P/M, 0) (+ a reaction along n while stuck)

with λ such that n·u̇ = 0. Impacts amplify a change of the start by less than 2000 in all scenes, so
that the errors of SciPy stay below 1e-9.
"""

# ruff: noqa: D101, D102

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

import iva

Array = NDArray[np.float64]
Force = iva.Harmonic | iva.Impulse | iva.Recorded
Drive = Callable[[float], tuple[float, float]]
Rows = list[dict[str, Any]]
TOLERANCE = 1e-8
FLOOR = 3e-6  # over ωn d: slower rebounds are summed; what the sum leaves out is their square


@dataclass(frozen=True)
class Scene:
    absorber: iva.Siva | iva.Piva
    forces: list[Force]
    duration: float = 30.0
    primary: iva.Primary = field(default=iva.Primary(damping_ratio=0.02), kw_only=True)
    start: iva.Start = field(default=iva.Start(displacement=1.0), kw_only=True)
    stays: int = field(default=0, kw_only=True)


@dataclass(frozen=True)
class Model:
    """Masses, forces and energies over the primary mass; z = (q, u, s, ṡ, work), s the base."""

    mass: float
    omega: float
    zeta: float
    mu: float
    e: float
    d: float
    length: float = 0.0  # 0: a free mass
    kappa: float = 1.0
    contact: float = 0.0
    gravity: float = 0.0
    pivot: float = 0.0  # 2 ζp ωp
    spring: float = 0.0  # ωs²
    small: bool = False

    def sine(self, angle: Any) -> Any:
        return angle if self.small else np.sin(angle)

    def cosine(self, angle: Any) -> Any:
        return 1.0 if self.small else np.cos(angle)

    def inertia(self, z: Array) -> Array:
        if not self.length:
            return np.diag([1.0, self.mu])
        mixed = self.mu * self.length * self.cosine(z[1])
        return np.array([[1.0 + self.mu, mixed], [mixed, self.mu * self.kappa * self.length**2]])

    def load(self, z: Array) -> Array:
        spring = -2.0 * self.zeta * self.omega * (z[2] - z[5]) - self.omega**2 * (z[0] - z[4])
        if not self.length:
            return np.array([spring, 0.0])
        if not self.small:
            spring += self.mu * self.length * z[3] ** 2 * math.sin(z[1])
        moment = self.gravity * self.length * self.sine(z[1])
        moment += self.kappa * self.length**2 * (self.pivot * z[3] + self.spring * z[1])
        return np.array([spring, -self.mu * moment])

    def gap(self, z: Array) -> Any:
        return self.contact * self.sine(z[1]) if self.length else z[1] - z[0]

    def normal(self, z: Array) -> tuple[Any, Any]:
        return (0.0, self.contact * self.cosine(z[1])) if self.length else (-1.0, 1.0)

    def gap_velocity(self, z: Array) -> Any:
        n = self.normal(z)
        return n[0] * z[2] + n[1] * z[3]

    def absorber_velocity(self, z: Array) -> Any:
        """Return the horizontal velocity of its centre of mass, relative to the base."""
        swing = z[2] + self.length * self.cosine(z[1]) * z[3] if self.length else z[3]
        return swing - z[5]

    def kinetic(self, z: Array) -> float:
        """Return the kinetic energy relative to the base; an impact loses it in any frame."""
        u = z[2:4] - ([z[5], 0.0] if self.length else z[5])
        return 0.5 * float(u @ self.inertia(z) @ u)

    def energy(self, z: Array) -> float:
        rise = 0.5 * z[1] ** 2 if self.small else 1.0 - math.cos(z[1])
        spring = 0.5 * self.omega**2 * (z[0] - z[4]) ** 2
        bob = self.gravity * self.length * rise
        bob += 0.5 * self.kappa * self.spring * (self.length * z[1]) ** 2
        return self.kinetic(z) + float(spring + self.mu * bob)


def model(scene: Scene) -> Model:
    """Return the numbers of a scene in its own units; lengths are m in SI units."""
    absorber, primary = scene.absorber, scene.primary
    mass, hertz, stiffness = primary.mass or 1.0, primary.frequency_hz, primary.stiffness
    omega = 2.0 * math.pi * hertz if hertz else math.sqrt((stiffness or 1.0) / mass)
    zeta = (primary.damping or 0.0) / (2.0 * mass * omega) or primary.damping_ratio or 0.0
    mu = absorber.mass_ratio or (absorber.mass or 0.0) / mass
    d = absorber.clearance or (absorber.gap_mm or 0.0) / 2000.0
    free = Model(mass, omega, zeta, mu, absorber.restitution or 0.0, d)
    if isinstance(absorber, iva.Siva):
        return free
    length, kappa = absorber.length or 0.0, absorber.inertia_ratio or 1.0
    ratio = absorber.frequency_ratio
    gravity = kappa * length * (ratio * omega) ** 2 if ratio else 9.80665
    pivot = 2.0 * (absorber.pivot_damping_ratio or 0.0) * math.sqrt(gravity / (kappa * length))
    contact, small = absorber.contact_distance or length, absorber.angles == "small"
    hung = replace(free, length=length, kappa=kappa, contact=contact, gravity=gravity)
    return replace(
        hung, pivot=pivot, small=small, spring=((absorber.spring_ratio or 0.0) * omega) ** 2
    )


def accelerations(forces: list[Force], of: Model, middle: float) -> Drive:
    """Return f/M and a_g as functions of time, on the piece between knots with this middle."""

    def at(time: float) -> tuple[float, float]:
        push, base = 0.0, 0.0
        for force in forces:
            if isinstance(force, iva.Harmonic):
                hertz, relative = force.frequency_hz or 0.0, force.relative_frequency or 0.0
                turns = force.frequency or 2.0 * math.pi * hertz or relative * of.omega
                wave = math.cos(turns * time + (force.phase or 0.0))
                push += ((force.amplitude or 0.0) + (force.force or 0.0) / of.mass) * wave
                base += (force.base_acceleration or 0.0) * wave
            elif isinstance(force, iva.Recorded) and force.times[0] < middle < force.times[-1]:
                value = force.scale * float(np.interp(time, force.times, force.values))
                newtons = value / of.mass
                push += {"force": value, "force_newtons": newtons}.get(force.kind, 0.0)
                base += value if force.kind == "base_acceleration" else 0.0
        return push, base

    return at


@dataclass
class Reference:
    """The integration of one scene, and what it met."""

    of: Model
    forces: list[Force]
    z: Array
    wall: int = 0  # ±1 while stuck
    impacts: Rows = field(default_factory=list)
    episodes: Rows = field(default_factory=list)
    states: Rows = field(default_factory=list)

    def motion(self, drive: Drive, time: float, z: Array) -> tuple[Array, float]:
        """Return ż, and ÿ as it would be without the wall, at rest on it."""
        push, base = drive(time)
        inertia, n = self.of.inertia(z), np.array(self.of.normal(z))
        rates = np.linalg.solve(inertia, self.of.load(z) + np.array([push, 0.0]))
        pull = float(n @ rates)
        if self.wall:
            reply = np.linalg.solve(inertia, n)
            rates = rates - pull / float(n @ reply) * reply
        v = z[2] - z[5]
        power = push * v - base * (v + self.of.mu * self.of.absorber_velocity(z))
        return np.array([z[2], z[3], *rates, z[5], base, power]), pull

    def next_contact(self, path: Any, begin: float, end: float) -> tuple[float, int] | None:
        """Return the first contact in a step and its wall."""
        of, grid = self.of, np.linspace(begin, end, 9)
        turns = [
            brentq(lambda t: of.gap_velocity(path(t)), *ends, xtol=1e-14)
            for ends in pairwise(grid)
            if math.prod(of.gap_velocity(path(t)) for t in ends) < 0.0
        ]
        # The gap displacement is monotone between these marks: no contact hides there.
        for a, b in pairwise(sorted([*grid, *turns])):
            wall = 1 if of.gap(path(b)) > of.gap(path(a)) else -1
            if wall * of.gap(path(b)) > of.d * (1.0 + 1e-13):
                distance = lambda t, stop: of.gap(path(t)) - stop  # noqa: E731
                return brentq(distance, a, b, (wall * of.d,), 1e-14), wall
        return None

    def change_gap_velocity(self, change: float) -> None:
        """Change it by a reaction along n."""
        n = np.array(self.of.normal(self.z))
        reply = np.linalg.solve(self.of.inertia(self.z), n)
        self.z[2:4] += change / float(n @ reply) * reply

    def impact(self, drive: Drive, time: float, wall: int) -> None:
        of, z = self.of, self.z.copy()
        approach = of.gap_velocity(z)
        self.change_gap_velocity(-(1.0 + of.e) * approach)
        row = {"time": time, "wall": wall, "displacement": z[0] - z[4]}
        row |= {"velocity_before": z[2] - z[5], "velocity_after": self.z[2] - z[5]}
        row["absorber_velocity_before"] = of.absorber_velocity(z)
        row["absorber_velocity_after"] = of.absorber_velocity(self.z)
        row |= {
            "approach_velocity": approach,
            "effective": (z[2] - z[5]) * row["absorber_velocity_before"] < 0.0,
        }
        row["energy_loss"] = of.mass * (of.kinetic(z) - of.kinetic(self.z))
        if of.length:
            row |= {"angle": z[1], "angular_velocity_before": z[3]}
            row["angular_velocity_after"] = self.z[3]
        self.impacts.append(row)
        pull, rebound = wall * self.motion(drive, time, self.z)[1], of.e * abs(approach)
        if pull > 0.0 and rebound <= FLOOR * of.omega * of.d:
            self.change_gap_velocity(-of.gap_velocity(self.z))
            self.wall, rest = wall, 2.0 * rebound / (pull * (1.0 - of.e))
            self.episodes.append({"wall": wall, "stick_time": time + rest})

    def release(self, time: float) -> None:
        self.wall = 0
        self.episodes[-1]["release_time"] = time

    def kick(self, time: float, change: float) -> None:
        """Apply an impulse; a wall that the absorber is pushed into keeps the gap closed."""
        before = self.z.copy()
        self.z[2:4] += np.linalg.solve(self.of.inertia(before), [change, 0.0])
        if self.wall and self.wall * self.of.gap_velocity(self.z) > 0.0:
            self.change_gap_velocity(-self.of.gap_velocity(self.z))
        elif self.wall:
            self.release(time)
        self.z[6] += change * (0.5 * (before[2] + self.z[2]) - before[5])

    def keep(self, time: float, z: Array) -> None:
        row = {"time": time, "displacement": z[0] - z[4], "velocity": z[2] - z[5]}
        row |= {"gap_displacement": self.of.gap(z), "gap_velocity": self.of.gap_velocity(z)}
        self.states.append(row | {"wall": self.wall})

    def run(self, instants: list[float]) -> None:
        """Integrate to the last instant; every kink, jump and impulse is the end of a step."""
        hits = {f.time or 0.0: f for f in self.forces if isinstance(f, iva.Impulse)}
        knots = {float(t) for f in self.forces if isinstance(f, iva.Recorded) for t in f.times}
        ends = sorted(t for t in {0.0, instants[-1], *hits, *knots} if 0.0 <= t <= instants[-1])
        for begin, end in pairwise(ends):
            if hit := hits.get(begin):
                self.kick(begin, hit.velocity or (hit.impulse or 0.0) / self.of.mass)
            drive, time = accelerations(self.forces, self.of, 0.5 * (begin + end)), begin
            if self.wall and self.wall * self.motion(drive, begin, self.z)[1] <= 0.0:
                self.release(begin)  # the force has jumped
            while time < end:
                time = self.stretch(drive, time, end, instants)
        self.keep(instants[-1], self.z)

    def pull(self, time: float, drive: Drive, path: Any) -> float:
        return self.motion(drive, time, path(time))[1]

    def stretch(self, drive: Drive, begin: float, end: float, instants: list[float]) -> float:
        """Go on to the next impact or release, or to the end."""
        accuracy = {"max_step": 0.1 / self.of.omega, "rtol": 1e-12, "atol": 1e-13 * self.of.d}
        rates = lambda t, z: self.motion(drive, t, z)[0]  # noqa: E731
        solver = DOP853(rates, begin, self.z, end, **accuracy)
        while solver.status == "running":
            solver.step()
            path, last, stop, wall = solver.dense_output(), solver.t_old, solver.t, 0
            if not self.wall:
                stop, wall = self.next_contact(path, last, stop) or (stop, 0)
            elif self.wall * self.pull(stop, drive, path) < 0.0:
                stop = brentq(self.pull, last, stop, (drive, path), 1e-14)
            for instant in instants:
                if last <= instant < stop:
                    self.keep(instant, path(instant))
            self.z = path(stop)
            if wall:
                self.impact(drive, stop, wall)
                break
            if stop < solver.t:
                self.release(stop)
                break
        assert solver.status != "failed"
        return float(stop)


def reference(scene: Scene, instants: list[float]) -> Reference:
    of, start = model(scene), scene.start
    x = (start.displacement or 0.0) + (start.displacement_mm or 0.0) / 1000.0
    v = start.velocity or 0.0
    q, u = ([x, 0.0], [v, 0.0]) if of.length else ([x, x], [v, v])
    expected = Reference(of, scene.forces, np.array([*q, *u, 0.0, 0.0, 0.0]))
    expected.run(instants)
    return expected


def deviation(found: pl.DataFrame, rows: Rows, omega: float) -> float:
    """Return the largest difference, of times over 1/ωn, else over the largest of its column."""
    assert found.height == len(rows)
    worst = 0.0
    for name in rows[0] if rows else ():
        have, want = found[name].to_numpy(), np.array([row[name] for row in rows])
        if name in ("wall", "effective"):
            assert have.tolist() == want.tolist(), name
            continue
        size = 1.0 / omega if name.endswith("time") else max(1e-6, np.abs(want).max())
        worst = max(worst, float(np.abs(have - want).max() / size))
    return worst


SIVA = iva.Siva(mass_ratio=0.1, clearance=0.8, restitution=0.7)
# Stops at 37 degrees.
PIVA = iva.Piva(mass_ratio=0.12, clearance=1.2, restitution=0.6, frequency_ratio=0.5, length=2.0)
COMPOUND = replace(
    PIVA, clearance=0.9, inertia_ratio=1.3, contact_distance=2.6, pivot_damping_ratio=0.04
)
SMALL = replace(COMPOUND, angles="small")
SPRUNG = replace(COMPOUND, clearance=1.6, spring_ratio=0.6)
SHAKE = iva.Harmonic(base_acceleration=0.3, relative_frequency=0.9, phase=0.7)
# Uneven steps, a jump at either end, one piece longer than a period and a knot 0.01 from the next.
TIMES = [0.3, 1.1, 1.7, 2.9, 3.4, 4.6, 5.0, 5.9, 7.2, 7.21, 8.8, 9.5, 10.4, 11.6, 12.0, 13.3]
TIMES += [14.1, 15.5, 16.2, 23.0]
VALUES = [0.25, -0.4, 0.1, 0.6, -0.55, -0.2, 0.5, 0.3, -0.6, 0.4, -0.1, 0.45, -0.5, 0.2, 0.6, -0.3]
VALUES += [0.1, -0.6, 0.5, -0.2]
QUAKE = iva.Recorded(TIMES, VALUES, kind="base_acceleration")
PUSH = iva.Recorded(TIMES, VALUES, kind="force")
HITS: list[Force] = [iva.Impulse(velocity=0.6), iva.Impulse(velocity=-0.7, time=6.3)]
# The first meets the absorber stuck and pushes it into the wall, the second pulls the wall away.
STUCK = [iva.Impulse(velocity=0.1, time=9.4), iva.Impulse(velocity=-0.2, time=15.5)]
# A frame and a tower in SI units; 0.1 s and 0.7 s a period.
BALL = iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0)
FRAME = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)
BOB = iva.Piva(mass=20.0, length=0.75, restitution=0.7, gap_mm=140.0)
TOWER = iva.Primary(mass=200.0, frequency_hz=1.4, damping=30.0)
SECONDS = [t * 0.016 for t in TIMES]
FRAME_FORCES: list[Force] = [
    iva.Recorded(SECONDS, VALUES, kind="base_acceleration", scale=9.80665),
    iva.Recorded(SECONDS, VALUES, kind="force_newtons", scale=40.0),
    iva.Harmonic(force=20.0, frequency_hz=9.0, phase=-0.4),
    iva.Harmonic(base_acceleration=3.0, frequency=50.0),
    iva.Impulse(impulse=0.3, time=0.11),
]
TOWER_FORCES: list[Force] = [
    iva.Recorded([t * 0.1 for t in TIMES], VALUES, kind="base_acceleration", scale=5.0),
    iva.Harmonic(force=500.0, frequency_hz=1.1),
    iva.Impulse(impulse=30.0, time=1.5),
]
ALL: list[Force] = [SHAKE, QUAKE, PUSH, *HITS]
SCENES = {
    "siva, harmonic base": Scene(SIVA, [SHAKE]),
    "piva, harmonic base": Scene(PIVA, [SHAKE]),
    "compound, harmonic base": Scene(COMPOUND, [SHAKE]),
    "small angles, harmonic base": Scene(SMALL, [SHAKE]),
    "spring, harmonic base": Scene(SPRUNG, [SHAKE]),
    "spring, small angles, impulses": Scene(replace(SMALL, spring_ratio=0.6), [*HITS]),
    "spring, sum": Scene(SPRUNG, ALL),
    "spring, plastic": Scene(
        replace(SPRUNG, clearance=0.6, restitution=0.0), [SHAKE], 27.5, stays=8
    ),
    "siva, recorded base": Scene(SIVA, [QUAKE]),
    "piva, recorded base": Scene(PIVA, [QUAKE]),
    "small angles, recorded base": Scene(SMALL, [QUAKE]),
    "siva, recorded force": Scene(replace(SIVA, clearance=1.0), [PUSH]),
    "piva, recorded force": Scene(PIVA, [PUSH]),
    "siva, impulses": Scene(SIVA, [*HITS]),
    "piva, impulses": Scene(PIVA, [*HITS]),
    "small angles, impulses": Scene(SMALL, [*HITS]),
    "siva, sum": Scene(SIVA, ALL),
    "siva, sum, overdamped": Scene(SIVA, ALL, primary=iva.Primary(damping_ratio=1.3)),
    "compound, sum": Scene(COMPOUND, ALL),
    "siva, SI": Scene(BALL, FRAME_FORCES, 0.5, primary=FRAME, start=iva.Start(displacement_mm=4.0)),
    "piva, SI": Scene(
        BOB, TOWER_FORCES, 4.0, primary=TOWER, start=iva.Start(displacement_mm=50.0, velocity=0.2)
    ),
    "siva, plastic": Scene(replace(SIVA, restitution=0.0), [SHAKE, *HITS, *STUCK], 21.0, stays=6),
    "piva, plastic": Scene(replace(PIVA, restitution=0.0), [SHAKE, *HITS], stays=6),
    "compound, plastic": Scene(replace(COMPOUND, restitution=0.0), [QUAKE], stays=6),
    "siva, chatter": Scene(replace(SIVA, clearance=0.2, restitution=0.4), ALL[:2], 20.0, stays=4),
    "compound, chatter": Scene(
        replace(COMPOUND, clearance=0.3, restitution=0.3), [SHAKE], 17.5, stays=2
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_run_is_the_motion_in_the_inertial_frame(name: str) -> None:
    scene = SCENES[name]
    instants = [scene.duration * k / 10 for k in range(1, 11)]
    expected = reference(scene, instants)
    of, z = expected.of, expected.z
    given: Any = {"start": scene.start, "force": scene.forces, "duration": scene.duration}
    floor = FLOOR * of.omega * of.d
    run = iva.simulate(scene.absorber, scene.primary, **given, chatter_floor=floor)
    assert run.impacts.height >= 5
    assert run.episodes.height == scene.stays
    energies = {"energy_work": of.mass * z[6], "energy_final": of.mass * of.energy(z)}
    assert deviation(run.impacts, expected.impacts, of.omega) < TOLERANCE
    assert deviation(run.at(instants), expected.states, of.omega) < TOLERANCE
    assert deviation(run.episodes, expected.episodes, of.omega) < TOLERANCE
    assert deviation(run.summary, [energies], of.omega) < TOLERANCE
