"""Files that a study does not read: named, and brought in by :meth:`iva.Recorded.write`.

Expected forces are those that :meth:`iva.Recorded.read` gives, which other tests compare with the
numbers in the files.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

import iva
from iva import _iva
from iva.measured.sensor_units import FORCES
from recordings import TIMES, VALUES, table, written

STUDY = """version = 1
[primary]
mass = 200
stiffness = 16000
damping = 30
[absorber]
kind = "siva"
mass = 20
restitution = 0.6
gap_mm = 20
[force]
record = "{file}"
kind = "{kind}"
[run]
duration = 2
"""

BLOCK = "".join(
    "".join(f"{value:10.5f}" for value in VALUES[at : at + 8]) + "\n" for at in range(0, 40, 8)
)
LABVIEW = "\n".join(
    [
        "LabVIEW Measurement\t",
        "Separator\tTab",
        "Decimal_Separator\t.",
        "X_Columns\tNo",
        "***End_of_Header***\t",
        "Channels\t1",
        "Samples\t40",
        "Y_Unit_Label\tm/s^2",
        "X_Dimension\tTime",
        "X0\t0.0",
        "Delta_X\t0.01",
        "***End_of_Header***\t",
        "X_Value\ta1\tComment",
        *(f"\t{value}" for value in VALUES),
    ]
)
CSMIP = "   40 points of accel data equally spaced at  .010 sec, in cm/sec2. (8f10.5)\n" + BLOCK
COSMOS = (
    "  100 Real-header values follow on  17 lines, Format= (6F13.5)\n"
    + "".join("".join(f"{10.0:13.5f}" for _ in range(6)) + "\n" for _ in range(17))
    + "   40 acceleration pts, approx   1 secs, units=cm/sec2 (04), Format=(8F10.5)\n"
    + BLOCK
)


def matlab(folder: Path) -> Path:
    """Write a MAT file."""
    scipy.io.savemat(folder / "rig", {"t": TIMES, "a_g": VALUES}, appendmat=False)
    return folder / "rig"


def wave(folder: Path) -> Path:
    """Write a WAV file of 16 bits at 100 Hz."""
    data = struct.pack("<40h", *(round(20000 * value) for value in VALUES))
    form = struct.pack("<4sIHHIIHH", b"fmt ", 16, 1, 1, 100, 200, 2, 16)
    body = b"WAVE" + form + struct.pack("<4sI", b"data", len(data)) + data
    return written(folder, b"RIFF" + struct.pack("<I", len(body)) + body, "rig")


def tdms(folder: Path) -> Path:
    """Write a TDMS file."""
    nptdms = pytest.importorskip("nptdms")
    facts = {"wf_increment": 0.01, "wf_start_offset": 0.0, "unit_string": "g"}
    with nptdms.TdmsWriter(str(folder / "rig")) as file:
        file.write_segment([nptdms.ChannelObject("rig", "a1", np.array(VALUES), facts)])
    return folder / "rig"


def universal(folder: Path) -> Path:
    """Write a universal file with one dataset 58: accelerations at equal steps."""
    words = ["    -1", "    58", "floor 3", "NONE", "NONE", "NONE", "NONE"]
    words += [
        "    1         0    0         0       NONE         3   1       NONE         0   0",
        "         2        40         1  0.00000e+00  1.00000e-02  0.00000e+00",
        "        17    0    0    0                 Time                    s",
        "        12    0    0    0         Acceleration                m/s^2",
        "         0    0    0    0                 NONE                 NONE",
        "         0    0    0    0                 NONE                 NONE",
    ]
    cells = [f"{value:13.5e}" for value in VALUES]
    words += ["".join(cells[at : at + 6]) for at in range(0, 40, 6)]
    return written(folder, "\n".join([*words, "    -1", ""]), "rig")


def text(contents: str) -> Callable[[Path], Path]:
    """Return what writes a text."""
    return lambda folder: written(folder, contents, "rig")


def checked(folder: Path, file: str, kind: str, capfd: pytest.CaptureFixture[str]) -> str:
    """Return what a study says of a file that it refuses."""
    study = written(folder, STUDY.format(file=file, kind=kind), "my.toml")
    assert _iva.main(["iva", "check", str(study)]) == 2
    return " ".join(capfd.readouterr().err.split())


@pytest.mark.filterwarnings("ignore::ResourceWarning")  # pyuff leaves files open
@pytest.mark.parametrize(
    ("made", "words", "keys"),
    [
        (matlab, "a MAT file, which a study does not read", {}),
        (wave, "a WAV file, which a study does not read", {"scale": 3.0, "unit": "g"}),
        (tdms, "a TDMS file of LabVIEW, which a study does not read", {}),
        (universal, "a universal file, which a study does not read", {}),
        (text(LABVIEW), "a LabVIEW measurement file (LVM), which a study does not read", {}),
        (text(CSMIP), "a strong-motion record of CSMIP or COSMOS, which a study does not", {}),
        (text(COSMOS), "a strong-motion record of CSMIP or COSMOS, which a study does not", {}),
        (
            text("8F10.5, dt = 0.01 s, in g\n" + BLOCK),
            "a series with 8 numbers a line, which a study reads only below dt = …",
            {},
        ),
    ],
)
def test_what_a_study_does_not_read_is_named_and_brought_in(
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    made: Callable[[Path], Path],
    words: str,
    keys: dict[str, Any],
) -> None:
    path = made(tmp_path)
    said = checked(tmp_path, path.name, "base_acceleration", capfd)
    call = 'iva.Recorded.read(…).write("record.csv") in Python makes a text of it'
    assert f"{path}: {words}" in said
    assert call in said
    force = iva.Recorded.read(path, "base_acceleration", **keys)
    force.write(tmp_path / "record.csv")
    again = iva.Recorded.read(tmp_path / "record.csv", "base_acceleration")
    assert again.is_metric
    assert again.times.tolist() == force.times.tolist()
    assert again.values.tolist() == (force.values * force.scale).tolist()
    run = iva.simulate(
        iva.Siva(mass=20.0, restitution=0.6, gap_mm=20.0),
        iva.Primary(mass=200.0, stiffness=16e3, damping=30.0),
        start=iva.Start(),
        force=again,
        duration=2.0,
    )
    good = written(tmp_path, STUDY.format(file="record.csv", kind="base_acceleration"), "good.toml")
    out = tmp_path / "out"
    assert _iva.main(["iva", "run", str(good), "--out", str(out), "--quiet"]) == 0
    assert iva.read(out).summary.equals(run.summary)


@pytest.mark.parametrize(
    ("contents", "words", "refused"),
    [
        (b"\x89HDF\r\n\x1a\n\0", "an HDF5 file; save it as text", "an HDF5 file; save it as"),
        (b"PK\x03\x04\0", "an Excel workbook, NPZ or other ZIP archive; save", "an Excel workbook"),
        (b"\xd0\xcf\x11\xe0\0", "an Excel workbook; save it as text", "an Excel workbook; save"),
        (b"\x93NUMPY\x01\0", "an array of NumPy; save it as text", "an array of NumPy; give what"),
        (
            b"MATLAB 7.3 MAT-file, Platform: none" + b" " * 200,
            "a MAT file of version 7.3, which is HDF5; save it in MATLAB with '-v7', then iva.",
            "a MAT file of version 7.3, which is HDF5; save it in MATLAB with '-v7'",
        ),
        (
            b"Uncorrected Accelerogram Data\n" + BLOCK.encode(),
            "a strong-motion record that was not processed (volume 1); give that of volume 2",
            r"a strong-motion record that was not processed \(volume 1\); give that of volume 2",
        ),
        (
            BLOCK.encode(),
            "its lines of 8 numbers may be one series or 8 columns; write names above columns, or "
            "dt = … above a series",
            "its lines of 8 numbers may be one series or 8 columns; write names above columns, or ",
        ),
    ],
)
def test_what_neither_reads_is_named(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], contents: bytes, words: str, refused: str
) -> None:
    path = written(tmp_path, contents, "rig")
    assert f"{path}: {words}" in checked(tmp_path, "rig", "base_acceleration", capfd)
    with pytest.raises(ValueError, match=refused):
        iva.Recorded.read(path)


@pytest.mark.parametrize("unit", [*FORCES, "m/s^2", "mm/s^2"])
@pytest.mark.parametrize(("name", "clock"), [("force", "s"), ("F", "ms")])
def test_units_below_the_names(tmp_path: Path, unit: str, name: str, clock: str) -> None:
    """Newtons in a unit are those of :data:`FORCES`."""
    factor = {**FORCES, "m/s^2": 1.0, "mm/s^2": 1e-3}[unit]
    path = written(tmp_path, table(f"t,{name}\n{clock},{unit}"))
    force = iva.Recorded.read(path)
    assert force.kind == ("force_newtons" if unit in FORCES else "force")
    assert force.values.tolist() == [value * factor for value in VALUES]
    second = 1.0 if clock == "s" else 1e-3
    assert force.times.tolist() == [time * second for time in TIMES]
    study = written(tmp_path, STUDY.format(file=path.name, kind=force.kind), "my.toml")
    out = tmp_path / "out"
    assert _iva.main(["iva", "run", str(study), "--out", str(out), "--quiet"]) == 0
    resolved = (out / "study.toml").read_text(encoding="utf-8")
    assert f'kind = "{force.kind}"' in resolved
    force.write(tmp_path / "record.csv")
    assert iva.Recorded.read(tmp_path / "record.csv") == force
    same = iva.simulate(
        iva.Siva(mass=20.0, restitution=0.6, gap_mm=20.0),
        iva.Primary(mass=200.0, stiffness=16e3, damping=30.0),
        start=iva.Start(),
        force=force,
        duration=2.0,
    )
    assert iva.read(out).summary.equals(same.summary)


def test_units_of_what_is_no_force(tmp_path: Path) -> None:
    rows = "\n".join(f"{t},{v},20.5" for t, v in zip(TIMES, VALUES, strict=True))
    path = written(tmp_path, "time,force,temperature\ns,kN,°C\n" + rows + "\n")
    force = iva.Recorded.read(path, column="force")
    assert force.values.tolist() == [1e3 * value for value in VALUES]
    with pytest.raises(ValueError, match=r"states unit '°C' for 'temperature', which is none of a"):
        iva.Recorded.read(path, column="temperature")
    volts = written(tmp_path, table("t,signal\ns,V"))
    with pytest.raises(ValueError, match=r"states unit 'V' for 'signal', which is none of a force"):
        iva.Recorded.read(volts)
    compass = written(tmp_path, table("N,V"))
    assert iva.Recorded.read(compass).values.tolist() == VALUES


def test_a_record_that_is_written_has_the_units_of_its_scene(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    iva.Recorded(TIMES, VALUES, "base_acceleration", scale=0.5).write(path)
    assert path.read_text(encoding="utf-8").startswith("time,value (1)\n0.0,0.6\n")
    force = iva.Recorded.read(path, "base_acceleration")
    assert not force.is_metric
    assert force.values.tolist() == [0.5 * value for value in VALUES]
    with pytest.raises(ValueError, match="this is a folder, give the name of a file"):
        force.write(tmp_path)
