"""Chains with many absorbers, and stops on the ground, beside an integrator of their equations.

Events of the integrator are those of SciPy's DOP853 in absolute coordinates, with impacts by
momentum and restitution: nothing of it is the product's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

import iva

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Chain:
    """Unit masses in a row or a ring, on springs, each with a free mass in a gap."""

    stiffness: Array
    damping: Array
    mass: float
    clearance: float
    restitution: float

    @property
    def count(self) -> int:
        """Return the number of masses of the chain."""
        return len(self.stiffness)


def chain(count: int, *, cyclic: bool, ground: float, mass: float, gap: float) -> Chain:
    """Return a chain with springs of 1 between neighbours, and a little damping."""
    stiffness = ground * np.eye(count)
    for i in range(count if cyclic else count - 1):
        j = (i + 1) % count
        stiffness[np.ix_([i, j], [i, j])] += [[1.0, -1.0], [-1.0, 1.0]]
    return Chain(stiffness, 0.004 * stiffness, mass, gap, 0.8)


def integrated(of: Chain, v0: Array, events: int) -> list[tuple[float, int, int]]:
    """Return instant, absorber and wall of the first impacts from rest in place."""
    n, d, e, m = of.count, of.clearance, of.restitution, of.mass

    def rates(_: float, z: Array) -> Array:
        x, v, _places, speeds = z.reshape(4, n)
        return np.concatenate([v, -of.stiffness @ x - of.damping @ v, speeds, np.zeros(n)])

    def meets(k: int, wall: int) -> object:
        def left(_: float, z: Array) -> float:
            return float(d - wall * (z[2 * n + k] - z[k]))

        left.terminal, left.direction = True, -1.0  # type: ignore[attr-defined]
        return left

    walls = [(k, wall) for k in range(n) for wall in (1, -1)]
    all_walls = [meets(k, wall) for k, wall in walls]
    t, z = 0.0, np.concatenate([np.zeros(n), v0, np.zeros(n), v0])
    found: list[tuple[float, int, int]] = []
    while len(found) < events:
        way = solve_ivp(
            rates, (t, t + 200.0), z, "DOP853", rtol=1e-12, atol=1e-13, events=all_walls
        )
        [place] = [k for k, times in enumerate(way.t_events) if len(times)]
        t, z, (k, wall) = float(way.t[-1]), way.y[:, -1].copy(), walls[place]
        w = z[3 * n + k] - z[n + k]
        impulse = m / (1.0 + m) * (1.0 + e) * w
        z[n + k] += impulse
        z[3 * n + k] -= impulse / m
        z[2 * n + k] = z[k] + wall * d
        found.append((t, k, wall))
    return found


def simulated(of: Chain, v0: Array, duration: float) -> iva.Run:
    """Return the run of the product, by the modes of the chain."""
    squares, shapes = eigh(of.stiffness)
    # The free chain moves as a whole with a frequency of 0.
    frequencies = np.sqrt(np.where(squares > 1e-9, squares, 0.0))
    natural = int(np.argmax(frequencies > 0.0))
    names = [f"m{k}" for k in range(of.count)]
    structure = iva.Structure(
        frequencies=frequencies.tolist(),
        damping_ratios=(0.002 * frequencies).tolist(),
        points={name: row.tolist() for name, row in zip(names, shapes, strict=True)},
        absorber_at=names,
        natural_mode=natural + 1,
        start_velocities=(shapes.T @ v0).tolist(),
    )
    absorber = iva.Siva(mass=of.mass, clearance=of.clearance, restitution=of.restitution)
    return iva.simulate([absorber] * of.count, structure, start=iva.Start(), duration=duration)


@pytest.mark.parametrize(
    ("of", "events"),
    [
        # A cyclic chain of ten that vibro-impact absorbers localise, and a free one of twenty.
        (chain(10, cyclic=True, ground=0.3, mass=0.12, gap=0.35), 60),
        (chain(20, cyclic=False, ground=0.0, mass=0.2, gap=0.4), 60),
    ],
    ids=["cyclic-10", "free-20"],
)
def test_chains_of_many_absorbers(of: Chain, events: int) -> None:
    """Each of the first impacts is of the same absorber, on the same wall, at the same instant."""
    v0 = np.random.default_rng(11).normal(0.0, 0.5, of.count)
    expected = integrated(of, v0, events)
    run = simulated(of, v0, expected[-1][0] + 1.0)
    row = run.summary.row(0, named=True)
    assert row["outcome"] == "finished"
    assert abs(row["energy_residual"]) < 1e-12
    impacts = run.impacts.head(events)
    assert impacts["absorber"].to_list() == [k for _, k, _ in expected]
    assert impacts["wall"].to_list() == [wall for *_, wall in expected]
    times = np.array([t for t, *_ in expected])
    assert np.abs(impacts["time"].to_numpy() - times).max() < 1e-8


def test_sixty_four_units_share_a_mass() -> None:
    """Units in gaps all alike move as one mass."""
    structure = iva.Primary(damping_ratio=0.01)
    absorber = {"mass_ratio": 0.1, "clearance": 0.5, "restitution": 0.6}
    start = iva.Start(displacement=1.0)
    one = iva.simulate(iva.Siva(**absorber), structure, start=start, periods=4)
    many = iva.simulate(iva.Siva(**absorber, units=64), structure, start=start, periods=4)
    assert many.summary["impacts"].item() == 64 * one.summary["impacts"].item() > 0
    last = many.impacts.group_by("absorber", maintain_order=True).last()
    assert last.height == 64
    assert last["time"].to_numpy() == pytest.approx(one.impacts["time"][-1], abs=1e-11)


def test_an_oscillator_meets_a_stop_on_one_side() -> None:
    """The point comes back to its stop at d after 2π − 2 atan(v/d), and each impact leaves e v."""
    e, d, v = 0.9, 0.5, 3.0
    stop = iva.Stop(clearance=d, restitution=e, walls="plus")
    run = iva.simulate(stop, iva.Primary(), start=iva.Start(velocity=v), duration=40.0)
    speed, time = math.sqrt(v * v - d * d), math.asin(d / v)
    assert run.impacts.height > 6
    for row in run.impacts.iter_rows(named=True):
        assert row["time"] == pytest.approx(time, abs=1e-13)
        assert row["velocity_before"] == pytest.approx(speed, rel=1e-13)
        assert row["velocity_after"] == pytest.approx(-e * speed, rel=1e-13)
        assert row["absorber_velocity_before"] == pytest.approx(0.0, abs=1e-15)
        assert (row["displacement"], row["wall"]) == (pytest.approx(d, rel=1e-15), 1)
        speed *= e
        time += 2.0 * math.pi - 2.0 * math.atan(speed / d)
    summary = run.summary.row(0, named=True)
    lost = 0.5 * (v * v - d * d) * (1.0 - e ** (2 * run.impacts.height))
    assert summary["energy_impacts"] == pytest.approx(lost, rel=1e-13)
    assert summary["energy_residual"] == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize("omega", [2.2, 2.4, 2.6])
def test_the_impact_oscillator_settles_on_its_closed_form(omega: float) -> None:
    """One impact a cycle of x″ + x = cos ωt at a stop in the place of rest, by Shaw and Holmes."""
    e, period = 0.8, 2.0 * math.pi / omega
    stop = iva.Stop(clearance=1.0, gap_offset=-1.0, restitution=e, walls="plus")
    start = iva.Start(displacement=-0.1, velocity=0.5)
    force = iva.Harmonic(amplitude=1.0, frequency=omega)
    run = iva.simulate(stop, iva.Primary(), start=start, force=force, cycles=1500)
    last = run.impacts.tail(3)
    assert np.diff(last["time"].to_numpy()) == pytest.approx(period, rel=1e-12)
    # x = (σ − γ cos φ) cos t + V sin t + γ cos(ωt + φ) comes back to σ = 0 after a cycle with its
    # velocity over −e.
    gamma, tau = 1.0 / (1.0 - omega**2), math.tan(0.5 * period)
    phi = math.atan(-tau * (1.0 - e) / (omega * (1.0 + e)))
    speed = abs(gamma * (math.cos(phi) * tau + omega * math.sin(phi))) / e
    assert last["velocity_before"].to_numpy() == pytest.approx(speed, rel=1e-12)


def test_a_ball_settles_on_a_table_that_moves_as_told() -> None:
    """One bounce a cycle comes down with g T / (1 + e), however the motion of the table is told."""
    e, hertz, g = 0.8, 25.0, 9.80665
    omega = 2.0 * math.pi * hertz
    table = iva.Structure(
        frequencies_hz=[1.0], points={"table": [0.0]}, base=[0.0], absorber_at="table"
    )
    ball = iva.Siva(mass=0.01, clearance=0.02, restitution=e, inclination_deg=90, walls="minus")
    x = 0.8 * g / omega**2
    told = [
        iva.Harmonic(base_displacement=x, frequency_hz=hertz, phase=-0.5 * math.pi),
        iva.Harmonic(base_displacement_mm=1000.0 * x, frequency_hz=hertz, phase=-0.5 * math.pi),
        iva.Harmonic(base_velocity=x * omega, frequency_hz=hertz),
        iva.Harmonic(base_acceleration=x * omega**2, frequency_hz=hertz, phase=0.5 * math.pi),
    ]
    start = iva.Start(gap_velocity=0.5 * g / hertz)
    for force in told:
        run = iva.simulate(ball, table, start=start, force=force, duration=20.0)
        assert set(run.impacts["wall"]) == {-1}
        down = run.impacts["approach_velocity"].abs().tail(3).to_numpy()
        assert down == pytest.approx(g / hertz / (1.0 + e), rel=1e-10)


def test_a_stop_beside_an_absorber_on_modes() -> None:
    """What a study says, Python says; the ledger closes, and twice the precision agrees."""
    structure = iva.Structure(
        frequencies=[10.0, 27.0],
        damping_ratios=0.01,
        points={"tip": [0.4, 0.3], "root": [0.2, -0.35]},
        absorber_at=["root", "tip"],
        start_velocities=[0.3, 0.1],
    )
    stop = iva.Stop(clearance_mm=4.0, gap_offset_mm=1.0, restitution=0.7)
    mass = iva.Siva(mass=0.4, clearance_mm=3.0, restitution=0.6)
    run = iva.simulate([stop, mass], structure, start=iva.Start(), duration=3.0, verify=True)
    assert run.verification.findings["rows"].equals(run.verification.findings["alike"])
    struck = run.impacts.filter(pl.col("absorber") == 0)
    assert struck.height > 4
    assert set(struck["displacement"].abs().round(12)) <= {0.005, 0.003}
    assert abs(run.summary["energy_residual"].item()) < 1e-15
    assert "Stop(" in repr(run)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: iva.Stop(clearance=1.0, restitution=0.5, walls="left"), ["walls", "both"]),
        (
            lambda: iva.simulate(
                iva.Stop(clearance=0.5, restitution=0.5),
                iva.Primary(),
                start=iva.Start(displacement=1.0),
                duration=1.0,
            ),
            ["start.displacement", "0.5"],
        ),
    ],
)
def test_a_sentence_says_what_is_wrong(make: object, words: list[str]) -> None:
    """Field, value and what to do."""
    with pytest.raises((ValueError, TypeError)) as caught:
        make()  # type: ignore[operator]
    for word in words:
        assert word in str(caught.value)
