"""A shock at the start: the run under an impulse at time zero, and the motion it must begin."""

from __future__ import annotations

import math

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva

METRIC = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)
SIVA = iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0)


def test_it_is_an_impulse_at_time_zero() -> None:
    for absorber in (SIVA, iva.Piva(mass=0.3, length=0.2, restitution=0.6, gap_mm=5.0), None):
        shock = iva.simulate(absorber, METRIC, start=iva.Start(impulse=0.9), duration=2.0)
        blow = iva.simulate(
            absorber, METRIC, start=iva.Start(), force=iva.Impulse(impulse=0.9), duration=2.0
        )
        assert_frame_equal(shock.summary, blow.summary)
        assert_frame_equal(shock.impacts, blow.impacts)
        by_velocity = iva.simulate(
            absorber, METRIC, start=iva.Start(impulse_velocity=0.3), duration=2.0
        )
        assert by_velocity.impacts["time"].to_list() == pytest.approx(
            shock.impacts["time"].to_list(), rel=1e-9
        )


def test_the_motion_without_damping_and_walls_is_a_sine() -> None:
    primary = iva.Primary(mass=3.0, stiffness=12_000.0)
    run = iva.simulate(None, primary, start=iva.Start(impulse=0.9), duration=1.0)
    omega = math.sqrt(4000.0)
    times = [0.01, 0.3, 0.77]
    expected = [0.3 / omega * math.sin(omega * at) for at in times]
    assert run.at(times)["displacement"].to_list() == pytest.approx(expected, rel=1e-12)


def test_it_is_swept_and_differentiated_as_any_number() -> None:
    table = iva.sweep(SIVA, METRIC, over={"impulse": [0.5, 0.9]}, start=iva.Start(), duration=2.0)
    alone = iva.simulate(SIVA, METRIC, start=iva.Start(impulse=0.9), duration=2.0)
    names = ["impacts", "settling_time_5", "energy_impacts"]
    assert_frame_equal(table.summary[1:].select(names), alone.summary.select(names))
    run = iva.simulate(
        SIVA,
        METRIC,
        start=iva.Start(impulse=0.9),
        duration=0.2,
        gradients=("start.impulse",),
    )
    step = 1e-7
    late, early = (
        iva.simulate(SIVA, METRIC, start=iva.Start(impulse=0.9 + off), duration=0.2).impacts["time"]
        for off in (step, -step)
    )
    slopes = (late - early) / (2.0 * step)
    found = run.gradients["start.impulse"].impacts["time"]
    assert found.len() > 1
    assert found.to_list() == pytest.approx(slopes.to_list(), rel=1e-5)


def test_a_state_of_the_first_instant_is_before_it() -> None:
    run = iva.simulate(SIVA, METRIC, start=iva.Start(impulse=0.9), duration=1.0)
    assert run.state_at(0.0) == run.start
    later = run.state_at(0.4)
    assert later.impulse is None
    on = iva.simulate(SIVA, METRIC, start=later, duration=0.6)
    whole = run.impacts.filter(pl.col("time") > 0.4)["time"].to_list()
    assert on.impacts["time"].to_list() == pytest.approx(whole, rel=1e-9)


def test_what_is_refused() -> None:
    with pytest.raises(ValueError, match=r"start\.impulse = 1: give primary\.mass"):
        iva.simulate(None, iva.Primary(), start=iva.Start(impulse=1.0), periods=1)
    with pytest.raises(ValueError, match=r"start\.impulse.*acts at time zero"):
        iva.simulate(SIVA, METRIC, start=iva.Start(impulse=1.0, time=2.0), duration=1.0)
    with pytest.raises(ValueError, match="give one of them"):
        iva.Start(impulse=1.0, impulse_velocity=1.0)
    with pytest.raises(ValueError, match=r"start\.impulse.*no shock at its start"):
        iva.dynamics.orbit(
            SIVA,
            METRIC,
            force=iva.Harmonic(force=2.0, relative_frequency=1.0),
            start=iva.Start(impulse=1.0),
        )
