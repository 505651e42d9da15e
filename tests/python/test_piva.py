"""The pendulum absorber: equations, impacts, ledger, known times and limits.

Unless a line says otherwise ωn = M = 1 and lengths are in units of the start displacement. The
equations meant, with s = sin θ, c = cos θ (small angles: s = θ, c = 1), y = b s, g = κ L ωp²:

    (1+μ) ẍ + μ L (θ̈ c − θ̇² s) + 2ζẋ + x = 0          κL (θ̈ + 2ζp ωp θ̇) + ẍ c + g s = 0
"""

from __future__ import annotations

import json
import math
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

import iva

Array = NDArray[np.float64]
ULP = 2.0**-53
CENTRED = iva.Start(displacement=1.0)
POINT_BOB: dict[str, Any] = {
    "mass_ratio": 0.12,
    "restitution": 0.5,
    "clearance": 1.4,
    "frequency_ratio": 0.4,
    "length": 10.0,
}
COMPOUND = POINT_BOB | {
    "clearance": 1.0,
    "length": 3.0,
    "inertia_ratio": 1.3,
    "contact_distance": 4.0,
    "pivot_damping_ratio": 0.05,
}
STEEP = POINT_BOB | {"mass_ratio": 0.1, "clearance": 1.5, "frequency_ratio": 0.5, "length": 2.0}
SMALL = POINT_BOB | {"angles": "small"}
SCENES = {
    "point bob": POINT_BOB,
    "compound": COMPOUND,
    "steep": STEEP,
    "small": SMALL,
    "small compound": COMPOUND | {"angles": "small", "length": 7.0, "clearance": 0.3},
}


def decay(
    absorber: dict[str, Any],
    start: iva.Start = CENTRED,
    damping_ratio: float = 0.0,
    periods: float = 10,
    **options: Any,
) -> iva.Run:
    primary = iva.Primary(damping_ratio=damping_ratio)
    return iva.simulate(iva.Piva(**absorber), primary, start=start, periods=periods, **options)


def array(frame: pl.DataFrame, name: str) -> Array:
    return frame[name].to_numpy().astype(float)


def sides(absorber: dict[str, Any]) -> tuple[float, float, float, float]:
    """Return μ, κ, L, b of an absorber."""
    length = absorber["length"]
    kappa = absorber.get("inertia_ratio", 1.0)
    return absorber["mass_ratio"], kappa, length, absorber.get("contact_distance", length)


def sine_cosine(absorber: dict[str, Any], angle: Array) -> tuple[Array, Array]:
    if absorber.get("angles") == "small":
        return angle, np.ones_like(angle)
    return np.sin(angle), np.cos(angle)


def energy(absorber: dict[str, Any], states: pl.DataFrame) -> Array:
    """Return kinetic, spring and potential energy; 0 at rest with the pendulum hanging."""
    mu, kappa, length, _ = sides(absorber)
    x, v, angle, rate = (
        array(states, name) for name in ("displacement", "velocity", "angle", "angular_velocity")
    )
    cosine = sine_cosine(absorber, angle)[1]
    rise = angle**2 / 2 if absorber.get("angles") == "small" else 2 * np.sin(angle / 2) ** 2
    gravity = kappa * length * absorber["frequency_ratio"] ** 2
    swing = v * length * rate * cosine + kappa * (length * rate) ** 2 / 2
    total: Array = x**2 / 2 + (1 + mu) * v**2 / 2 + mu * (swing + gravity * length * rise)
    return total


# First impacts, about 1e-11 accurate, by a program that shares nothing with this one.
DECAYS = [
    (
        POINT_BOB,
        0.0,
        "2.131699850978 4.309021495887 6.574044520667 10.90373735348 14.33770847684 18.07552746539",
    ),
    (
        POINT_BOB | {"clearance": 1.0, "length": 4.0},
        0.01,
        "1.643414382895 3.629451750201 6.831152668725 11.05345393585 13.75133919954",
    ),
]


@pytest.mark.parametrize(("absorber", "zeta", "times"), DECAYS)
def test_known_free_decays(absorber: dict[str, Any], zeta: float, times: str) -> None:
    expected = [float(time) for time in times.split()]
    found = decay(absorber, damping_ratio=zeta).impacts["time"].head(len(expected))
    assert found.to_list() == pytest.approx(expected, rel=0, abs=1e-11)


