"""Several free masses on one structure, integrated without iva.

One system of the first order by SciPy's DOP853, in natural units: x and ẋ of the structure, and of
each mass the gap displacement from a stop of its own, so that a short flight keeps its digits. With
f/M of a force and a_g of the base, and μ_S the masses that ride on a stop,

    F = f − 2ζẋ − x       A = F/(1 + μ_S)       ẍ = A − a_g       ÿ = −A in flight, 0 on a stop

A mass on the stop s = ±1 is pressed while s F < 0. Contacts are looked for in samples of the dense
output, extrema between two samples included, and found by Brent's method.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

import iva

Values = NDArray[np.float64]

#: Steps this short have a dense output right to some 1e-15 where frequencies are below 2.
STEP = 0.05
SAMPLES = 6
#: A pressed mass that rebounds slower than this stays on its stop.
FLOOR = 1e-9
#: Contacts of two masses nearer than this in place are at one instant.
AT_ONCE = 1e-13
#: A mass as near as this to a stop and slower than the floor is at the end of its chatter.
AT_REST = 1e-16


@dataclass(frozen=True)
class Mass:
    """A mass, its stops and its start; `e_minus` is the restitution at the stop −1."""

    mu: float
    e: float
    d: float
    y: float = 0.0
    w: float = 0.0
    offset: float = 0.0
    e_minus: float | None = None

    def stop(self, wall: int) -> float:
        """Return where a stop is."""
        return self.offset + wall * self.d

    def restitution(self, wall: int) -> float:
        """Return that of a stop."""
        return self.e if wall > 0 or self.e_minus is None else self.e_minus

    def rests(self) -> bool:
        """Tell whether it begins at rest on a stop."""
        return self.w == 0.0 and self.y in (self.stop(1), self.stop(-1))

    def absorber(self) -> iva.Siva:
        """Return it as iva has it."""
        given: dict[str, float] = {"mass_ratio": self.mu, "restitution": self.e}
        if self.offset:
            given["gap_offset"] = self.offset
        if self.e_minus is not None:
            given["restitution_minus"] = self.e_minus
        return iva.Siva(**given, clearance=self.d)


@dataclass(frozen=True)
class Row:
    """A scene: masses, damping, start, length, and (amplitude, Ω, phase) of what drives it."""

    masses: tuple[Mass, ...]
    zeta: float = 0.0
    x: float = 1.0
    v: float = 0.0
    duration: float = 20.0
    harmonic: tuple[float, float, float] | None = None
    base: bool = False

    def start(self) -> iva.Start:
        """Return its start as iva has it."""
        places: Any = [mass.y for mass in self.masses]
        rates: Any = [mass.w for mass in self.masses]
        if len(self.masses) == 1:  # a list is of several
            places, rates = places[0], rates[0]
        return iva.Start(
            displacement=self.x, velocity=self.v, gap_displacement=places, gap_velocity=rates
        )

    def force(self) -> iva.Harmonic | None:
        """Return what drives it as iva has it."""
        if self.harmonic is None:
            return None
        name = "base_acceleration" if self.base else "amplitude"
        size, omega, phase = self.harmonic
        return iva.Harmonic(**{name: size}, frequency=omega, phase=phase)

    def run(self, **more: Any) -> iva.Run:
        """Run it in iva."""
        given: dict[str, Any] = {
            "start": self.start(),
            "force": self.force(),
            "duration": self.duration,
        }
        absorbers: Any = [mass.absorber() for mass in self.masses]
        return iva.simulate(absorbers, iva.Primary(damping_ratio=self.zeta), **(given | more))

    def shifted(self, size: float, seed: int) -> Row:
        """Return it with the numbers of the start changed by at most `size`, but for riders."""
        random = np.random.default_rng(seed)

        def moved(value: float) -> float:
            return float(value + size * random.uniform(-1.0, 1.0))

        masses = tuple(
            mass if mass.rests() else replace(mass, y=moved(mass.y), w=moved(mass.w))
            for mass in self.masses
        )
        return replace(self, masses=masses, x=moved(self.x), v=moved(self.v))


class Hit(NamedTuple):
    """An impact; velocities of the structure, and of the gap, before and after."""

    time: float
    absorber: int
    wall: int
    x: float
    before: float
    after: float
    gap_before: float
    gap_after: float


@dataclass
class Ride:
    """What a mass does on a stop, from `stick` to `release`, which is infinite until it is over.

    Where others are on the stops of that side, `stick` is right to `doubt`: each impact of a mass
    in chatter takes their stops away from those that ride.
    """

    absorber: int
    wall: int
    stick: float
    release: float = math.inf
    doubt: float = 0.0


class Motion:
    """The integration of a row, up to so many impacts faster than `listed`.

    Attributes
    ----------
    hits : list of Hit
        All impacts, in their order, those at one instant by the number of the mass.
    rides : list of Ride
        What rode on a stop, in the order of the sticks.
    """

    def __init__(self, row: Row, impacts: int = 10**6, listed: float = 0.0) -> None:
        self.row = row
        self.hits: list[Hit] = []
        self.rides: list[Ride] = []
        self.time = 0.0
        places = [(mass.y, mass.w) for mass in row.masses]
        self.state = np.array([row.x, row.v, *np.ravel(places)])
        self.origins = [0.0] * len(row.masses)
        self.stuck = [0] * len(row.masses)
        self._begin_on_stops()
        while self.time < row.duration:
            if sum(abs(hit.gap_before) > listed for hit in self.hits) >= impacts:
                break
            if self._fly():
                self._meet()

    @property
    def gaps(self) -> Values:
        """The gap displacements where it is."""
        places: Values = np.array(self.origins) + self.state[2::2]
        return places

    def load(self, time: float) -> tuple[float, float]:
        """Return f/M and a_g."""
        if self.row.harmonic is None:
            return 0.0, 0.0
        size, omega, phase = self.row.harmonic
        value = size * math.cos(omega * time + phase)
        return (0.0, value) if self.row.base else (value, 0.0)

    def pull(self, time: float, state: Values) -> float:
        """Return F, which presses masses onto stops of the other sign."""
        return float(self.load(time)[0] - 2.0 * self.row.zeta * state[1] - state[0])

    def carried(self) -> float:
        """Return the masses that ride."""
        pairs = zip(self.row.masses, self.stuck, strict=True)
        return sum(mass.mu for mass, wall in pairs if wall)

    def _slope(self, time: float, state: Values) -> Values:
        a = self.pull(time, state) / (1.0 + self.carried())
        out = np.empty_like(state)
        out[0], out[1] = state[1], a - self.load(time)[1]
        for k, wall in enumerate(self.stuck):
            out[2 + 2 * k : 4 + 2 * k] = (0.0, 0.0) if wall else (state[3 + 2 * k], -a)
        return out

    def _begin_on_stops(self) -> None:
        pull = self.pull(0.0, self.state)
        for k, mass in enumerate(self.row.masses):
            for wall in (1, -1):
                if mass.rests() and mass.y == mass.stop(wall) and wall * pull < 0.0:
                    self._stick(k, wall, 0.0)

    def _stick(self, k: int, wall: int, time: float, doubt: float = 0.0) -> None:
        self.stuck[k] = wall
        self._put_on(k, wall, 0.0)
        self.rides.append(Ride(k, wall, time, doubt=doubt))

    def _put_on(self, k: int, wall: int, w: float) -> None:
        """Put a mass on a stop, which becomes the origin of its gap displacement."""
        self.origins[k] = self.row.masses[k].stop(wall)
        self.state[2 + 2 * k : 4 + 2 * k] = 0.0, w

    def _room(self, k: int, wall: int) -> float:
        """Return how far a mass is from a stop."""
        stop = self.row.masses[k].stop(wall)
        return float(wall * (stop - self.origins[k] - self.state[2 + 2 * k]))

    def _release(self) -> None:
        for ride in self.rides:
            if math.isinf(ride.release):
                ride.release = self.time
        self.stuck = [0] * len(self.stuck)

    def _fly(self) -> bool:
        """Go on to the next contact or release, or to the end; tell whether there was a contact."""
        how = {"rtol": 1e-12, "atol": 1e-15, "max_step": STEP}
        solver = DOP853(self._slope, self.time, self.state, self.row.duration, **how)
        while solver.status == "running":
            solver.step()
            path = solver.dense_output()
            contact = self._first_contact(path, solver.t_old, solver.t)
            release = self._first_release(path, solver.t_old, solver.t)
            at = min(contact, release)
            if math.isfinite(at):
                self.time, self.state = at, path(at)
                if release < contact:
                    self._release()
                return contact <= release
        assert solver.status == "finished"
        self.time, self.state = solver.t, solver.y
        return False

    def _first_release(self, path: Any, begin: float, end: float) -> float:
        wall = max(self.stuck, key=abs)
        if not wall:
            return math.inf

        def pressed(time: float) -> float:
            return wall * self.pull(time, path(time))

        # All that ride are on the same side, pressed by the same F.
        grid = np.linspace(begin, end, SAMPLES)
        for left, right in itertools.pairwise(grid):
            if pressed(left) < 0.0 <= pressed(right):
                return rooted(pressed, left, right)
        return math.inf

    def _first_contact(self, path: Any, begin: float, end: float) -> float:
        grid = np.linspace(begin, end, SAMPLES)
        states = path(grid)
        first = math.inf
        for k, mass in enumerate(self.row.masses):
            if self.stuck[k]:
                continue
            for wall in (1, -1):
                to_stop = mass.stop(wall) - self.origins[k]
                rooms = wall * (to_stop - states[2 + 2 * k])
                rates = -wall * states[3 + 2 * k]

                def room(time: float, k: int = k, s: int = wall, c: float = to_stop) -> float:
                    return float(s * (c - path(time)[2 + 2 * k]))

                def rate(time: float, k: int = k, s: int = wall) -> float:
                    return float(-s * path(time)[3 + 2 * k])

                first = min(first, first_zero(room, rate, grid, rooms, rates))
        return first

    def _meet(self) -> None:
        """Let all masses that touch a stop rebound at once, and see who rides."""
        row, state = self.row, self.state
        hitting: dict[int, int] = {}
        for k in range(len(row.masses)):
            for wall in (1, -1) if not self.stuck[k] else ():
                # One that has just left has not come back: it would be found by a root.
                if self._room(k, wall) <= AT_ONCE and wall * state[3 + 2 * k] > 0.0:
                    hitting[k] = wall
        assert hitting, f"a grazing at {self.time}"
        approach = {k: float(state[3 + 2 * k]) for k in hitting}
        factors = {k: row.masses[k].restitution(wall) for k, wall in hitting.items()}
        push = sum(row.masses[k].mu * (1.0 + factors[k]) * approach[k] for k in hitting)
        # Stops that are pushed against what rides on them carry it along.
        kept = [k for k, wall in enumerate(self.stuck) if wall and wall * push <= 0.0]
        change = push / (1.0 + sum(row.masses[k].mu for k in (*hitting, *kept)))
        x, before = float(state[0]), float(state[1])
        state[1] += change
        for k in range(len(row.masses)):
            if k in hitting:
                self._put_on(k, hitting[k], -factors[k] * approach[k])
            elif k not in kept:
                state[3 + 2 * k] -= change
                if self.stuck[k]:
                    self._leave(k)
        for k in sorted(hitting):
            told = (before, before + change, approach[k], -factors[k] * approach[k])
            self.hits.append(Hit(self.time, k, hitting[k], x, *told))
        self._settle()

    def _leave(self, k: int) -> None:
        ride = next(ride for ride in self.rides if ride.absorber == k and math.isinf(ride.release))
        ride.release = self.time
        self.stuck[k] = 0

    def _settle(self) -> None:
        """Let go what is pressed no more, and end the chatter of pressed masses that are slow."""
        row, pull = self.row, self.pull(self.time, self.state)
        for k, wall in enumerate(self.stuck):
            if wall and wall * pull >= 0.0:
                self._leave(k)
        wall = -1 if pull > 0.0 else 1
        near = [k for k in range(len(row.masses)) if self._room(k, wall) < AT_REST]
        for k in near:
            mass, w = row.masses[k], float(self.state[3 + 2 * k])
            if self.stuck[k] or abs(w) > FLOOR:
                continue
            # Its last rebounds leave it their momentum, and take 2w/(a(1 − e)) if it is alone.
            carried = 1.0 + self.carried()
            rest = 2.0 * abs(w) * carried / abs(pull) / max(1.0 - mass.restitution(wall), 0.1)
            change = w * mass.mu / (carried + mass.mu)
            self.state[1] += change
            for other, on in enumerate(self.stuck):
                if other != k and not on:
                    self.state[3 + 2 * other] -= change
            self._stick(k, wall, self.time + rest, 0.0 if near == [k] else 50.0 * FLOOR / abs(pull))


def rooted(of: Callable[[float], float], left: float, right: float) -> float:
    """Return the root between two instants, to the last bits of the time."""
    return float(brentq(of, left, right, xtol=1e-18, rtol=8.9e-16))


def first_zero(
    room: Callable[[float], float],
    rate: Callable[[float], float],
    grid: Values,
    rooms: Values,
    rates: Values,
) -> float:
    """Return the first instant at which a room that is not negative ends, or infinity.

    `rooms` and `rates` are those at the samples `grid`. A room of 0 at the first sample with a rate
    above 0 is that of a mass which has just left: this root is divided out.
    """
    begin = float(grid[0])
    for i in range(len(grid) - 1):
        left, right = float(grid[i]), float(grid[i + 1])
        leaves = i == 0 and rooms[0] <= 0.0
        if leaves and rates[0] <= 0.0 and rooms[1] > 0.0:
            continue
        if rooms[i + 1] > 0.0:
            if leaves or not rates[i] < 0.0 < rates[i + 1]:
                continue
            # It comes nearer and goes away again: is there anything left at the nearest?
            right = rooted(rate, left, right)
            if room(right) > 0.0:
                continue
        if leaves:

            def divided(time: float) -> float:
                return room(time) / (time - begin) if time > begin else float(rates[0])

            return rooted(divided, left, right)
        return rooted(room, left, right)
    return math.inf


def alike(one: Sequence[Hit], other: Sequence[Hit]) -> int:
    """Return how many impacts, from the first on, are of the same mass at the same stop."""
    same = (a[1:3] == b[1:3] for a, b in zip(one, other, strict=False))
    return next((i for i, equal in enumerate(same) if not equal), min(len(one), len(other)))
