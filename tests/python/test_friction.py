"""Coulomb friction of a free mass on its way, as studies and Python give it.

Numbers are closed forms, or come from SciPy's DOP853 with events of its own. The core has
references to 50 digits.
"""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray
from polars.testing import assert_frame_equal
from scipy.integrate import solve_ivp

import iva
from iva.plots.energy_split import split_of

Array = NDArray[np.float64]

G = 9.80665
PRIMARY = iva.Primary(mass=100.0, stiffness=90e3, damping_ratio=0.01)
START = iva.Start(displacement=0.025)


def siva(**more: Any) -> iva.Siva:
    """Return a free mass that rubs."""
    given = {"mass": 10.0, "restitution": 0.6, "clearance": 0.01, "friction": 0.05} | more
    return iva.Siva(**given)


@pytest.mark.parametrize("degrees", [0.0, 4.0])
def test_a_mass_slides_as_far_as_its_speed_carries_it(degrees: float) -> None:
    """w₀²/2R on a structure that is too heavy to move, level or up a slope that holds it."""
    k, speed = 0.2, 0.7
    structure = iva.Primary(mass=1e9, stiffness=1e9)
    absorber = iva.Siva(
        mass=1e-9, restitution=0.5, clearance=1.0, friction=k, inclination_deg=degrees
    )
    start = iva.Start(gap_velocity=speed, gap_displacement=0.0)
    run = iva.simulate(absorber, structure, start=start, duration=5.0, verify=True)
    angle = math.radians(degrees)
    deceleration = G * (k * math.cos(angle) + math.sin(angle))
    end = run.at([4.0])
    assert end["gap_displacement"].item() == pytest.approx(speed**2 / (2 * deceleration), rel=1e-13)
    assert end["gap_velocity"].item() == 0.0
    row = run.summary.row(0, named=True)
    assert (row["stops"], row["impacts"], row["outcome"]) == (1, 0, "finished")
    assert row["time_held"] == pytest.approx(5.0 - speed / deceleration, rel=1e-13)
    lost = 1e-9 * k * G * math.cos(angle) * speed**2 / (2 * deceleration)
    # The energies are those of a structure of 10⁹ kg in units in which they cancel.
    assert row["energy_friction"] == pytest.approx(lost, rel=1e-9)
    assert (
        run.verification.findings["rows"].to_list() == run.verification.findings["alike"].to_list()
    )


def integrated(
    absorber: iva.Siva, force: tuple[float, float], x0: float, end: float
) -> list[Array]:
    """Return instant, wall (0: a stop) and state of all events, one after the other by DOP853."""
    mass, stiffness, m = 100.0, 90e3, 10.0
    damping = 2 * 0.01 * math.sqrt(stiffness * mass)
    e, d = float(absorber.restitution or 0.0), float(absorber.clearance or 0.0)
    r = float(absorber.friction or 0.0) * G
    amplitude, omega = force

    def push(t: float, x: float, v: float) -> float:
        return amplitude * math.cos(omega * t) - stiffness * x - damping * v

    def sliding(s: float) -> Any:
        def rates(t: float, z: Array) -> list[float]:
            a = (push(t, z[0], z[1]) + m * r * s) / mass
            return [z[1], a, z[3], -r * s - a]

        return rates

    def held(t: float, z: Array) -> list[float]:
        return [z[1], push(t, z[0], z[1]) / (mass + m), 0.0, 0.0]

    t, z, found = 0.0, np.array([x0, 0.0, 0.0, 0.0]), []
    mode = 0.0
    while t < end:
        a = push(t, z[0], z[1]) / (mass + m)
        if z[3] == 0.0 and abs(a) <= r * (1 + 1e-12) and mode == 0.0:

            def slips(t: float, z: Array) -> float:
                return abs(push(t, z[0], z[1]) / (mass + m)) - r

            slips.terminal, slips.direction = True, 1.0  # type: ignore[attr-defined]
            events: list[Any] = [slips]
            rates = held
        else:
            mode = math.copysign(1.0, z[3] if z[3] != 0.0 else -a)

            def plus(_: float, z: Array) -> float:
                return float(d - z[2])

            def minus(_: float, z: Array) -> float:
                return float(d + z[2])

            def stops(_: float, z: Array, s: float = mode) -> float:
                return float(s * z[3])

            for event in (plus, minus, stops):
                event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
            events = [plus, minus, stops]
            rates = sliding(mode)
        step = solve_ivp(
            rates, (t, end), z, "DOP853", events=events, rtol=1e-13, atol=1e-16, max_step=1e-3
        )
        t, z = float(step.t[-1]), step.y[:, -1].copy()
        if step.status == 0:
            break
        if rates is held:
            mode = -math.copysign(1.0, push(t, z[0], z[1]))
            # So that the next slide begins with this direction.
            z[3] = mode * 1e-300
            continue
        which = next(index for index, times in enumerate(step.t_events) if len(times))
        if which == 2:
            z[3], mode = 0.0, 0.0
            found.append(np.array([t, 0.0, *z]))
            continue
        found.append(np.array([t, 1.0 - 2.0 * which, *z]))
        w = z[3]
        z[1] += m * (1 + e) * w / (mass + m)
        z[3] = -e * w
        mode = 0.0
    return found


