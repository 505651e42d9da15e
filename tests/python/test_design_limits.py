"""What an impact absorber asks of its parts, against closed forms.

Columns of the summary: `approach_speed_max`, `impulse_max`, `reduction_rms` (always) and
`acceleration_max`, `gap_displacement_max`, `stroke`, `absorber_displacement_max` (if named); of the
motion `acceleration` and `absorber_acceleration`. Natural units,
ωn = M = 1, unless said otherwise: x + 2ζẋ + ẍ = f − a_g, absolute acceleration ẍ + a_g.
"""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva

DEFAULT = ("approach_speed_max", "impulse_max", "reduction_rms")
NAMED = ("acceleration_max", "gap_displacement_max", "stroke", "absorber_displacement_max")
GAP = ("approach_speed_max", "impulse_max", *NAMED[1:])
MEASURES = (*DEFAULT, *NAMED, "amplitude_rms", "amplitude_max", "reduction", "transmissibility")
EPS = 2.0**-52
#: An absorber whose walls are out of reach.
FAR = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=32.0)
HARD: dict[str, Any] = {"mass_ratio": 0.1, "restitution": 0.6, "clearance": 0.5}


def simulate(absorber: Any, start: iva.Start, zeta: float = 0.0, **run: Any) -> iva.Run:
    """Run it with all columns that are tested here."""
    given: dict[str, Any] = {"measures": MEASURES} | run
    return iva.simulate(absorber, iva.Primary(damping_ratio=zeta), start=start, **given)


def row(run: iva.Run) -> dict[str, Any]:
    """Return its summary."""
    return run.summary.row(0, named=True)


def values(run: iva.Run, names: tuple[str, ...] = NAMED) -> list[Any]:
    """Return some of its summary, in the order of the names."""
    return list(run.summary.select(names).row(0))


@pytest.mark.parametrize("y", [0.3, -0.3, 0.0])
def test_a_gap_that_is_never_closed(y: float) -> None:
    """A mass at rest at x₁ = 1 + y, x = cos t: the gap y + 1 − cos t goes from y to y + 2."""
    run = simulate(FAR, iva.Start(displacement=1.0, gap_displacement=y), periods=3)
    assert values(run) == pytest.approx([1.0, y + 2.0, 2.0, 1.0 + y], rel=4 * EPS)
    assert values(run, GAP[:2]) == [0.0, 0.0]
    assert row(run)["reduction_rms"] is None


def test_a_gap_that_drifts() -> None:
    """x₁ = 1.3 + ut and y = x₁ − cos t, which has its extrema where sin t = −u, or at the ends."""
    u, end = 0.01, 21.0
    start = iva.Start(displacement=1.0, gap_displacement=0.3, gap_velocity=u)
    run = simulate(FAR, start, duration=end)
    crests = [t for k in range(4) for t in (math.pi + math.asin(u) + 2 * math.pi * k,) if t < end]
    troughs = [2 * math.pi * k - math.asin(u) for k in range(1, 4)]
    gaps = [1.3 + u * t - math.cos(t) for t in (0.0, *crests, *troughs, end)]
    assert len(crests) == 3
    expected = [1.0, max(gaps), max(gaps) - min(gaps), 1.3 + u * end]
    assert values(run) == pytest.approx(expected, rel=8 * EPS)
    mirrored = iva.Start(displacement=-1.0, gap_displacement=-0.3, gap_velocity=-u)
    assert values(simulate(FAR, mirrored, duration=end)) == values(run)


def test_a_gap_over_part_of_a_cycle() -> None:
    """Up to t = 2, x = cos t falls: the largest size of ẍ is at the start, the gap is 1 − cos 2."""
    start, open_gap = iva.Start(displacement=1.0), 1.0 - math.cos(2.0)
    run = simulate(FAR, start, duration=2.0)
    assert values(run) == pytest.approx([1.0, open_gap, open_gap, 1.0], rel=4 * EPS)
    # From rest at 0 with the velocity 1: ẍ = −sin t up to t = 1, x₁ = t, y = t − sin t.
    run = simulate(FAR, iva.Start(velocity=1.0), duration=1.0)
    gap = 1.0 - math.sin(1.0)
    assert values(run) == pytest.approx([math.sin(1.0), gap, gap, 1.0], rel=8 * EPS)


