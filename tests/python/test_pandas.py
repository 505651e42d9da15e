"""Frames of pandas as points: those of the same frame of polars."""

from __future__ import annotations

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva

pandas = pytest.importorskip("pandas")

PARTS = (iva.Siva(mass_ratio=0.1, restitution=0.6), iva.Primary(damping_ratio=0.01))
START = iva.Start(displacement=1.0)
POINTS = {"relative_clearance": [0.4, 0.6, 0.9], "restitution": [0.5, 0.6, 0.7]}


def test_rows_are_points() -> None:
    frame = pandas.DataFrame(POINTS, index=["a", "b", "c"])
    made = iva.sweep(*PARTS, over=frame, start=START, periods=5)
    same = iva.sweep(*PARTS, over=pl.DataFrame(POINTS), start=START, periods=5)
    assert made == same


def test_whole_numbers_and_those_that_may_be_missing() -> None:
    frame = pandas.DataFrame(
        {
            "units": pandas.array([1, 2], dtype="Int64"),
            "relative_clearance": np.array([0.5, 1.0], dtype=np.float32),
        }
    )
    points = iva.sampling.points(frame)
    expected = pl.DataFrame({"units": [1.0, 2.0], "relative_clearance": [0.5, 1.0]})
    assert_frame_equal(points.drop("point"), expected)


def test_what_is_no_number_is_refused() -> None:
    for column, why in (
        ([0.4, float("nan")], r"over\['relative_clearance'\] has no number in row 1"),
        (pandas.array([0.4, None], dtype="Float64"), "has no number in row 1"),
        (["0.4", "0.6"], "over has the column 'relative_clearance' of .*: give numbers"),
        ([True, False], "of bool: give numbers"),
    ):
        with pytest.raises((TypeError, ValueError), match=why):
            iva.sampling.points(pandas.DataFrame({"relative_clearance": column}))