@pytest.mark.parametrize(
    ("friction", "force", "x0"),
    [(0.05, (0.0, 1.0), 0.025), (0.3, (200.0, 28.0), 0.0), (0.5, (400.0, 33.0), 0.004)],
)
def test_events_are_those_of_an_integrator(
    friction: float, force: tuple[float, float], x0: float
) -> None:
    absorber = siva(friction=friction)
    drive = iva.Harmonic(force=force[0], frequency=force[1])
    run = iva.simulate(
        absorber,
        PRIMARY,
        start=iva.Start(displacement=x0),
        force=drive if force[0] else None,
        duration=1.2,
    )
    found = integrated(absorber, force, x0, 1.2)
    hits = np.array([event for event in found if event[1] != 0.0])
    assert run.impacts.height == len(hits)
    assert run.impacts["wall"].to_list() == hits[:, 1].tolist()
    # An integrator is late by its tolerance over the approach speed.
    assert np.abs(run.impacts["time"].to_numpy() - hits[:, 0]).max() < 1e-8
    assert run.summary["stops"].item() == sum(event[1] == 0.0 for event in found) > 2
    row = run.summary.row(0, named=True)
    assert abs(row["energy_residual"]) < 1e-13 * max(row["energy_initial"], row["energy_work"])
    assert row["energy_friction"] > 0.0


def test_no_friction_is_none() -> None:
    without = iva.simulate(siva(friction=None), PRIMARY, start=START, periods=10)
    none = iva.simulate(siva(friction=0.0), PRIMARY, start=START, periods=10)
    assert_frame_equal(none.impacts, without.impacts, check_exact=True)
    assert none.summary.select("energy_friction", "stops", "time_held").row(0) == (0.0, 0, 0.0)


def test_a_decay_ends() -> None:
    """Then the mass is held, and the structure swings as one with it."""
    run = iva.simulate(siva(), PRIMARY, start=START, periods=120)
    end = run.summary["time_held"].item()
    last = run.at([run.trajectory()["time"][-1]])
    assert last["gap_velocity"].item() == 0.0
    assert end > 10.0
    free = iva.simulate(siva(friction=None), PRIMARY, start=START, periods=120)
    assert free.summary["time_held"].item() == 0.0
    assert pickle.loads(pickle.dumps(run)).summary.equals(run.summary)