EVENTS = Path(__file__).parents[1] / "reference" / "piva_free_decay.json"


@pytest.mark.parametrize("name", ["piva_gamma_1.4", "piva_large_angle", "piva_chatter"])
def test_reference_events(name: str) -> None:
    # 50 digits (tests/reference/README.md). An event may be off by 2.5 rounding units, the worst of
    # docs/guarantee.md. Rebounds below the default chatter floor, 1e-7 here, are no rows.
    reference = json.loads(EVENTS.read_text(encoding="utf-8"))[name]
    scene = {key: float(value) for key, value in reference["scene"].items() if key != "kind"}
    absorber = {
        "mass_ratio": scene["mu"],
        "restitution": scene["e"],
        "clearance": scene["gamma"],
        "frequency_ratio": scene["r"],
        "length": scene["lam"],
    }
    run = decay(absorber, damping_ratio=scene["zeta"], periods=scene["periods"])
    hits = run.impacts.filter(pl.col("approach_velocity").abs() > 2e-7)
    found = {
        "impact": hits.select("time", "wall"),
        "stick": run.episodes.select("stick_time", "wall"),
        "release": run.episodes.select("release_time", "wall").drop_nulls(),
    }
    for kind, frame in found.items():
        expected = [
            event
            for event in reference["events"]
            if event["kind"] == kind and (kind != "impact" or abs(float(event["approach"])) > 2e-7)
        ]
        assert frame["wall"].to_list() == [event["side"] for event in expected]
        for time, event in zip(frame[:, 0], expected, strict=True):
            error = abs(float(Decimal(time) - Decimal(event["tau"])))
            assert error <= 2.5 * ULP * (max(event["condition"], 1) + time)


@pytest.mark.parametrize("degrees", [30, 90, 150])
def test_period_of_a_pendulum(degrees: float) -> None:
    # 2π/ωp · 1/AGM(1, cos(θ0/2)), with Gauss's mean. μ = 1e-12 shifts it by about 1e-13 at r = 0.1.
    mean, other = 1.0, math.cos(math.radians(degrees) / 2)
    for _ in range(6):
        mean, other = (mean + other) / 2, math.sqrt(mean * other)
    period = 2 * math.pi / 0.1 / mean
    start = iva.Start(angle=math.radians(degrees))
    absorber = POINT_BOB | {"mass_ratio": 1e-12, "frequency_ratio": 0.1, "clearance": 20.0}
    run = decay(absorber, start, periods=20)
    assert run.summary["stop_reachable"].item() is False
    found = run.at([0, period / 4, period / 2, 3 * period / 4, period])["angle"].to_list()
    expected = [math.radians(value) for value in (degrees, 0, -degrees, 0, degrees)]
    assert found == pytest.approx(expected, rel=0, abs=5e-13)


# Roots of (1+μ−μ)λ² − (1 + (1+μ)r²)λ + r² = 0, λ = ω², for μ, r: the point bob at small angles.
MODES = [
    (0.12, 0.4, 0.3955241294359459),
    (0.12, 0.4, 1.011316302169572),
    (0.1, 1.0, 0.8543089535574104),
    (0.1, 1.0, 1.170536719574248),
]


@pytest.mark.parametrize(("mu", "r", "omega"), MODES)
def test_modes_of_small_angles(mu: float, r: float, omega: float) -> None:
    # ÿ = −ẍ − r²y makes y = ω²/(r² − ω²) x the shape: released in it, both swing as cos ωτ.
    shape = omega**2 / (r**2 - omega**2)
    absorber = SMALL | {"mass_ratio": mu, "frequency_ratio": r, "length": None, "clearance": 100}
    run = decay(absorber, iva.Start(displacement=1.0, gap_displacement=shape))
    times = np.linspace(0, 20 * math.pi, 41)
    states = run.at(times)
    wave = np.cos(omega * times)
    assert np.allclose(states["displacement"], wave, rtol=0, atol=2e-13)
    assert np.allclose(states["gap_displacement"], shape * wave, rtol=0, atol=2e-13 * abs(shape))


