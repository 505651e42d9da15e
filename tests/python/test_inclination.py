"""A free mass whose line of motion is inclined: gravity pulls it to its lower stop.

Natural units, ωn = M = 1. With γ = g sin α along the motion, x from the rest position with the
absorber on its lower stop (y = −d), and a_g of the base, the motion is

    flight   ẍ + 2ζẋ + x = f + μγ − a_g     ẍ₁ = −γ − a_g
    stuck    (1+μ) ẍ + 2ζẋ + x = f − (1+μ) a_g, with the pressure p = ẍ + a_g + γ of the stop:
             it leaves the lower one where p falls to 0, the upper one where p rises to 0

and the energy (x² + ẋ²)/2 + μẋ₁²/2 + μγ (y + d). Expected numbers are closed forms of these lines,
or of an integration by them below.
"""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import polars as pl
import pytest
from scipy.optimize import brentq

import iva

REST = iva.Start(displacement=0.0)
PLAIN: dict[str, float] = {"mass_ratio": 0.1, "restitution": 0.6, "clearance": 0.5}


def siva(gamma: float, degrees: float = 90.0, **changes: float) -> iva.Siva:
    """Return an absorber that gravity accelerates by −gamma along its line."""
    given = {"mass_ratio": 0.1, "restitution": 0.5, "clearance": 1.0} | changes
    gravity = gamma / math.sin(math.radians(degrees))
    return iva.Siva(**given, inclination_deg=degrees, gravity=gravity)


def simulate(absorber: Any, start: iva.Start = REST, zeta: float = 0.0, **run: Any) -> iva.Run:
    return iva.simulate(absorber, iva.Primary(damping_ratio=zeta), start=start, **run)


def bits(frame: pl.DataFrame, names: list[str]) -> str:
    """Return all values such that equal texts are equal bits."""
    return repr([frame[name].to_list() for name in names])


def residual(run: iva.Run) -> float:
    """Return what is left of the ledger over its largest entry."""
    row = run.summary.row(0, named=True)
    parts = ("initial", "work", "impacts", "viscous", "final")
    return float(abs(row["energy_residual"]) / max(abs(row[f"energy_{part}"]) for part in parts))


@pytest.mark.parametrize("degrees", [0.0, 0.5, 30.0, 90.0])
def test_the_start_without_a_gap_is_the_rest_on_the_lower_stop(degrees: float) -> None:
    """By definition nothing moves and all energies are 0; a level absorber begins in the middle."""
    run = simulate(iva.Siva(**PLAIN, inclination_deg=degrees, gravity=0.8), zeta=0.01, periods=5)
    state = run.at([0.0, 1.0, 20.0])
    names = ("displacement", "velocity", "gap_displacement", "gap_velocity", "wall")
    expected = (0.0, 0.0, -0.5, 0.0, -1) if degrees else (0.0,) * 5
    assert state.select(names).rows() == [expected] * 3
    parts = ("initial", "work", "impacts", "viscous", "final", "residual")
    assert run.summary.select(f"energy_{part}" for part in parts).row(0) == (0.0,) * 6
    assert run.impacts.height == 0


@pytest.mark.parametrize("degrees", [30.0, 90.0])
@pytest.mark.parametrize("e", [0.3, 0.6, 0.9])
def test_a_light_ball_bounces_to_rest_on_the_lower_stop(degrees: float, e: float) -> None:
    """Parabolas on a structure that does not feel the ball (μ = 1e-18).

    From the height h it falls for t₁ = √(2h/γ) and meets the stop with √(2hγ); after bounce k it
    flies for 2 eᵏ t₁. The sum of all is t₁ (1+e)/(1−e).
    """
    gamma, height, mu = 0.7, 1.5, 1e-18
    absorber = siva(gamma, degrees, mass_ratio=mu, restitution=e, clearance=8.0)
    first = math.sqrt(2.0 * height / gamma)
    rest = first * (1.0 + e) / (1.0 - e)
    run = simulate(absorber, iva.Start(gap_displacement=height - 8.0), duration=1.2 * rest)
    times = [first * (1.0 + sum(2.0 * e**j for j in range(1, k))) for k in range(1, 9)]
    speeds = [-math.sqrt(2.0 * height * gamma) * e**k for k in range(8)]
    impacts = run.impacts
    assert set(impacts["wall"].to_list()) == {-1}
    assert impacts["time"][:8].to_list() == pytest.approx(times, rel=1e-13)
    assert impacts["approach_velocity"][:8].to_list() == pytest.approx(speeds, rel=1e-13)
    (episode,) = run.episodes.rows(named=True)
    assert (episode["wall"], episode["release_time"]) == (-1, None)
    assert (episode["start_time"], episode["impacts"]) == (impacts["time"][0], impacts.height)
    assert episode["stick_time"] == pytest.approx(rest, rel=1e-12)
    assert run.at([1.1 * rest])["gap_displacement"].item() == -8.0
    # The ball loses its height: μγh. Of the structure's motion, of the order of μ, nothing is seen.
    row = run.summary.row(0, named=True)
    assert row["energy_initial"] == pytest.approx(mu * gamma * height, rel=1e-14)
    assert row["energy_impacts"] == pytest.approx(mu * gamma * height, rel=1e-12)
    assert row["energy_final"] < 1e-12 * row["energy_initial"]


