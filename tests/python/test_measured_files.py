"""Files of measured records: what SciPy, pyuff and this package write into them comes back."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
import scipy.io
from numpy.typing import NDArray

import iva
from iva.measured import Measured
from recordings import TIMES, VALUES, table, written


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
    with pytest.raises(
        iva.IvaError, match=r"pipe.csv cannot be read: it is no regular file; give a reg"
    ):
        Measured.read(tmp_path / "pipe.csv")


def test_names_of_files_may_be_text_or_paths(tmp_path: Path) -> None:
    path = written(tmp_path, table(), "DECAY.CSV")
    assert Measured.read(str(path)).source == Measured.read(path).source == str(path)


def test_letters_that_a_terminal_obeys_are_shown(tmp_path: Path) -> None:
    for wrong in ("words", table("t,a\x1b[31m_g", [*VALUES[1:], "nan"])):
        with pytest.raises(ValueError, match=r"\{1b\}\[31m") as caught:
            Measured.read(written(tmp_path, wrong, "red\x1b[31m.csv"))
        assert str(caught.value).isprintable()


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


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_mat_files(tmp_path: Path, kind: type, compressed: bool) -> None:
    path = tmp_path / "decay.mat"
    time: NDArray[Any] = np.array(TIMES, dtype=kind)
    values: NDArray[Any] = np.array(VALUES, dtype=kind)
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
    same = Measured.read(path.rename(tmp_path / "decay.txt"))
    assert same.values.tolist() == record.values.tolist()
    quake = iva.Recorded.read(tmp_path / "decay.txt", "base_acceleration")
    assert quake.values.tolist() == record.values.tolist()


def test_a_column_that_begins_with_the_mark_of_universal_files(tmp_path: Path) -> None:
    values = [-1.0, 58.0, *map(float, range(30))]
    path = written(tmp_path, "".join(f"{value:.0f}\n" for value in values))
    assert Measured.read(path, unit="m", sampling_hz=100).values.tolist() == values


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
        record = Measured.read(path, key)
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
