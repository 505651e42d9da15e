"""A structure with free masses and pendulums, integrated by SciPy's DOP853.

The coordinates are x, and y of a free mass or the angle of a pendulum; Lagrange's equations with
their mass matrix are solved at every step. The program that is tested uses y = b sin θ, b θ' and
cos θ, and no matrix.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

import iva


@dataclass(frozen=True)
class Rider:
    """A free mass, or a pendulum of a length; gap displacement and velocity at the start."""

    mu: float
    e: float
    d: float
    y: float
    w: float
    length: float | None = None
    r: float = 0.0
    kappa: float = 1.0
    contact: float = 1.0
    pivot: float = 0.0
    spring: float = 0.0

    @property
    def b(self) -> float:
        """The distance from the pivot to the point of contact."""
        return (self.length or 1.0) * self.contact

    def begin(self) -> list[float]:
        """Coordinate and its rate at the start."""
        if self.length is None:
            return [self.y, self.w]
        angle = float(np.arcsin(self.y / self.b))
        return [angle, self.w / (self.b * np.cos(angle))]

    def gap(self, q: float, rate: float) -> tuple[float, float]:
        """Gap displacement and velocity."""
        if self.length is None:
            return q, rate
        return self.b * float(np.sin(q)), self.b * float(np.cos(q)) * rate

    def at_wall(self, wall: int) -> float:
        """Return the coordinate at a wall."""
        return wall * (self.d if self.length is None else float(np.arcsin(self.d / self.b)))

    def inertia(self, q: float) -> tuple[float, float]:
        """How the coordinate couples to x, and its own inertia, over the mass."""
        if self.length is None:
            return 1.0, 1.0
        return self.length * float(np.cos(q)), self.kappa * self.length**2

    def forces(self, q: float, rate: float) -> tuple[float, float]:
        """Return what acts on the coordinate, and the centrifugal force on the structure."""
        if self.length is None:
            return 0.0, 0.0
        own = self.kappa * self.length**2
        pull = own * self.r**2 * np.sin(q) + own * self.spring**2 * q
        damped = own * 2 * self.pivot * self.r * rate
        return -self.mu * float(pull + damped), self.mu * self.length * float(np.sin(q)) * rate**2

    def absorber(self) -> iva.Siva | iva.Piva:
        """Return the absorber of a run."""
        common: dict[str, Any] = {
            "mass_ratio": self.mu,
            "restitution": self.e,
            "clearance": self.d,
        }
        if self.length is None:
            return iva.Siva(**common)
        return iva.Piva(
            **common,
            frequency_ratio=self.r,
            length=self.length,
            inertia_ratio=self.kappa,
            contact_distance=self.b,
            pivot_damping_ratio=self.pivot,
            spring_ratio=self.spring,
        )


class Hit(NamedTuple):
    """An impact."""

    time: float
    absorber: int
    wall: int
    velocity_before: float
    velocity_after: float
    gap_before: float
    gap_after: float


class Ride(NamedTuple):
    """A stick episode."""

    absorber: int
    wall: int
    stick: float
    release: float


@dataclass(frozen=True)
class Scene:
    """A scene of riders in natural units, in decay or under a harmonic force or on a base."""

    riders: tuple[Rider, ...]
    zeta: float
    x: float
    v: float
    duration: float
    harmonic: tuple[float, float, float] | None = None
    base: bool = False

    def run(self) -> iva.Run:
        """Return the run of the scene."""
        drive: dict[str, Any] = {}
        if self.harmonic is not None:
            a, omega, phase = self.harmonic
            name = "base_acceleration" if self.base else "amplitude"
            drive["force"] = iva.Harmonic(**{name: a}, frequency=omega, phase=phase)
        start = iva.Start(
            displacement=self.x,
            velocity=self.v,
            gap_displacement=[rider.y for rider in self.riders],
            gap_velocity=[rider.w for rider in self.riders],
        )
        primary = iva.Primary(damping_ratio=self.zeta)
        absorbers = [rider.absorber() for rider in self.riders]
        return iva.simulate(absorbers, primary, start=start, duration=self.duration, **drive)


class Motion:
    """The motion of a scene up to a number of impacts; the structure with those stuck to it."""

    def __init__(self, scene: Scene, impacts: int) -> None:
        self.scene = scene
        self.stuck: dict[int, tuple[int, float]] = {}
        self.hits: list[Hit] = []
        self.rides: list[Ride] = []
        begun = [rider.begin() for rider in scene.riders]
        self.q = np.array([scene.x, *(q for q, _ in begun)])
        self.u = np.array([scene.v, *(rate for _, rate in begun)])
        self.time = 0.0
        while self.time < scene.duration and len(self.hits) < impacts:
            self.advance()

    def matrix(self, q: np.ndarray) -> np.ndarray:
        """Return the mass matrix, over the primary mass."""
        riders = self.scene.riders
        mass = np.zeros((1 + len(riders),) * 2)
        mass[0, 0] = 1.0 + sum(rider.mu for rider in riders)
        for k, rider in enumerate(riders, 1):
            coupled, own = rider.inertia(q[k])
            mass[0, k] = mass[k, 0] = rider.mu * coupled
            mass[k, k] = rider.mu * own
        return mass

    def accelerations(self, time: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Of all coordinates; 0 of those that are stuck."""
        scene = self.scene
        mass = self.matrix(q)
        push = np.zeros(len(q))
        push[0] = -q[0] - 2 * scene.zeta * u[0]
        for k, rider in enumerate(scene.riders, 1):
            own, centrifugal = rider.forces(q[k], u[k])
            push[k] += own
            push[0] += centrifugal
        if scene.harmonic is not None:
            a, omega, phase = scene.harmonic
            drive = a * np.cos(omega * time + phase)
            if scene.base:
                push -= mass[:, 0] * drive
            else:
                push[0] += drive
        free = [k for k in range(len(q)) if k - 1 not in self.stuck]
        found = np.zeros(len(q))
        found[free] = np.linalg.solve(mass[np.ix_(free, free)], push[free])
        self.reactions = mass @ found - push
        return found

    def pressure(self, time: float, y: np.ndarray, k: int) -> float:
        """Return the force of its wall on one that is stuck, positive while it presses."""
        q, u = np.split(y, 2)
        self.accelerations(time, q, u)
        return -float(self.reactions[k + 1]) * self.stuck[k][0]

    def advance(self) -> None:
        """Go on to the next event."""
        riders = self.scene.riders

        def rates(time: float, y: np.ndarray) -> np.ndarray:
            q, u = np.split(y, 2)
            return np.concatenate([u, self.accelerations(time, q, u)])

        events: list[Any] = []
        what: list[tuple[int, int]] = []
        for k, rider in enumerate(riders):
            if k in self.stuck:
                events.append(lambda time, y, k=k: self.pressure(time, y, k))
                what.append((k, 0))
                continue
            for wall in (1, -1):
                place = rider.at_wall(wall)
                events.append(lambda _, y, k=k, s=wall, to=place: s * (y[k + 1] - to))
                what.append((k, wall))
        for event, (_, wall) in zip(events, what, strict=True):
            event.terminal, event.direction = True, 1 if wall else -1
        y = np.concatenate([self.q, self.u])
        span = (self.time, self.scene.duration)
        step = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14, "max_step": 0.05}
        found = solve_ivp(rates, span, y, events=events, **step)
        self.time = float(found.t[-1])
        self.q, self.u = np.split(found.y[:, -1], 2)
        ended = [one for one, times in zip(what, found.t_events, strict=True) if len(times)]
        for k, wall in ended:
            if wall == 0:
                self.release(k)
            else:
                self.strike(k, wall)

    def release(self, k: int) -> None:
        """Let one go."""
        wall, stick = self.stuck.pop(k)
        self.rides.append(Ride(k, wall, stick, self.time))

    def strike(self, k: int, wall: int) -> None:
        """Apply an impact; a plastic one sticks."""
        rider = self.scene.riders[k]
        self.q[k + 1] = rider.at_wall(wall)
        mass, before = self.matrix(self.q), self.u.copy()
        while True:
            free = [j for j in range(len(self.q)) if j - 1 not in self.stuck]
            inverse = np.linalg.inv(mass[np.ix_(free, free)])
            place = free.index(k + 1)
            change = inverse[:, place] * (-(1 + rider.e) * before[k + 1] / inverse[place, place])
            after = before.copy()
            after[free] += change
            impulses = mass @ (after - before)
            pulled = [j for j, (s, _) in self.stuck.items() if s * impulses[j + 1] > 0]
            if not pulled:
                break
            for j in pulled:
                self.release(j)
        self.u = after
        w, w_after = (rider.gap(self.q[k + 1], u[k + 1])[1] for u in (before, after))
        self.hits.append(Hit(self.time, k, wall, before[0], after[0], w, w_after))
        if rider.e == 0.0:
            self.u[k + 1] = 0.0
            self.stuck[k] = (wall, self.time)
            y = np.concatenate([self.q, self.u])
            if self.pressure(self.time, y, k) <= 0:
                del self.stuck[k]


def alike(a: list[Hit], b: list[Hit]) -> int:
    """How many impacts of two runs, from the first on, are of the same absorbers and walls."""
    pairs = itertools.takewhile(lambda pair: pair[0][1:3] == pair[1][1:3], zip(a, b, strict=False))
    return sum(1 for _ in pairs)
