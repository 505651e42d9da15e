"""Stops that are not alike, and what is estimated of the force of an impact."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva

PRIMARY = iva.Primary(damping_ratio=0.02)
LET_GO = iva.Start(displacement=1.0)


def largest(values: pl.Series) -> float:
    """Return the largest size of some numbers."""
    return float(np.abs(values.to_numpy()).max())


PENDULUM: dict[str, Any] = {"mass_ratio": 0.1, "frequency_ratio": 0.3, "length": 5.0}


def test_each_wall_has_its_own_restitution() -> None:
    for absorber in (
        iva.Siva(mass_ratio=0.1, restitution=0.8, restitution_minus=0.3, clearance=0.4),
        iva.Piva(**PENDULUM, restitution=0.8, restitution_minus=0.3, clearance=0.4),
    ):
        run = iva.simulate(absorber, PRIMARY, start=LET_GO, periods=8)
        hits = run.impacts
        # w after over w before; of a pendulum ẋ₁ = ẋ + (L/b) w with L = b.
        before = hits["absorber_velocity_before"] - hits["velocity_before"]
        after = hits["absorber_velocity_after"] - hits["velocity_after"]
        ratio = hits.select(pl.when(pl.col("wall") > 0).then(0.8).otherwise(0.3)).to_series()
        assert set(hits["wall"]) == {-1, 1}
        # Differences of velocities of the size of 1.
        assert largest(after + ratio * before) < 1e-15
        assert abs(run.summary["energy_residual"].item()) < 1e-14


def test_the_same_restitution_twice_is_one() -> None:
    given: dict[str, Any] = {"mass_ratio": 0.1, "restitution": 0.6, "clearance": 0.4}
    one = iva.simulate(iva.Siva(**given), PRIMARY, start=LET_GO, periods=20)
    twice = iva.Siva(**given, restitution_minus=0.6)
    assert iva.simulate(twice, PRIMARY, start=LET_GO, periods=20)._frames == one._frames


def test_a_sweep_beside_equal_stops() -> None:
    siva = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.4)
    values = [0.2, 0.4, 0.6, 0.8, 1.0]
    found = iva.sweep(
        siva, PRIMARY, over={"restitution_minus": values}, start=LET_GO, periods=10
    ).summary
    for index, value in enumerate(values):
        alone = iva.simulate(
            iva.Siva(mass_ratio=0.1, restitution=0.6, restitution_minus=value, clearance=0.4),
            PRIMARY,
            start=LET_GO,
            periods=10,
        )
        row = found.drop("restitution_minus")[index].with_columns(point=pl.lit(0, pl.UInt32))
        assert row.equals(alone.summary)


def test_derivatives_and_true_errors() -> None:
    # Central differences with h = 1e-5 are off by some h² and 1e-16/h of the value, as long as the
    # motion is not sensitive.
    def run_with(minus: float, **more: Any) -> iva.Run:
        siva = iva.Siva(mass_ratio=0.1, restitution=0.7, restitution_minus=minus, clearance=0.4)
        return iva.simulate(siva, PRIMARY, start=LET_GO, periods=4, **more)

    run = run_with(0.5, gradients=["restitution_minus"], verify=True, errors=True)
    found = run.gradients["restitution_minus"].impacts["time"][:5]
    high, low = (run_with(0.5 + h).impacts["time"][:5] for h in (1e-5, -1e-5))
    assert found[-1] != 0.0
    assert largest((found - (high - low) / 2e-5) / (1 + found.abs())) < 1e-8
    errors = run.verification.impacts["time"].abs()
    assert (errors <= run.impacts["time_error"]).all()


def test_an_offset_moves_the_stops() -> None:
    siva = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5, gap_offset=0.25)
    run = iva.simulate(siva, PRIMARY, start=LET_GO, periods=10, measures=["stroke"])
    at_walls = run.at(run.impacts["time"])["gap_displacement"]
    # y at a wall, to the bit: 0.25 ± 0.5.
    assert set(at_walls) == {0.75, -0.25}
    assert run.summary["stroke"].item() == 1.0
    given: dict[str, Any] = {"mass_ratio": 0.1, "restitution": 0.6, "clearance": 0.5}
    upright = iva.Siva(**given, gap_offset=0.25, inclination_deg=90, gravity=2)
    resting = iva.simulate(upright, PRIMARY, start=iva.Start(), periods=1)
    assert resting.at([0.0])["gap_displacement"].item() == -0.25


def test_a_start_outside_the_gap_is_blamed_on_the_offset() -> None:
    siva = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.5, gap_offset=0.75)
    with pytest.raises(
        ValueError, match=r"^absorber\.gap_offset = 0\.75: the mass starts at y = 0"
    ):
        iva.simulate(siva, PRIMARY, start=LET_GO, periods=1)
    inside = iva.Start(displacement=1.0, gap_displacement=0.5)
    assert iva.simulate(siva, PRIMARY, start=inside, periods=1).summary["impacts"].item() >= 0
    far = iva.Start(displacement=1.0, gap_displacement=1.5)
    with pytest.raises(ValueError, match=r"start.gap_displacement = 1.5: .* from 0.25 to 1.25"):
        iva.simulate(siva, PRIMARY, start=far, periods=1)


def linear_stop(restitution: float) -> float:
    """Return the largest force of z″ + 2ζz′ + z = 0, from z = 0 and z′ = 1, while it pushes."""

    def contact(ratio: float) -> tuple[float, float]:
        omega = math.sqrt(1 - ratio**2)
        time = np.linspace(0, 7, 200_001)
        damped = np.exp(-ratio * time)
        place = damped * np.sin(omega * time) / omega
        speed = damped * np.cos(omega * time) - ratio * place
        force = place + 2 * ratio * speed
        end = int(np.argmax(force < 0))
        return -speed[end], force[:end].max()

    low, high = 0.0, 0.9
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (low, middle) if contact(middle)[0] < restitution else (middle, high)
    return contact(low)[1]


def test_the_force_of_an_impact_is_that_of_a_half_sine_or_of_a_linear_stop() -> None:
    # ∫ F sin(πt/T) dt = 2FT/π is the impulse.
    mass, absorber = 3.0, 0.3
    primary = iva.Primary(mass=mass, stiffness=12_000.0, damping=2.0)
    given: dict[str, Any] = {"mass": absorber, "restitution": 0.6, "gap_mm": 5.0}
    start = iva.Start(displacement_mm=4.0)
    stiffness = 1e6
    reduced = 1 / (1 / absorber + 1 / mass)
    lasts = 1e-3
    for contact in ({"contact_time": lasts}, {"contact_stiffness": stiffness}):
        run = iva.simulate(iva.Siva(**given, **contact), primary, start=start, duration=1.0)
        hits = run.impacts
        impulse = mass * (hits["velocity_after"] - hits["velocity_before"]).abs()
        force = math.pi / 2 * impulse / lasts
        within = 1e-11
        if "contact_stiffness" in contact:
            speed = hits["approach_velocity"].abs()
            force = linear_stop(0.6) * math.sqrt(stiffness * reduced) * speed
            within = 1e-5  # of the samples
        assert run.units["impacts"]["peak_force_estimate"] == "N"
        assert largest(hits["peak_force_estimate"] / force - 1) < within
        row = run.summary.row(0, named=True)
        assert row["peak_force_estimate"] == pytest.approx(largest(force), rel=within)
        assert row["impulse_max"] == pytest.approx(largest(impulse), rel=1e-11)
    bare = iva.simulate(iva.Siva(**given), primary, start=start, duration=1.0)
    assert bare.impacts["peak_force_estimate"].null_count() == bare.impacts.height
    assert bare.impacts.drop("peak_force_estimate").equals(hits.drop("peak_force_estimate"))
    natural = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=1, contact_stiffness=1e6)
    with pytest.raises(ValueError, match=r"contact_stiffness = .* give primary.mass"):
        iva.simulate(natural, PRIMARY, start=LET_GO, periods=1)
    with pytest.raises(ValueError, match="contact_time"):
        iva.Siva(**given, contact_time=1e-3, contact_stiffness=1e6)
