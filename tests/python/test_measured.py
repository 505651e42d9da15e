"""Measured records: numbers that were written in some dialect come back, all else is refused.

Expected values are those that the tests write themselves, in decimal digits, so that they come back
to the bit. The three records in ``tests/data/identification`` were made by another program; their
sampling, clock and units are told by the JSON beside them, their values by the lines of the file.
"""

from __future__ import annotations

import copy
import json
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from iva.measured import Measured
from iva.measured.sensor_units import parted, unit_of
from recordings import TIMES, VALUES, table, written

TESTS = Path(__file__).parents[1]
DATA = TESTS / "data" / "identification"
#: The record that everybody gets, as an example.
SHIPPED = {"public_1_acceleration.csv": TESTS.parent / "studies" / "decay.csv"}


def file_of(name: str) -> Path:
    """Return where a record is."""
    return SHIPPED.get(name, DATA / name)


@pytest.mark.parametrize("name", sorted(path.stem for path in DATA.glob("*.json")))
def test_records_of_another_program(name: str) -> None:
    told = json.loads((DATA / f"{name}.json").read_text())
    record = Measured.read(file_of(told["file"]), told["column"])
    assert record.quantity == told["quantity"]
    assert len(record) == len(record.time) == len(record.values) == told["samples"]
    assert record.sampling_hz == told["sampling_hz"]
    assert record.time[0] == told["clock_of_first_sample_s"]
    assert record.name == told["column"]
    assert record.source == str(file_of(told["file"]))
    factor = told["sensor_chain"].get("unit_si", 1.0)
    rows = file_of(told["file"]).read_text().splitlines()[-told["samples"] :]
    texts = [row.replace(",", " " if "." in row else ".").split()[-1] for row in rows]
    texts = [text.rpartition(";")[2] for text in texts]
    assert record.values.tolist() == [float(text) * factor for text in texts]


def test_the_units_of_those_records() -> None:
    units = [Measured.read(path).unit for path in sorted([*DATA.glob("*.csv"), *SHIPPED.values()])]
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
    read = Measured.read(written(tmp_path, table()))
    assert repr(read).endswith("from 0 to 0.39 s, 'a1 [m/s^2]')")


def test_the_direction_of_the_sensor(tmp_path: Path) -> None:
    path = written(tmp_path, table())
    assert Measured.read(path, direction=-1).values.tolist() == [-value for value in VALUES]
    assert Measured.read(path, direction=1).values.tolist() == VALUES
    for wrong in (0, 2, 0.5, math.nan):
        with pytest.raises(ValueError, match=r"^direction = .*: give 1 or -1$"):
            Measured.read(path, direction=wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^direction = '-x': give a number, not str"):
        Measured.read(path, direction="-x")  # type: ignore[arg-type]


def test_a_cut_keeps_both_ends(tmp_path: Path) -> None:
    path = written(tmp_path, table())
    record = Measured.read(path, begin=0.07, end=0.31)
    assert record.values.tolist() == VALUES[7:32]
    assert record.time[0] == 0.07
    assert record.time[-1] == pytest.approx(0.31, abs=1e-15)
    assert Measured.read(path, begin=0.2301).values.tolist() == VALUES[24:]
    assert Measured.read(path, end=0.2399).values.tolist() == VALUES[:24]
    assert len(Measured.read(path, begin=-5, end=50)) == 40


def test_a_cut_knows_that_instants_are_rounded(tmp_path: Path) -> None:
    lines = "".join(f"{10 * k},{value}\n" for k, value in enumerate(VALUES))
    path = written(tmp_path, f"t [ms],a [g]\n{lines}")
    assert 350 * 1e-3 > 0.35  # the last instant of the cut, in binary
    assert len(Measured.read(path, end=0.35)) == 36


def test_a_cut_leaves_out_what_is_wrong(tmp_path: Path) -> None:
    values: list[Any] = list(VALUES)
    values[3] = "nan"
    path = written(tmp_path, table(values=values))
    assert Measured.read(path, begin=0.04).values.tolist() == VALUES[4:]
    late = table().replace("0.39,", "0.49,")
    assert Measured.read(written(tmp_path, late), end=0.38).values.tolist() == VALUES[:-1]
    for place, begin, end in (("0.0,", 0.01, None), ("0.39,", None, 0.38)):
        lost = table("t,a_g").replace(f"\n{place}", "\nnan,")
        assert len(Measured.read(written(tmp_path, lost), begin=begin, end=end)) == 39


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
        Measured.read(written(tmp_path, table()), **keywords)


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
    path = written(tmp_path, table(f"t,{header}"))
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
        Measured.read(written(tmp_path, table(header)), **keywords)


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
        Measured.read(written(tmp_path, table()), **keywords)
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