@pytest.mark.parametrize("kind", ["amplitude", "base_acceleration"])
@pytest.mark.parametrize("degrees", [30.0, 90.0])
def test_a_driven_rider_lifts_off(kind: str, degrees: float) -> None:
    """The steady state of a linear oscillator of the mass 1 + μ, with complex amplitudes.

    x = Re X e^(iΩt) with X (1 − (1+μ)Ω² + 2iζΩ) = F, or −(1+μ) A under a_g = A cos(Ωt + φ). The
    pressure is γ + Re P e^(iΩt) with P = −Ω²X (+ A). The phase φ makes P real and positive, the
    start leaves no transient: it falls to 0 at Ωt = arccos(−γ/P), or never if γ > P.
    """
    mu, zeta, omega, size = 0.1, 0.02, 0.8, 0.3
    base = size if kind == "base_acceleration" else 0.0
    load = -(1.0 + mu) * base if base else size
    steady = load / complex(1.0 - (1.0 + mu) * omega**2, 2.0 * zeta * omega)
    pressure = base - omega**2 * steady
    phase = -cmath.phase(pressure)
    steady *= cmath.exp(1j * phase)
    start = iva.Start(displacement=steady.real, velocity=(1j * omega * steady).real)
    given: Any = {"force": iva.Harmonic(**{kind: size}, frequency=omega, phase=phase), "cycles": 20}
    weak, strong = (
        simulate(siva(ratio * abs(pressure), degrees, mass_ratio=mu), start, zeta, **given)
        for ratio in (0.6, 1.001)
    )
    (episode,) = strong.episodes.select("wall", "start_time", "stick_time", "release_time").rows()
    assert episode == (-1, 0.0, 0.0, None)
    assert strong.impacts.height == 0
    assert strong.summary["time_stuck"].item() == pytest.approx(40.0 * math.pi / omega, rel=1e-14)
    moved = (steady * cmath.exp(100j * omega)).real
    assert strong.at([100.0])["displacement"].item() == pytest.approx(moved, rel=0, abs=1e-13)
    # dt = d(γ/P)/(0.8 Ω): the condition is about 1.
    lift = math.acos(-0.6) / omega
    assert (weak.episodes["wall"][0], weak.episodes["stick_time"][0]) == (-1, 0.0)
    assert weak.episodes["release_time"][0] == pytest.approx(lift, rel=1e-12)
    assert weak.impacts.height > 10
    assert max(residual(weak), residual(strong)) < 1e-12


@pytest.mark.parametrize("ratio", [1.00001, 0.99999, 0.7, 0.2])
@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_a_rider_of_a_free_decay_lifts_off(zeta: float, ratio: float) -> None:
    """The ride that begins at rest at x = −1: it lifts off where ẍ falls to −γ, if ever.

    With ω0² = 1/(1+μ), a = ζω0², ω² = ω0² − a²: ẍ = (ω0²/ω) e^(−at) (ω cos ωt − a sin ωt), which
    has its minimum where tan ωt = −2aω/(ω² − a²); without damping it is −1/(1+μ).
    """
    mu, square = 0.2, 1.0 / 1.2
    a = zeta * square
    omega = math.sqrt(square - a**2)

    def acceleration(t: float) -> float:
        return square / omega * (complex(omega, a) * cmath.exp(complex(-a, omega) * t)).real

    least = (math.pi - math.atan2(2.0 * a * omega, omega**2 - a**2)) / omega
    gamma = -ratio * acceleration(least)
    absorber = siva(gamma, mass_ratio=mu, clearance=3.0)
    run = simulate(absorber, iva.Start(displacement=-1.0), zeta, periods=3)
    episode = run.episodes.row(0, named=True)
    assert (episode["wall"], episode["stick_time"]) == (-1, 0.0)
    assert residual(run) < 1e-13
    if ratio > 1.0:
        assert (run.impacts.height, episode["release_time"]) == (0, None)
        return
    lift = brentq(lambda t: acceleration(t) + gamma, 0.0, least, xtol=1e-15)
    # Rounding of ẍ and γ, some 1e-16, over the slope of ẍ; near the minimum that is small.
    error = 1e-14 / math.sqrt(1.0 - ratio**2)
    assert episode["release_time"] == pytest.approx(lift, rel=0, abs=error)