@pytest.mark.parametrize("zeta", [0.02, 0.1, 0.3, 0.45, 0.6, 0.95])
def test_the_acceleration_of_a_damped_decay(zeta: float) -> None:
    """From x = 0 with ẋ = 1: x = Im e^(λt)/ω, λ = −ζ + iω.

    ẍ = Im λ² e^(λt)/ω is −2ζ at the start and has its first extremum where Im λ³ e^(λt) = 0. Let go
    at rest at 1 instead, the structure begins with ẍ = −1, and every later extremum is smaller up
    to some ζ.
    """
    omega = math.sqrt(1.0 - zeta**2)
    rate = complex(-zeta, omega)
    turn = (-3.0 * cmath.phase(rate) % math.pi) / omega
    peak = abs((rate**2 * cmath.exp(rate * turn)).imag) / omega
    expected = max(2.0 * zeta, peak)
    # Both branches are met by the values of ζ.
    assert (peak > 2.0 * zeta) == (zeta < 0.5)
    run = simulate(FAR, iva.Start(velocity=1.0), zeta, periods=5)
    assert row(run)["acceleration_max"] == pytest.approx(expected, rel=1e-14)
    rest = simulate(FAR, iva.Start(displacement=1.0), zeta, periods=5)
    assert row(rest)["acceleration_max"] == pytest.approx(1.0, rel=1e-14)


def test_the_acceleration_of_an_overdamped_decay() -> None:
    """At the start ẍ = −2ζẋ − x = −5 for ζ = 2; later it is smaller (rates 3.7 and 0.27)."""
    run = simulate(FAR, iva.Start(displacement=1.0, velocity=1.0), 2.0, periods=2)
    assert row(run)["acceleration_max"] == pytest.approx(5.0, rel=1e-15)


def test_a_blow_leaves_out_its_own_acceleration() -> None:
    """By x = v sin(t − 2), ẍ is 0 on both sides of the impulse, v a quarter of a period later."""
    run = simulate(FAR, iva.Start(), force=iva.Impulse(velocity=0.7, time=2.0), duration=12.0)
    assert row(run)["acceleration_max"] == pytest.approx(0.7, rel=4 * EPS)
    assert row(run)["gap_displacement_max"] == pytest.approx(0.7, rel=4 * EPS)
    assert row(run)["reduction_rms"] is None
    assert values(run, GAP[:2]) == [0.0, 0.0]


def steady(kind: str, omega: float, zeta: float, size: float, phase: float) -> dict[str, complex]:
    """Return complex amplitudes under size·cos(Ωt + phase), without impacts.

    x: X (1 − Ω² + 2iζΩ) = F, or −A; a mass in flight: x₁ = 0, or A/Ω²; acceleration −Ω²X, or
    A − Ω²X.
    """
    load, base = size * cmath.exp(1j * phase), kind == "base_acceleration"
    x = (-load if base else load) / complex(1.0 - omega**2, 2.0 * zeta * omega)
    mass = load / omega**2 if base else 0j
    return {"x": x, "mass": mass, "acceleration": (load if base else 0j) - omega**2 * x}


