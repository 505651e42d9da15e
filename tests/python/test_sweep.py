"""Grids: order of points, tables, threads, progress."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from polars.testing import assert_frame_equal

import iva

START = iva.Start(displacement=1.0)
PRIMARY = iva.Primary(damping_ratio=0.01)


def test_order_of_points(table: iva.Table) -> None:
    summary = table.summary
    assert summary.columns[:4] == ["point", "relative_clearance", "mass_ratio", "outcome"]
    assert summary["point"].to_list() == [0, 1, 2, 3, 4, 5]
    assert summary["relative_clearance"].to_list() == [0.4, 0.4, 0.6, 0.6, 0.8, 0.8]
    assert summary["mass_ratio"].to_list() == [0.05, 0.1] * 3
    assert table.impacts["point"].is_sorted()
    assert table.tables == ("summary", "impacts", "episodes", "envelope")


def test_a_point_is_the_run_of_its_values(table: iva.Table) -> None:
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, relative_clearance=0.6, restitution=0.5),
        PRIMARY,
        start=START,
        periods=6,
    )
    point = table.impacts.filter(point=3).drop("point")
    assert_frame_equal(point, run.impacts.drop("point"), check_exact=True)
    measures = table.summary.filter(point=3).drop("point", "relative_clearance", "mass_ratio")
    assert_frame_equal(measures, run.summary.drop("point"), check_exact=True)


def test_swept_keys_keep_their_names() -> None:
    table = iva.sweep(
        iva.Siva(restitution=0.5, gap_mm=8.0),
        iva.Primary(mass=2.0, stiffness=800.0),
        over={"absorber.mass": (0.1, 0.2), "clearance_mm": range(3, 5)},
        start=iva.Start(displacement_mm=10.0),
        periods=5,
    )
    assert table.summary.columns[:3] == ["point", "absorber.mass", "clearance_mm"]
    assert table.summary["clearance_mm"].to_list() == [3.0, 4.0, 3.0, 4.0]
    assert table.units["summary"]["absorber.mass"] == "kg"
    assert table.units["summary"]["clearance_mm"] == "mm"


@pytest.mark.parametrize("threads", [1, 2, 7, np.int64(3)])
def test_threads_change_nothing(table: iva.Table, siva: iva.Siva, threads: int) -> None:
    again = iva.sweep(
        siva,
        PRIMARY,
        over={"relative_clearance": np.array([0.4, 0.6, 0.8]), "mass_ratio": [0.05, 0.1]},
        start=START,
        periods=6,
        tables=("envelope", "impacts", "summary", "episodes"),
        threads=threads,
    )
    assert again == table


def test_a_table_not_asked_for(siva: iva.Siva) -> None:
    table = iva.sweep(siva, PRIMARY, over={"mass_ratio": [0.1]}, start=START, periods=1)
    assert table.tables == ("summary",)
    with pytest.raises(AttributeError, match=r"'impacts'.*tables="):
        _ = table.impacts
    with pytest.raises(AttributeError, match="trajectory"):
        _ = table.trajectory


def test_results_are_values(table: iva.Table) -> None:
    for twin in (pickle.loads(pickle.dumps(table)), copy.copy(table), copy.deepcopy(table)):
        assert twin == table
        assert_frame_equal(twin.envelope, table.envelope)
    assert "relative_clearance × mass_ratio" in repr(table)
    assert "ωn = 1" in repr(table)


def sweep_of(points: int, **arguments: Any) -> iva.Table:
    return iva.sweep(
        iva.Siva(mass_ratio=0.1, restitution=0.8),
        PRIMARY,
        over={"relative_clearance": np.linspace(0.1, 1.2, points)},
        start=START,
        periods=100,
        **arguments,
    )


def test_progress_is_told_until_the_end() -> None:
    calls: list[tuple[int, int]] = []
    sweep_of(400, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (400, 400)
    assert calls == sorted(calls)


def test_what_a_callback_raises_comes_out_unchanged() -> None:
    class EnoughError(Exception):
        pass

    enough = EnoughError("enough")

    def stop(_done: int, _total: int) -> None:
        raise enough

    with pytest.raises(EnoughError) as caught:
        sweep_of(100_000, progress=stop)
    assert caught.value is enough
