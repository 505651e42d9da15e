"""Pivots of pendulums that rub, and that move up and down.

Numbers come from pencil and paper (small swings below a structure that hardly moves), from
Lagrange's equations of structure and pendulum, which SciPy's DOP853 integrates from event to event,
and from the characteristic values of Mathieu's equation.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import mathieu_a, mathieu_b

import iva
from iva.design import design_of
from iva.plots.energy_split import split_of

mpl.use("Agg")

pytestmark = pytest.mark.usefixtures("pictures_are_closed")

Array = Any
MU, LENGTH, KAPPA, CONTACT = 0.2, 1.0, 1.2, 0.8
RATIO, RESTITUTION, CLEARANCE, DAMPING = 0.7, 0.6, 0.5, 0.01
#: g of these, in natural units.
GRAVITY = KAPPA * LENGTH * RATIO**2


def hanging(friction: float | None = None, **more: Any) -> iva.Piva:
    return iva.Piva(
        mass_ratio=MU,
        restitution=RESTITUTION,
        clearance=CLEARANCE,
        frequency_ratio=RATIO,
        length=LENGTH,
        inertia_ratio=KAPPA,
        contact_distance=CONTACT,
        friction=friction,
        **more,
    )


def ends_at(event: Any, direction: float) -> Any:
    """Return an event that ends the integration where it crosses 0 this way."""
    event.terminal, event.direction = True, direction
    return event


def integrated(
    rubs: tuple[float, float],
    rise: float,
    push: tuple[float, float],
    start: list[float],
    end: float,
    sides: tuple[float, ...] = (-1.0, 1.0),
    clearance: float = CLEARANCE,
) -> tuple[list[float], list[float], int]:
    """Return the instants of impacts and stops, and how often the pendulum was held.

    States are x, v, θ, θ̇; f is cos Ωt. The structure moves along a line that rises, and x is 0
    where it rests under the weight.
    """
    amplitude, omega = push
    own, weight = MU * KAPPA * LENGTH**2, MU * GRAVITY * LENGTH
    limits = [moment * weight for moment in rubs]

    def pushed(t: float, state: Array) -> float:
        x, v, _, _ = state
        return float(amplitude * math.cos(omega * t) - x - 2 * DAMPING * v)

    def swing(t: float, state: Array, sign: float) -> list[float]:
        _, v, angle, rate = state
        across = MU * LENGTH * math.cos(angle - rise)
        matrix = [[1 + MU, across], [across, own]]
        forces = [
            pushed(t, state) + MU * LENGTH * rate**2 * math.sin(angle - rise),
            -weight * math.sin(angle) - limits[0] * sign,
        ]
        acceleration = np.linalg.solve(matrix, forces)
        return [v, acceleration[0], rate, acceleration[1]]

    def ride(t: float, state: Array) -> list[float]:
        return [state[1], pushed(t, state) / (1 + MU), 0.0, 0.0]

    def turning(t: float, state: Array) -> float:
        """Return the moment that friction has to carry."""
        angle = state[2]
        shaken = MU * LENGTH * math.cos(angle - rise) * pushed(t, state) / (1 + MU)
        return -shaken - weight * math.sin(angle)

    t, state = 0.0, np.array(start)
    impacts: list[float] = []
    stops: list[float] = []
    holds = 0
    wall = math.asin(clearance / CONTACT)
    precise: dict[str, Any] = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14, "max_step": 0.05}

    def begin(t: float, state: Array) -> float:
        if state[3] != 0.0:
            return math.copysign(1.0, state[3])
        moment = turning(t, state)
        return 0.0 if abs(moment) <= limits[1] else math.copysign(1.0, moment)

    sign = begin(t, state)
    while t < end:
        if sign == 0.0:
            holds += 1

            def slips(t: float, state: Array) -> float:
                return limits[1] - abs(turning(t, state))

            found = solve_ivp(ride, (t, end), state, events=[ends_at(slips, -1.0)], **precise)
            t, state = float(found.t[-1]), found.y[:, -1].copy()
            if found.status == 1:
                sign = math.copysign(1.0, turning(t, state))
            continue

        def stop(_t: float, state: Array) -> float:
            return float(state[3])

        def meets(_t: float, state: Array, sign: float = sign) -> float:
            return float(wall - sign * state[2]) if sign in sides else 1.0

        found = solve_ivp(
            lambda t, state, sign=sign: swing(t, state, sign),
            (t, end),
            state,
            events=[ends_at(stop, -sign), ends_at(meets, -1.0)],
            **precise,
        )
        t, state = float(found.t[-1]), found.y[:, -1].copy()
        if found.status != 1:
            break
        if found.t_events[1].size:
            impacts.append(t)
            share = MU * LENGTH * math.cos(state[2] - rise) / (1 + MU)
            state[1] += share * (1 + RESTITUTION) * state[3]
            state[3] *= -RESTITUTION
        else:
            stops.append(t)
            state[3] = 0.0
        sign = begin(t, state)
    return impacts, stops, holds


@pytest.mark.parametrize(
    ("rubs", "rise", "push"),
    [
        ((0.05, 0.05), 0.0, (0.0, 1.0)),
        ((0.1, 0.1), 0.0, (0.12, 0.9)),
        ((0.3, 0.4), 0.0, (1.0, 0.6)),
        ((0.2, 0.2), 0.0, (0.1, 1.05)),
        ((0.0, 0.0), 0.4, (0.2, 0.9)),
        ((0.05, 0.05), 1.1, (0.3, 1.1)),
        ((0.02, 0.03), 1.1, (0.0, 1.0)),
        ((0.0, 0.0), math.pi / 2, (0.6, 1.3)),
    ],
)
def test_the_swing_is_that_of_lagranges_equations(
    rubs: tuple[float, float], rise: float, push: tuple[float, float]
) -> None:
    start = [1.0, 0.0, 0.3, 0.0]
    end = 60.0
    impacts, stops, holds = integrated(rubs, rise, push, start, end)
    force = iva.Harmonic(amplitude=push[0], frequency=push[1]) if push[0] else None
    rubbing = {"friction": rubs[0], "static_friction": rubs[1]} if rubs[0] else {}
    run = iva.simulate(
        hanging(inclination=rise, **rubbing),
        iva.Primary(damping_ratio=DAMPING),
        start=iva.Start(displacement=1.0, angle=0.3),
        force=force,
        duration=end,
    )
    row = run.summary.row(0, named=True)
    times = run.impacts["time"].to_numpy()
    assert len(times) == len(impacts) > 3
    assert np.abs(times - impacts).max() < 1e-8
    if rubs[0]:
        assert row["stops"] == len(stops) >= 3
        assert row["energy_friction"] > 0.0
    assert abs(row["energy_residual"]) < 1e-12
    assert (row["time_held"] > 0.0) == (holds > 0)


def trace_after_a_period(a: float, q: float) -> float:
    """Return the trace of the monodromy of small swings on an upright motion X cos Ωt."""
    omega = 2 * RATIO / math.sqrt(a)
    motion = 0.5 * q * KAPPA * LENGTH
    damper = hanging(inclination_deg=90.0)
    small, trace = 1e-7, 0.0
    for angle, rate in ((small, 0.0), (0.0, small)):
        run = iva.simulate(
            dataclasses.replace(damper, mass_ratio=1e-12),
            iva.Primary(damping_ratio=0.0),
            start=iva.Start(displacement=motion, angle=angle, angular_velocity=rate),
            force=iva.Harmonic(amplitude=motion * (1 - omega**2), frequency=omega),
            duration=2 * math.pi / omega,
        )
        last = run.trajectory().row(-1, named=True)
        trace += last["angle"] / small if angle else last["angular_velocity"] / small
    return trace


@pytest.mark.parametrize("q", [0.05, 0.3, 0.8])
def test_an_upright_motion_has_the_stability_boundaries_of_mathieu(q: float) -> None:
    # On the boundaries of the first tongue both multipliers are -1, on those of the second 1.
    lower, upper = mathieu_b(1, q), mathieu_a(1, q)
    for a in (lower, upper):
        assert abs(trace_after_a_period(a, q) + 2) < 2e-11
    for a in (mathieu_b(2, q), mathieu_a(2, q)):
        assert abs(trace_after_a_period(a, q) - 2) < 2e-11
    middle, wide = 0.5 * (lower + upper), upper - lower
    assert trace_after_a_period(middle, q) < -2 - 2 * q**2
    for a in (lower - 0.01 * wide, upper + 0.01 * wide):
        assert trace_after_a_period(a, q) > -2


@pytest.mark.parametrize("rise", [0.0, 0.7])
def test_one_stop_leaves_the_other_side_free(rise: float) -> None:
    start, push, end = [0.3, 0.0, -0.6, 0.0], (0.1, 1.05), 40.0
    impacts, _, _ = integrated((0.0, 0.0), rise, push, start, end, (1.0,), 0.1)
    run = iva.simulate(
        dataclasses.replace(hanging(inclination=rise, walls="plus"), clearance=0.1),
        iva.Primary(damping_ratio=DAMPING),
        start=iva.Start(displacement=start[0], angle=start[2]),
        force=iva.Harmonic(amplitude=push[0], frequency=push[1]),
        duration=end,
    )
    times = run.impacts["time"].to_numpy()
    assert len(times) == len(impacts) > 5
    assert np.abs(times - impacts).max() < 1e-8
    assert run.impacts["wall"].unique().to_list() == [1]
    assert run.trajectory()["gap_displacement"].to_numpy().min() < -0.3
    assert abs(run.summary["energy_residual"][0]) < 1e-12


def test_beyond_the_horizontal_a_run_ends_and_says_so() -> None:
    for rate, outcome in ((1.0, "finished"), (3.0, "not_finite")):
        run = iva.simulate(
            hanging(walls="plus"),
            iva.Primary(damping_ratio=DAMPING),
            start=iva.Start(displacement=0.1, angular_velocity=-rate),
            duration=40.0,
        )
        assert run.summary["outcome"][0] == outcome


@pytest.mark.parametrize("upwards", [True, False])
def test_a_kick_upright_presses_a_pendulum_on_its_stop_or_throws_it_off(upwards: bool) -> None:
    """Closed form: it hangs on a stop at θ < 0, where an upward kick turns it towards that stop."""
    place, kick = -0.2, 0.1 if upwards else -0.1
    sine = place / CONTACT
    run = iva.simulate(
        dataclasses.replace(
            hanging(inclination_deg=90.0, gap_offset=-0.4, walls="plus"), clearance=0.2
        ),
        iva.Primary(damping_ratio=0.0),
        start=iva.Start(displacement=0.0, gap_displacement=place),
        force=iva.Impulse(velocity=kick, time=0.5),
        duration=0.6,
    )
    after = run.at([0.5]).row(0, named=True)
    # Of a pendulum in flight the part μ (1 − γ²/κ) goes along, γ = sin θ.
    carried = MU if upwards else MU * (1 - sine**2 / KAPPA)
    assert abs(after["velocity"] - kick / (1 + carried)) < 1e-14
    thrown = 0.0 if upwards else -sine * after["velocity"] / (KAPPA * LENGTH)
    assert abs(after["angular_velocity"] - thrown) < 1e-14
    assert (run.summary["time_stuck"][0] == 0.6) is upwards


def rising(**more: Any) -> iva.Run:
    return iva.simulate(
        hanging(inclination=0.9, **more),
        iva.Primary(damping_ratio=DAMPING),
        start=iva.Start(displacement=1.0, angle=0.3),
        duration=30.0,
    )


def test_the_bob_moves_along_the_line_in_tables_and_pictures() -> None:
    run = rising(pivot_damping_ratio=0.02)
    design, motion = design_of(run), run.trajectory()
    columns = {name: column.to_numpy() for name, column in motion.to_dict().items()}
    _, beside = design.beside(columns)
    velocity = columns["velocity"] + beside
    assert run.impacts.height > 3
    for impact in run.impacts.iter_rows(named=True):
        before, after = np.flatnonzero(columns["time"] == impact["time"])[:2]
        assert abs(velocity[before] - impact["absorber_velocity_before"]) < 1e-13
        assert abs(velocity[after] - impact["absorber_velocity_after"]) < 1e-13
    # Displacements are those whose rate the velocities are.
    steps = np.diff(columns["time"])
    flown = (steps > 0.0) & (steps < 0.05)
    mean = 0.5 * (velocity[1:] + velocity[:-1])
    moved = np.diff(columns["displacement"] + design.beside(columns)[0])
    assert np.abs(moved - mean * steps)[flown].max() < 1e-4
    split = split_of(run)
    assert np.abs(split.total - split.total[0]).max() < 1e-8 * split.total[0]
    with pytest.raises(ValueError, match="rises"):
        iva.plots.animation(run)


def test_gradients_by_the_inclination_are_those_of_differences() -> None:
    def of(degrees: float) -> iva.Run:
        return iva.simulate(
            hanging(inclination_deg=degrees),
            iva.Primary(damping_ratio=DAMPING),
            start=iva.Start(displacement=1.0, angle=0.3),
            duration=12.0,
            gradients=["absorber.inclination_deg"],
        )

    step = 1e-4
    low, middle, high = (of(50.0 + shift) for shift in (-step, 0.0, step))
    times = [run.impacts["time"].to_numpy() for run in (low, high)]
    assert len(times[0]) > 2
    told = middle.gradients["absorber.inclination_deg"].impacts["time"].to_numpy()
    assert np.abs((times[1] - times[0]) / (2 * step) - told).max() < 1e-7


def test_walls_that_are_not_there_are_not_drawn() -> None:
    for walls, count in (("both", 2), ("plus", 1)):
        run = iva.simulate(
            hanging(walls=walls),
            iva.Primary(damping_ratio=DAMPING),
            start=iva.Start(displacement=0.3, angle=-0.3),
            duration=10.0,
        )
        axes = iva.plots.phase(run, relative=True)
        hatched = [patch for patch in axes.patches if patch.get_hatch()]
        assert len(hatched) == count
    with pytest.raises(ValueError, match="one wall"):
        iva.plots.animation(run)
    stop = iva.simulate(
        iva.Stop(clearance=0.5, restitution=0.8),
        iva.Primary(damping_ratio=DAMPING),
        start=iva.Start(velocity=1.0),
        duration=10.0,
    )
    columns = {name: column.to_numpy() for name, column in stop.trajectory().to_dict().items()}
    _, beside = design_of(stop).beside(columns)
    assert np.abs(columns["velocity"] + beside).max() == 0.0
    with pytest.raises(ValueError, match="on the ground"):
        iva.plots.animation(stop)


def test_friction_holds_up_to_its_angle() -> None:
    for angle, held in ((0.0999, True), (0.1002, False)):
        run = iva.simulate(
            hanging(math.sin(0.1)),
            iva.Primary(damping_ratio=DAMPING),
            start=iva.Start(angle=angle),
            duration=20.0,
        )
        assert (run.summary["time_held"][0] == 20.0) is held


def test_units_lists_and_sweeps_take_it() -> None:
    damper = hanging(0.08)
    mass = iva.Siva(mass_ratio=0.05, restitution=0.5, clearance=0.3)
    primary = iva.Primary(damping_ratio=DAMPING)
    common: dict[str, Any] = {"start": iva.Start(displacement=1.0, angle=0.2), "duration": 30.0}
    run = iva.simulate([damper, mass], primary, **common)
    assert run.summary["energy_friction"][0] > 0.0
    assert abs(run.summary["energy_residual"][0]) < 1e-12
    swept = iva.sweep(
        damper, primary, over={"absorber.friction": [0.0, 0.08], "absorber.units": [1, 2]}, **common
    )
    taken = swept.summary["energy_friction"].to_list()
    assert len(taken) == 4
    assert sum(energy > 0.0 for energy in taken) == 2
    alone = iva.simulate(damper, primary, verify=True, **common)
    assert alone.summary["energy_friction"][0] in taken
    assert alone.verification.agrees
    assert np.abs(alone.verification.impacts["time"].to_numpy()).max() < 1e-12


def test_what_is_missing_is_said() -> None:
    small = iva.Piva(
        mass_ratio=0.1,
        restitution=0.5,
        clearance=0.5,
        frequency_ratio=0.7,
        angles="small",
        friction=0.1,
    )
    with pytest.raises(ValueError, match="length"):
        iva.simulate(small, iva.Primary(), start=iva.Start(displacement=1.0), duration=10.0)
    with pytest.raises(ValueError, match="give at least friction"):
        iva.simulate(
            hanging(0.2, static_friction=0.1),
            iva.Primary(),
            start=iva.Start(displacement=1.0),
            duration=10.0,
        )