@pytest.mark.parametrize("kind", ["amplitude", "base_acceleration"])
@pytest.mark.parametrize("omega", [0.7, 1.0, 1.8])
@pytest.mark.parametrize("discard", [0, 3])
def test_a_steady_state_from_its_begin(kind: str, omega: float, discard: int) -> None:
    """Complex amplitudes of `steady`; the start leaves no transient, and the mass no drift.

    The root mean square over q cycles after the first 3 is that of a cosine, by its integral:
    q is no multiple of a half cycle, while reduction_rms compares with the steady state.
    """
    zeta, size, phase, cycles = 0.08, 0.3, 0.4, 10.3
    of = steady(kind, omega, zeta, size, phase)
    gap = of["mass"] - of["x"]
    state = {"displacement": of["x"], "velocity": 1j * omega * of["x"]}
    state |= {"gap_displacement": gap, "gap_velocity": 1j * omega * gap}
    start = iva.Start(**{name: value.real for name, value in state.items()})
    force: Any = iva.Harmonic(**{kind: size}, frequency=omega, phase=phase)
    run = simulate(FAR, start, zeta, force=force, cycles=cycles, discard=discard)
    expected = [abs(of["acceleration"]), abs(gap), 2.0 * abs(gap), abs(of["mass"])]
    assert values(run) == pytest.approx(expected, rel=1e-13, abs=1e-14)
    begin, end = (2.0 * math.pi * n + cmath.phase(of["x"]) for n in (discard, cycles))
    square = 0.5 * (1.0 + 0.5 * (math.sin(2.0 * end) - math.sin(2.0 * begin)) / (end - begin))
    reduction = 1.0 - math.sqrt(2.0 * square)
    assert abs(reduction) > 1e-3
    assert row(run)["reduction_rms"] == pytest.approx(reduction, rel=0, abs=1e-13)
    if kind == "base_acceleration":
        # The same acceleration as that of `transmissibility`.
        ratio = row(run)["transmissibility"] * size
        assert row(run)["acceleration_max"] == pytest.approx(ratio, rel=4 * EPS)


def test_transients_are_discarded() -> None:
    """From x = 10 the structure begins with ẍ = f − 10; e^(−0.1·2π·60) of it is left later.

    The mass, at rest in space at x₁ = 10, is not damped by anything.
    """
    force = iva.Harmonic(amplitude=0.3, frequency=1.0)
    late, whole = (
        simulate(FAR, iva.Start(displacement=10.0), 0.1, force=force, cycles=80, discard=discard)
        for discard in (60, 0)
    )
    size = 0.3 / 0.2
    # At resonance X = −iF/2ζ, in the middle of the gap's motion stands 10.
    expected = [size, 10.0 + size, 2.0 * size, 10.0]
    assert values(late) == pytest.approx(expected, rel=1e-13)
    assert row(late)["reduction_rms"] == pytest.approx(0.0, rel=0, abs=1e-13)
    assert row(whole)["acceleration_max"] == pytest.approx(10.0 - 0.3, rel=1e-15)
    assert row(whole)["stroke"] > 10.0


def test_the_largest_impact_of_the_run_may_be_discarded() -> None:
    """Contract: approach speeds and impulses are those of all impacts, whatever the window."""
    force = iva.Harmonic(amplitude=0.3, frequency=1.0)
    start = iva.Start(displacement=10.0)
    runs = [
        simulate(iva.Siva(**HARD), start, 0.1, force=force, cycles=20, discard=discard)
        for discard in (0, 15)
    ]
    hits = runs[1].impacts
    late = hits.filter(hits["time"] >= 30.0 * math.pi)
    largest = max(abs(speed) for speed in hits["approach_velocity"])
    assert late.height > 3
    assert 2.0 * max(abs(speed) for speed in late["approach_velocity"]) < largest
    assert [row(run)["approach_speed_max"] for run in runs] == [largest] * 2
    impulse = pytest.approx(0.1 * 1.6 / 1.1 * largest, rel=4 * EPS)
    assert [row(run)["impulse_max"] for run in runs] == [impulse] * 2
    assert row(runs[1])["acceleration_max"] < 0.5 * row(runs[0])["acceleration_max"]


