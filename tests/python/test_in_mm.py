"""Lengths in millimetres: the numbers of the tables times a thousand, and all else as it was."""

from __future__ import annotations

import copy
import pickle

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva

PRIMARY = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)
RUN = iva.simulate(
    iva.Siva(mass=0.3, restitution=0.6, gap_mm=4.0),
    PRIMARY,
    start=iva.Start(),
    force=iva.Harmonic(force=2.0, relative_frequency=1.0),
    cycles=60,
)


def checked(frame: pl.DataFrame, metric: pl.DataFrame, units: iva.Units, table: str) -> int:
    """Compare a frame in mm with that in metres; return how many columns have lengths."""
    lengths = 0
    in_mm = units.in_mm()[table]
    for name in metric.columns:
        if units[table][name] == "m":
            lengths += 1
            assert in_mm[name] == "mm"
            assert_frame_equal(frame.select(name), metric.select(pl.col(name) * 1000.0))
        else:
            assert in_mm[name] == units[table][name]
            assert_frame_equal(frame.select(name), metric.select(name))
    return lengths


def test_the_tables_of_a_run() -> None:
    told = RUN.in_mm
    for table in ("summary", "impacts", "envelope", "stroboscope", "absorbers"):
        assert checked(getattr(told, table), getattr(RUN, table), RUN.units, table) > 0
    assert checked(told.trajectory(20), RUN.trajectory(20), RUN.units, "trajectory") == 2
    assert checked(told.at([0.1, 0.2]), RUN.at([0.1, 0.2]), RUN.units, "trajectory") == 2
    assert "lengths in mm" in repr(told)
    assert "lengths in mm" in str(told.units)


def test_what_is_printed_of_a_run_in_mm() -> None:
    amplitude = RUN.summary["amplitude_max"].item()
    assert f"amplitude_max {1000 * amplitude:.4g} mm" in repr(RUN)
    assert f"<td>{1000 * amplitude:.6g}</td><td>mm</td>" in RUN._repr_html_()
    metric = iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap=0.004),
        PRIMARY,
        start=iva.Start(),
        force=iva.Harmonic(force=2.0, relative_frequency=1.0),
        cycles=60,
    )
    # In millimetres as well, so that it can be compared with the other.
    assert f"amplitude_max {1000 * amplitude:.4g} mm," in repr(metric)


def test_a_table() -> None:
    table = iva.sweep(
        iva.Siva(mass=0.3, restitution=0.6),
        PRIMARY,
        over={"gap_mm": [4.0, 5.0], "displacement": [0.003, 0.004]},
        start=iva.Start(),
        duration=1.0,
        tables=("summary", "impacts"),
        measures=("settling_time_5", "stroke"),
    )
    told = table.in_mm
    assert told.swept == table.swept
    assert told.summary["displacement"].to_list() == [3.0, 4.0, 3.0, 4.0]
    assert told.summary["gap_mm"].equals(table.summary["gap_mm"])
    assert told.units["summary"]["displacement"] == "mm"
    assert checked(told.summary, table.summary, table.units, "summary") > 1
    assert checked(told.impacts, table.impacts, table.units, "impacts") > 0
    assert told.in_mm is told
    assert pickle.loads(pickle.dumps(told)) == told
    assert copy.copy(told).units.millimetres


def test_only_metres_become_millimetres() -> None:
    run = iva.simulate(None, iva.Primary(), start=iva.Start(displacement=1.0), periods=1)
    with pytest.raises(ValueError, match=r"in_mm: .*give primary\.mass"):
        _ = run.in_mm