@pytest.mark.parametrize("wall", [-1, 1])
def test_a_ride_on_either_stop_ends(wall: int) -> None:
    """Without damping x = ±cos(t/√(1+μ)) from rest; the pressure is 0 where ẍ = −γ.

    So the lower stop is left at cos = −(1+μ)γ in a ride from −1, the upper one at (1+μ)γ from +1:
    before, the structure pulls the absorber down faster than it falls.
    """
    mu, gamma = 0.25, 0.3
    start = iva.Start(displacement=wall, gap_displacement=wall)
    run = simulate(siva(gamma, 50.0, mass_ratio=mu), start, periods=1)
    episode = run.episodes.row(0, named=True)
    assert (episode["wall"], episode["stick_time"]) == (wall, 0.0)
    expected = math.sqrt(1.0 + mu) * math.acos(wall * (1.0 + mu) * gamma)
    assert episode["release_time"] == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(("x", "wall"), [(0.99, -1), (1.01, 0)])
def test_a_start_on_a_stop_that_falls_away_is_a_flight(x: float, wall: int) -> None:
    """At rest at x the pressure is γ − x/(1+μ): positive below x = (1+μ)γ = 1."""
    start = iva.Start(displacement=x, gap_displacement=-1.0)
    run = simulate(siva(0.8, mass_ratio=0.25), start, periods=0.05)
    assert run.episodes.height == abs(wall)
    assert run.at([0.1])["wall"].item() == wall


@pytest.mark.parametrize("degrees", [20.0, 90.0])
def test_energy_is_conserved_by_elastic_impacts(degrees: float) -> None:
    """The energy in the docstring of this file, 1/2 + 0.1·0.4·0.8 at the start, stays."""
    gamma, mu, d = 0.4, 0.1, 0.8
    absorber = siva(gamma, degrees, mass_ratio=mu, restitution=1.0, clearance=d)
    run = simulate(absorber, iva.Start(displacement=1.0, gap_displacement=0.0), periods=120)
    assert run.impacts.height > 200
    assert set(run.impacts["wall"].to_list()) == {-1, 1}
    initial = 0.5 + mu * gamma * d
    row = run.summary.row(0, named=True)
    assert row["energy_initial"] == pytest.approx(initial, rel=1e-15)
    assert row["energy_final"] == pytest.approx(initial, rel=1e-13)
    assert abs(row["energy_impacts"]) < 1e-13 * initial
    assert residual(run) < 1e-13
    states = run.at(np.linspace(0.0, 239.0 * math.pi, 777))
    names = ("displacement", "velocity", "gap_displacement", "gap_velocity")
    x, v, y, w = (states[name].to_numpy() for name in names)
    energy = 0.5 * (x**2 + v**2 + mu * (v + w) ** 2) + mu * gamma * (y + d)
    assert np.abs(energy / initial - 1.0).max() < 1e-13


FORCES = [None, iva.Harmonic(amplitude=0.1, relative_frequency=0.95), iva.Impulse(velocity=1.0)]


@pytest.mark.parametrize("force", FORCES)
@pytest.mark.parametrize("name", ["inclination", "inclination_deg"])
@pytest.mark.parametrize("gravity", [None, 9.81])
def test_a_level_line_is_that_of_a_free_mass(force: Any, name: str, gravity: float | None) -> None:
    """Contract: bit for bit a run without inclination, whatever the gravity."""
    tilts: Any = ({}, {name: 0.0, "gravity": gravity})
    given: Any = {"start": iva.Start(displacement=1.0), "force": force, "periods": 20}
    level, run = (simulate(iva.Siva(**PLAIN, **tilt), **given) for tilt in tilts)
    assert level.impacts.height > 10
    for table in ("impacts", "episodes", "summary"):
        have, want = getattr(run, table), getattr(level, table)
        # The column of gravity says what was given.
        names = [c for c in want.columns if c in have.columns and c != "gravity"]
        assert len(names) >= len(want.columns) - 1
        assert bits(have, names) == bits(want, names)


