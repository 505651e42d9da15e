"""Measured records: numbers that were written in some dialect come back, all else is refused.

Expected values are those that the tests write themselves, in decimal digits, so that they come back
to the bit. The three records in ``tests/data/identification`` were made by another program; their
sampling, clock and units are told by the JSON beside them, their values by the lines of the file.
"""

from __future__ import annotations

import copy
import json
import math
import os
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
import pyuff
import scipy.io
from numpy.typing import NDArray

import iva
from iva.measured import Measured
from iva.measured.sensor_units import parted, unit_of

DATA = Path(__file__).parents[1] / "data" / "identification"

# 40 samples at 100 Hz, of ±1.2 with three decimal places.
TIMES = [k / 100 for k in range(40)]
VALUES = [round(1.2 * math.cos(0.37 * k), 3) for k in range(40)]


def written(folder: Path, text: str | bytes, name: str = "decay.csv") -> Path:
    """Write a file and return its path."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def lines(header: str = "time [s],a1 [m/s^2]\n", values: list[Any] = VALUES) -> str:
    """Return a text with a column of the time and one of values."""
    return header + "".join(f"{t},{v}\n" for t, v in zip(TIMES, values, strict=True))


@pytest.mark.parametrize("name", sorted(path.stem for path in DATA.glob("*.json")))
def test_records_of_another_program(name: str) -> None:
    told = json.loads((DATA / f"{name}.json").read_text())
    record = Measured.read(DATA / told["file"], told["column"])
    assert record.quantity == told["quantity"]
    assert len(record) == len(record.time) == len(record.values) == told["samples"]
    assert record.sampling_hz == told["sampling_hz"]
    assert record.time[0] == told["clock_of_first_sample_s"]
    assert record.name == told["column"]
    assert record.source == str(DATA / told["file"])
    factor = told["sensor_chain"].get("unit_si", 1.0)
    rows = (DATA / told["file"]).read_text().splitlines()[-told["samples"] :]
    texts = [row.replace(",", " " if "." in row else ".").split()[-1] for row in rows]
    texts = [text.rpartition(";")[2] for text in texts]
    assert record.values.tolist() == [float(text) * factor for text in texts]


def test_the_units_of_those_records() -> None:
    units = [Measured.read(path).unit for path in sorted(DATA.glob("*.csv"))]
    assert units == ["m_s2", "g", "mm"]


def test_the_column_and_unit_of_the_front_page() -> None:
    record = Measured.read(DATA / "public_2_offset_bias.csv", column="a1", unit="g")
    # The first lines are 12,400000;0,040588 and 12,400500;0,046387.
    assert record.values[:2].tolist() == [0.040588 * 9.80665, 0.046387 * 9.80665]
    assert np.abs(record.time - (12.4 + np.arange(7000) / 2000)).max() < 1e-14


def test_a_record_of_arrays() -> None:
    for given in (VALUES, tuple(VALUES), np.array(VALUES), pl.Series(VALUES)):
        record = Measured(TIMES, given, "velocity")
        assert record.values.tolist() == VALUES
        assert record.quantity == "velocity"
        assert record.unit == "m/s"
        assert (record.name, record.source) == ("", None)
        assert record.sampling_hz == 100.0
    whole = Measured(TIMES, np.array([(k % 7) ** 2 for k in range(40)], dtype=np.int16), "velocity")
    assert whole.values.dtype == np.float64
    assert whole.values[6] == 36.0


def test_a_record_is_a_value_that_does_not_change() -> None:
    values = np.array(VALUES)
    record = Measured(TIMES, values, quantity="acceleration", name="a1")
    values[0] = 99.0
    assert record.values[0] == VALUES[0]
    with pytest.raises(ValueError, match="read-only"):
        record.values[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        record.time[0] = 1.0
    with pytest.raises(AttributeError):
        record.name = "b"  # type: ignore[misc]
    for same in (pickle.loads(pickle.dumps(record)), copy.deepcopy(record), copy.copy(record)):
        assert same is not record
        assert same != record
        assert same.values.tolist() == VALUES
        assert same.time.tolist() == record.time.tolist()
        assert (same.sampling_hz, same.quantity, same.name) == (100.0, "acceleration", "a1")
        assert not same.values.flags.writeable
    assert record in {record}


def test_what_a_record_shows(tmp_path: Path) -> None:
    record = Measured(TIMES, VALUES, "acceleration")
    assert repr(record) == "Measured(40 samples of acceleration at 100 Hz from 0 to 0.39 s)"
    read = Measured.read(written(tmp_path, lines()))
    assert repr(read).endswith("from 0 to 0.39 s, 'a1 [m/s^2]')")


def test_the_direction_of_the_sensor(tmp_path: Path) -> None:
    path = written(tmp_path, lines())
    assert Measured.read(path, direction=-1).values.tolist() == [-value for value in VALUES]
    assert Measured.read(path, direction=1).values.tolist() == VALUES
    for wrong in (0, 2, 0.5, math.nan):
        with pytest.raises(ValueError, match=r"^direction = .*: give 1 or -1$"):
            Measured.read(path, direction=wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^direction = '-x': give a number, not str"):
        Measured.read(path, direction="-x")  # type: ignore[arg-type]


def test_a_cut_keeps_both_ends(tmp_path: Path) -> None:
    path = written(tmp_path, lines())
    record = Measured.read(path, begin=0.07, end=0.31)
    assert record.values.tolist() == VALUES[7:32]
    assert record.time[0] == 0.07
    assert record.time[-1] == pytest.approx(0.31, abs=1e-15)
    assert Measured.read(path, begin=0.2301).values.tolist() == VALUES[24:]
    assert Measured.read(path, end=0.2399).values.tolist() == VALUES[:24]
    assert len(Measured.read(path, begin=-5, end=50)) == 40


def test_a_cut_leaves_out_what_is_wrong(tmp_path: Path) -> None:
    values: list[Any] = list(VALUES)
    values[3] = "nan"
    path = written(tmp_path, lines(values=values))
    assert Measured.read(path, begin=0.04).values.tolist() == VALUES[4:]
    late = lines().replace("0.39,", "0.49,")
    assert Measured.read(written(tmp_path, late), end=0.38).values.tolist() == VALUES[:-1]


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"begin": 0.3}, r"the record of 0 to 0.39 s has 10 samples from begin to end; give at l"),
        ({"end": 0.1}, "has 11 samples from begin to end; give at least 16"),
        ({"begin": 9}, "has 0 samples from begin to end"),
        ({"begin": 0.3, "end": 0.1}, "has 0 samples from begin to end"),
        ({"begin": math.nan}, r"^begin = nan: give a finite time in s$"),
        ({"end": math.inf}, r"^end = inf: give a finite time in s$"),
    ],
)
def test_cuts_that_are_refused(tmp_path: Path, keywords: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Measured.read(written(tmp_path, lines()), **keywords)


# Factors: g is 9.80665 m/s² exactly, an inch 25.4 mm, a foot 12 inches, a Gal 1 cm/s².
UNITS = {
    "m/s^2 m/s² m/s2 m/s**2 m_s2 m/s/s m*s^-2 m·s⁻² M/S2 m/(s^2) m_per_s2": ("acceleration", 1.0),
    "mm/s² mm_s2 mm/s^2": ("acceleration", 1e-3),
    "g G gn g_n": ("acceleration", 9.80665),
    "mg": ("acceleration", 9.80665e-3),
    "Gal cm/s²": ("acceleration", 1e-2),
    "in/s^2": ("acceleration", 0.0254),
    "ft/s²": ("acceleration", 0.3048),
    "m/s m_s m*s^-1 m/sec": ("velocity", 1.0),
    "mm/s mm_per_s": ("velocity", 1e-3),
    "in/s": ("velocity", 0.0254),
    "m": ("displacement", 1.0),
    "mm MM": ("displacement", 1e-3),
    "µm μm um": ("displacement", 1e-6),
    "in inch": ("displacement", 0.0254),
    "mil": ("displacement", 2.54e-5),
    "s sec S": ("time", 1.0),
    "ms msec": ("time", 1e-3),
    "µs us": ("time", 1e-6),
}


@pytest.mark.parametrize("spellings", UNITS)
def test_units(spellings: str) -> None:
    for text in spellings.split():
        unit = unit_of(text)
        assert unit is not None, text
        assert (unit.text, unit.quantity) == (text, UNITS[spellings][0])
        assert unit.factor == pytest.approx(UNITS[spellings][1], rel=1e-15)
    assert unit_of("m / s ^ 2") is not None
    assert unit_of("m s^-2") is not None


def test_what_is_no_unit() -> None:
    for text in ("", "V", "mV/g", "Mm", "kg", "s2", "m/s^3", "g/s", "m/min", "%", "-", "1", "N"):
        assert unit_of(text) is None, text


HEADERS = {
    "a1 [g]": ("a1", "g"),
    "a1 (g)": ("a1", "g"),
    "a1[mm/s²]": ("a1", "mm/s²"),
    "a1 / g": ("a1", "g"),
    "a1 / (m/s²)": ("a1", "m/s²"),
    "a1 in mm": ("a1", "mm"),
    "a1_g": ("a1", "g"),
    "acceleration_m_s2": ("acceleration", "m_s2"),
    "v_mm_per_s": ("v", "mm_per_s"),
    "displacement_mm": ("displacement", "mm"),
    "time_s": ("time", "s"),
    "Zeit [s]": ("Zeit", "s"),
    "a1 [V]": ("a1", "V"),
    # Not units, or words that mean something else more often.
    "signal_in": ("signal_in", ""),
    "x_left": ("x_left", ""),
    "a_1": ("a_1", ""),
    "g": ("g", ""),
    "a/b": ("a/b", ""),
}


@pytest.mark.parametrize("header", HEADERS)
def test_names_with_units(header: str) -> None:
    assert parted(header) == HEADERS[header]


@pytest.mark.parametrize(
    ("header", "unit"), [("a", "mm/s^2"), ("a_mm_s2", None), ("a [kN]", "mm/s²"), ("a (mm/s2)", "")]
)
def test_the_unit_is_that_of_the_file_or_the_one_given(
    tmp_path: Path, header: str, unit: str | None
) -> None:
    path = written(tmp_path, lines(f"t,{header}\n"))
    record = Measured.read(path, unit=unit or None)
    assert record.values.tolist() == [value * 1e-3 for value in VALUES]
    assert record.quantity == "acceleration"
    assert (unit_of(record.unit) or unit_of("s")).factor == 1e-3  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("header", "keywords", "message"),
    [
        ("t,a1", {}, r"^unit = None: decay.csv states none for 'a1'; give one, such as m/s\^2, mm"),
        (
            "t,a [V]",
            {},
            r"^unit = None: decay.csv states unit 'V', which is none of a motion for 'a",
        ),
        ("t,a1", {"unit": "V"}, r"^unit = 'V': give a unit of a motion, such as m/s\^2, mm/s\^2, "),
        ("t,a1", {"unit": "ms"}, r"^unit = 'ms': give a unit of a motion, such as "),
        ("t,a [g]", {"unit": "mm"}, r"^unit = 'mm': the file says that 'a \[g\]' is in g; leave "),
        ("t,a [g]", {"unit": "mg"}, r"^unit = 'mg': the file says that 'a \[g\]' is in g; leave "),
        ("t,a_mm", {"quantity": "velocity"}, r"^quantity = 'velocity': mm is a unit of displ"),
        ("t,a_mm", {"quantity": "speed"}, r"^quantity = 'speed': give one of acceleration, veloc"),
        ("t,a_mm", {"quantity": "velocty"}, r"did you mean `velocity`\?$"),
        ("t,a_mm", {"column": "b"}, r"^column = 'b': no such column; there is 't', 'a_mm'$"),
        ("t,acc_g", {"column": "ac_g"}, r"no such column; did you mean `acc_g`\?; there is"),
        ("t,a_mm", {"column": 2}, r"^column = 2: give an index from 0 to 1; there is 't', 'a_mm'"),
        ("t,a_mm", {"column": -1}, r"^column = -1: give an index from 0 to 1"),
        ("t,a_mm", {"column": "t"}, r"^column = 't': this column holds the time, not a motion$"),
        ("a,b", {"unit": "g"}, r"^column = None: name one column; there is 'a', 'b'$"),
        ("a_g,a_g", {"column": "a"}, r"^column = 'a': columns 0, 1 have this name, give an index"),
        ("x,a_g", {"column": "a"}, r"^sampling_hz = None: decay.csv has no column of time; give s"),
        ("x,a_g", {"column": "a", "time": "y"}, r"^time = 'y': no such column; there is"),
        ("x,a_g", {"column": "a", "time": 1}, r"^time = 1: this is the column of the values$"),
        ("x_mm,a_g", {"column": "a", "time": 0}, r"^time = 0: this column is in 'mm'; give one in"),
        ("t,a_mm", {"sampling_hz": 0}, r"^sampling_hz = 0: give a finite number greater than 0$"),
        ("t,a_mm", {"sampling_hz": math.inf}, r"^sampling_hz = inf: give a finite number great"),
        ("t,a_mm", {"sampling_hz": 50}, r"^sampling_hz = 50: .* with 100 samples a second"),
    ],
)
def test_what_is_not_known_is_refused(
    tmp_path: Path, header: str, keywords: Any, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        Measured.read(written(tmp_path, lines(f"{header}\n")), **keywords)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"column": 1.5}, r"^column = 1.5: give the name of a column, or its index$"),
        ({"column": True}, r"^column = True: give the name of a column, or its index$"),
        ({"time": b"t"}, r"^time = b't': give the name of a column, or its index$"),
        ({"unit": 9.81}, r"^unit = 9.81: give a word$"),
        ({"quantity": 3}, r"^quantity = 3: give a word$"),
        ({"sampling_hz": "100"}, r"^sampling_hz = '100': give a number, not str$"),
        ({"begin": "now"}, r"^begin = 'now': give a number, not str$"),
        ({"colum": "a1"}, r"^colum = 'a1': Measured.read has no such argument; did you mean `col"),
    ],
)
def test_arguments_of_the_wrong_type(tmp_path: Path, keywords: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        Measured.read(written(tmp_path, lines()), **keywords)
    with pytest.raises(TypeError, match=r"^path = 7: give the name of a file$"):
        Measured.read(7)  # type: ignore[arg-type]


def test_columns_by_name_and_by_index(tmp_path: Path) -> None:
    text = "note,a [g],t [ms],a [mm],b 2_m_s\n" + "".join(
        f"x{k},{k % 5},{10 * k},{value},{k}\n" for k, value in enumerate(VALUES)
    )
    path = written(tmp_path, text)
    for key in ("a [mm]", 3, np.int64(3)):
        record = Measured.read(path, key)  # type: ignore[arg-type]
        assert record.values.tolist() == [value * 1e-3 for value in VALUES]
        assert record.sampling_hz == pytest.approx(100.0, rel=1e-12)
    assert Measured.read(path, "b 2").quantity == "velocity"
    assert Measured.read(path, "b 2", time="t").time[5] == pytest.approx(0.05, abs=1e-15)
    with pytest.raises(ValueError, match=r"^column = 'a': columns 1, 3 have this name, give an in"):
        Measured.read(path, "a")
    with pytest.raises(ValueError, match=r"decay.csv:2: 'x0' is not a number; give numbers such"):
        Measured.read(path, "note", unit="g")


def test_two_columns_of_the_time(tmp_path: Path) -> None:
    text = "t [s],zeit [ms],a [g]\n" + "".join(
        f"{t},{500 * t},{v}\n" for t, v in zip(TIMES, VALUES, strict=True)
    )
    path = written(tmp_path, text)
    with pytest.raises(ValueError, match=r"^time = None: name one column; there is 't \[s\]', 'z"):
        Measured.read(path)
    assert Measured.read(path, time="t").sampling_hz == 100.0
    assert Measured.read(path, time="zeit").sampling_hz == pytest.approx(200.0, rel=1e-12)


def test_a_record_without_a_column_of_the_time(tmp_path: Path) -> None:
    path = written(tmp_path, "a [mm]\n" + "".join(f"{value}\n" for value in VALUES))
    record = Measured.read(path, sampling_hz=2048)
    assert record.sampling_hz == 2048.0
    assert record.time.tolist() == [k / 2048 for k in range(40)]
    assert Measured.read(path, sampling_hz=2048, begin=10 / 2048).time[0] == 10 / 2048
    with pytest.raises(ValueError, match=r"^sampling_hz = None: decay.csv has no column of time"):
        Measured.read(path)
    bare = written(tmp_path, "".join(f"{value}\n" for value in VALUES), "bare.txt")
    assert Measured.read(bare, 0, unit="mm", sampling_hz=50).values.tolist() == [
        value * 1e-3 for value in VALUES
    ]
    assert Measured.read(bare, unit="mm", sampling_hz=50).name == ""
    with pytest.raises(ValueError, match=r"^column = 'a': no such column; there is columns witho"):
        Measured.read(bare, "a", unit="mm", sampling_hz=50)
    with pytest.raises(ValueError, match=r"^unit = None: bare.txt states none for its columns"):
        Measured.read(bare, sampling_hz=50)


# --- Sampling ----------------------------------------------------------------------------------


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
        (lambda t: np.where(t == 0.2, math.nan, t), r"^time: sample 20 has no time; give finite"),
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


# --- Values ------------------------------------------------------------------------------------


def at(place: slice | int, value: float, count: int = 400) -> NDArray[np.float64]:
    """Return a decay that holds a value at some places."""
    values = 5.0 * np.exp(-np.arange(count) / 300) * np.cos(0.21 * np.arange(count))
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


# --- Files -------------------------------------------------------------------------------------


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for ending in ("csv", "mat", "uff", "at2"):
        with pytest.raises(iva.IvaError, match=rf"none.{ending} cannot be read: No such file or d"):
            Measured.read(tmp_path / f"none.{ending}")
    folder = tmp_path / "folder.csv"
    folder.mkdir()
    with pytest.raises(iva.IvaError, match=r"folder.csv cannot be read: it is a folder; give a fi"):
        Measured.read(folder)
    with pytest.raises(ValueError, match=r"^path = .*: give a file whose name ends with one of .c"):
        Measured.read(tmp_path / "decay.xlsx")
    with pytest.raises(iva.IvaError, match=r"cannot be read: embedded null"):
        Measured.read("a\0b.csv")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(iva.IvaError, match=r"pipe.csv cannot be read: it is no regular file$"):
        Measured.read(tmp_path / "pipe.csv")


def test_names_of_files_may_be_text_or_paths(tmp_path: Path) -> None:
    path = written(tmp_path, lines(), "DECAY.CSV")
    assert Measured.read(str(path)).source == Measured.read(path).source == str(path)


def test_accelerograms_are_those_of_recorded_forces() -> None:
    path = Path(__file__).parents[2] / "studies" / "synthetic_quake.at2"
    record = Measured.read(path)
    quake = iva.Recorded.read(path)
    assert record.values.tolist() == quake.values.tolist()
    assert record.time == pytest.approx(quake.times, abs=1e-12)
    assert (record.quantity, record.unit, record.sampling_hz) == ("acceleration", "g", 50.0)
    assert Measured.read(path, "acceleration", unit="g", direction=-1).values[7] == -quake.values[7]
    with pytest.raises(ValueError, match=r"^unit = 'm/s²': the file says that 'acceleration \[g\]"):
        Measured.read(path, unit="m/s²")


# --- MAT files ---------------------------------------------------------------------------------


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_mat_files(tmp_path: Path, kind: type, compressed: bool) -> None:
    path = tmp_path / "decay.mat"
    time, values = np.array(TIMES, dtype=kind), np.array(VALUES, dtype=kind)
    contents = {"t": time, "a1_g": values.reshape(-1, 1), "fs": 100.0, "note": "decay"}
    scipy.io.savemat(path, contents, do_compression=compressed)
    record = Measured.read(path)
    assert record.values.tolist() == (values.astype(float) * 9.80665).tolist()
    assert record.sampling_hz == pytest.approx(100.0, rel=1e-6)
    assert record.name == "a1_g"
    assert Measured.read(path, "a1", unit="g", begin=0.1).time[0] == time[10]


def test_mat_files_with_structs_and_matrices(tmp_path: Path) -> None:
    path = tmp_path / "decay.mat"
    other = [2.0 * value for value in VALUES]
    rig = {"time": TIMES, "x_mm": VALUES, "counts": np.arange(40, dtype=np.int16) ** 2}
    contents = {
        "rig": rig,
        "both": np.column_stack([VALUES, other]),
        "time": [2 * t for t in TIMES],
        "units": {"rig": {"counts": "mm/s"}},
        "complex": np.array(VALUES) * 1j,
    }
    scipy.io.savemat(path, contents)
    record = Measured.read(path, "rig.x_mm")
    assert record.values.tolist() == [value * 1e-3 for value in VALUES]
    assert record.sampling_hz == 100.0  # the time beside it, not that outside of the struct
    assert Measured.read(path, "rig.x").values.tolist() == record.values.tolist()
    counts = Measured.read(path, "rig.counts")
    assert counts.unit == "mm/s"
    assert counts.values[9] == 81 * 1e-3
    column = Measured.read(path, "both(:,2)", time="time", unit="m")
    assert column.values.tolist() == other
    assert column.sampling_hz == 50.0
    with pytest.raises(ValueError, match=r"^column = 'complex': no such column; there is 'rig.t"):
        Measured.read(path, "complex", unit="m")


def test_the_trajectory_of_a_run_comes_back(tmp_path: Path, metric: iva.Run) -> None:
    # Without impacts in the first 16 samples, the only ones that are there twice.
    metric.write_mat(tmp_path / "run.mat", samples_per_period=400)
    record = Measured.read(tmp_path / "run.mat", "trajectory.displacement", end=0.005)
    expected = metric.trajectory(400)["displacement"][: len(record)].to_numpy()
    assert record.values.tolist() == expected.tolist()
    assert (record.unit, record.quantity) == ("m", "displacement")


def test_mat_files_that_are_refused(tmp_path: Path) -> None:
    newer = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + b"\x89HDF\r\n\x1a\n" + bytes(99)
    with pytest.raises(ValueError, match=r"new.mat: a MAT file of version 7.3, which is HDF5; sav"):
        Measured.read(written(tmp_path, newer, "new.mat"))
    with pytest.raises(ValueError, match=r"bad.mat: a damaged MAT file \(.*\); save it anew"):
        Measured.read(written(tmp_path, b"nothing of the kind" * 20, "bad.mat"))
    scipy.io.savemat(tmp_path / "words.mat", {"note": "decay", "fs": 100.0})
    with pytest.raises(ValueError, match=r"words.mat: no vectors of real numbers in it; give tim"):
        Measured.read(tmp_path / "words.mat")
    scipy.io.savemat(tmp_path / "two.mat", {"t": TIMES, "a_g": VALUES[1:]})
    with pytest.raises(ValueError, match=r"^time = 't': it has 40 samples, but 'a_g' has 39$"):
        Measured.read(tmp_path / "two.mat", "a", time="t")


@pytest.mark.parametrize(
    ("module", "name", "message"),
    [
        ("scipy.io", "a.mat", r"reading a MAT file needs SciPy: pip install 'iva-dynamics\[export"),
        ("pyuff", "a.uff", r"reading a universal file needs pyuff: pip install 'iva-dynamics\[exp"),
    ],
)
def test_packages_that_are_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, name: str, message: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=message):
        Measured.read(written(tmp_path, b"MATLAB 5.0 MAT-file", name))


# --- Universal files ---------------------------------------------------------------------------


def dataset(values: Any, **changes: Any) -> dict[str, Any]:
    """Return a dataset 58 of a time response."""
    made = {
        "type": 58,
        "binary": 1,
        "id1": "floor 3",
        "func_type": 1,
        "rsp_node": 7,
        "rsp_dir": -2,
        "ref_node": 0,
        "ref_dir": 0,
        "abscissa_spacing": 1,
        "abscissa_spec_data_type": 17,
        "abscissa_axis_lab": "Time",
        "abscissa_axis_units_lab": "s",
        "ordinate_spec_data_type": 12,
        "ordinate_axis_lab": "Acceleration",
        "ordinate_axis_units_lab": "m/s^2",
        "orddenom_spec_data_type": 0,
        "x": np.array(TIMES),
        "data": np.array(values),
    }
    return made | changes


def universal(folder: Path, *sets: dict[str, Any]) -> Path:
    """Write some datasets into a file."""
    path = folder / "decay.uff"
    path.unlink(missing_ok=True)
    pyuff.UFF(str(path)).write_sets([dict(one) for one in sets], "add")
    return path


def in_millimetres() -> dict[str, Any]:
    """Return dataset 164 of a file in mm: a metre is 1000 of its units."""
    return {
        "type": 164,
        "units_code": 5,
        "units_description": "MM",
        "temp_mode": 1,
        "length": 1000.0,
        "force": 1000.0,
        "temp": 1.0,
        "temp_offset": 273.15,
    }


pyuff_leaves_files_open = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pyuff_leaves_files_open
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize(("unit", "factor"), [("m/s^2", 1.0), ("g", 9.80665), ("mm/s2", 1e-3)])
def test_universal_files(tmp_path: Path, binary: int, unit: str, factor: float) -> None:
    path = universal(tmp_path, dataset(VALUES, binary=binary, ordinate_axis_units_lab=unit))
    record = Measured.read(path)
    assert record.values.tolist() == [value * factor for value in VALUES]
    assert record.sampling_hz == 100.0
    assert (record.unit, record.quantity, record.name) == (unit, "acceleration", "floor 3")


@pyuff_leaves_files_open
def test_channels_of_a_universal_file(tmp_path: Path) -> None:
    other = dataset(
        [2 * value for value in VALUES],
        id1="floor 4",
        rsp_dir=1,
        ordinate_axis_units_lab="mm",
        ordinate_spec_data_type=8,
        abscissa_axis_units_lab="ms",
    )
    spectrum = dataset(VALUES, func_type=4, abscissa_spec_data_type=18)
    path = universal(tmp_path, dataset(VALUES), other, spectrum)
    with pytest.raises(ValueError, match=r"^column = None: name one column; there is 'floor 3', "):
        Measured.read(path)
    for key in ("floor 4", "7:+X", 1):
        record = Measured.read(path, key)  # type: ignore[arg-type]
        assert record.values.tolist() == [2 * value * 1e-3 for value in VALUES]
        assert record.sampling_hz == pytest.approx(1e5, rel=1e-9)
    assert Measured.read(path, "7:-Y").quantity == "acceleration"


@pyuff_leaves_files_open
@pytest.mark.parametrize(
    ("kind", "quantity"), [(8, "displacement"), (11, "velocity"), (12, "acceleration")]
)
def test_units_of_dataset_164(tmp_path: Path, kind: int, quantity: str) -> None:
    plain = dataset(VALUES, ordinate_axis_units_lab="NONE", ordinate_spec_data_type=kind)
    record = Measured.read(universal(tmp_path, in_millimetres(), plain))
    assert record.quantity == quantity
    assert record.values == pytest.approx(np.array(VALUES) * 1e-3, rel=1e-15)
    unknown = dataset(VALUES, ordinate_axis_units_lab="NONE", ordinate_spec_data_type=1)
    with pytest.raises(ValueError, match=r"^unit = None: decay.uff states none for 'floor 3'; gi"):
        Measured.read(universal(tmp_path, in_millimetres(), unknown))
    # What stands on the axis is what was meant: software often leaves dataset 164 as it is.
    shown = dataset(VALUES, ordinate_axis_units_lab="g")
    record = Measured.read(universal(tmp_path, in_millimetres(), shown))
    assert record.values.tolist() == [value * 9.80665 for value in VALUES]


@pyuff_leaves_files_open
def test_a_universal_file_of_a_run_comes_back(tmp_path: Path, metric: iva.Run) -> None:
    metric.write_uff(tmp_path / "run.uff", samples_per_second=2000)
    record = Measured.read(tmp_path / "run.uff", 1)
    assert (record.quantity, record.sampling_hz) == ("velocity", 2000.0)
    # The instants of the file are multiples of 5e-4 s, those of the record quotients by 2000 Hz.
    expected = metric.at(record.time[:-1])["velocity"].to_numpy()
    assert record.values[:-1] == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pyuff_leaves_files_open
def test_universal_files_that_are_refused(tmp_path: Path) -> None:
    message = r"uff: no time responses \(dataset 58\) in it; export some$"
    for wrong in (
        dataset(VALUES, func_type=4),
        dataset(VALUES, abscissa_spec_data_type=18),
        dataset(VALUES, abscissa_axis_units_lab="1/omega_n"),
        in_millimetres(),
    ):
        with pytest.raises(ValueError, match=message):
            Measured.read(universal(tmp_path, wrong))
    with pytest.raises(ValueError, match=r"bad.uff: (no time responses|a damaged universal file)"):
        Measured.read(written(tmp_path, b"nothing of the kind\n" * 20, "bad.uff"))
    path = universal(tmp_path, dataset(VALUES))
    half = path.read_bytes().replace(b"    -1\n    58", b"    -1\n    58", 1)[:700] + b"\n    -1\n"
    with pytest.raises(ValueError, match=r"half.uff: "):
        Measured.read(written(tmp_path, half, "half.uff"))
