"""Design limits against an integration of the equations of motion, and against dense samples.

The integration (`Motion`) is that of SciPy, DOP853 with steps of at most 0.02 and the tolerance
1e-13, restarted at every impact and at every corner of a record; extrema are refined from samples
by `minimize_scalar`. Natural units. With A = ẍ + a_g the absolute acceleration of the structure

    free mass  A = f + μγ − 2ζẋ − x                              ẍ₁ + a_g = −γ
    pendulum   A (1 + μ − μ cos²θ/κ) = f − 2ζẋ − x + μL θ̇² sin θ + (μ/κ) g sin θ cos θ
                                       + 2 ζp ωp μ L θ̇ cos θ
               κL (θ̈ + 2ζpωp θ̇) = −A cos θ − g sin θ,  centre of mass A + L (θ̈ cos θ − θ̇² sin θ)

at small angles with cos θ = 1, sin θ = θ and no θ̇².
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import polars as pl
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

import iva

NAMED = ("acceleration_max", "gap_displacement_max", "stroke", "absorber_displacement_max")
EPS = 2.0**-52
MEASURES = ("approach_speed_max", "impulse_max", *NAMED, "amplitude_rms", "amplitude_max")


class Scene(NamedTuple):
    """A scene for both programs; forces as numbers: (amplitude, Ω, phase), or (times, values)."""

    mu: float
    e: float
    d: float
    zeta: float
    start: tuple[float, float, float, float]  # x, ẋ, y, w
    end: float
    harmonic: tuple[float, float, float] | None = None
    record: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    base: bool = False
    discard: float = 0.0
    gamma: float = 0.0
    r: float = 0.0  # ωp, and 0 of a free mass
    length: float = 1.0
    contact: float = 1.0
    kappa: float = 1.0
    pivot: float = 0.0
    small: bool = False

    def absorber(self) -> iva.Siva | iva.Piva:
        """Return it as iva has it."""
        given: Any = {"mass_ratio": self.mu, "restitution": self.e, "clearance": self.d}
        if self.r:
            given |= {"frequency_ratio": self.r, "length": self.length, "inertia_ratio": self.kappa}
            given |= {"contact_distance": self.contact, "pivot_damping_ratio": self.pivot}
            return iva.Piva(**given, angles="small" if self.small else "large")
        if self.gamma:
            given |= {"inclination_deg": 50.0}
            given |= {"gravity": self.gamma / math.sin(math.radians(50.0))}
        return iva.Siva(**given)

    def run(self, **more: Any) -> iva.Run:
        """Run it."""
        x, v, y, w = self.start
        start = iva.Start(displacement=x, velocity=v, gap_displacement=y, gap_velocity=w)
        force: Any = None
        if self.harmonic:
            name = "base_acceleration" if self.base else "amplitude"
            size, omega, phase = self.harmonic
            force = iva.Harmonic(**{name: size}, frequency=omega, phase=phase)
            more = {"discard": self.discard} | more
        elif self.record:
            force = iva.Recorded(*self.record, "base_acceleration" if self.base else "force")
        primary = iva.Primary(damping_ratio=self.zeta)
        given: Any = {"start": start, "force": force, "duration": self.end}
        return iva.simulate(self.absorber(), primary, **(given | {"measures": MEASURES} | more))

    def begin(self) -> float:
        """Return the begin of the window."""
        return 2.0 * math.pi * self.discard / self.harmonic[1] if self.harmonic else 0.0

    def load(self, t: Any) -> Any:
        """Return f/M or a_g."""
        if self.harmonic:
            size, omega, phase = self.harmonic
            return size * np.cos(omega * t + phase)
        return np.interp(t, *self.record, left=0.0, right=0.0) if self.record else 0.0 * t

    def accelerations(self, t: Any, s: Any) -> tuple[Any, Any, Any]:
        """Return those of structure and absorber, absolute, and that of θ (or x₁)."""
        x, v, q, u = s[:4]
        pull = -2.0 * self.zeta * v - x + (0.0 if self.base else self.load(t))
        if not self.r:
            weight = -self.gamma + 0.0 * t
            return pull + self.mu * self.gamma, weight, weight
        mu, kappa, length = self.mu, self.kappa, self.length
        g, friction = kappa * length * self.r**2, 2.0 * self.pivot * self.r
        sine, cosine = (q, 1.0) if self.small else (np.sin(q), np.cos(q))
        whirl = 0.0 if self.small else length * u**2 * sine
        pull = pull + mu * (whirl + g * sine * cosine / kappa + length * friction * u * cosine)
        a = pull / (1.0 + mu - mu * cosine**2 / kappa)
        turn = -(a * cosine + g * sine) / (kappa * length) - friction * u
        return a, a + length * turn * cosine - whirl, turn

    def gap(self, s: Any) -> tuple[Any, Any]:
        """Return y and w."""
        if not self.r:
            return s[2] - s[0], s[3] - s[1]
        if self.small:
            return self.contact * s[2], self.contact * s[3]
        return self.contact * np.sin(s[2]), self.contact * np.cos(s[2]) * s[3]

    def mass(self, s: Any) -> Any:
        """Return the displacement of the centre of mass of the absorber."""
        return s[0] + self.length / self.contact * self.gap(s)[0] if self.r else s[2]


class Motion(NamedTuple):
    """Flights (begin, end, state as a function) and impacts (time, w before, |Δẋ|)."""

    flights: list[tuple[float, float, Callable[[Any], Any]]]
    hits: list[tuple[float, float, float]]

    def extremes(self, of: Callable[[Any, Any], Any], begin: float) -> tuple[float, float]:
        """Return the least and the largest value from an instant on."""
        found = []
        for first, last, state in self.flights:
            if last <= begin:
                continue
            first, n = max(first, begin), 12 + int(60 * (last - first))
            grid = np.linspace(first, last, n)
            for sign in (1.0, -1.0):

                def turned(t: Any, sign: float = sign, state: Any = state) -> Any:
                    return sign * of(t, state(t))

                sampled = turned(grid)
                i = int(np.argmin(sampled))
                ends = (grid[max(i - 1, 0)], grid[min(i + 1, n - 1)])
                fine = minimize_scalar(turned, bounds=ends, options={"xatol": 1e-9})
                found.append(sign * min(float(fine.fun), float(sampled[i])))
        return min(found), max(found)


@cache
def motion(scene: Scene) -> Motion:
    """Integrate a scene."""
    x, v, y, w = scene.start
    s = np.array([x, v, x + y, v + w, 0.0])
    if scene.r:
        theta = y / scene.contact if scene.small else math.asin(y / scene.contact)
        s[2:4] = theta, w / (scene.contact * (1.0 if scene.small else math.cos(theta)))
    window = scene.begin()
    corners = scene.record[0] if scene.record else ()
    stops = sorted({t for t in (*corners, window, scene.end) if 0.0 < t <= scene.end})
    flights, hits, t = list[Any](), list[Any](), 0.0

    def flow(t: float, s: Any) -> list[float]:
        a, _, turn = scene.accelerations(t, s)
        ground = scene.load(t) if scene.base else 0.0
        second = turn if scene.r else turn - ground
        return [s[1], a - ground, s[3], second, s[0] ** 2 if t >= window else 0.0]

    def room(_t: float, s: Any) -> float:
        return float(scene.d - abs(scene.gap(s)[0]))

    room.terminal, room.direction = True, -1.0  # type: ignore[attr-defined]
    for stop in stops:
        while t < stop:
            given: Any = {"rtol": 1e-13, "atol": 1e-15, "max_step": 0.02, "dense_output": True}
            solved = solve_ivp(flow, (t, stop), s, "DOP853", events=room, **given)
            flights.append((t, float(solved.t[-1]), solved.sol))
            t, s = float(solved.t[-1]), solved.y[:, -1].copy()
            if solved.status == 1:
                _, w = scene.gap(s)
                share = scene.length / scene.contact if scene.r else 1.0
                change = share * scene.mu * (1.0 + scene.e) / (1.0 + scene.mu) * w
                s[1] += change
                s[3] = -scene.e * s[3] if scene.r else s[1] - scene.e * w
                hits.append((t, w, abs(change)))
                assert len(hits) == 1 or t - hits[-2][0] > 0.03, "a rebound between two steps"
    flights.append((t, t, lambda at, s=s: np.multiply.outer(s, np.ones_like(at))))
    return Motion(flights, hits)


QUAKE = ((0.5, 2.0, 3.0, 5.5, 7.0, 9.0), (0.4, 1.2, -0.9, 0.7, -1.1, 0.3))
SCENES: dict[str, Scene] = {
    "decay": Scene(0.12, 0.8, 0.5, 0.03, (1.5, 0.4, 0.2, -0.1), 16.0),
    "force": Scene(0.05, 0.8, 1.0, 0.05, (0.2, 0, 0, 0), 30.0, (0.2, 0.95, 0.3), discard=2.0),
    "base": Scene(0.1, 0.7, 1.2, 0.1, (0.5, 0, 0.3, 0), 22.0, (0.5, 1.2, 1.0), base=True),
    "push": Scene(0.1, 0.75, 0.7, 0.04, (0.05, 0, 0, 0), 14.0, record=QUAKE),
    "quake": Scene(0.1, 0.75, 0.9, 0.04, (0.1, 0.2, 0.1, 0), 12.0, record=QUAKE, base=True),
    "upright": Scene(0.1, 0.8, 1.5, 0.05, (1.0, 0, 0.2, 0), 7.5, (0.5, 0.9, 0), gamma=0.4),
    "one wall": Scene(0.08, 0.9, 3.0, 0.06, (1.0, 0.9, 2.0, 0.4), 5.4),
    "no wall": Scene(0.08, 0.9, 9.0, 0.02, (1.0, 0.9, 2.0, -0.85), 16.0),
    "pendulum": Scene(
        0.12, 0.7, 0.9, 0.02, (1.0, 0.3, 0.2, 0.1), 18.0, r=0.6, length=1.6, contact=1.6
    ),
    "compound": Scene(
        0.15, 0.7, 0.8, 0.03, (0.8, 0, 0.1, 0), 18.0, (0.3, 1.1, 0.5), base=True, discard=1.0,
        r=0.5, length=1.2, contact=1.5, kappa=1.3, pivot=0.05,
    ),
    "small": Scene(
        0.1, 0.8, 1.0, 0.03, (1.0, 0, 0.1, 0), 18.0, (0.25, 0.9, 0), r=0.7, length=1.3,
        contact=1.7, kappa=1.2, pivot=0.04, small=True,
    ),
    "hanging": Scene(
        0.1, 0.8, 1.9, 0.01, (0.4, 0, 0.1, 0), 25.0, record=QUAKE, r=0.9, length=2.0, contact=2.0
    ),
}  # fmt: skip
UNHIT = {"no wall", "hanging"}
HARD = (0.15, 0.4, 0.1)
#: Scenes with chatter and stick, which `Motion` does not integrate.
STICKING: dict[str, Scene] = {
    "chatter": Scene(*HARD, 0.05, (2.0, 0, 0, 0), 12.0),
    "plastic": Scene(0.15, 0.0, 0.3, 0.02, (2.0, 0, 0, 0), 20.0),
    "shaken": Scene(*HARD, 0.05, (0.0, 0, 0, 0), 25.0, (0.4, 0.9, 0.2), base=True, discard=1.0),
    "fallen": Scene(*HARD, 0.05, (2.0, 0, 0, 0), 18.0, (0.3, 1.1, 0.0), gamma=0.3),
    "quaking": Scene(0.15, 0.3, 0.2, 0.05, (0.0, 0, 0, 0), 15.0, record=QUAKE, base=True),
    "stuck pendulum": Scene(*HARD, 0.02, (1.5, 0, 0, 0), 12.0, r=0.3, length=2.0, contact=2.0),
}


@pytest.mark.parametrize("name", SCENES)
def test_extremes_are_those_of_an_integration(name: str) -> None:
    """By `Motion`: the errors of a step, some 1e-14, grow by a few digits over the impacts."""
    scene = SCENES[name]
    truth, run = motion(scene), scene.run()
    assert run.impacts.height == len(truth.hits)
    assert (name in UNHIT) == (not truth.hits)
    begin = scene.begin()

    def extremes(of: Callable[[Any, Any], Any]) -> tuple[float, float]:
        return truth.extremes(of, begin)

    gaps = extremes(lambda _t, s: scene.gap(s)[0])
    expected = {
        "approach_speed_max": max((abs(w) for _, w, _ in truth.hits), default=0.0),
        "impulse_max": max((change for _, _, change in truth.hits), default=0.0),
        "acceleration_max": max(map(abs, extremes(lambda t, s: scene.accelerations(t, s)[0]))),
        "gap_displacement_max": max(map(abs, gaps)),
        "stroke": gaps[1] - gaps[0],
        "absorber_displacement_max": max(map(abs, extremes(lambda _t, s: scene.mass(s)))),
    }
    if scene.harmonic or scene.record:
        mean = truth.flights[-1][2](scene.end)[4] / (scene.end - begin)
        expected["amplitude_rms"] = math.sqrt(mean)
    found = run.summary.select(*expected).row(0)
    assert found == pytest.approx(tuple(expected.values()), rel=1e-9)
    if name == "one wall":
        assert set(run.impacts["wall"]) == {1}
        assert expected["stroke"] < 2.0 * scene.d - 0.1


@pytest.mark.parametrize("name", SCENES)
def test_accelerations_are_those_of_an_integration(name: str) -> None:
    """By `Motion` at 300 instants; those of a flight, the one after an impact included."""
    scene = SCENES[name]
    truth, run = motion(scene), scene.run(measures=[])
    times = np.sort(np.random.default_rng(1).uniform(0.0, scene.end, 300))
    states = run.at(times)
    assert set(states["wall"]) == {0}
    found = states.select("acceleration", "absorber_acceleration").to_numpy()
    begins = [first for first, _, _ in truth.flights]
    for t, row in zip(times, found, strict=True):
        flight = truth.flights[int(np.searchsorted(begins, t, side="right")) - 1]
        expected = scene.accelerations(t, flight[2](t))[:2]
        assert row == pytest.approx(expected, rel=1e-9, abs=1e-10)


@pytest.mark.parametrize("name", [*SCENES, *STICKING])
def test_dense_samples_stay_below_and_come_close(name: str) -> None:
    """At 1e5 instants nothing is larger, and they come within 1e-6.

    Impacts are sampled before and after, corners of a record, where a force may jump, 1e-9 beside.
    """
    scene = (SCENES | STICKING)[name]
    run = scene.run()
    motion = run.trajectory(int(2e5 * math.pi / scene.end))
    beside = [t + shift for t in (scene.record or [()])[0] for shift in (-1e-9, 1e-9)]
    motion = pl.concat([motion, run.at(beside)]).filter(pl.col("time") >= scene.begin())
    assert run.episodes.height > 0 or name in SCENES
    x, y, a = (motion[of].to_numpy() for of in ("displacement", "gap_displacement", "acceleration"))
    share = scene.length / scene.contact if scene.r else 1.0
    sampled = (np.abs(a).max(), np.abs(y).max(), np.ptp(y), np.abs(x + share * y).max())
    for found, largest in zip(run.summary.select(NAMED).row(0), sampled, strict=True):
        assert largest <= found * (1.0 + 4 * EPS) + 4 * EPS
        assert found <= largest * (1.0 + 1e-6)
    hits = run.impacts
    row = run.summary.row(0, named=True)
    assert row["approach_speed_max"] == (hits["approach_velocity"].abs().max() or 0.0)
    # Velocities of the size of 1 are rounded before they are subtracted.
    changes = (hits["velocity_after"] - hits["velocity_before"]).abs().max() or 0.0
    assert row["impulse_max"] == pytest.approx(changes, rel=0, abs=8 * EPS)
