"""Units of recorded forces: what a file or the caller names is used, what may be g is asked for.

Expected values are the decimal numbers that the tests write times the factor of their unit:
standard gravity 9.80665 m/s² (3rd CGPM, 1901), the pound-force of 0.45359237 kg under it.
"""

from __future__ import annotations

import pickle
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import iva
from iva.measured import Measured
from recordings import TIMES, VALUES, rows, table, written

G = 9.80665

#: Spellings of units of acceleration, and what one is in m/s².
ACCELERATIONS = {
    "g": G,
    "mg": G * 1e-3,
    "Gal": 1e-2,
    "cm/s^2": 1e-2,
    "cm/sec/sec": 1e-2,
    "mm/s²": 1e-3,
    "m/s2": 1.0,
    "in/s^2": 0.0254,
    "N/kg": 1.0,
}


def test_the_unit_in_the_head_drives_the_structure(tmp_path: Path) -> None:
    # One motion of the ground, 0.3 g at 1.4 Hz, in three units, and as arrays in SI units.
    time = np.arange(500) / 100
    shape = 0.3 * np.sin(2 * np.pi * 1.4 * time)
    mast = iva.Primary(mass=200.0, stiffness=16e3, damping=30.0)
    heads = {
        "time (s),acceleration (g)": (1.0, 1.0),
        "time (ms),acceleration (m/s^2)": (1e3, G),
        "time_s,acceleration_mm_s2": (1.0, 1e3 * G),
    }

    def impacts(force: iva.Recorded) -> int:
        run = iva.simulate(
            iva.Siva(mass=20.0, restitution=0.6, gap_mm=140.0),
            mast,
            start=iva.Start(),
            force=force,
            duration=5.0,
        )
        return run.impacts.height

    expected = impacts(iva.Recorded(time, shape * G, "base_acceleration"))
    assert expected > 30
    for head, (per_second, per_g) in heads.items():
        lines = [f"{per_second * t:.9g},{per_g * a:.15g}" for t, a in zip(time, shape, strict=True)]
        path = written(tmp_path, "\n".join([head, *lines]))
        quake = iva.Recorded.read(path, "base_acceleration")
        assert quake.values == pytest.approx(shape * G, rel=1e-14)
        assert quake.times == pytest.approx(time, rel=1e-14)
        assert impacts(quake) == expected


@pytest.mark.parametrize(("unit", "factor"), ACCELERATIONS.items())
def test_units_in_heads_and_given(tmp_path: Path, unit: str, factor: float) -> None:
    expected = [value * factor for value in VALUES]
    for head in (f"time [ms],a1 [{unit}]", f"time [ms],a1 / ({unit})"):
        path = written(tmp_path, table(head))
        quake = iva.Recorded.read(path, "base_acceleration")
        assert quake.values.tolist() == expected
        assert quake.times.tolist() == [t * 1e-3 for t in TIMES]
        assert quake.values.tolist() == Measured.read(path).values.tolist()
        assert iva.Recorded.read(path, unit=unit).values.tolist() == expected
    plain = written(tmp_path, "\n".join(rows(",")))
    assert iva.Recorded.read(plain, "base_acceleration", unit=unit).values.tolist() == expected