@pytest.mark.parametrize("amplitude", [0.0, 0.25])
@pytest.mark.parametrize("y", [-0.25, 0.5])
def test_gravity_is_a_constant_acceleration_of_the_base(amplitude: float, y: float) -> None:
    """A level absorber on a base with a_g = γ has the same equations for x − (1+μ)γ.

    All numbers are exact in binary, so that both scenes are the same to the bit; times differ by
    the errors that the two runs estimate (four standard deviations) and by rounding to a double.
    """
    gamma, mu = 0.5, 0.125
    shift = (1.0 + mu) * gamma
    forces = [iva.Harmonic(amplitude=amplitude, frequency=0.875, phase=0.25)] if amplitude else []
    base = iva.Recorded([0.0, 1000.0], [gamma, gamma], kind="base_acceleration")
    same: Any = {"mass_ratio": mu, "restitution": 0.75, "clearance": 0.5}
    given: Any = {"zeta": 0.03125, "duration": 30.0, "errors": True}
    start, shifted = (iva.Start(displacement=x, gap_displacement=y) for x in (1.25, 1.25 - shift))
    upright = iva.Siva(**same, inclination=math.pi / 2, gravity=gamma)
    run = simulate(upright, start, **given, force=forces)
    level = simulate(iva.Siva(**same), shifted, **given, force=[*forces, base])
    for table in ("impacts", "episodes"):
        walls = getattr(run, table)["wall"].to_list()
        assert walls == getattr(level, table)["wall"].to_list()
    known = run.impacts["time_error"].is_not_null() & level.impacts["time_error"].is_not_null()
    have, want = run.impacts.filter(known), level.impacts.filter(known)
    assert have.height >= 12
    errors = (have["time_error"] + want["time_error"]).to_numpy()
    times = have["time"].to_numpy()
    assert (np.abs(times - want["time"].to_numpy()) <= errors + np.spacing(times)).all()
    # States differ by as much times what is of the order of 1.
    for name in ("displacement", "velocity_before", "absorber_velocity_after", "approach_velocity"):
        moved = (have[name] - want[name]).to_numpy() - (shift if name == "displacement" else 0.0)
        assert (np.abs(moved) <= 100.0 * errors + 1e-14).all(), name


def bounces(of: dict[str, float], x: float, v: float, y: float, w: float) -> list[Any]:
    """Return (time, wall, gap velocity before) of the first impacts, in plain doubles.

    The flight in closed form, the first contact by samples 1e-4 apart and bisection. It ends after
    twelve impacts, four periods, or before a rebound could hide between two samples.
    """
    mu, e, d, gamma, zeta = (of[name] for name in ("mu", "e", "d", "gamma", "zeta"))
    omega, grid = math.sqrt(1.0 - zeta**2), 1e-4 * np.arange(80_001)
    found, time = list[Any](), 0.0
    while len(found) < 12:

        def structure(t: Any, a: float = x - mu * gamma, v: float = v) -> tuple[Any, Any]:
            fade, cosine, sine = np.exp(-zeta * t), np.cos(omega * t), np.sin(omega * t)
            moved = fade * (a * cosine + (v + zeta * a) / omega * sine) - a
            return moved, fade * (v * cosine - (a + zeta * v) / omega * sine)

        def gap(t: Any, y: float = y, u: float = v + w) -> Any:
            return y + u * t - 0.5 * gamma * t**2 - structure(t)[0]

        index = int(np.argmax(np.abs(gap(grid)[1:]) > d)) + 1
        wall = 1 if gap(grid[index]) > 0.0 else -1
        assert wall * gap(grid[index]) > d
        assert index > 1
        hit = brentq(lambda t: wall * gap(t) - d, grid[index - 1], grid[index], xtol=1e-16)  # noqa: B023
        time += hit
        moved, velocity = (float(value) for value in structure(hit))
        approach = v + w - gamma * hit - velocity
        if abs(approach) < 5e-3 or time > 8.0 * math.pi:
            break
        found.append((time, wall, approach))
        x, v = x + moved, velocity + mu * (1.0 + e) / (1.0 + mu) * approach
        y, w = wall * d, -e * approach
    return found