@pytest.mark.parametrize(
    "force",
    [
        [iva.Harmonic(amplitude=0.2, frequency=f) for f in (0.8, 1.7)],
        iva.Recorded([0.0, 3.0, 4.0, 9.0, 11.0], [0.0, 0.9, -1.2, 0.6, 0.0]),
        iva.Recorded([0.0, 3.0, 4.0, 9.0], [0.0, 0.9, -1.2, 0.0], kind="base_acceleration"),
        [iva.Harmonic(amplitude=0.2, frequency=1.0), iva.Impulse(velocity=0.5, time=3.0)],
    ],
)
def test_the_reference_of_other_forces_is_a_run_without_absorber(force: Any) -> None:
    """Contract: the same x(0), ẋ(0), force and window."""
    start = iva.Start(displacement=0.4, velocity=-0.2)
    given: dict[str, Any] = {"force": force, "duration": 40.0}
    if isinstance(force, list):
        given["discard"] = 2
    run = row(simulate(iva.Siva(**HARD), start, 0.02, **given))
    bare = row(simulate(None, start, 0.02, **given))
    assert run["approach_speed_max"] > 0.0
    expected = 1.0 - run["amplitude_rms"] / bare["amplitude_rms"]
    assert abs(expected) > 1e-3
    assert run["reduction_rms"] == pytest.approx(expected, rel=0, abs=4 * EPS)
    assert run["reduction_rms"] != pytest.approx(run["reduction"], rel=1e-3)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("d", [0.3, 1.7])
def test_the_first_impact(e: float, d: float) -> None:
    """Without damping the wall comes at arccos(1 − d) with the speed √(1 − (1 − d)²).

    The impulse is (1 + e) μ/(1 + μ) times it. Two time units hold no impact that is faster.
    """
    mu, speed = 0.25, math.sqrt(1.0 - (1.0 - d) ** 2)
    absorber = iva.Siva(mass_ratio=mu, restitution=e, clearance=d)
    run = simulate(absorber, iva.Start(displacement=1.0), duration=math.acos(1.0 - d) + 0.01)
    assert run.impacts.height == 1
    expected = [speed, mu * (1.0 + e) / (1.0 + mu) * speed]
    assert values(run, GAP[:2]) == pytest.approx(expected, rel=4 * EPS)
    # The gap went from 0 to the wall and, at e > 0, a little back.
    assert values(run, ("gap_displacement_max", "stroke")) == [d, d]
    assert row(run)["absorber_displacement_max"] == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize("floor", [1e-12, None, 10.0])
@pytest.mark.parametrize("degrees", [30.0, 90.0])
def test_a_light_ball_on_its_lower_stop(degrees: float, floor: float | None) -> None:
    """A ball that falls from h above its stop lands with √(2hγ); the structure does not feel it.

    Its impulse is μ(1 + e)√(2hγ). It is never farther from x = 0 than at its height y = h − d or on
    its stop at −d, and its stroke is h. With the floor at 10 not one of its impacts is a row.
    """
    mu, e, gamma, d, h = 1e-18, 0.5, 0.7, 2.0, 1.5
    gravity = gamma / math.sin(math.radians(degrees))
    absorber = iva.Siva(
        mass_ratio=mu, restitution=e, clearance=d, inclination_deg=degrees, gravity=gravity
    )
    start = iva.Start(gap_displacement=h - d)
    run = simulate(absorber, start, duration=20.0, chatter_floor=floor)
    assert run.episodes.height == 1
    speed = math.sqrt(2.0 * h * gamma)
    found = values(run, GAP[:2])
    assert found == pytest.approx([speed, mu * (1.0 + e) * speed], rel=4 * EPS)
    assert row(run)["acceleration_max"] < 1e-17
    assert row(run)["gap_displacement_max"] == d
    assert values(run, NAMED[2:]) == pytest.approx([h, d], rel=2 * EPS)
    motion = run.at([0.3, 19.0])
    assert motion["absorber_acceleration"][0] == pytest.approx(-gamma, rel=2 * EPS)
    assert motion["absorber_acceleration"][1] == motion["acceleration"][1]


