"""Every column of the summary against the same thing computed from the other tables."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva

# M = 2 kg, k = 800 N/m: ωn = 20 rad/s; m = 0.3 kg; c = 0.8 N s/m: ζ = c/(2 M ωn) = 0.01.
MASS, STIFFNESS, DAMPING, ABSORBER, OMEGA, ZETA = 2.0, 800.0, 0.8, 0.3, 20.0, 0.01
X0 = 0.01
PERIODS = 60
END = PERIODS * 2 * math.pi / OMEGA
SAMPLES = 2000
STEP = 2 * math.pi / OMEGA / SAMPLES


@pytest.fixture(scope="module")
def run() -> iva.Run:
    """Return a decay in SI units without stick that settles and has more than 20 peaks."""
    return iva.simulate(
        iva.Siva(mass=ABSORBER, clearance_mm=6.0, restitution=0.7),
        iva.Primary(mass=MASS, stiffness=STIFFNESS, damping=DAMPING),
        start=iva.Start(displacement=X0),
        periods=PERIODS,
    )


@pytest.fixture(scope="module")
def row(run: iva.Run) -> dict[str, Any]:
    """Return the row of its summary."""
    return run.summary.row(0, named=True)


@pytest.fixture(scope="module")
def motion(run: iva.Run) -> pl.DataFrame:
    """Return its motion, sampled densely."""
    return run.trajectory(SAMPLES)


def energy(states: pl.DataFrame) -> np.ndarray:
    """Return ½ M v² + ½ k x² + ½ m (v + w)²."""
    x, v, w = (states[name].to_numpy() for name in ("displacement", "velocity", "gap_velocity"))
    total: np.ndarray = 0.5 * (MASS * v**2 + STIFFNESS * x**2 + ABSORBER * (v + w) ** 2)
    return total


def test_counts_are_rows(run: iva.Run, row: dict[str, Any]) -> None:
    assert row["outcome"] == "finished"
    assert row["impacts"] == run.impacts.height > 10
    assert row["effective_impacts"] == run.impacts["effective"].sum() > 0
    assert row["episodes"] == run.episodes.height == 0
    assert row["undecided"] == 0
    assert row["time_stuck"] == 0.0


def test_effective_impacts_are_those_of_masses_that_approach_each_other(run: iva.Run) -> None:
    before = run.impacts.select("velocity_before", "absorber_velocity_before", "effective")
    opposed = before["velocity_before"] * before["absorber_velocity_before"] < 0
    assert opposed.to_list() == before["effective"].to_list()
    assert 0 < opposed.sum() < opposed.len()


def test_a_peak_on_the_wall_is_undecided() -> None:
    # x = cos τ and the absorber rests at 0: y = 1 − cos τ touches d = 2 once a period.
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=2.0),
        iva.Primary(),
        start=iva.Start(displacement=1.0, gap_displacement=0.0),
        periods=3,
    )
    assert run.summary["undecided"].item() == 3
    assert run.summary["impacts"].item() == 0


def test_time_stuck_is_that_of_the_episodes() -> None:
    run = iva.simulate(
        iva.Siva(mass=ABSORBER, clearance_mm=1.0, restitution=0.5),
        iva.Primary(mass=MASS, stiffness=STIFFNESS),
        start=iva.Start(displacement=X0),
        periods=5,
    )
    row = run.summary.row(0, named=True)
    assert row["episodes"] == run.episodes.height > 3
    end = 5 * 2 * math.pi / OMEGA
    rides = run.episodes["release_time"].fill_null(end) - run.episodes["stick_time"]
    # Both are sums of differences of doubles not above the end of the run.
    assert row["time_stuck"] == pytest.approx(rides.sum(), rel=0, abs=rides.len() * 2.0**-52 * end)
    losses = row["energy_initial"] - row["energy_final"]
    assert row["energy_impacts"] == pytest.approx(losses, rel=1e-12)  # the only loss; its ledger
    assert run.impacts["energy_loss"].sum() <= row["energy_impacts"]


@pytest.mark.parametrize("cycles", [1, 3, 10])
def test_decrement(run: iva.Run, row: dict[str, Any], cycles: int) -> None:
    amplitudes = run.envelope["amplitude"]
    decrement = math.log(amplitudes[0] / amplitudes[2 * cycles]) / cycles
    expected = decrement / math.hypot(2 * math.pi, decrement)
    # Some roundings each side; the logarithm of a quotient loses what it is short of 1.
    assert row[f"damping_ratio_{cycles}"] == pytest.approx(expected, rel=1e-14)


def test_fit(run: iva.Run, row: dict[str, Any]) -> None:
    amplitudes = run.envelope["amplitude"].to_numpy()
    times = run.envelope["time"].to_numpy()
    count = int(np.argmax(amplitudes < 0.05 * X0))
    assert count > 3
    slope = np.polyfit(OMEGA * times[:count], np.log(amplitudes[:count]), 1)[0]
    # The normal equations of a hundred points or fewer, each way to solve them rounds.
    assert row["damping_ratio_fit"] == pytest.approx(-slope, rel=1e-12)


def test_energy_ratio(run: iva.Run, row: dict[str, Any]) -> None:
    begin, later = energy(run.at([0.0, 2 * math.pi / OMEGA]))
    expected = (begin - later) / (4 * math.pi * begin)
    assert row["damping_ratio_energy"] == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("percent", [10, 5, 2])
def test_settling(motion: pl.DataFrame, row: dict[str, Any], percent: int) -> None:
    level = 0.01 * percent * X0
    last = motion.filter(pl.col("displacement").abs() > level)["time"].max()
    assert isinstance(last, float)
    settled = row[f"settling_time_{percent}"]
    # The last sample beyond the level, and less than a step later the level itself.
    assert last <= settled <= last + STEP
    assert settled < END - math.pi / OMEGA


def test_settling_is_a_root_of_the_motion(run: iva.Run, row: dict[str, Any]) -> None:
    times = [row[f"settling_time_{percent}"] for percent in (10, 5, 2)]
    sizes = run.at(times)["displacement"].abs().to_numpy() / X0
    assert np.allclose(sizes, [0.1, 0.05, 0.02], rtol=0, atol=1e-14)


def test_residual(motion: pl.DataFrame, row: dict[str, Any]) -> None:
    tail = motion.filter(pl.col("time") >= END - 2 * math.pi / OMEGA)["displacement"].abs()
    highest = tail.max()
    assert isinstance(highest, float)
    # Between samples x rises above them by at most ½ ẍ (step/2)², |ẍ| about ωn² x.
    above = 0.5 * OMEGA**2 * (STEP / 2) ** 2 * 2
    assert highest <= row["residual_amplitude"] * X0 * (1 + 1e-14)
    assert row["residual_amplitude"] * X0 <= highest * (1 + above)


def test_ledger(run: iva.Run, motion: pl.DataFrame, row: dict[str, Any]) -> None:
    initial = 0.5 * STIFFNESS * X0**2
    assert row["energy_initial"] == pytest.approx(initial, rel=1e-15)
    losses = run.impacts["energy_loss"]
    assert row["energy_impacts"] == pytest.approx(losses.sum(), rel=losses.len() * 2.0**-52)
    assert row["energy_final"] == pytest.approx(energy(run.at([END]))[0], rel=1e-13)
    # ∫ c ẋ² dt by the trapezoidal rule between impacts: the error is at most
    # step² · end · max |(c ẋ²)''| / 12, and ẋ² has the second derivative 2 (ẍ² + ẋ ẋ⃛) ≤ 4 ωn⁴ X0².
    power = DAMPING * motion["velocity"].to_numpy() ** 2
    worked = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(motion["time"].to_numpy()))
    error = STEP**2 * END * DAMPING * 4 * OMEGA**4 * X0**2 / 12
    assert row["energy_viscous"] == pytest.approx(worked, rel=0, abs=error)
    assert error < 1e-3 * worked
    parts = row["energy_impacts"] + row["energy_viscous"] + row["energy_final"]
    # A sum of four numbers none of which is above the first.
    assert row["energy_residual"] == pytest.approx(
        initial - parts, rel=0, abs=8 * 2.0**-53 * initial
    )
    assert abs(row["energy_residual"]) < 1e-13 * initial