@pytest.mark.parametrize("zeta", [0.0, 0.05, 1.5])
def test_small_angles_follow_the_matrix_exponential(zeta: float) -> None:
    absorber = COMPOUND | {"angles": "small", "clearance": 100.0}
    mu, kappa, length, reach = sides(absorber)
    omega = absorber["frequency_ratio"]
    mass = np.array([[1 + mu, mu * length / reach], [reach / (kappa * length), 1.0]])
    right = -np.array([[1, 0, 2 * zeta, 0], [0, omega**2, 0, 2 * 0.05 * omega]])
    system = np.vstack([np.eye(4)[2:], np.linalg.solve(mass, right)])
    values, vectors = np.linalg.eig(system)
    state = np.array([1.0, -0.5, 0.3, 0.8])
    start = iva.Start(displacement=1, gap_displacement=-0.5, velocity=0.3, gap_velocity=0.8)
    times = np.linspace(0, 40, 81)
    modes = np.linalg.solve(vectors, state.astype(complex))[:, None] * np.exp(
        values[:, None] * times
    )
    names = ("displacement", "gap_displacement", "velocity", "gap_velocity")
    states = decay(absorber, start, damping_ratio=zeta).at(times)
    for name, expected in zip(names, (vectors @ modes).real, strict=True):
        assert np.allclose(states[name], expected, rtol=0, atol=1e-12), name


@pytest.mark.parametrize("angles", ["large", "small"])
def test_equations_of_motion(angles: str) -> None:
    # Accelerations by the central difference of order 8. With h = 0.01 its error, which goes with
    # h⁸, is 3e-13 at most (1e-8 with h = 0.04), and rounding gives as much.
    absorber = COMPOUND | {"angles": angles, "clearance": 1e3, "mass_ratio": 0.4}
    absorber |= {"frequency_ratio": 0.8}
    mu, kappa, length, _ = sides(absorber)
    start = iva.Start(displacement=1.0, velocity=-0.4, angle=2.0, angular_velocity=0.6)
    run = decay(absorber, start, damping_ratio=0.03)
    instants, step = np.linspace(0.1, 60, 200), 0.01
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    accelerations = {"velocity": np.zeros(200), "angular_velocity": np.zeros(200)}
    for count, weight in weights.items():
        later, earlier = run.at(instants + count * step), run.at(instants - count * step)
        for name, total in accelerations.items():
            total += weight / step * (array(later, name) - array(earlier, name))
    states = run.at(instants)
    x, v, angle, rate = (
        array(states, name) for name in ("displacement", "velocity", "angle", "angular_velocity")
    )
    sine, cosine = sine_cosine(absorber, angle)
    along, swing = accelerations.values()
    turn = 0.0 if angles == "small" else rate**2 * sine
    primary = (1 + mu) * along + mu * length * (swing * cosine - turn) + 0.06 * v + x
    omega, gravity = 0.8, kappa * length * 0.8**2
    pendulum = kappa * length * (swing + 2 * 0.05 * omega * rate) + along * cosine + gravity * sine
    assert np.allclose(primary, 0, rtol=0, atol=5e-12)
    assert np.allclose(pendulum, 0, rtol=0, atol=5e-12)
    assert np.abs(rate).max() > 0.5


