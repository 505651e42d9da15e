"""A linear dashpot in the gap of a free mass, as studies and Python give it.

Numbers come from SciPy's DOP853 with events of its own and from closed forms. The core is compared
with another implementation and with itself in twice the precision.
"""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polars.testing import assert_frame_equal
from scipy.integrate import solve_ivp

import iva
from iva.plots.energy_split import split_of

Array = NDArray[np.float64]

PRIMARY = iva.Primary(mass=100.0, stiffness=90e3, damping_ratio=0.01)
START = iva.Start(displacement=0.025)


def siva(**more: Any) -> iva.Siva:
    """Return a free mass with a dashpot."""
    given = {"mass": 10.0, "restitution": 0.6, "clearance": 0.01, "gap_damping": 8.0} | more
    return iva.Siva(**given)


def integrated(force: tuple[float, float], x0: float, end: float) -> list[Array]:
    """Return instant, wall and state before each impact, one after the other by DOP853."""
    big, stiffness, m, c, e, d = 100.0, 90e3, 10.0, 8.0, 0.6, 0.01
    damping = 2 * 0.01 * math.sqrt(stiffness * big)
    amplitude, omega = force

    def rates(t: float, z: Array) -> list[float]:
        pull = c * z[3]
        a = (amplitude * math.cos(omega * t) - stiffness * z[0] - damping * z[1] + pull) / big
        return [z[1], a, z[3], -pull / m - a]

    def plus(_: float, z: Array) -> float:
        return float(d - z[2])

    def minus(_: float, z: Array) -> float:
        return float(d + z[2])

    for event in (plus, minus):
        event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
    t, z = 0.0, np.array([x0, 0.0, 0.0, 0.0])
    found: list[Array] = []
    while True:
        step = solve_ivp(rates, (t, end), z, "DOP853", events=[plus, minus], rtol=1e-13, atol=1e-16)
        t, z = float(step.t[-1]), step.y[:, -1].copy()
        if step.status == 0:
            return found
        wall = 1 if len(step.t_events[0]) else -1
        found.append(np.array([t, wall, *z]))
        gained = m / (big + m) * (1 + e) * z[3]
        z[1], z[2], z[3] = z[1] + gained, wall * d, -e * z[3]


@pytest.mark.parametrize("force", [(0.0, 1.0), (400.0, 29.0)])
def test_impacts_are_those_of_an_integrator(force: tuple[float, float]) -> None:
    """Instants, walls and velocities of the first impacts."""
    drive = iva.Harmonic(force=force[0], frequency=force[1]) if force[0] else None
    run = iva.simulate(siva(), PRIMARY, start=START, duration=1.0, force=drive)
    truth = integrated(force, 0.025, 1.0)
    rows = run.impacts.filter(run.impacts["approach_velocity"].abs() > 1e-3)
    assert len(truth) > 8
    for row, (t, wall, _, v, _, w) in zip(rows.to_dicts(), truth[:8], strict=False):
        assert row["time"] == pytest.approx(t, abs=1e-9)
        assert row["wall"] == wall
        assert row["velocity_before"] == pytest.approx(v, abs=1e-8)
        assert row["approach_velocity"] == pytest.approx(w, abs=1e-8)
    assert run.summary["energy_pivot"].item() > 0.0


def test_the_mass_slows_down_by_stokes_law() -> None:
    """w₀ e^(−ct/m) on a structure too heavy to move, far from the walls."""
    heavy = iva.Primary(mass=1e12, stiffness=1e12)
    absorber = iva.Siva(mass=2.0, restitution=0.5, clearance=100.0, gap_damping=0.6)
    start = iva.Start(gap_velocity=0.4)
    run = iva.simulate(absorber, heavy, start=start, duration=5.0)
    end = run.at([4.0])
    assert end["gap_velocity"].item() == pytest.approx(0.4 * math.exp(-0.3 * 4.0), rel=1e-10)
    way = 0.4 / 0.3 * (1 - math.exp(-0.3 * 4.0))
    assert end["gap_displacement"].item() == pytest.approx(way, rel=1e-10)


def test_ratio_and_constant_are_one_and_natural_units_take_the_ratio() -> None:
    """The constant is 2 M ωn times the ratio, which natural units take alone."""
    ratio = 8.0 / (2 * 100.0 * 30.0)
    one = iva.simulate(siva(), PRIMARY, start=START, periods=4)
    other = siva(gap_damping=None, gap_damping_ratio=ratio)
    two = iva.simulate(other, PRIMARY, start=START, periods=4)
    assert_frame_equal(one.impacts, two.impacts, rel_tol=1e-9)
    bare = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.4, gap_damping_ratio=ratio)
    natural = iva.simulate(
        bare, iva.Primary(damping_ratio=0.01), start=iva.Start(displacement=1.0), periods=4
    )
    assert natural.impacts["time"].to_numpy() / 30.0 == pytest.approx(
        one.impacts["time"].to_numpy(), rel=1e-8
    )