def test_sweeps_gradients_and_studies() -> None:
    over = {"friction": [0.0, 0.02, 0.1], "clearance": [0.01, 0.02]}
    table = iva.sweep(
        siva(), PRIMARY, start=START, periods=10, over=over, tables=["summary", "impacts"]
    )
    for point, (friction, clearance) in enumerate(
        (f, c) for f in over["friction"] for c in over["clearance"]
    ):
        alone = iva.simulate(
            siva(friction=friction, clearance=clearance), PRIMARY, start=START, periods=10
        )
        swept = table.impacts.filter(pl.col("point") == point).drop("point")
        assert_frame_equal(swept, alone.impacts.drop("point"), check_exact=True)
    by = 1e-7
    found = iva.simulate(siva(), PRIMARY, start=START, periods=2, gradients=["friction"])
    lower, upper = (
        iva.simulate(siva(friction=0.05 + off), PRIMARY, start=START, periods=2)
        .impacts["time"]
        .to_numpy()
        for off in (-by, by)
    )
    told = found.gradients["friction"].impacts["time"].to_numpy()
    assert np.abs(told - (upper - lower) / (2 * by)).max() < 1e-4 * np.abs(told).max()


def test_estimated_errors_are_no_smaller_than_the_true_ones() -> None:
    """Those of `verify`, and the condition tells what a displaced start moves."""
    run = iva.simulate(siva(), PRIMARY, start=START, periods=10, errors=True, verify=True)
    assert (run.verification.impacts["time"].abs() <= run.impacts["time_error"]).all()
    row = run.summary.row(0, named=True)
    assert row["stops"] > 0
    assert row["digits"] > 10
    share = 1e-9
    displaced = iva.Start(displacement=0.025 * (1 + share))
    moved = iva.simulate(siva(), PRIMARY, start=displaced, periods=10).impacts["time"]
    largest = np.abs((moved - run.impacts["time"]).to_numpy()).max()
    assert 0.0 < largest * 30.0 < 1.01 * share * row["condition"]


MODES = iva.Structure(
    frequencies=[30.0, 110.0],
    damping_ratios=[0.01, 0.01],
    points={"top": [0.1, 0.07], "middle": [0.06, -0.09]},
    absorber_at=["top", "middle"],
    start_displacements=[0.25, 0.02],
)


@pytest.mark.parametrize("structure", [PRIMARY, MODES])
@pytest.mark.parametrize("more", [{}, {"gap_damping": 4.0}, {"spring": 900.0}])
def test_errors_of_masses_that_rub_together(structure: Any, more: dict[str, float]) -> None:
    """Two masses, level and inclined: true errors, from twice the precision, are as estimated."""
    start = START if structure is PRIMARY else iva.Start()
    pair = [siva(**more), siva(mass=6.0, clearance=0.008, inclination_deg=3.0)]
    run = iva.simulate(pair, structure, start=start, duration=1.5, errors=True, verify=True)
    row = run.summary.row(0, named=True)
    assert row["stops"] > 10
    assert set(run.impacts["absorber"]) == {0, 1}
    assert (run.verification.impacts["time"].abs() <= run.impacts["time_error"]).all()
    assert abs(row["energy_residual"]) < 1e-13 * row["energy_initial"]
    if structure is PRIMARY:
        lost = split_of(run)
        assert lost.layers["friction"][-1] == pytest.approx(row["energy_friction"], rel=1e-3)


def test_held_masses_slide_when_another_is_struck() -> None:
    """Friction holds a mass until the blow of another, and a sweep tells what a run tells."""
    pair = [siva(friction=0.6), siva(friction=0.0, gravity=None, restitution=0.9)]
    over = {"absorber.0.friction": [0.3, 0.6]}
    swept = iva.sweep(pair, PRIMARY, over=over, start=iva.Start(displacement=0.03), duration=2.0)
    run = iva.simulate(pair, PRIMARY, start=iva.Start(displacement=0.03), duration=2.0)
    row, point = run.summary.row(0, named=True), swept.summary.row(1, named=True)
    assert row["time_held"] > 0.1
    assert row["stops"] > 2
    for name in ("time_held", "stops", "energy_friction", "impacts"):
        assert row[name] == point[name]


