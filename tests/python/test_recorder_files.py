"""Files of LabVIEW and WAV files: the numbers that the tests write come back.

Expected values are the decimal numbers of the files, read by Python's own ``float``, times the
factor of their unit; those of WAV files are the whole numbers written over full scale.
"""

from __future__ import annotations

import struct
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st

import iva
from iva.measured import Measured
from recordings import TIMES, VALUES, written

G = 9.80665


def labview(separator: str, decimal: str, **changes: str) -> str:
    """Return an LVM file with two channels of 40 samples at 100 Hz, from 2 s on."""
    tags = {
        "Channels": ["2"],
        "Samples": ["40", "40"],
        "Y_Unit_Label": ["g", "Volts"],
        "X_Dimension": ["Time", "Time"],
        "X0": ["2.0E+0", "2.0E+0"],
        "Delta_X": ["0.010000", "0.010000"],
    }
    tags |= {key: value.split() for key, value in changes.items()}
    words = ["LabVIEW Measurement", "Separator@" + {"\t": "Tab", ",": "Comma"}[separator]]
    words += ["Decimal_Separator@" + decimal, "X_Columns@No", "***End_of_Header***@", ""]
    words += ["@".join([key, *map(localised(decimal), values)]) for key, values in tags.items()]
    words += ["***End_of_Header***@@@", "X_Value@a1@load@Comment"]
    cells = [(str(value), str(2 * value)) for value in VALUES]
    words += ["@" + "@".join(map(localised(decimal), pair)) for pair in cells]
    return "\r\n".join(words).replace("@", separator) + "\r\n"


def localised(decimal: str) -> Callable[[str], str]:
    """Return what writes a number with a decimal mark."""
    return lambda text: text.replace(".", decimal)


@pytest.mark.parametrize(("separator", "decimal"), [("\t", "."), ("\t", ","), (",", ".")])
@pytest.mark.parametrize("name", ["run.lvm", "run.txt"])
def test_labview_text(tmp_path: Path, separator: str, decimal: str, name: str) -> None:
    path = written(tmp_path, labview(separator, decimal), name)
    record = Measured.read(path, "a1")
    assert record.values.tolist() == [value * G for value in VALUES]
    assert record.time.tolist() == [2.0 + k / 100 for k in range(40)]
    volts = Measured.read(path, "load", unit="m/s^2", scale=0.5)
    assert volts.values.tolist() == [2 * value * 0.5 for value in VALUES]
    assert iva.Recorded.read(path, column="a1").values.tolist() == record.values.tolist()
    with pytest.raises(
        ValueError, match=r"states unit 'Volts' for 'load', which is none of a force"
    ):
        iva.Recorded.read(path, column="load")


def test_a_column_of_the_abscissa_in_labview_text(tmp_path: Path) -> None:
    lines = labview("\t", ".").splitlines()
    first = lines.index("X_Value\ta1\tload\tComment") + 1
    head, cells = lines[:first], lines[first:]
    # The column is rounded to two digits behind the point; X0 and Delta_X are not.
    text = "\n".join([*head, *(f"{k / 100 + 2:.2f}{line}\t" for k, line in enumerate(cells))])
    record = Measured.read(written(tmp_path, text, "run.lvm"), "a1")
    assert record.values.tolist() == [value * G for value in VALUES]
    assert record.time.tolist() == [2.0 + k / 100 for k in range(40)]
    text = "\n".join([*head, *(f"{k / 50 + 2}{line}\t" for k, line in enumerate(cells))])
    with pytest.raises(
        ValueError, match=r"X_Value of channel 0 is up to 0.39 s away from X0 and De"
    ):
        Measured.read(written(tmp_path, text, "run.lvm"), "a1")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            labview("\t", ".", X_Dimension="Frequency"),
            r"X_Dimension = 'Frequency' of 'a1': give a r",
        ),
        (labview("\t", ".", Samples="x 40"), r"Samples = 'x' of channel 0: give a number$"),
        (labview("\t", ".", Samples="99 99"), r"it ends within the 99 samples that it states$"),
        (
            labview("\t", ".").replace("***", "* *"),
            r"an LVM file with 0 segments that have a head;",
        ),
        (
            labview("\t", ".") + labview("\t", "."),
            r"an LVM file with 3 segments that have a head; ",
        ),
        (
            labview("\t", ".").replace("a1\tload", "\t"),
            r"an LVM file without names of channels; sa",
        ),
        (labview("\t", ".").replace(f"\t{VALUES[3]}\t", "\tx\t"), r"lvm:\d+: 'x' is not a number"),
    ],
)
def test_labview_text_that_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Measured.read(written(tmp_path, text, "run.lvm"), "a1", unit="g")


