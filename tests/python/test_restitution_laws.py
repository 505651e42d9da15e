"""Restitution that depends on the approach speed, as studies and Python give it.

Numbers come from the formulas of the laws (docs/study-file.md), written here once more.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva
from iva import dynamics

PRIMARY = iva.Primary(damping_ratio=0.01)
START = iva.Start(displacement=1.0)


def siva(**more: float) -> iva.Siva:
    """Return a free mass with some law of restitution."""
    given: dict[str, Any] = {"mass_ratio": 0.1, "clearance": 0.6} | more
    return iva.Siva(**given)


def run(absorber: Any, **more: Any) -> iva.Run:
    """Return a decay."""
    return iva.simulate(absorber, PRIMARY, start=START, **({"periods": 8} | more))


def restitutions(found: iva.Run) -> tuple[np.ndarray, np.ndarray]:
    """Return approach speeds and what each rebound is of its approach."""
    hits = found.impacts
    after = hits["absorber_velocity_after"] - hits["velocity_after"]
    return hits["approach_velocity"].abs().to_numpy(), (
        -after / hits["approach_velocity"]
    ).to_numpy()


def plastic(speed: np.ndarray, limit: float) -> np.ndarray:
    """Return the restitution of Thornton's spheres."""
    q = np.minimum(limit / speed, 1.0)
    stored = q / (q + 2.0 * np.sqrt(1.2 - 0.2 * q**2))
    law = np.sqrt(1.2 * math.sqrt(3.0)) * np.sqrt(1.0 - q**2 / 6.0) * stored**0.25
    return np.where(speed <= limit, 1.0, law)


@pytest.mark.parametrize("exponent", [None, 0.5, 1.0, 1.0 / 3.0])
def test_a_power_law_is_met_at_every_impact(exponent: float | None) -> None:
    """1 − (1 − e)(u/u₀)^b, in units in which ωn is not 1."""
    more = {} if exponent is None else {"restitution_exponent": exponent}
    absorber = siva(restitution=0.6, reference_speed=2.0, **more)
    primary = iva.Primary(natural_frequency=3.0, damping_ratio=0.01)
    speeds, found = restitutions(iva.simulate(absorber, primary, start=START, periods=3))
    expected = 1.0 - 0.4 * (speeds / 2.0) ** (exponent or 0.2)
    assert speeds.size > 3
    assert np.abs(found - expected).max() < 1e-13


def test_plastic_spheres_are_met_at_every_impact() -> None:
    """Elastic below the yield speed; a table of both sides of it."""
    speeds, found = restitutions(run(siva(yield_speed=0.6), periods=30))
    assert (speeds < 0.6).any()
    assert (speeds > 0.6).any()
    assert np.abs(found - plastic(speeds, 0.6)).max() < 1e-13


def test_the_energy_goes_where_it_is_said_to_go() -> None:
    """The ledger closes, and the sum over impacts is that of the summary."""
    for more in ({"restitution": 0.5, "reference_speed": 1.0}, {"yield_speed": 0.1}):
        found = run(siva(**more), periods=30)
        row = found.summary.row(0, named=True)
        assert abs(row["energy_residual"]) < 1e-14
        assert row["energy_impacts"] >= float(found.impacts["energy_loss"].sum()) - 1e-14


def test_a_law_that_is_flat_is_a_number() -> None:
    """With e = 1 at the reference speed the power law is 1 at all: the bits of restitution 1."""
    flat = run(siva(restitution=1.0, reference_speed=0.7))
    assert flat.impacts.equals(run(siva(restitution=1.0)).impacts)


