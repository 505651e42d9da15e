"""The two tiers: which one makes a row, and how far apart they are.

The exact tier is the truth here; how exact it is, and how far the fast tier is from independent
references, is tested in Rust (``tests/rust/tests/all/fast_tier.rs``). Scenes that are compared have
a condition below 1e5 (``errors=True``), so that roundings grow to 1e-10 at most.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva

SIVA = iva.Siva(mass_ratio=0.08, clearance=0.8, restitution=0.6)
PENDULUM = iva.Piva(
    mass_ratio=0.08, clearance=0.8, restitution=0.6, frequency_ratio=0.4, length=10.0
)
PRIMARY = iva.Primary(damping_ratio=0.01)
START = iva.Start(displacement=1.0)
FORCE = iva.Harmonic(amplitude=0.1, frequency=0.95)
BASE = iva.Harmonic(base_acceleration=0.1, frequency=0.95)
RECORD = iva.Recorded(times=[0.0, 0.5, 1.5], values=[0.0, 0.1, 0.0])
OVER = {"clearance": np.linspace(0.6, 1.2, 8), "restitution": [0.5, 0.6, 0.7, 0.8, 0.3]}
LARGEST_CONDITION = 1e5


def sweep(over: Any = None, absorber: Any = SIVA, **given: Any) -> pl.DataFrame:
    """Return the summary of a sweep; without axes over one clearance."""
    scene = {"primary": PRIMARY, "start": START, "periods": 20, "tolerance": 1e-9, **given}
    return iva.sweep(absorber, over=over or {"clearance": [0.8]}, **scene).summary


@pytest.mark.parametrize(
    ("given", "tier"),
    [
        ({}, "exact"),
        ({"tolerance": 0.0}, "exact"),
        ({"tolerance": None}, "exact"),
        ({"force": FORCE}, "fast"),
        ({"force": BASE}, "fast"),
        ({"force": RECORD}, "exact"),
        ({"force": [FORCE, iva.Harmonic(amplitude=0.05, frequency=1.3)]}, "exact"),
        ({"force": iva.Impulse(velocity=0.1)}, "exact"),
        ({"tables": ("summary", "impacts")}, "exact"),
        ({"errors": True}, "exact"),
        ({"absorber": PENDULUM}, "fast"),
        ({"absorber": PENDULUM, "tolerance": None}, "exact"),
    ],
)
def test_the_tier_of_a_row(given: dict[str, Any], tier: str) -> None:
    assert sweep(**given)["tier"].to_list() == [tier]


def test_the_structure_alone_has_one_tier() -> None:
    over = {"primary.damping_ratio": [0.01]}
    assert sweep(over, None, tolerance=None)["tier"].to_list() == ["exact"]


@pytest.mark.parametrize("force", [None, FORCE, BASE], ids=["decay", "force", "base"])
def test_what_stands_beside_a_point_changes_nothing(force: Any) -> None:
    together = sweep(OVER, force=force, threads=1)
    assert together.equals(sweep(OVER, force=force, threads=2))
    for point in (0, 7, 23, 39):
        row = together.row(point, named=True)
        alone = sweep({name: [row[name]] for name in OVER}, force=force)
        assert alone.drop("point").row(0) == together.drop("point").row(point)


@pytest.mark.parametrize("force", [FORCE, BASE], ids=["force", "base"])
def test_tiers_agree(force: Any) -> None:
    given = {"force": force, "periods": 8}
    fast = sweep(OVER, **given)
    exact = sweep(OVER, tolerance=None, **given)
    condition = sweep(OVER, errors=True, tolerance=None, **given)["condition"]
    judged = (condition.is_null() | (condition < LARGEST_CONDITION)).to_numpy()
    assert judged.sum() >= 30
    for name in exact.columns:
        one, other = fast.filter(judged)[name], exact.filter(judged)[name]
        if one.dtype != pl.Float64:
            assert name == "tier" or one.equals(other), name
            continue
        assert one.is_null().equals(other.is_null()), name
        a, b = (column.drop_nulls().to_numpy() for column in (one, other))
        assert np.allclose(a, b, rtol=1e-9, atol=1e-12), name


def test_units_change_nothing_but_scale() -> None:
    natural = sweep(OVER)
    si = iva.sweep(
        iva.Siva(mass_ratio=0.08, clearance=0.8, restitution=0.6),
        iva.Primary(mass=3.0, natural_frequency=2.0, damping_ratio=0.01),
        over=OVER,
        start=START,
        periods=20,
        tolerance=1e-9,
    ).summary
    assert natural["impacts"].equals(si["impacts"])
    assert np.allclose(natural["settling_time_10"], 2.0 * si["settling_time_10"], rtol=1e-8)


def test_a_tolerance_is_an_axis() -> None:
    found = sweep({"tolerance": [0.0, 1e-9, 1e-6]}, force=FORCE, tolerance=None)
    assert found["tier"].to_list() == ["exact", "fast", "fast"]
    assert found["amplitude_max"].n_unique() <= 2


def test_a_tolerance_changes_nothing_of_a_decay() -> None:
    assert sweep(OVER).equals(sweep(OVER, tolerance=None))


@pytest.mark.parametrize("force", [FORCE, BASE], ids=["force", "base"])
def test_the_errors_of_the_fast_tier_are_found(force: Any) -> None:
    run = iva.simulate(
        SIVA,
        PRIMARY,
        start=START,
        force=force,
        periods=8,
        tolerance=1e-9,
        tables=("summary",),
        verify=True,
    )
    assert run.summary["tier"].item() == "fast"
    found = run.verification
    assert found is not None
    assert found.agrees
    numbers = found.summary.select(pl.col(pl.Float64)).row(0)
    largest = max(abs(number) for number in numbers if number is not None)
    assert 0.0 < largest < 1e-11


def test_a_run_is_a_row_of_a_sweep() -> None:
    run = iva.simulate(SIVA, PRIMARY, start=START, periods=20, tolerance=1e-9, tables=("summary",))
    assert run.summary.drop("point").equals(sweep().drop("point", "clearance"))


def test_derivatives_stand_beside_the_exact_tier() -> None:
    run = iva.simulate(
        SIVA,
        PRIMARY,
        start=START,
        periods=4,
        tolerance=1e-9,
        tables=("summary",),
        gradients=("clearance",),
    )
    assert run.summary["tier"].item() == "exact"
    assert run.gradients["clearance"].summary["impacts"].equals(run.summary["impacts"])


def test_other_tables_are_those_of_the_exact_tier() -> None:
    given: dict[str, Any] = {"start": START, "periods": 8}
    fast = iva.simulate(SIVA, PRIMARY, tolerance=1e-9, **given)
    exact = iva.simulate(SIVA, PRIMARY, **given)
    assert fast.impacts.equals(exact.impacts)
    assert fast.summary.equals(exact.summary)


@pytest.mark.parametrize("force", [None, FORCE, BASE], ids=["decay", "force", "base"])
@pytest.mark.parametrize("absorber", [SIVA, PENDULUM], ids=["siva", "piva"])
def test_events_of_a_sweep_are_those_of_runs_alone(absorber: Any, force: Any) -> None:
    scene = {"force": force, "start": START, "periods": 20}
    over = {"clearance": [0.05, 0.6, 0.9, 30.0], "restitution": [0.0, 0.3, 0.8]}
    tables = ("summary", "impacts", "episodes")
    swept = iva.sweep(absorber, PRIMARY, over=over, tables=tables, **scene)
    for row in swept.summary.iter_rows(named=True):
        values = {name: row[name] for name in over}
        alone = iva.simulate(dataclasses.replace(absorber, **values), PRIMARY, **scene)
        at = pl.col("point") == row["point"]
        assert swept.impacts.filter(at).drop("point").equals(alone.impacts.drop("point"))
        assert swept.episodes.filter(at).drop("point").equals(alone.episodes.drop("point"))
    assert swept.impacts.height > 500
    assert swept.episodes.height > 0