@pytest.mark.parametrize("floor", [1e-10, None, 0.02, 3.0])
def test_summed_rebounds_count(floor: float | None) -> None:
    """The paper's Fig. 4 chatters without end: what is a row does not change what is the largest.

    Its first impact is the fastest of its first chatter: at the wall with √(1 − 0.9²).
    """
    absorber = iva.Siva(mass_ratio=0.15, restitution=0.5, clearance=0.1)
    run, short = (
        simulate(absorber, iva.Start(displacement=1.0), duration=end, chatter_floor=floor)
        for end in (20.0, 1.5)
    )
    listed = simulate(absorber, iva.Start(displacement=1.0), duration=20.0)
    assert run.episodes.height == listed.episodes.height >= 3
    assert values(run, GAP) == values(listed, GAP)
    speeds = [abs(speed) for speed in listed.impacts["approach_velocity"]]
    assert row(run)["approach_speed_max"] == max(speeds)
    share = 0.15 * 1.5 / 1.15
    assert row(run)["impulse_max"] == pytest.approx(share * max(speeds), rel=4 * EPS)
    assert row(short)["approach_speed_max"] == pytest.approx(math.sqrt(0.19), rel=4 * EPS)


def test_both_walls_bound_the_stroke() -> None:
    """Contract: exactly the play where both walls were met."""
    run = simulate(iva.Siva(**HARD), iva.Start(displacement=3.0), 0.01, periods=4)
    assert set(run.impacts["wall"]) == {-1, 1}
    assert values(run, ("gap_displacement_max", "stroke")) == [0.5, 1.0]


@pytest.mark.parametrize("kind", ["amplitude", "base_acceleration"])
def test_a_rider_that_never_leaves(kind: str) -> None:
    """Stuck on the lower stop both are one mass 1 + μ: X = F/(1 − (1+μ)Ω² + 2iζΩ), or −(1+μ)A/….

    The start leaves no transient. The gap stays −d; the mass, at x − d, is at most d + |X| away.
    """
    mu, zeta, omega, size, d = 0.1, 0.02, 0.8, 0.3, 0.5
    base = size if kind == "base_acceleration" else 0.0
    load = -(1.0 + mu) * base if base else size
    x = load / complex(1.0 - (1.0 + mu) * omega**2, 2.0 * zeta * omega)
    acceleration = abs(base - omega**2 * x)
    absorber = iva.Siva(
        mass_ratio=mu,
        restitution=0.5,
        clearance=d,
        inclination_deg=90.0,
        gravity=1.01 * acceleration,
    )
    start = iva.Start(displacement=x.real, velocity=(1j * omega * x).real)
    force: Any = iva.Harmonic(**{kind: size}, frequency=omega)
    run = simulate(absorber, start, zeta, force=force, cycles=6)
    assert row(run)["gap_displacement_max"] == d
    assert values(run, (*DEFAULT[:2], "stroke")) == [0.0, 0.0, 0.0]
    found = values(run, ("acceleration_max", "absorber_displacement_max"))
    assert found == pytest.approx([acceleration, d + abs(x)], rel=1e-13)
    # Over whole cycles the root mean square is |X|/√2, against F/√((1 − Ω²)² + (2ζΩ)²)/√2.
    bare = size / math.hypot(1.0 - omega**2, 2.0 * zeta * omega)
    reduction = 1.0 - abs(x) / bare
    assert row(run)["reduction_rms"] == pytest.approx(reduction, rel=0, abs=1e-13)
    motion = run.at(np.linspace(0.0, 40.0, 99))
    assert motion["absorber_acceleration"].to_list() == motion["acceleration"].to_list()