def riff(code: int, bits: int, data: bytes, channels: int = 1, extensible: bool = False) -> bytes:
    """Return a WAV file sampled at 100 Hz, with a chunk of odd length before its samples."""
    size = channels * bits // 8
    form = struct.pack(
        "<HHIIHH", 0xFFFE if extensible else code, channels, 100, 100 * size, size, bits
    )
    if extensible:
        form += struct.pack("<HHIH14s", 22, bits, 0, code, b"\0" * 14)
    chunks = [(b"fmt ", form), (b"LIST", b"odd\0\0"), (b"data", data)]
    body = b"".join(
        name + struct.pack("<I", len(part)) + part + b"\0" * (len(part) % 2)
        for name, part in chunks
    )
    return b"RIFF" + struct.pack("<I", len(body) + 4) + b"WAVE" + body


BLOCK = b"".join(
    b"".join(b"%10.5f" % value for value in VALUES[at : at + 8]) + b"\n" for at in range(0, 40, 8)
)
#: What damages a file: numbers that are too large, signs, separators, ends of lines, any byte.
SCRAPS = [
    b"9e999",
    b"1e308",
    b"-",
    b" ",
    b"\n",
    b"\r",
    b"\t",
    b";",
    b",",
    b"\0",
    b"\xff",
    b"99999999",
]

WHOLE = [(37 * k) % 201 - 100 for k in range(40)]