@given(
    delimiter=st.sampled_from([";", "\t", ",", " "]),
    decimal=st.sampled_from([".", ","]),
    unit=st.sampled_from(sorted(ACCELERATIONS)),
    clock=st.sampled_from([("s", 1.0), ("ms", 1e-3), ("us", 1e-6)]),
    mark=st.sampled_from(["", "# "]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"]),
    steps=st.lists(st.integers(1, 10**6), min_size=8, max_size=30),
    thousandths=st.integers(-(10**6), 10**6),
)
def test_what_is_written_in_any_dialect_comes_back(
    delimiter: str,
    decimal: str,
    unit: str,
    clock: tuple[str, float],
    mark: str,
    encoding: str,
    steps: list[int],
    thousandths: int,
) -> None:
    if delimiter == decimal:
        delimiter = ";"
    times = np.cumsum(steps) / 1000
    values = [(thousandths + 7 * k) / 1000 for k in range(len(steps))]
    lines = [f"{t:.3f}{delimiter}{v:.3f}" for t, v in zip(times, values, strict=True)]
    head = f"{mark}t ({clock[0]}){delimiter}a ({unit})"
    text = "\n".join([head, *(line.replace(".", decimal) for line in lines)]) + "\n"
    with TemporaryDirectory() as folder:
        path = written(Path(folder), text.encode(encoding))
        quake = iva.Recorded.read(path, "base_acceleration")
    assert quake.times.tolist() == [float(f"{t:.3f}") * clock[1] for t in times]
    assert quake.values.tolist() == [value * ACCELERATIONS[unit] for value in values]


@pytest.mark.parametrize(
    ("head", "factor"),
    [
        ("time (s),force (N)", 1.0),
        ("time (s),force [kN]", 1e3),
        ("time_s,force_N", 1.0),
        ("time_s,load_kN", 1e3),
        ("time (s),shaker (lbf)", 0.45359237 * G),
    ],
)
def test_forces(tmp_path: Path, head: str, factor: float) -> None:
    push = iva.Recorded.read(written(tmp_path, table(head)))
    assert push.kind == "force_newtons"
    assert push.values.tolist() == [value * factor for value in VALUES]
    with pytest.raises(
        ValueError, match=r'^kind = "force": the values are in .*, a unit of force; g'
    ):
        iva.Recorded.read(written(tmp_path, table(head)), "force")


def test_what_names_no_unit_is_taken_as_it_stands(tmp_path: Path) -> None:
    # A force may be of any size. An acceleration of 2.4 is too large for g, too small for mm/s².
    double = [2 * value for value in VALUES]
    for head in ("-1,0", "time,force", "t (s),f/M", "time,north_N", "t,push [-]"):
        path = written(tmp_path, table(head))
        assert iva.Recorded.read(path).values.tolist()[-40:] == VALUES
        assert iva.Recorded.read(path).kind == "force"
    path = written(tmp_path, table("t,ground", double))
    quake = iva.Recorded.read(path, "base_acceleration")
    assert quake.values.tolist() == double
    # Nothing says that these are in s and m/s², so a structure without a frequency takes them.
    run = iva.simulate(
        iva.Siva(gap=1.0, mass_ratio=0.1, restitution=0.6),
        iva.Primary(),
        start=iva.Start(),
        force=quake,
        duration=1.0,
    )
    assert run.summary["outcome"].item() == "finished"


@pytest.mark.parametrize(
    ("head", "kind", "factor", "others"),
    [
        ("t,ground", "base_acceleration", 0.25, "g"),
        ("t,ground", "base_acceleration", 1000.0, r"mm/s\^2 or Gal"),
        ("t,acceleration", None, 0.25, "g"),
        ("t;Beschleunigung", "force", 1000.0, r"mm/s\^2 or Gal"),
    ],
)
def test_what_may_be_in_g_is_asked_for(
    tmp_path: Path, head: str, kind: str | None, factor: float, others: str
) -> None:
    values = [value * factor for value in VALUES]
    path = written(tmp_path, table(head.replace(";", ","), values))
    message = (
        rf"^unit = None: decay.csv states no unit, and accelerations of up to {1.2 * factor:g}"
    )
    with pytest.raises(ValueError, match=message + rf" may be in m/s\^2 or in {others}; give unit"):
        iva.Recorded.read(path, kind)  # type: ignore[arg-type]
    read = iva.Recorded.read(path, kind, unit="1")  # type: ignore[arg-type]
    assert read.values.tolist() == values
    assert iva.Recorded.read(path, kind, unit="m/s²").values.tolist() == values  # type: ignore[arg-type]
    # Who multiplies by g, or by 0.001, has seen to it.
    assert iva.Recorded.read(path, kind, scale=G).values.tolist() == values  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=message[:-6]):
        iva.Recorded.read(path, kind, scale=1.01)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("head", "keywords", "message"),
    [
        (
            "t,a [g]",
            {"unit": "m/s^2"},
            r"^unit = 'm/s\^2': the file says that 'a \[g\]' is in g; lea",
        ),
        (
            "t,a [g]",
            {"unit": "1"},
            r"^unit = '1': the file says that 'a \[g\]' is in g; leave unit",
        ),
        (
            "t,a [N]",
            {"unit": "g"},
            r"^unit = 'g': the file says that 'a \[N\]' is in N; leave unit",
        ),
        (
            "t,a",
            {"unit": "mm"},
            r"^unit = 'mm': give a unit of a force, such as m/s\^2, mm/s\^2, g",
        ),
        ("t,a", {"unit": 3}, r"^unit = 3: give a word$"),
        (
            "t,a [mm]",
            {},
            r"^unit = None: decay.csv states unit 'mm' for 'a \[mm\]', which is none of",
        ),
        (
            "t,a [V]",
            {},
            r"^unit = None: decay.csv states unit 'V' for 'a \[V\]', which is none of a f",
        ),
        (
            "t,a [g]",
            {"kind": "force_newtons"},
            r'in g, a unit of acceleration; give "force" or "bas',
        ),
        ("t [min],a [g]", {}, r"^time: 't \[min\]' is in 'min'; give a column in s, ms or us$"),
        (
            "t,a",
            {"sampling_hz": 100},
            r"^sampling_hz = 100: decay.csv has instants of its own; leave",
        ),
        (
            "t,a",
            {"kind": "ground", "unit": "g"},
            r'^kind = "ground": give one of "force", "force_new',
        ),
        ("t,a", {"column": "b"}, r"^column = 'b': no such column; there is 't', 'a'$"),
    ],
)
def test_units_that_are_refused(
    tmp_path: Path, head: str, keywords: dict[str, object], message: str
) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        iva.Recorded.read(written(tmp_path, table(head)), **keywords)  # type: ignore[arg-type]


