"""Verified runs: true errors, found by a second run in numbers of twice the precision."""

import copy
import pickle
from typing import Any

import polars as pl
import pytest

import iva

UNIT = 2.0**-53


def decay(**more: Any) -> iva.Run:
    return iva.simulate(
        iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1.0),
        periods=30,
        **more,
    )


def test_errors_are_those_of_rounding() -> None:
    run = decay(verify=True, errors=True)
    found = run.verification
    assert found.agrees
    # Every number of the impacts has an error, none of the words and counts is changed.
    assert found.impacts.select(pl.col("time", "velocity_after", "energy_loss").null_count()).row(
        0
    ) == (0, 0, 0)
    unchanged = ("point", "impact", "wall", "effective")
    assert found.impacts.select(unchanged).equals(run.impacts.select(unchanged))
    # Rounding leaves something, and not more than the estimate of `errors=True`, nor than so many
    # units of it as the conditioning allows (the last of these impacts lie close to grazings).
    error = found.impacts["time"].abs()
    assert (error <= run.impacts["time_error"]).all()
    assert 0.0 < error.max() < 6 * UNIT * run.summary["condition"].item()  # type: ignore[operator]
    # The first impact has a closed form, rounded once.
    assert error[0] <= UNIT


def test_errors_reach_every_table() -> None:
    run = decay(verify=True)
    names = ("summary", "impacts", "episodes", "envelope", "stroboscope", "absorbers")
    assert run.verification.findings["table"].to_list() == list(names)
    assert run.verification.summary["settling_time_5"].abs().item() < 1e-11
    assert run.verification.envelope["log_decrement"][:2].to_list() == [None, None]
    assert run.verification.envelope["log_decrement"][2:].abs().max() < 1e-9  # type: ignore[operator]


def test_the_tolerance_of_a_pendulum_shows() -> None:
    def run(tolerance: float) -> float:
        pendulum = iva.Piva(
            mass_ratio=0.1,
            relative_clearance=0.8,
            restitution=0.6,
            frequency_ratio=0.4,
            length=5.0,
        )
        found = iva.simulate(
            pendulum,
            iva.Primary(damping_ratio=0.01),
            start=iva.Start(displacement=1.0),
            periods=6,
            tolerance=tolerance,
            verify=True,
        ).verification
        assert found.agrees
        return found.impacts["time"].abs().max()  # type: ignore[return-value]

    full, coarse = run(0.0), run(1e-6)
    assert full < 1e-13
    assert 1e-11 < coarse < 1e-4


def test_a_run_that_rounding_decides_is_told_apart() -> None:
    # 300 periods of a chaotic motion: conditions grow beyond 2^53 long before the end.
    run = iva.simulate(
        iva.Siva(mass_ratio=0.3, clearance=0.1, restitution=0.9),
        iva.Primary(),
        start=iva.Start(displacement=1.0),
        force=iva.Harmonic(amplitude=0.5, relative_frequency=0.9),
        periods=300,
        verify=True,
        tables=("impacts",),
    )
    found = run.verification
    assert not found.agrees
    row = found.findings.row(by_predicate=pl.col("table") == "impacts", named=True)
    assert 10 < row["alike"] < row["rows"]
    beyond = found.impacts["time"][row["alike"] :]
    assert beyond.null_count() == len(beyond)
    assert "events differ" in repr(found)


def test_a_verification_has_to_be_asked_for() -> None:
    with pytest.raises(AttributeError, match="verify=True"):
        decay().verification  # noqa: B018
    with pytest.raises(TypeError, match="verify = 1: give True or False"):
        decay(verify=1)
    with pytest.raises(AttributeError, match="no table 'impacts'"):
        decay(verify=True, tables=()).verification.impacts  # noqa: B018


def test_verifications_travel() -> None:
    run = decay(verify=True)
    for other in (copy.deepcopy(run), pickle.loads(pickle.dumps(run))):
        assert other == run
        assert other.verification == run.verification
        assert other.verification.units["impacts"]["time"] == "1/ωn"
        assert repr(other.verification) == repr(run.verification)


@pytest.mark.parametrize(
    "absorber",
    [
        iva.Siva(mass_ratio=0.07, restitution=0.5, clearance=1.81015, gap_offset=0.321772),
        iva.Siva(
            mass_ratio=0.07,
            restitution=0.5,
            clearance=1.81015,
            gap_offset=0.321772,
            spring_ratio=0.1,
        ),
        iva.Piva(
            mass_ratio=0.07,
            restitution=0.5,
            clearance=1.81015,
            gap_offset=0.321772,
            frequency_ratio=0.5,
            length=5.1,
        ),
    ],
)
def test_a_start_on_a_wall_is_one_in_any_precision(absorber: iva.Siva | iva.Piva) -> None:
    """The wall is the sum of two numbers, which a double of the start only rounds."""
    for side in (-1.0, 1.0):
        wall = 0.321772 + side * 1.81015
        start = iva.Start(displacement=1.0, velocity=0.3, gap_displacement=wall)
        primary = iva.Primary(damping_ratio=0.02)
        run = iva.simulate(absorber, primary, start=start, periods=3, verify=True)
        assert run.verification.agrees