@pytest.mark.parametrize("extensible", [False, True])
@pytest.mark.parametrize("bits", [8, 16, 24, 32])
def test_wave_files_of_whole_numbers(tmp_path: Path, bits: int, extensible: bool) -> None:
    if bits == 8:
        data = bytes(value + 128 for value in WHOLE)
    else:
        data = b"".join(value.to_bytes(bits // 8, "little", signed=True) for value in WHOLE)
    path = written(tmp_path, riff(1, bits, data, extensible=extensible), "run.wav")
    record = Measured.read(path, unit="g", scale=4.0)
    assert record.values.tolist() == [value / 2 ** (bits - 1) * (4.0 * G) for value in WHOLE]
    assert record.sampling_hz == 100.0
    quake = iva.Recorded.read(path, "base_acceleration", unit="g", scale=4.0)
    assert quake.values.tolist() == [value / 2 ** (bits - 1) * G for value in WHOLE]
    assert quake.scale == 4.0


def test_wave_files_with_floating_point_and_two_channels(tmp_path: Path) -> None:
    frames = np.column_stack([VALUES, [0.5 * value for value in VALUES]])
    for bits in (32, 64):
        samples = frames.astype(f"<f{bits // 8}")
        path = written(tmp_path, riff(3, bits, samples.tobytes(), 2), "run.wav")
        record = Measured.read(path, "channel 2", unit="m/s^2", scale=2)
        assert record.values.tolist() == (samples[:, 1].astype(float) * 2.0).tolist()


def test_wave_files_that_are_refused(tmp_path: Path) -> None:
    data = struct.pack("<40h", *WHOLE)
    path = written(tmp_path, riff(1, 16, data), "run.wav")
    needed = (
        r"^scale = None: run.wav holds fractions of full scale; give scale, which is full scale"
    )
    with pytest.raises(ValueError, match=needed):
        Measured.read(path, unit="g")
    with pytest.raises(ValueError, match=needed):
        iva.Recorded.read(path, unit="g")
    with pytest.raises(ValueError, match=r"^unit = None: run.wav states none for 'channel 1'"):
        Measured.read(path, scale=4)
    with pytest.raises(ValueError, match=r"^scale = 0: give a finite number other than 0$"):
        Measured.read(path, unit="g", scale=0)
    for contents, message in (
        (riff(7, 8, data), r"wav: a WAV file of format 7 with 8 bits; give PCM of 8, 16, 24 or 32"),
        (riff(1, 12, data), r"wav: a WAV file of format 1 with 12 bits; give PCM"),
        (riff(1, 16, data, 0), r"wav: a WAV file of format 1 with 16 bits; give PCM"),
        (riff(1, 16, b""), r"wav: a damaged WAV file without format or samples; record it anew$"),
        (b"RIFX" + riff(1, 16, data)[4:], r"wav: not a WAV file \(RIFF\); give one of PCM"),
    ):
        with pytest.raises(ValueError, match=message):
            Measured.read(written(tmp_path, contents, "bad.wav"), unit="g", scale=1)


def test_tdms_files(tmp_path: Path) -> None:
    nptdms = pytest.importorskip("nptdms")
    path = tmp_path / "run.tdms"
    waveform = {"wf_increment": 0.01, "wf_start_offset": 2.0}
    contents = [
        nptdms.ChannelObject("rig", "a1", np.array(VALUES), {"unit_string": "g", **waveform}),
        nptdms.ChannelObject("rig", "x_mm", np.array(VALUES), waveform),
        nptdms.ChannelObject("rig", "notes", ["a", "b"]),
    ]
    with nptdms.TdmsWriter(str(path)) as file:
        file.write_segment(contents)
    record = Measured.read(path, "a1")
    assert record.values.tolist() == [value * G for value in VALUES]
    assert record.time.tolist() == [2.0 + k / 100 for k in range(40)]
    assert Measured.read(path, "rig.x_mm").values.tolist() == [value * 1e-3 for value in VALUES]
    assert iva.Recorded.read(path, column="a1").values.tolist() == record.values.tolist()
    with pytest.raises(ValueError, match=r"bad.tdms: a damaged TDMS file \(.*\); save it anew$"):
        Measured.read(written(tmp_path, b"nothing of the kind" * 20, "bad.tdms"))


def test_recorders_by_another_ending(tmp_path: Path) -> None:
    wave = written(tmp_path, riff(1, 16, struct.pack("<40h", *WHOLE)), "run.dat")
    assert len(Measured.read(wave, unit="g", scale=1.0)) == 40
    scipy.io.savemat(tmp_path / "run.mat", {"t": TIMES, "a_g": VALUES})
    matlab = written(tmp_path, (tmp_path / "run.mat").read_bytes(), "run.txt")
    assert Measured.read(matlab).values.tolist() == [value * G for value in VALUES]


def test_without_nptdms(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(
        ImportError, match=r"TDMS file needs npTDMS: pip install 'iva-dynamics\[tdms"
    ):
        Measured.read(written(tmp_path, b"TDSm", "run.tdms"))


GOOD = {
    "run.lvm": labview("\t", ".").encode(),
    "run.wav": riff(1, 16, struct.pack("<40h", *WHOLE)),
    "run.v2": (
        b"   40 points of accel data equally spaced at  .010 sec, in cm/sec2. (8f10.5)\n" + BLOCK
    ),
    "run.txt": b"8F10.5, dt = 0.01 s, in g\n" + BLOCK,
    "run.dat": b"dt = 0.01\n" + BLOCK,
    "run.csv": b"t [ms];a [g]\n" + b"".join(b"%d;%d,5\n" % (k, k % 7) for k in range(40)),
}


@given(
    name=st.sampled_from(sorted(GOOD)),
    places=st.lists(st.tuples(st.integers(0, 1200), st.sampled_from(SCRAPS)), max_size=5),
    end=st.integers(0, 1500),
)
def test_damaged_files_are_read_or_refused(
    name: str, places: list[tuple[int, bytes]], end: int
) -> None:
    contents = bytearray(GOOD[name])
    for place, scrap in places:
        contents[place : place + len(scrap)] = scrap
    with TemporaryDirectory() as folder:
        path = written(Path(folder), bytes(contents[: len(contents) - end]), name)
        for read in (
            lambda: Measured.read(path, unit="g", scale=2),
            lambda: Measured.read(path, 0, sampling_hz=100, unit="g"),
            lambda: iva.Recorded.read(path, "base_acceleration", scale=2, column=0),
            lambda: iva.Recorded.read(path, sampling_hz=100, unit="g"),
        ):
            assert "\n" not in refusal(read)


def refusal(read: Callable[[], Measured | iva.Recorded]) -> str:
    """Return why a file is refused, or nothing if it is read, in which case all is finite."""
    try:
        made = read()
    except ValueError as error:
        return str(error)
    assert np.isfinite(made.values).all()
    return ""