@pytest.mark.parametrize("index", range(8))
def test_a_decay_is_that_of_another_integration(index: int) -> None:
    """Drawn scenes against `bounces`, whose errors of some 1e-16 grow by the impacts."""
    random = np.random.default_rng(index)
    ranges = {"mu": (0.05, 0.3), "zeta": (0.01, 0.05), "e": (0.4, 0.8), "gamma": (0.3, 3.0)}
    of = {name: float(random.uniform(*ends)) for name, ends in ranges.items()}
    weight = (1.0 + of["mu"]) * of["gamma"]
    of["d"] = weight * float(random.uniform(0.3, 0.9))
    x, v = (weight * float(random.uniform(1.5, 3.0)) for _ in range(2))
    y, w = (of["d"] * float(random.uniform(-0.9, 0.9)) for _ in range(2))
    expected = bounces(of, x, v, y, w)
    assert len(expected) >= 5
    changes = {"mass_ratio": of["mu"], "restitution": of["e"], "clearance": of["d"]}
    absorber = siva(of["gamma"], (90.0, 65.0, 40.0, 15.0)[index % 4], **changes)
    start = iva.Start(displacement=x, velocity=v, gap_displacement=y, gap_velocity=w)
    run = simulate(absorber, start, of["zeta"], periods=4.5)
    found = run.impacts.head(len(expected))
    times, walls, approaches = (list(column) for column in zip(*expected, strict=True))
    assert found["wall"].to_list() == walls
    assert found["time"].to_list() == pytest.approx(times, rel=0, abs=1e-9)
    approx = pytest.approx(approaches, rel=0, abs=1e-8 * of["gamma"])
    assert found["approach_velocity"].to_list() == approx
    assert residual(run) < 1e-13


# fields of an absorber, pieces of what is said
BAD: list[tuple[dict[str, float], tuple[str, ...]]] = [
    ({"gravity": 9.81}, ("gravity", "inclination")),
    ({"inclination": 0.3}, ("gravity",)),
    ({"inclination_deg": 30.0}, ("gravity",)),
    ({"inclination": -0.1, "gravity": 1.0}, ("absorber.inclination = -0.1",)),
    ({"inclination": 1.5708, "gravity": 1.0}, ("absorber.inclination = 1.5708",)),
    ({"inclination": math.nan, "gravity": 1.0}, ("absorber.inclination = NaN",)),
    ({"inclination_deg": -1.0, "gravity": 1.0}, ("absorber.inclination_deg = -1",)),
    ({"inclination_deg": 90.5, "gravity": 1.0}, ("absorber.inclination_deg = 90.5",)),
    ({"inclination": 0.3, "gravity": 0.0}, ("absorber.gravity = 0",)),
    ({"inclination": 0.3, "gravity": -9.81}, ("absorber.gravity = -9.81",)),
    ({"inclination": 0.3, "inclination_deg": 30.0}, ("absorber.inclination_deg = 30", "one of")),
]


@pytest.mark.parametrize(("fields", "pieces"), BAD)
def test_bad_values_are_named(fields: dict[str, float], pieces: tuple[str, ...]) -> None:
    """Contract: one sentence with the names of the fields."""
    with pytest.raises(ValueError, match="absorber") as caught:
        simulate(iva.Siva(**PLAIN, **fields), periods=1)
    assert all(piece in str(caught.value) for piece in pieces)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("upright", [{"inclination": math.pi / 2}, {"inclination_deg": 90.0}])
def test_a_pendulum_hangs_still_on_an_upright_motion(upright: dict[str, float]) -> None:
    """Closed form: all of its mass moves with the structure, x = cos(t / √(1 + μ))."""
    given: Any = PLAIN | {"frequency_ratio": 0.4, "length": 3.0} | upright
    damper = iva.Piva(**given)
    start = iva.Start(displacement=1.0)
    run = iva.simulate(damper, iva.Primary(damping_ratio=0.0), start=start, duration=20.0)
    assert (run.summary["impacts"][0], run.summary["episodes"][0]) == (0, 0)
    motion = run.trajectory()
    expected = np.cos(motion["time"].to_numpy() / math.sqrt(1 + PLAIN["mass_ratio"]))
    assert np.abs(motion["displacement"].to_numpy() - expected).max() < 1e-14
    assert motion["angle"].abs().max() == 0.0