def test_each_of_a_list_has_its_own() -> None:
    """A power law, plastic spheres and a number beside each other."""
    found = run(
        [
            siva(restitution=0.6, reference_speed=1.0),
            siva(yield_speed=0.2, clearance=0.8),
            siva(restitution=0.5, clearance=0.4),
        ]
    )
    hits = found.impacts.with_columns(
        rebound=-(pl.col("absorber_velocity_after") - pl.col("velocity_after"))
        / pl.col("approach_velocity"),
        speed=pl.col("approach_velocity").abs(),
    )
    parts = [hits.filter(pl.col("absorber") == k) for k in range(3)]
    speeds = [part["speed"].to_numpy() for part in parts]
    laws = [1.0 - 0.4 * speeds[0] ** 0.2, plastic(speeds[1], 0.2), np.full(speeds[2].size, 0.5)]
    for part, law in zip(parts, laws, strict=True):
        assert part.height > 1
        assert np.abs(part["rebound"].to_numpy() - law).max() < 1e-13


def test_a_sweep_has_the_rows_of_single_runs() -> None:
    """To the bit, whatever stands beside a point."""
    over = {"reference_speed": [0.5, 1.0, 2.0]}
    table = iva.sweep(
        siva(restitution=0.6), PRIMARY, over=over, start=START, periods=8, tables=("impacts",)
    )
    for point, speed in enumerate(over["reference_speed"]):
        alone = run(siva(restitution=0.6, reference_speed=speed)).impacts.drop("point")
        assert table.impacts.filter(pl.col("point") == point).drop("point").equals(alone)


def test_a_gradient_is_the_slope_of_differences() -> None:
    """Of the first impact instants by the reference speed, to 1e-6."""
    found = run(
        siva(restitution=0.6, reference_speed=1.0), periods=2, gradients=["reference_speed"]
    )
    small = 1e-6
    times = [
        run(siva(restitution=0.6, reference_speed=1.0 + by), periods=2).impacts["time"].to_numpy()
        for by in (-small, small)
    ]
    slope = (times[1] - times[0]) / (2.0 * small)
    told = found.gradients["reference_speed"].impacts["time"].to_numpy()
    assert np.abs(told - slope).max() < 1e-6
    assert np.abs(slope).max() > 1e-3


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"restitution": 0.5, "yield_speed": 0.1}, "restitution is given as well; give one"),
        ({"restitution": 0.5, "restitution_exponent": 0.5}, "give reference_speed too"),
        ({"reference_speed": 0.5}, "absorber.restitution is missing"),
        (
            {"restitution": 0.5, "reference_speed": 1.0, "restitution_exponent": 0.21},
            "restitution_exponent = 0.21: give a quotient of whole numbers from 1 to 8",
        ),
        (
            {"restitution": 0.5, "reference_speed": 1.0, "restitution_exponent": 1.5},
            "restitution_exponent = 1.5: give a quotient of whole .* that is at most 1",
        ),
        (
            {"restitution": 0.5, "reference_speed": 0.0},
            "reference_speed = 0: give a number greater",
        ),
    ],
)
def test_what_does_not_fit_is_refused(more: dict[str, float], told: str) -> None:
    """With field, value and what is allowed."""
    with pytest.raises(ValueError, match=told):
        run(siva(**more))


def test_an_exponent_has_no_gradient() -> None:
    """It is one of a few quotients."""
    absorber = siva(restitution=0.6, reference_speed=1.0, restitution_exponent=0.5)
    with pytest.raises(ValueError, match="sweep it"):
        run(absorber, gradients=["restitution_exponent"])


def test_a_motion_between_unlike_laws_has_no_mirror_image() -> None:
    """At low speeds the restitution of both walls is 1; at the speeds of the orbit it is not."""
    force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    primary = iva.Primary(damping_ratio=0.05)
    # The symmetric orbit A1 of the dynamics references lies nearby.
    state = (-1.103, 0.327, -4.038, 3.256)

    def orbit(symmetric: bool | None = None, **more: float) -> Any:
        absorber = iva.Siva(
            mass_ratio=0.2, restitution=0.7, clearance=4.5, reference_speed=3.2, **more
        )
        return dynamics.orbit(absorber, primary, force=force, start=state, symmetric=symmetric)

    assert orbit().symmetric is orbit(True).symmetric is True
    unlike = orbit(restitution_minus=0.66)
    assert unlike.symmetric is False
    assert unlike.residual < 1e-14
    with pytest.raises(ValueError, match="only with like walls"):
        orbit(True, restitution_minus=0.66)