@pytest.mark.parametrize("scene", SCENES)
def test_laws_of_an_impact(scene: str) -> None:
    absorber = SCENES[scene]
    mu, kappa, length, reach = sides(absorber)
    e, clearance = absorber["restitution"], absorber["clearance"]
    impacts = decay(absorber, damping_ratio=0.01).impacts
    assert impacts.height >= 5
    wall, angle = array(impacts, "wall"), array(impacts, "angle")
    sine, cosine = sine_cosine(absorber, angle)
    before, after = array(impacts, "velocity_before"), array(impacts, "velocity_after")
    rate, rebound = (array(impacts, f"angular_velocity_{when}") for when in ("before", "after"))
    approach = array(impacts, "approach_velocity")

    def same(one: Array, other: Array) -> bool:
        return np.allclose(one, other, rtol=0, atol=4e-15)

    assert same(reach * sine, wall * clearance)
    assert same(reach * cosine * rate, approach)
    assert (wall * approach > 0).all()
    # Restitution on w = b cos θ θ̇; momentum (1+μ)ẋ + μ L cos θ θ̇; so the jump of ẋ has L/b.
    assert same(rebound, -e * rate)
    assert same(
        (1 + mu) * before + mu * length * cosine * rate,
        (1 + mu) * after + mu * length * cosine * rebound,
    )
    assert same(after - before, mu * (1 + e) / (1 + mu) * length / reach * approach)
    loss = 0.5 * mu * (1 - e**2) * (length * rate) ** 2 * (kappa - mu * cosine**2 / (1 + mu))
    assert same(array(impacts, "energy_loss"), loss)
    if kappa == 1.0 and absorber.get("angles") != "small":
        of_a_point = (1 + mu * sine**2) / (1 + mu) * 0.5 * mu * (1 - e**2) * (length * rate) ** 2
        assert same(loss, of_a_point)
    # The absorber's velocity is that of its centre of mass, so that ẋ + μ ẋ₁ is conserved.
    bob = array(impacts, "absorber_velocity_before")
    assert same(bob, before + length * cosine * rate)
    later = array(impacts, "absorber_velocity_after")
    assert same(later, after + length * cosine * rebound)
    assert same(before + mu * bob, after + mu * later)
    assert ((before * bob < 0) == impacts["effective"].to_numpy()).all()


def test_printed_impact_law() -> None:
    # Eq. 17 as printed: W⁺ = −2μe/(1+μ) W⁻ in place of −e W⁻.
    run = decay(POINT_BOB | {"impact_law": "printed"})
    rate, rebound = (array(run.impacts, f"angular_velocity_{when}") for when in ("before", "after"))
    assert np.allclose(rebound, -2 * 0.12 * 0.5 / 1.12 * rate, rtol=1e-15, atol=0)
    assert run.impacts.height >= 5
    # It breaks momentum; what energy it takes or makes is booked all the same.
    assert abs(run.summary["energy_residual"].item()) <= 1e-11


@pytest.mark.parametrize("damping_ratio", [0.0, 0.02])
@pytest.mark.parametrize("scene", SCENES)
def test_ledger(scene: str, damping_ratio: float) -> None:
    absorber = SCENES[scene]
    start = iva.Start(displacement=1.0, velocity=0.2, angle=-0.07, angular_velocity=0.05)
    run = decay(absorber, start, damping_ratio, periods=20)
    row = run.summary.row(0, named=True)
    initial, final = energy(absorber, run.at([0.0, 40 * math.pi]))
    assert row["energy_initial"] == pytest.approx(initial, rel=1e-14)
    assert row["energy_final"] == pytest.approx(final, rel=0, abs=1e-14)
    assert abs(row["energy_residual"]) <= 1e-11 * initial
    lost = row["energy_impacts"] + row["energy_viscous"] + row["energy_pivot"]
    assert initial - lost == pytest.approx(final, rel=0, abs=1e-11)
    assert (row["energy_viscous"] > 0.01) == (damping_ratio > 0)
    assert (row["energy_pivot"] > 1e-3) == ("pivot_damping_ratio" in absorber)
    # Rebounds that are not listed are slower than 1e-6 ωn d.
    assert run.impacts["energy_loss"].sum() == pytest.approx(row["energy_impacts"], abs=1e-11)


def test_release_from_the_wall() -> None:
    # Stuck at +: (1+μ)ẍ + 2ζẋ + x = 0, θ = asin(d/b), until ẍ cos θ + g sin θ = 0; mirrored at −.
    absorber = STEEP | {"restitution": 0.0, "clearance": 0.2}
    run = decay(absorber, damping_ratio=0.02)
    rides = run.episodes.drop_nulls("release_time")
    assert rides.height >= 3
    sine = 0.2 / 2.0

    def pressure(states: pl.DataFrame, wall: Array) -> Array:
        resisting = 2 * 0.02 * array(states, "velocity") + array(states, "displacement")
        held: Array = -resisting / 1.1 * math.sqrt(1 - sine**2) + 0.25 * 2.0 * wall * sine
        return -wall * held

    wall = array(rides, "wall")
    begin, end = array(rides, "stick_time"), array(rides, "release_time")
    assert np.allclose(pressure(run.at(end), wall), 0, rtol=0, atol=1e-12)
    middle = run.at((begin + end) / 2)
    assert (pressure(middle, wall) > 0).all()
    assert (array(middle, "wall") == wall).all()
    assert np.allclose(middle["angle"], wall * math.asin(sine), rtol=1e-14, atol=0)
    assert set(middle["angular_velocity"]) == {0.0}