def test_a_record_in_si_units_says_so(tmp_path: Path) -> None:
    quake = iva.Recorded.read(written(tmp_path, table("t [s],a [g]")), "base_acceleration")
    for record in (quake, pickle.loads(pickle.dumps(quake))):
        with pytest.raises(ValueError, match=r"its times are in s; give primary.natural_frequency"):
            iva.simulate(
                iva.Siva(gap=1.0, mass_ratio=0.1, restitution=0.6),
                iva.Primary(),
                start=iva.Start(),
                force=record,
                duration=1.0,
            )


def test_one_column_of_several(tmp_path: Path) -> None:
    lines = [f"{row};{value}" for row, value in zip(rows(), reversed(VALUES), strict=True)]
    path = written(tmp_path, "\n".join(["t [s];a [g];b [kN]", *lines]))
    with pytest.raises(
        ValueError, match=r"^column = None: name one column; there is 't \[s\]', 'a"
    ):
        iva.Recorded.read(path)
    assert iva.Recorded.read(path, column="a").values.tolist() == [value * G for value in VALUES]
    push = iva.Recorded.read(path, column=2)
    assert (push.kind, push.values[0]) == ("force_newtons", VALUES[-1] * 1e3)
    behind = written(
        tmp_path, "\n".join(["a [g],t [ms]", *(f"{v},{k}" for k, v in enumerate(VALUES))])
    )
    assert iva.Recorded.read(behind).values.tolist() == [value * G for value in VALUES]
    assert iva.Recorded.read(behind).times[7] == 7 * 1e-3


def test_values_that_are_missing(tmp_path: Path) -> None:
    text = table("t [s],a [g]", [*VALUES[:5], "", *VALUES[6:]])
    path = written(tmp_path, text.replace(",", ";").replace(".", ","))
    with pytest.raises(
        ValueError, match=r"csv: 1 of 40 points are missing or not finite, the first"
    ):
        iva.Recorded.read(path)


def test_decimal_commas_that_come_late(tmp_path: Path) -> None:
    path = written(tmp_path, "t [ms];a [g]\n0;0\n10;1\n20,5;0,3\n30;0\n")
    quake = iva.Recorded.read(path)
    assert quake.values.tolist() == [0.0, G, 0.3 * G, 0.0]
    assert quake.times.tolist() == [0.0, 10 * 1e-3, 20.5 * 1e-3, 30 * 1e-3]


@pytest.mark.parametrize(
    ("peak", "other"), [(1.99, "g"), (2.01, None), (49.9, None), (50.1, r"mm/s\^2")]
)
def test_accelerations_of_a_size_that_leaves_the_unit_open(
    tmp_path: Path, peak: float, other: str | None
) -> None:
    # Up to 2 they may be in g, above 50 in mm/s² or Gal; the ground never moved with 5 g.
    path = written(tmp_path, table("t,a", [peak if k == 7 else 0.1 for k in range(40)]), "a.csv")
    if other is None:
        assert iva.Recorded.read(path, "base_acceleration").values[7] == peak
        return
    with pytest.raises(ValueError, match=rf"up to {peak} may be in m/s\^2 or in {other}"):
        iva.Recorded.read(path, "base_acceleration")