def test_units() -> None:
    """One scene three ways: M = 2 kg, ωn = 20/s, lengths in m; energies over M ωn², M and 1."""
    start = iva.Start(displacement=0.06, gap_displacement=0.0)
    same: Any = {"restitution": 0.6, "inclination_deg": 40.0, "clearance": 0.015}
    standard, mu = 9.80665, 0.15
    scenes: list[tuple[Any, Any, float, float]] = [  # the last are units: 1/time, energy
        ({"mass_ratio": mu, "gravity": standard / 400.0}, {}, 1.0, 1.0),
        ({"mass_ratio": mu, "gravity": standard}, {"natural_frequency": 20.0}, 20.0, 400.0),
        ({"mass": 0.3}, {"mass": 2.0, "stiffness": 800.0}, 20.0, 800.0),
    ]
    initial = 0.5 * 0.06**2 + mu * standard / 400.0 * math.sin(math.radians(40.0)) * 0.015
    found: list[list[float]] = []
    for fields, structure, rate, unit in scenes:
        primary = iva.Primary(**structure, damping_ratio=0.02)
        run = iva.simulate(iva.Siva(**fields, **same), primary, start=start, periods=3)
        assert run.summary["energy_initial"].item() / unit == pytest.approx(initial, rel=1e-14)
        impacts = run.impacts[:6]
        losses = impacts["energy_loss"] / unit
        found.append([*impacts["wall"], *(impacts["time"] * rate), *losses])
        assert len(found[-1]) == 18
        assert found[-1] == pytest.approx(found[0], rel=1e-12)


@pytest.mark.parametrize("force", FORCES[:2])
def test_a_sweep_is_its_runs(force: Any) -> None:
    """Contract: each row has the bits of the run of its values."""
    given: Any = {"start": iva.Start(displacement=1.0), "force": force, "periods": 12}
    over = {"inclination_deg": [0.0, 25.0, 90.0], "gravity": [0.2, 1.3]}
    primary, tables = iva.Primary(damping_ratio=0.01), ("summary", "impacts")
    table = iva.sweep(iva.Siva(**PLAIN), primary, over=over, tables=tables, **given)
    pairs = [(angle, gravity) for angle in over["inclination_deg"] for gravity in over["gravity"]]
    finals = []
    for point, (angle, gravity) in enumerate(pairs):
        absorber = iva.Siva(**PLAIN, inclination_deg=angle, gravity=gravity)
        run = iva.simulate(absorber, primary, **given)
        for name in tables:
            rows = getattr(table, name).filter(point=point)
            names = [name for name in rows.columns if name not in {"point", *over}]
            assert bits(rows, names) == bits(getattr(run, name), names)
        finals.append(run.summary["energy_final"].item())
    assert len(set(finals)) == 5  # a level one does not feel gravity


@pytest.mark.parametrize("mass_ratio", [1e-18, 1e-22, 1e-25, 1e-30])
def test_a_ball_of_no_mass_rebounds_as_one_of_little_mass(mass_ratio: float) -> None:
    # Thrown from 10 m above the stop of a structure at rest: v₁ = √(15² + 2 · 9.81 · 10) m/s, and
    # each rebound lasts 2 eᵏ v₁/g.
    e, g = 0.8, 9.81
    ball = iva.Siva(mass_ratio=mass_ratio, restitution=e, gap=100.0, inclination_deg=90, gravity=g)
    primary = iva.Primary(mass=1e3, frequency_hz=1.0)
    start = iva.Start(gap_displacement=-40.0, gap_velocity=15.0)
    run = iva.simulate(ball, primary, start=start, duration=25.0)
    speed = math.sqrt(15.0**2 + 2 * g * 10.0)
    count = run.impacts.height
    assert count == 50, "down to the default chatter floor"
    slowest = run.impacts["approach_velocity"].abs()[-1]
    assert slowest == pytest.approx(speed * e**49, rel=1e-11)
    expected = (15.0 + speed) / g + 2 * speed / g * (e - e ** np.arange(1, count + 1)) / (1 - e)
    assert np.abs(run.impacts["time"].to_numpy() / expected - 1).max() < 1e-13
    (above,) = run.at([10.0])["gap_displacement"]
    last = int(np.searchsorted(expected, 10.0)) - 1
    since = 10.0 - expected[last]
    flown = speed * e ** (last + 1) * since - g * since**2 / 2
    assert above == pytest.approx(flown - 50.0, rel=1e-12)