@pytest.mark.parametrize("scene", SCENES)
def test_angle_and_gap_say_the_same(scene: str) -> None:
    absorber = SCENES[scene]
    reach = sides(absorber)[3]
    states = decay(absorber, damping_ratio=0.01).trajectory(40)
    sine, cosine = sine_cosine(absorber, array(states, "angle"))
    rate = array(states, "angular_velocity")
    assert np.allclose(states["gap_displacement"], reach * sine, rtol=0, atol=4e-15)
    assert np.allclose(states["gap_velocity"], reach * cosine * rate, rtol=0, atol=4e-15)
    assert np.ptp(array(states, "angle")) > 0.1


def test_rotation_over_the_top() -> None:
    # θ̇ = 3 ωp at the bottom; without coupling 2 ωp would do.
    absorber = STEEP | {"clearance": 2.0}
    run = decay(absorber, iva.Start(displacement=1.0, angular_velocity=1.5), periods=20)
    assert run.summary["stop_reachable"].item() is False
    states = run.trajectory(200)
    angle, rate = array(states, "angle"), array(states, "angular_velocity")
    assert angle.min() < -3.1
    assert angle.max() > 3.1
    assert ((angle > -math.pi) & (angle <= math.pi)).all()
    # Simpson's rule over pairs of steps, as far as it goes: error h⁵/90 of the fourth derivative.
    turned = np.unwrap(angle)
    assert np.ptp(turned) > 4 * math.pi
    step = np.diff(array(states, "time"))[:-1]
    simpson = step / 3 * (rate[:-2] + 4 * rate[1:-1] + rate[2:])
    assert np.allclose(turned[2:-1] - turned[:-3], simpson[:-1], rtol=0, atol=1e-7)
    assert np.allclose(energy(absorber, states), energy(absorber, states)[0], rtol=1e-12, atol=0)
    sine, cosine = sine_cosine(absorber, angle)
    assert np.allclose(states["gap_displacement"], 2 * sine, rtol=0, atol=1e-14)
    assert np.allclose(states["gap_velocity"], 2 * cosine * rate, rtol=0, atol=1e-14)


@pytest.mark.parametrize("scene", SCENES)
def test_mirror(scene: str) -> None:
    state = {"displacement": 1.0, "velocity": 0.2, "angle": -0.05, "angular_velocity": 0.1}
    base = decay(SCENES[scene], iva.Start(**state), 0.01)
    other = decay(SCENES[scene], iva.Start(**{name: -value for name, value in state.items()}), 0.01)
    assert other.summary.equals(base.summary)
    kept = ("point", "impact", "time", "energy_loss", "effective", "time_error", "near_grazing")
    turned = [name for name in base.impacts.columns if name not in kept]
    assert base.impacts.height >= 5
    assert other.impacts.with_columns(-pl.col(turned)).equals(base.impacts)


def test_limit_of_a_long_slow_pendulum() -> None:
    # r → 0 at small angles is the free mass; at large angles the difference goes with 1/L².
    free = iva.simulate(
        iva.Siva(mass_ratio=0.12, restitution=0.5, clearance=0.6),
        iva.Primary(),
        start=CENTRED,
        periods=2,
    )
    absorber = POINT_BOB | {"clearance": 0.6, "frequency_ratio": 1e-9}
    times = array(free.impacts, "time")
    assert times.size >= 3
    small = decay(absorber | {"angles": "small", "length": None}, periods=2).impacts
    assert np.allclose(small["time"], times, rtol=0, atol=1e-13)
    off = [
        array(decay(absorber | {"length": length}, periods=2).impacts, "time") - times
        for length in (100.0, 1000.0)
    ]
    assert np.allclose(off[0] / off[1], 100, rtol=1e-3)
