"""Samples of measured records: equal steps are found, and what no sensor measured is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

from iva.measured import Measured
from recordings import TIMES, VALUES, written


def test_instants_that_are_rounded() -> None:
    values = np.cos(0.1 * np.arange(4000))
    exact = 3.0 + np.arange(4000) / 2048
    # To 1e-4 s the step of 4.9e-4 s is still seen; the rate comes back to 1e-6.
    record = Measured(exact.round(4), values, "displacement")
    assert record.sampling_hz == pytest.approx(2048.0, rel=1e-6)
    # To 1e-6 s all instants fit the whole number of hertz.
    assert Measured(exact.round(6), values, "displacement").sampling_hz == 2048.0
    # Of single precision, as many recorders have it.
    single = exact.astype(np.float32)
    assert Measured(single, values, "displacement").sampling_hz == pytest.approx(2048, rel=1e-7)
    # A rate that is no whole number is left alone.
    odd = Measured(np.arange(4000) / 2048.37, values, "displacement")
    assert odd.sampling_hz == pytest.approx(2048.37, rel=1e-13)
    assert odd.time[-1] == pytest.approx(3999 / 2048.37, rel=1e-13)


def coarse(folder: Path, steps: NDArray[np.int64]) -> Path:
    """Write a record at some steps of 1/2048 s, with instants in whole milliseconds."""
    rows = (f"{k / 2048:.3f},{math.cos(0.1 * k):.6f}\n" for k in steps)
    return written(folder, "t,a [g]\n" + "".join(rows))


def test_instants_that_are_the_same_need_the_rate(tmp_path: Path) -> None:
    path = coarse(tmp_path, np.arange(4000))
    with pytest.raises(ValueError, match=r"^time: 0 s is followed by 0 s .*; give sampling_hz if"):
        Measured.read(path)
    record = Measured.read(path, sampling_hz=2048)
    assert record.time.tolist() == [k / 2048 for k in range(4000)]
    with pytest.raises(ValueError, match=r"^sampling_hz = 2000: instants are up to"):
        Measured.read(path, sampling_hz=2000)
    # A sample that is missing shows even so.
    path = coarse(tmp_path, np.delete(np.arange(4000), 1700))
    with pytest.raises(ValueError, match=r"^sampling_hz = 2048: instants are up to"):
        Measured.read(path, sampling_hz=2048)


def test_instants_rounded_to_more_than_half_a_step_need_the_rate() -> None:
    times = (np.arange(400) / 800).round(3)
    values = np.cos(0.1 * np.arange(400))
    with pytest.raises(ValueError, match=r"^time: instants are rounded to 0.001 s, which is 0.8 s"):
        Measured(times, values, "velocity")


@pytest.mark.parametrize("missing", [1, 2, 200, 397, 398])
@pytest.mark.parametrize("digits", [3, 6, 15])
def test_a_sample_that_is_missing(missing: int, digits: int) -> None:
    times = np.delete(np.arange(400) / 500, missing).round(digits)
    with pytest.raises(ValueError, match=r"^time: from .* the step is 0.004 s, elsewhere 0.002 s"):
        Measured(times, np.cos(np.arange(399)), "velocity")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t[::-1], r"^time: 0.39 s is followed by 0.38 s \(sample 1\); give times that i"),
        (lambda t: t * 0.0, r"^time: 0 s is followed by 0 s"),
        (lambda t: t + (t > 0.2), r"the step is 1.01 s, elsewhere 0.01 s; give a record sampled"),
        (
            lambda t: np.where(t == 0.2, math.nan, t),
            r"^time: sample 20 is at nan s; give finite times in s$",
        ),
        (lambda t: t * 1e-12, r"^time: the steps are 1e-14 s; give times in s$"),
        (lambda t: t * 1e-310, r"^time: the steps are 1e-312 s; give times in s$"),
        (lambda t: t * 1e300, r"^time: sample 1 is at 1e\+298 s; give finite times in s$"),
        (lambda t: t**1.1, r"^time: instants are up to .* steps apart from equal ones, with"),
        (lambda t: t + 0.0015 * np.sin(9 * t * 100), r"^time: instants are up to 0.3 steps apart"),
    ],
)
def test_steps_that_are_not_equal(change: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Measured(change(np.arange(40) / 100), VALUES, "velocity")


def test_steps_that_are_nearly_equal() -> None:
    # Up to a tenth of a step is allowed.
    times = np.arange(40) / 100 + 0.0009 * np.sin(9 * np.arange(40))
    record = Measured(times, VALUES, "velocity")
    assert np.ptp(np.diff(record.time)) < 1e-15
    assert record.sampling_hz == pytest.approx(100.0, rel=2e-3)


def at(place: slice | int, value: float, count: int = 400) -> NDArray[np.float64]:
    """Return a decay that holds a value at some places."""
    values: NDArray[np.float64] = (
        5.0 * np.exp(-np.arange(count) / 300) * np.cos(0.21 * np.arange(count))
    )
    values[place] = value
    return values


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            at(7, math.nan),
            r"^values: 1 of 400 values are missing or not finite, the first at 0.014",
        ),
        (at(slice(3, 9), math.inf), r"^values: 6 of 400 values are missing or not finite, the fir"),
        (at(slice(None), 2.5), r"^values: all 400 values are 2.5; give a channel that moves$"),
        (at(7, 1e101), r"^values: give values of at most 1e\+100 in size$"),
        # From 0.25·5 to 9 between 120 and 135: the cosine is far from both values.
        (at(slice(120, 135), 0.0), r"^values: the value is 0 from 0.24 s to 0.268 s, with a jump"),
        (at(slice(120, 135), 9.0), r"^values: the value is 9 from 0.24 s to 0.268 s, with a jump"),
    ],
)
def test_values_that_no_sensor_measured(values: NDArray[np.float64], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Measured(np.arange(400) / 500, values, "acceleration")


def test_values_that_look_like_dropouts_and_are_none() -> None:
    times = np.arange(400) / 500
    motion = 5.0 * np.exp(-np.arange(400) / 60) * np.cos(0.21 * np.arange(400))
    # At rest before the release, which begins with a jump of the acceleration.
    Measured(times, np.where(times < 0.3, 0.0, motion), "acceleration")
    # A recorder of three levels holds each of them between jumps from one to the next.
    Measured(times, np.sign(np.round(motion)), "acceleration")
    # A recorder whose range is too small holds the ends of its range, without jumps.
    Measured(times, np.clip(motion, -2.0, 2.0), "acceleration")
    # A pulse is a jump up and down, with few samples between.
    motion[120:123] = 60.0
    Measured(times, motion, "acceleration")


def test_masked_values_and_nulls_are_missing() -> None:
    masked = np.ma.MaskedArray(VALUES, mask=[k == 3 for k in range(40)])
    nulls = pl.Series([None if k == 3 else value for k, value in enumerate(VALUES)])
    for values in (masked, nulls):
        with pytest.raises(ValueError, match=r"^values: 1 of 40 values are missing or not finite"):
            Measured(TIMES, values, "velocity")
    whole = np.ma.MaskedArray([k**2 for k in range(40)], mask=[k == 3 for k in range(40)])
    with pytest.raises(ValueError, match=r"^values: 1 of 40 values are missing or not finite"):
        Measured(TIMES, whole, "velocity")


def test_too_few_samples() -> None:
    with pytest.raises(ValueError, match=r"^the record has 15 samples; give at least 16$"):
        Measured(TIMES[:15], VALUES[:15], "velocity")
    assert len(Measured(TIMES[:16], VALUES[:16], "velocity")) == 16
    with pytest.raises(ValueError, match=r"^the record has 0 samples; give at least 16$"):
        Measured([], [], "velocity")
    with pytest.raises(ValueError, match=r"^time has 40 samples, values 39: give as many$"):
        Measured(TIMES, VALUES[1:], "velocity")


@pytest.mark.parametrize(
    "wrong",
    [
        "text",
        None,
        3.0,
        [[1.0, 2.0]],
        [[1.0], [2.0, 3.0]],
        [1j] * 40,
        ["1"] * 40,
        [True] * 40,
        np.arange(40).astype("timedelta64[ms]"),
    ],
)
def test_arrays_of_something_else(wrong: Any) -> None:
    with pytest.raises(TypeError, match=r"^values = .*: give a one-dimensional sequence of real n"):
        Measured(TIMES, wrong, "velocity")
    with pytest.raises(TypeError, match=r"^time = .*: give a one-dimensional sequence of real num"):
        Measured(wrong, VALUES, "velocity")


def test_words_of_a_record() -> None:
    with pytest.raises(ValueError, match=r"^quantity = 'acc': give one of acceleration, velocity"):
        Measured(TIMES, VALUES, "acc")  # type: ignore[arg-type]
    for key in ("name", "unit", "source"):
        with pytest.raises(TypeError, match=rf"^{key} = 7: give a word$"):
            Measured(TIMES, VALUES, "velocity", **{key: 7})  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"Measured has no such argument; did you mean `quantity`"):
        Measured(TIMES, VALUES, quantty="velocity")  # type: ignore[call-arg]
