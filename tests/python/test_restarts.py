"""Runs on structures with several modes that go on from the state of another run."""

from __future__ import annotations

from typing import Any

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva

#: Natural frequencies in rad/s and shapes of two modes at two points.
FREQUENCIES = (12.0, 31.0)
POINTS = {"top": [0.1, 0.08], "mid": [0.06, -0.09]}


def structure(**more: Any) -> iva.Structure:
    """By its modes, without damping unless that is given."""
    given = {"points": POINTS, "absorber_at": "top", "seen_at": "top", "force_at": "top"}
    return iva.Structure(frequencies=FREQUENCIES, **(given | more))


def frame(**more: Any) -> iva.Structure:
    """By its matrices, damped."""
    return iva.Structure(
        points=["first", "second", "top"],
        mass=np.diag([80.0, 60.0, 40.0]).tolist(),
        stiffness=[[9e4, -4e4, 0.0], [-4e4, 6e4, -2e4], [0.0, -2e4, 2e4]],
        damping=[[60.0, -20.0, 0.0], [-20.0, 40.0, -15.0], [0.0, -15.0, 15.0]],
        absorber_at="top",
        force_at="first",
        start_displacements=[0.01, 0.02, 0.04],
        **more,
    )


MASS = iva.Siva(mass=3.0, restitution=0.6, gap_mm=20.0)
RUBBING = iva.Siva(mass=2.0, restitution=0.5, gap_mm=15.0, friction=0.01, gravity=9.81)
TUNED = iva.Siva(mass=2.0, restitution=0.5, gap_mm=25.0, spring=400.0, gap_damping=3.0)
PENDULUM = iva.Piva(mass=2.0, restitution=0.7, gap_mm=25.0, length=0.6)
PUSH = iva.Harmonic(force=60.0, frequency_hz=1.4)


def test_modes_without_damping_are_cosines() -> None:
    """Q = q0 cos ωt + (v0/ω) sin ωt of each mode, and the same of a run from there."""
    at, rates = np.array([0.3, -0.2]), np.array([1.5, 4.0])
    begun = structure(start_displacements=at, start_velocities=rates)
    run = iva.simulate(None, begun, start=iva.Start(), duration=9.0)
    state: Any = run.state_at(5.0)
    omega = np.array(FREQUENCIES)
    cosine, sine = np.cos(5 * omega), np.sin(5 * omega)
    assert state.displacements == pytest.approx(at * cosine + rates / omega * sine, abs=1e-14)
    assert state.velocities == pytest.approx(rates * cosine - omega * at * sine, abs=1e-12)
    assert (state.displacement, state.velocity, state.time) == (None, None, 5.0)
    later = iva.simulate(None, structure(), start=state, duration=4.0).at([8.5])
    expected = np.array(POINTS["top"]) @ (
        at * np.cos(8.5 * omega) + rates / omega * np.sin(8.5 * omega)
    )
    assert later["displacement"].item() == pytest.approx(expected, abs=1e-14)


SCENES: dict[str, tuple[Any, iva.Structure, Any]] = {
    "mass": (MASS, structure(damping_ratios=0.01, start_displacements=[0.4, 0.05]), None),
    "list": ([MASS, RUBBING, TUNED], frame(), None),
    "pendulum": ([PENDULUM, MASS], frame(), PUSH),
    "tuned": (TUNED, structure(damping_ratios=0.01, start_displacements=[0.4, 0.05]), PUSH),
    "stop": (
        [MASS, iva.Stop(restitution=0.6, gap_mm=90.0)],
        structure(damping_ratios=0.01, start_displacements=[0.4, 0.05]),
        PUSH,
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_the_motion_goes_on(name: str) -> None:
    """The impacts of the run that was not cut, to what its condition makes of rounding."""
    absorber, primary, force = SCENES[name]
    given: dict[str, Any] = {} if force is None else {"force": force}
    run = iva.simulate(absorber, primary, start=iva.Start(), duration=3.0, errors=True, **given)
    condition = run.summary["condition"].item()
    lost = 64 * np.finfo(float).eps * (condition + 3.0)
    assert lost < 1e-8
    for time in (0.3, 0.9, 1.6):
        start = run.state_at(time)
        later = iva.simulate(absorber, primary, start=start, duration=3.0 - time, **given)
        # Impacts below the floor of a chatter are listed or not by their speed.
        slow = pl.col("approach_velocity").abs() > 1e-4
        kept = pl.col("time").is_between(time, 2.99) & slow
        columns = ("absorber", "wall", "time", "displacement", "velocity_after")
        found, expected = (of.impacts.filter(kept).select(columns) for of in (later, run))
        assert expected.height > 3
        assert_frame_equal(found, expected, abs_tol=lost, rel_tol=0)
        seen = [of.at([2.8])["displacement"].to_list() for of in (later, run)]
        assert seen[0] == pytest.approx(seen[1], abs=lost)


def test_a_start_of_modes_takes_the_place_of_that_of_the_structure() -> None:
    begun = structure(start_displacements=[0.3, 0.1], start_velocities=[1.0, 2.0])
    start = iva.Start(displacements=[0.2, 0.0], velocities=[0.0, 0.5])
    other = structure(start_displacements=[0.2, 0.0], start_velocities=[0.0, 0.5])
    runs = [
        iva.simulate(MASS, begun, start=start, duration=3.0),
        iva.simulate(MASS, other, start=iva.Start(), duration=3.0),
    ]
    assert runs[0].impacts.equals(runs[1].impacts)
    assert repr(start) == "Start(displacements=(0.2, 0.0), velocities=(0.0, 0.5))"
    over = {"restitution": [0.4, 0.6]}
    table = iva.sweep(MASS, begun, over=over, start=start, duration=3.0)
    assert table.summary["impacts"][1] == runs[0].impacts.height


def test_starts_of_modes_where_there_are_none() -> None:
    start = iva.Start(displacements=[0.2, 0.1])
    with pytest.raises(ValueError, match=r"start\.displacements.*an iva\.Structure"):
        iva.simulate(None, iva.Primary(), start=start, periods=1)
    with pytest.raises(ValueError, match=r"structure\.start_displacements"):
        iva.simulate(None, structure(), start=iva.Start(displacements=[0.2]), periods=1)
    with pytest.raises(TypeError, match=r"start\.velocities"):
        iva.Start(velocities="fast")
