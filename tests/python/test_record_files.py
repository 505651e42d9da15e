"""Formats of recorders and of strong-motion records: the numbers that the tests write come back.

Expected values are the decimal numbers of the files, read by Python's own ``float``, times the
factor of their unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

import iva
from iva.measured import Measured
from recordings import TIMES, VALUES, written

G = 9.80665


def block(values: Sequence[float], fields: int = 8, width: int = 10) -> str:
    """Return numbers with five decimal places in fields of fixed width, several a line."""
    cells = [f"{value:{width}.5f}" for value in values]
    lines = [cells[at : at + fields] for at in range(0, len(cells), fields)]
    return "".join("".join(line) + "\n" for line in lines)


def reals(numbers: dict[int, float]) -> str:
    """Return the hundred real numbers of a COSMOS header, unknown but for some, counted from 1."""
    return block([numbers.get(place, -999.0) for place in range(1, 101)], 6, 13)


def cosmos(
    channel: int = 1, unit: str = "cm/sec2 (04)", known: dict[int, float] | None = None
) -> str:
    """Return a channel in the COSMOS format, at 100 Hz unless real numbers are known."""
    texts = [
        "Corrected acceleration   (Format v01.20 with 13 text lines) Src: none",
        *[f"text {line} of 13: 12.5 0.25" for line in range(2, 7)],
        f"Sta Chan {channel:3}: 90 deg (Rcrdr Chan  7) Location:",
        *[f"text {line} of 13" for line in range(8, 14)],
        "   20 Integer-header values follow on   2 lines, Format= (10I8)",
        *["".join(f"{k:8}" for k in range(10))] * 2,
        "  100 Real-header values follow on  17 lines, Format= (6F13.5)",
    ]
    head = "\n".join(texts) + "\n" + reals({62: 10.0} if known is None else known)
    comment = '   1 Comment line(s) follow, each starting with a "|":\n| made for a test\n'
    data = f"   40 acceleration pts, approx   1 secs, units={unit}, Format=(8F10.5)\n"
    return head + comment + data + block(VALUES) + f"End-of-data for Chan {channel} acceleration\n"


def csmip(channel: int = 1, unit: str = ", in cm/sec2. (8f10.5)") -> str:
    """Return a channel of a CSMIP record of volume 2, sampled at 100 Hz."""
    return (
        f"Corrected accelerogram   00000-X0000-00000.00       Chan {channel:2}: 360 Deg\n"
        + " 40 points of instrument- and baseline-corrected accel, veloc and displ data\n"
        + "".join(f"{k:5}" for k in range(16))
        + "\n"
        + block(VALUES[:16])
        + f"   40 points of accel data equally spaced at  .010 sec{unit}\n"
        + block(VALUES)
        + "   40 points of veloc data equally spaced at  .010 sec, in cm/sec.  (8f10.5)\n"
        + block([10.0 * value for value in VALUES])
        + "   40 points of displ data equally spaced at  .010 sec, in cm.      (8f10.5)\n"
        + block([100.0 * value for value in VALUES])
        + f"/&  ---------- End of data for channel {channel:2} ----------\n"
    )


@pytest.mark.parametrize("text", [csmip(), cosmos()])
@pytest.mark.parametrize("name", ["quake.V2", "quake.txt", "quake.v2c", "quake.dat"])
def test_strong_motion(tmp_path: Path, text: str, name: str) -> None:
    path = written(tmp_path, text, name)
    record = Measured.read(path)
    assert record.values.tolist() == [value * 0.01 for value in VALUES]
    assert (record.quantity, record.sampling_hz) == ("acceleration", 100.0)
    quake = iva.Recorded.read(path)
    assert quake.values.tolist() == record.values.tolist()
    assert quake.times.tolist() == [k * 0.01 for k in range(40)]
    assert quake.kind == "base_acceleration"
    with pytest.raises(
        ValueError, match=r"^unit = 'g': the file says that 'acceleration \[cm/sec2"
    ):
        Measured.read(path, unit="g")


@pytest.mark.parametrize("unit", [" (units: cm/sec/sec)", ", IN CM/SEC/SEC.", ", in cm/sec2"])
def test_spellings_of_csmip(tmp_path: Path, unit: str) -> None:
    record = Measured.read(written(tmp_path, csmip(unit=unit), "quake.v2"))
    assert record.values.tolist() == [value * 0.01 for value in VALUES]


def test_the_other_blocks_of_csmip(tmp_path: Path) -> None:
    path = written(tmp_path, csmip(), "quake.v2")
    velocity = Measured.read(path, "velocity")
    assert velocity.values.tolist() == [float(f"{10.0 * v:.5f}") * 0.01 for v in VALUES]
    assert Measured.read(path, "displacement", unit="cm").quantity == "displacement"
    with pytest.raises(
        ValueError, match=r"states unit 'cm/sec' for 'velocity \[cm/sec\]', which is"
    ):
        iva.Recorded.read(path, column="velocity")


@pytest.mark.parametrize("make", [csmip, cosmos])
def test_several_channels_of_strong_motion(tmp_path: Path, make: Any) -> None:
    path = written(tmp_path, make(1) + make(3).replace(f"{VALUES[7]:10.5f}", "   0.77777"))
    with pytest.raises(ValueError, match=r"^column = None: name one column; there is 'chan 1 acc"):
        Measured.read(path)
    assert Measured.read(path, "chan 3 acceleration").values[7] == 0.77777 * 0.01
    assert iva.Recorded.read(path, column="chan 1 acceleration").values[7] == VALUES[7] * 0.01


def test_the_step_of_cosmos_is_the_number_62_or_34(tmp_path: Path) -> None:
    path = written(tmp_path, cosmos(known={34: 5.0, 62: 20.0}))
    assert Measured.read(path).sampling_hz == 50.0
    assert Measured.read(written(tmp_path, cosmos(known={34: 5.0}))).sampling_hz == 200.0
    with pytest.raises(
        ValueError, match=r"csv:\d+: the step between samples is missing; give a pro"
    ):
        Measured.read(written(tmp_path, cosmos(known={})))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            csmip().replace(f"{VALUES[9]:10.5f}", " *********"),
            r"csv:\d+: '\*{9}' is not a number; ",
        ),
        (
            csmip().replace(f"{VALUES[9]:10.5f}", "        12"),
            r"csv:\d+: '12' is not a number; the",
        ),
        (csmip().partition(" 40 points of veloc")[0][:-90], r"csv: it ends within the 40 numbers "),
        (cosmos().replace("(8F10.5)", "(*)"), r"csv:\d+: no format such as \(8F10.5\) in this lin"),
        (csmip().replace(".010 sec", "0 sec"), r"csv:\d+: the step between samples is missing; gi"),
        (
            cosmos(unit="counts (50)"),
            r"^unit = None: quake.csv states unit 'counts', which is none",
        ),
        (
            "Uncorrected accelerogram\n1 2\n3 4\n",
            r"not processed \(volume 1\); give that of volume ",
        ),
    ],
)
def test_strong_motion_that_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = written(tmp_path, text, "quake.csv")
    with pytest.raises(ValueError, match=message):
        Measured.read(path)


def test_accelerograms_by_another_ending(tmp_path: Path) -> None:
    known = Path(__file__).parents[2] / "studies" / "synthetic_quake.at2"
    expected = Measured.read(known)
    for name in ("quake.txt", "quake.dat", "quake.csv"):
        path = written(tmp_path, known.read_bytes(), name)
        for record in (Measured.read(path), Measured.read(path, 0, unit="g", sampling_hz=50)):
            assert record.values.tolist() == expected.values.tolist()
            assert record.time.tolist() == expected.time.tolist()


TITLES = [
    "El Centro 1940 NS, 40 points at 0.01 sec in g (8F10.5)\n",
    "El Centro\n\n8F10.5, dt = 10 ms, units of g\n",
    "# (8f10.5)\n# dt 0.01 s, unit: g\n",
]


@pytest.mark.parametrize("title", TITLES)
@pytest.mark.parametrize("count", [40, 38])
def test_a_series_with_several_numbers_a_line(tmp_path: Path, title: str, count: int) -> None:
    path = written(tmp_path, title + block(VALUES[:count]), "elcentro.txt")
    record = Measured.read(path)
    assert record.values.tolist() == [value * G for value in VALUES[:count]]
    assert record.sampling_hz == 100.0
    quake = iva.Recorded.read(path, "base_acceleration")
    assert quake.values.tolist() == record.values.tolist()


def test_numbers_without_blanks_between_them(tmp_path: Path) -> None:
    values = [1000.0 * value - 2000.0 for value in VALUES]
    path = written(tmp_path, "(8F11.5), dt = 0.01 s, in mm/s^2\n" + block(values, 8, 11))
    assert "-" in path.read_text().splitlines()[1].strip()[1:]
    assert Measured.read(path).values.tolist() == [float(f"{v:.5f}") * 1e-3 for v in values]


def test_a_series_without_a_word(tmp_path: Path) -> None:
    # The last line is shorter, so these are no columns.
    path = written(tmp_path, block(VALUES[:38]), "elcentro.txt")
    record = Measured.read(path, unit="g", sampling_hz=100)
    assert record.values.tolist() == [value * G for value in VALUES[:38]]
    quake = iva.Recorded.read(path, "base_acceleration", unit="g", sampling_hz=100)
    assert quake.values.tolist() == record.values.tolist()
    with pytest.raises(
        ValueError, match=r"^sampling_hz = None: elcentro.txt has no column of time"
    ):
        Measured.read(path, unit="g")


def test_a_series_that_may_be_a_table(tmp_path: Path) -> None:
    path = written(tmp_path, block(VALUES * 4), "elcentro.txt")
    advice = (
        r"txt: its lines of 8 numbers may be one series or 8 columns; write names above columns"
    )
    for read in (Measured.read, iva.Recorded.read):
        with pytest.raises(
            ValueError, match=advice + r", or a line such as '\(8F10.5\), dt = 0.02"
        ):
            read(path, column=0, unit="g", sampling_hz=100)
    loose = "".join(" ".join(map(str, VALUES[at : at + 5])) + "\n" for at in range(0, 40, 5))
    with pytest.raises(ValueError, match=r"or the series with one number a line$"):
        Measured.read(written(tmp_path, loose), 0, unit="g", sampling_hz=100)
    named = written(tmp_path, " ".join(f"a{k}" for k in range(8)) + "\n" + block(VALUES * 4))
    record = Measured.read(named, "a3", unit="g", sampling_hz=100)
    assert record.values.tolist() == [value * G for value in (VALUES * 4)[3::8]]


@pytest.mark.parametrize("title", ["", "(8F10.5)\n"])
def test_pairs_of_time_and_value(tmp_path: Path, title: str) -> None:
    pairs = [number for pair in zip(TIMES, VALUES, strict=True) for number in pair]
    path = written(tmp_path, title + block(pairs))
    with pytest.raises(
        ValueError, match=r"its lines seem to hold 4 pairs of a time and a value; wr"
    ):
        Measured.read(path, 1, unit="g", sampling_hz=100)


def test_values_below_a_time_step(tmp_path: Path) -> None:
    text = "# acceleration [g]\ndt = 0.01\n" + "".join(f"{value}\n" for value in VALUES)
    path = written(tmp_path, text)
    record = Measured.read(path)
    assert record.values.tolist() == [value * G for value in VALUES]
    assert (record.sampling_hz, record.name) == (100.0, "acceleration [g]")
    assert iva.Recorded.read(path).values.tolist() == record.values.tolist()


@pytest.mark.parametrize("has_time", [True, False])
def test_matrices_with_a_row_for_each_channel(tmp_path: Path, has_time: bool) -> None:
    other = [2.0 * value for value in VALUES]
    beside: dict[str, Any] = {"time": TIMES} if has_time else {"limits": [0.0, 1.0]}
    scipy.io.savemat(tmp_path / "rows.mat", {"out": {"acc": [VALUES, other], **beside}})
    rate = None if has_time else 100.0
    record = Measured.read(tmp_path / "rows.mat", "out.acc(2,:)", unit="mm", sampling_hz=rate)
    assert record.values.tolist() == [value * 1e-3 for value in other]
    assert record.sampling_hz == 100.0
    with pytest.raises(ValueError, match=r"there is .*'out.acc\(1,:\)', 'out.acc\(2,:\)'"):
        Measured.read(tmp_path / "rows.mat", "out.acc", unit="mm")


def test_samples_run_along_the_side_that_is_as_long_as_the_time(tmp_path: Path) -> None:
    # More sensors than samples: the time tells which side is which.
    grid = np.outer(VALUES[:20], np.arange(1, 31))
    for name, matrix in (("(:,3)", grid), ("(3,:)", grid.T)):
        scipy.io.savemat(tmp_path / "wide.mat", {"t": TIMES[:20], "a": matrix})
        record = Measured.read(tmp_path / "wide.mat", f"a{name}", unit="g")
        assert record.values.tolist() == [value * 3 * G for value in VALUES[:20]]