def test_more_friction_at_rest_than_in_a_slide() -> None:
    """A mass thrown up a slope stays where it stops; with less at rest it slides back."""
    k, speed, degrees = 0.05, 0.7, 6.0
    structure = iva.Primary(mass=1e9, stiffness=1e9)
    angle = math.radians(degrees)
    start = iva.Start(gap_velocity=speed, gap_displacement=0.0)
    up = speed / (G * (math.sin(angle) + k * math.cos(angle)))

    def thrown(at_rest: float | None) -> iva.Run:
        absorber = iva.Siva(
            mass=1e-9,
            restitution=0.5,
            clearance=2.0,
            friction=k,
            static_friction=at_rest,
            inclination_deg=degrees,
        )
        return iva.simulate(absorber, structure, start=start, duration=2.0, verify=True)

    # tan 6° = 0.105 lies between the two coefficients.
    held, back = thrown(0.2), thrown(None)
    row = held.summary.row(0, named=True)
    assert (row["stops"], row["impacts"]) == (1, 0)
    assert row["time_held"] == pytest.approx(2.0 - up, rel=1e-13)
    assert back.summary["time_held"].item() == 0.0
    later = 2.0 - up
    fallen = 0.5 * G * (math.sin(angle) - k * math.cos(angle)) * later**2
    expected = speed * up / 2 - fallen
    assert back.at([2.0])["gap_displacement"].item() == pytest.approx(expected, rel=1e-12)
    # The same coefficient at rest is that of the slide: the scene is the same.
    same = thrown(k)
    assert_frame_equal(same.summary, back.summary)


def test_errors_and_gradients_know_the_friction_at_rest() -> None:
    """The jump with which a slide begins is in errors and derivatives: beside differences."""

    def ran(at_rest: float, **asked: Any) -> iva.Run:
        absorber = siva(static_friction=at_rest)
        return iva.simulate(absorber, PRIMARY, start=START, periods=4, **asked)

    run = ran(0.15, verify=True, errors=True, gradients=["static_friction"])
    assert run.summary["stops"].item() > 3
    assert (run.verification.impacts["time"].abs() <= run.impacts["time_error"]).all()
    step = 1e-6
    more, less = (ran(0.15 + sign * step).impacts["time"].to_numpy() for sign in (1, -1))
    told = run.gradients["static_friction"].impacts["time"].to_numpy()
    assert len(more) == len(less) == len(told) > 3
    by_differences = (more - less) / (2 * step)
    assert np.abs(told - by_differences).max() < 1e-4 * max(np.abs(told).max(), 1e-3)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (
            lambda: iva.simulate(
                iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5, friction=0.1),
                iva.Primary(),
                start=iva.Start(displacement=1.0),
                periods=1,
            ),
            "absorber.gravity is missing",
        ),
        (lambda: siva(friction=-0.1), "friction = -0.1: give"),
        (
            lambda: iva.simulate(siva(static_friction=0.04), PRIMARY, start=START, periods=1),
            r"absorber.static_friction = 0.04: give at least friction, which is 0.05",
        ),
        (
            lambda: iva.simulate(
                siva(friction=None, static_friction=0.1), PRIMARY, start=START, periods=1
            ),
            r"absorber.static_friction = 0.1: give friction too",
        ),
    ],
)
def test_what_friction_does_not_go_with(call: Any, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        call()


@pytest.mark.parametrize("degrees", [0.0, 2.0])
def test_the_losses_in_friction_are_drawn(degrees: float) -> None:
    """All energies of a decay together are the initial one."""
    start = iva.Start(displacement=0.025, gap_displacement=0.0)
    run = iva.simulate(siva(inclination_deg=degrees), PRIMARY, start=start, periods=12)
    split = split_of(run)
    assert list(split.layers) == ["structure", "absorber", "damper", "impacts", "friction"]
    lost = run.summary["energy_friction"].item()
    assert split.layers["friction"][-1] == pytest.approx(lost, rel=1e-3)
    assert np.abs(split.total / split.total[0] - 1.0).max() < 1e-4