@pytest.mark.parametrize("degrees", [0.0, 40.0])
@pytest.mark.parametrize("force", [None, iva.Harmonic(base_acceleration=0.4, frequency=0.9)])
def test_accelerations_of_the_motion(degrees: float, force: Any) -> None:
    """In flight −2ζẋ − x (+ μγ), stuck (1+μ)(ẍ + a_g) = −2ζẋ − x. At an impact ẍ jumps by −2ζ Δẋ.

    The mass has −γ in flight, at the instants of `at` (which shows the state after an impact).
    """
    mu, zeta, gamma = 0.15, 0.05, 0.3 if degrees else 0.0
    gravity = 0.3 / math.sin(math.radians(degrees)) if degrees else None
    absorber = iva.Siva(
        mass_ratio=mu, restitution=0.4, clearance=0.1, inclination_deg=degrees, gravity=gravity
    )
    run = simulate(absorber, iva.Start(displacement=2.0), zeta, force=force, duration=25.0)
    motion = run.trajectory(100)
    x, v, wall = (motion[name].to_numpy() for name in ("displacement", "velocity", "wall"))
    found = motion["acceleration"].to_numpy()
    assert 50 < np.count_nonzero(wall) < wall.size - 50
    pull = -2.0 * zeta * v - x
    expected = np.where(wall == 0, pull + mu * gamma, pull / (1.0 + mu))
    # Rebounds so small that the program may have summed them are those of the next test.
    kept = (np.abs(motion["gap_velocity"].to_numpy()) > 1e-5) | (wall != 0)
    assert np.abs(found - expected)[kept].max() < 1e-14
    states = run.at(np.linspace(0.0, 25.0, 2000))
    found_mass, stuck = states["absorber_acceleration"].to_numpy(), states["wall"].to_numpy() != 0
    expected_mass = np.where(stuck, states["acceleration"].to_numpy(), -gamma)
    assert np.abs(found_mass - expected_mass).max() < 1e-14
    twice = np.flatnonzero((np.diff(motion["time"].to_numpy()) == 0.0) & (np.diff(v) != 0.0))
    assert twice.size >= 5
    flying = twice[(wall[twice] == 0) & (wall[twice + 1] == 0) & kept[twice + 1]]
    jump, change = found[flying + 1] - found[flying], v[flying + 1] - v[flying]
    assert np.abs(jump + 2.0 * zeta * change).max() < 1e-14
    assert np.abs(jump).max() > 0.01


@pytest.mark.parametrize("degrees", [0.0, 40.0])
def test_the_mass_before_an_impact(degrees: float) -> None:
    """Just before each impact the mass, in flight, has −γ as everywhere else."""
    gamma = 0.3 if degrees else 0.0
    gravity = 0.3 / math.sin(math.radians(degrees)) if degrees else None
    absorber = iva.Siva(
        mass_ratio=0.15, restitution=0.4, clearance=0.1, inclination_deg=degrees, gravity=gravity
    )
    motion = simulate(absorber, iva.Start(displacement=2.0), 0.05, duration=25.0).trajectory(100)
    before = motion.filter((pl.col("time").diff(-1) == 0.0) & (pl.col("wall") == 0))
    assert before.height > 20
    assert np.abs(before["absorber_acceleration"].to_numpy() + gamma).max() < 1e-14


def test_accelerations_at_the_end_of_a_chatter() -> None:
    """The same −2ζẋ − x beside the states of the same row, at the last rebounds before a stick."""
    zeta = 0.05
    absorber = iva.Siva(mass_ratio=0.15, restitution=0.4, clearance=0.1)
    motion = simulate(absorber, iva.Start(displacement=2.0), zeta, duration=25.0).trajectory(100)
    x, v, w = (motion[name].to_numpy() for name in ("displacement", "velocity", "gap_velocity"))
    last = (motion["wall"].to_numpy() == 0) & (np.abs(w) > 0.0) & (np.abs(w) < 1e-5)
    assert np.count_nonzero(last) > 20
    found = motion["acceleration"].to_numpy()
    assert np.abs(found + 2.0 * zeta * v + x)[last].max() < 1e-14


def test_without_absorber() -> None:
    """Contract: x = cos t has the acceleration 1 and −x; what belongs to an absorber is null."""
    run = simulate(None, iva.Start(displacement=1.0), periods=2)
    assert row(run)["acceleration_max"] == pytest.approx(1.0, rel=2 * EPS)
    assert values(run, GAP) == [None] * 5
    motion = run.at([0.0, 1.0, 2.0])
    assert motion["acceleration"].to_list() == pytest.approx(
        [-math.cos(t) for t in (0.0, 1.0, 2.0)], rel=4 * EPS
    )
    assert motion["absorber_acceleration"].to_list() == [None] * 3
    driven = simulate(None, iva.Start(), force=iva.Harmonic(amplitude=1.0, frequency=2), cycles=3)
    assert (row(driven)["reduction"], row(driven)["reduction_rms"]) == (None, None)
