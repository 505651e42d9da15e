"""One run: known event times, tables, results as values."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva

# Columns and their order: the table layout, version 1.
SUMMARY = """point outcome impacts effective_impacts episodes undecided time_stuck damping_ratio_1
    damping_ratio_3 damping_ratio_10 damping_ratio_fit damping_ratio_energy settling_time_10
    settling_time_5 settling_time_2 residual_amplitude energy_initial energy_impacts energy_viscous
    energy_final energy_residual energy_pivot stop_reachable gravity
    energy_work amplitude_max amplitude_rms reduction transmissibility impacts_per_cycle
    regime condition digits tier approach_speed_max impulse_max peak_force_estimate
    reduction_rms acceleration_max gap_displacement_max stroke absorber_displacement_max
    time_near_wall energy_friction stops time_held""".split()
IMPACTS = """point impact time wall displacement velocity_before velocity_after
    absorber_velocity_before absorber_velocity_after approach_velocity energy_loss
    effective angle angular_velocity_before angular_velocity_after time_error
    near_grazing peak_force_estimate absorber""".split()
EPISODES = """point episode wall start_time stick_time release_time impacts energy_loss
    absorber""".split()
ENVELOPE = "point peak time displacement amplitude log_decrement".split()
STROBOSCOPE = """point cycle time displacement velocity gap_displacement gap_velocity amplitude
    impacts absorber""".split()
TRAJECTORY = """point time displacement velocity gap_displacement gap_velocity wall angle
    angular_velocity acceleration absorber_acceleration absorber""".split()
ABSORBERS = """point absorber impacts effective_impacts episodes time_stuck energy_impacts
    approach_speed_max impulse_max peak_force_estimate gap_displacement_max stroke
    absorber_displacement_max""".split()


def test_columns(run: iva.Run) -> None:
    assert run.summary.columns == SUMMARY
    assert run.impacts.columns == IMPACTS
    assert run.episodes.columns == EPISODES
    assert run.envelope.columns == ENVELOPE
    assert run.stroboscope.columns == STROBOSCOPE
    assert run.absorbers.columns == ABSORBERS
    assert run.trajectory(10).columns == TRAJECTORY
    assert run.at([0.0]).columns == TRAJECTORY


# First impacts of free decays from rest in the centre of the gap, ωn = x0 = 1, computed with 40 to
# 60 digits and written with 15 or more: (μ, e, γ, ζ), t1, t2, t3, t12, energy after 12 impacts,
# condition of t12 (its largest change when one of μ, e, γ, ζ or the start velocity changes by 1e-9,
# per 1e-9; of t1, t2, t3 that is at most 7, of the energy at most 6).
DECAYS = [
    (
        (0.15, 0.5, 0.6, 0.0),
        (1.159279480727409, 3.198998157574207, 4.641564815434219, 32.43361927781994),
        0.02822948003443826,
        240,
    ),
    (
        (0.1, 0.5, 0.5, 0.01),
        (1.051167803954852, 3.068547465595078, 4.29090201371719, 34.80792232843577),
        0.05020389769953705,
        138,
    ),
    (
        (0.1, 0.9, 0.5, 0.01),
        (1.051167803954852, 2.478855127646062, 4.404897272081979, 19.9782984148845),
        0.2999595689504741,
        728,
    ),
    (
        (0.1, 1.0, 0.5, 0.0),
        (1.047197551196598, 2.349439255726284, 4.495927983340139, 20.60916234563145),
        0.5,
        1364,
    ),
]


def error(condition: float, time: float) -> float:
    """Return 2.5 rounding units, the worst of docs/guarantee.md, and half the last digit given."""
    return 2.5 * 2.0**-53 * (max(condition, 1) + time) + 0.5e-14


@pytest.mark.parametrize(("scene", "times", "energy", "condition"), DECAYS)
def test_known_free_decays(
    scene: tuple[float, ...], times: tuple[float, ...], energy: float, condition: float
) -> None:
    mu, e, gamma, zeta = scene
    run = iva.simulate(
        iva.Siva(mass_ratio=mu, restitution=e, relative_clearance=gamma),
        iva.Primary(damping_ratio=zeta),
        start=iva.Start(displacement=1.0),
        duration=times[3] * (1 + 1e-9),
    )
    found = run.impacts["time"].to_list()
    assert len(found) == 12
    for index, time in enumerate(times[:3]):
        assert found[index] == pytest.approx(time, rel=0, abs=error(7, time))
    assert found[11] == pytest.approx(times[3], rel=0, abs=error(condition, times[3]))
    # From the twelfth impact to the end the damper takes energy at a rate of at most 4 ζ E.
    damped = 4 * zeta * energy * times[3] * 1e-9
    assert run.summary["energy_final"].item() == pytest.approx(
        energy, rel=0, abs=error(6, 0) + damped
    )


@pytest.mark.parametrize("gamma", [0.1, 0.6, 1.0, 1.9])
def test_first_impact_without_damping(gamma: float) -> None:
    # x = cos τ and the absorber rests: y = 1 − cos τ reaches γ at arccos(1 − γ).
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.5, relative_clearance=gamma),
        iva.Primary(),
        start=iva.Start(displacement=1),
        periods=1,
    )
    first = run.impacts.row(0, named=True)
    assert first["time"] == pytest.approx(math.acos(1 - gamma), rel=1e-14)
    assert abs(first["approach_velocity"]) == pytest.approx(
        math.sqrt(gamma * (2 - gamma)), rel=1e-14
    )


def test_a_gap_too_wide_is_never_closed() -> None:
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=2.001),
        iva.Primary(),
        start=iva.Start(displacement=1),
        periods=5,
    )
    assert run.impacts.height == 0
    assert run.summary["outcome"].item() == "finished"
    assert run.summary["impacts"].item() == 0


def test_chatter_sticks_where_it_should() -> None:
    # μ .15, γ .1, e .5, ζ 0: stick and release by an independent 50-digit simulation.
    run = iva.simulate(
        iva.Siva(mass_ratio=0.15, restitution=0.5, relative_clearance=0.1),
        iva.Primary(),
        start=iva.Start(displacement=1),
        duration=5.2,
    )
    episode = run.episodes.row(0, named=True)
    assert episode["stick_time"] == pytest.approx(3.95518860904244782, rel=1e-13)
    assert episode["release_time"] == pytest.approx(5.066274514962852, rel=1e-13)


def test_momentum_and_restitution_at_every_impact(run: iva.Run) -> None:
    impacts = run.impacts
    before = impacts["velocity_before"] + 0.15 * impacts["absorber_velocity_before"]
    after = impacts["velocity_after"] + 0.15 * impacts["absorber_velocity_after"]
    assert np.allclose(before.to_numpy(), after.to_numpy(), rtol=0, atol=4e-16)
    gap_after = impacts["absorber_velocity_after"] - impacts["velocity_after"]
    expected = -0.5 * impacts["approach_velocity"]
    assert np.allclose(gap_after.to_numpy(), expected.to_numpy(), rtol=0, atol=4e-16)


def test_trajectory_and_at_agree(run: iva.Run) -> None:
    trajectory = run.trajectory(samples_per_period=20)
    assert trajectory["time"].is_sorted()
    assert trajectory["time"][0] == 0.0
    assert max(trajectory["gap_displacement"].abs()) <= 0.6 * (1 + 4 * 2.0**-52)
    doubled = trajectory.filter(pl.col("time").is_duplicated())
    assert set(run.impacts["time"]) <= set(doubled["time"])
    smooth = trajectory.filter(~pl.col("time").is_duplicated())
    exact = run.at(smooth["time"].to_numpy())
    for column in ("displacement", "velocity", "gap_displacement", "gap_velocity"):
        assert np.allclose(smooth[column], exact[column], rtol=0, atol=1e-13)


@pytest.mark.parametrize("stiffness", [12_000.0, 7_919.3, 1.3e5])
def test_at_an_impact_is_after_it(stiffness: float) -> None:
    # Times of the table are rounded to seconds, and come back as ωn t.
    run = iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0),
        iva.Primary(mass=3.0, stiffness=stiffness, damping=2.0),
        start=iva.Start(displacement_mm=4.0),
        duration=2.0,
    )
    impacts = run.impacts
    states = run.at(impacts["time"])
    after = impacts["absorber_velocity_after"] - impacts["velocity_after"]
    assert impacts.height > 20
    for computed, listed in (
        (states["gap_velocity"], after),
        (states["velocity"], impacts["velocity_after"]),
    ):
        assert np.abs((computed - listed).to_numpy()).max() < 1e-12


@pytest.mark.parametrize("k", range(3, 25))
def test_a_sample_that_falls_on_an_impact_keeps_the_order(k: int) -> None:
    # ζ = 0: the first impact is at τ = arccos(1 − γ), here a sample to rounding.
    run = iva.simulate(
        iva.Siva(
            mass_ratio=0.1, restitution=0.5, clearance=1.0 - math.cos(2.0 * math.pi * k / 100)
        ),
        iva.Primary(),
        start=iva.Start(displacement=1.0),
        periods=1,
    )
    rows = run.trajectory(100).filter((pl.col("time") - run.impacts["time"][0]).abs() < 1e-9)
    opening = (rows["gap_velocity"] < 0.0).to_list()
    assert rows.height == 3
    assert opening == sorted(opening)


def test_at_keeps_the_order_of_the_times(run: iva.Run) -> None:
    times = [5.0, 0.0, 2.5, 5.0]
    states = run.at(times)
    assert states["time"].to_list() == times
    assert states["displacement"][1] == 1.0
    assert states.row(0) == states.row(3)
    assert run.at([]).height == 0


def test_limits_are_outcomes(siva: iva.Siva) -> None:
    arguments: dict[str, Any] = {"start": iva.Start(displacement=1), "periods": 30}
    run = iva.simulate(siva, iva.Primary(), max_impacts=3, **arguments)
    assert run.summary["outcome"].item() == "impact_limit"
    assert run.impacts.height == 3
    run = iva.simulate(siva, iva.Primary(), max_work=2, **arguments)
    assert run.summary["outcome"].item() == "work_limit"


def test_measures_leave_the_others_null(siva: iva.Siva) -> None:
    run = iva.simulate(
        siva,
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1),
        periods=30,
        measures=["damping_ratio_1", "settling_time_5"],
    )
    row = run.summary.row(0, named=True)
    assert row["damping_ratio_1"] > 0.01
    assert row["settling_time_5"] > 0
    assert row["outcome"] == "finished"
    assert row["damping_ratio_3"] is None
    assert "finished" in repr(run)


def test_repr_states_outcome_counts_and_units(run: iva.Run) -> None:
    shown = repr(run)
    assert "finished" in shown
    assert f"{run.impacts.height} impacts" in shown
    assert "Siva(mass_ratio=0.15" in shown
    assert "ωn = 1" in shown


def test_no_zero_is_negative(table: iva.Table) -> None:
    # Plastic impacts end in rides: the gap velocity is 0 there, whichever way it came.
    plastic = iva.Siva(mass_ratio=0.15, relative_clearance=0.3, restitution=0.0)
    for x0 in (1.0, -1.0):
        start = iva.Start(displacement=x0, velocity=-0.0, gap_velocity=-0.0)
        run = iva.simulate(plastic, iva.Primary(), start=start, periods=2)
        frames = [run.summary, run.impacts, run.episodes, run.envelope, run.trajectory(50)]
        frames += [run.at([-0.0, 3.0]), table.summary]
        numbers = [frame.select(pl.selectors.float()).to_numpy() for frame in frames]
        assert not any(np.signbit(found[found == 0.0]).any() for found in numbers)
        assert (run.trajectory(50)["gap_velocity"] == 0.0).sum() > 10


def test_at_gives_nulls_after_an_early_end(siva: iva.Siva) -> None:
    run = iva.simulate(
        siva, iva.Primary(), start=iva.Start(displacement=1), periods=5, max_impacts=2
    )
    end = run.impacts["time"][1]
    states = run.at([0.5 * end, 2 * end])
    assert states["time"].to_list() == [0.5 * end, 2 * end]
    for column in TRAJECTORY[2:]:
        if column.startswith("ang"):  # a free mass has none
            continue
        assert states[column].null_count() == 1
        assert states[column][1] is None


def test_results_are_values(run: iva.Run, siva: iva.Siva) -> None:
    for twin in (pickle.loads(pickle.dumps(run)), copy.copy(run), copy.deepcopy(run)):
        assert twin == run
        assert_frame_equal(twin.impacts, run.impacts)
        assert_frame_equal(twin.trajectory(7), run.trajectory(7))
    other = iva.simulate(
        siva, iva.Primary(damping_ratio=0.01), start=iva.Start(displacement=1.0), periods=7
    )
    assert other != run
    assert run != "run"


def test_frames_are_made_once(run: iva.Run) -> None:
    assert run.summary is run.summary