def test_everything_that_a_run_has() -> None:
    """Ledger, verification, errors, gradients, sweeps, reductions, energies and pickling."""
    force = iva.Harmonic(force=400.0, frequency=29.0)
    run = iva.simulate(
        siva(), PRIMARY, start=START, periods=6, verify=True, errors=True, gradients=["gap_damping"]
    )
    row = run.summary.row(0, named=True)
    assert abs(row["energy_residual"]) < 1e-12 * row["energy_initial"]
    assert run.verification.agrees
    # The rounding to seconds is not that of the run.
    rounded = run.impacts["time_error"] + 3e-16 * run.impacts["time"]
    assert (run.verification.impacts["time"].abs() <= rounded).all()
    by = 1e-5
    lower, upper = (
        iva.simulate(siva(gap_damping=8.0 + off), PRIMARY, start=START, periods=2)
        .impacts["time"]
        .to_numpy()
        for off in (-by, by)
    )
    told = run.gradients["gap_damping"].impacts["time"].to_numpy()[: len(lower)]
    assert np.abs(told - (upper - lower) / (2 * by)).max() < 1e-4 * np.abs(told).max()
    split = split_of(iva.simulate(siva(), PRIMARY, start=START, periods=6))
    assert split.layers["dashpot"][-1] == pytest.approx(row["energy_pivot"], rel=1e-4)
    reductions = [
        iva.simulate(siva(gap_damping=c), PRIMARY, start=START, force=force, cycles=40, tables=())
        .summary["reduction"]
        .item()
        for c in (0.0, 1e-12)
    ]
    assert reductions[1] == pytest.approx(reductions[0], rel=1e-6)
    table = iva.sweep(
        siva(gap_damping=None),
        PRIMARY,
        over={"gap_damping": [0.0, 4.0, 8.0]},
        start=START,
        periods=4,
    )
    free = iva.simulate(siva(gap_damping=None), PRIMARY, start=START, periods=4).summary
    columns = ["impacts", "energy_impacts", "energy_viscous", "energy_final"]
    assert table.summary.select(columns).row(0) == free.select(columns).row(0)
    assert pickle.loads(pickle.dumps(siva())) == siva()


def test_with_others_and_on_modes() -> None:
    """Units share the dashpot; on a structure of one mode the run is that of the primary."""
    shared = iva.simulate(siva(units=2, gap_damping=8.0), PRIMARY, start=START, periods=3)
    half = siva(mass=5.0, gap_damping=4.0)
    listed = iva.simulate([half, half], PRIMARY, start=START, periods=3)
    assert shared.impacts["time"].to_list() == listed.impacts["time"].to_list()
    structure = iva.Structure(
        points=["top"], mass=[[100.0]], stiffness=[[90e3]], damping=[[60.0]], base=[1.0]
    )
    one = iva.simulate(siva(), PRIMARY, start=START, periods=3).impacts
    modal = iva.simulate(siva(), structure, start=START, periods=3).impacts
    assert modal["time"].to_numpy() == pytest.approx(one["time"].to_numpy(), rel=1e-9)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: siva(gap_damping=-1.0), "gap_damping = -1: give"),
        (lambda: siva(gap_damping_ratio=0.1), "gap_damping is given as well"),
        (
            lambda: iva.simulate(
                iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5, gap_damping=0.1),
                iva.Primary(),
                start=iva.Start(displacement=1.0),
                periods=1,
            ),
            "or give gap_damping_ratio",
        ),
    ],
)
def test_what_does_not_fit_is_told(call: Any, told: str) -> None:
    """One sentence with field, value and what is allowed."""
    with pytest.raises(ValueError, match=told):
        call()


def test_twins_meet_their_wall_at_once() -> None:
    # Two alike masses with a dashpot, let go together by one wall: by symmetry they have all later
    # impacts at one instant, between the same velocities of the structure.
    d = 0.12205215165205067
    twin = iva.Siva(
        mass_ratio=0.12979447912416206,
        clearance=d,
        restitution=0.0,
        gap_damping_ratio=0.01579538227603441,
    )
    run = iva.simulate(
        [twin, twin],
        iva.Primary(damping_ratio=1.3746756577759809),
        start=iva.Start(
            displacement=1.0,
            velocity=0.19912179299159805,
            gap_displacement=[-d, -0.026230555247999908],
            gap_velocity=[-0.9847634621607204, 0.0],
            time=1.315297948962525,
        ),
        force=[
            iva.Harmonic(amplitude=0.027021223274406158, frequency=0.32174548022573224),
            iva.Harmonic(
                amplitude=0.028004784816677876,
                frequency=1.3000352794965067,
                phase=-2.588562693245352,
            ),
        ],
        duration=17.0,
    )
    one, other = run.impacts.tail(2).rows(named=True)
    assert {one["absorber"], other["absorber"]} == {0, 1}
    assert one["approach_velocity"] == other["approach_velocity"]
    assert one["velocity_before"] == other["velocity_before"]
