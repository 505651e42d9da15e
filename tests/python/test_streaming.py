"""Sweeps into a folder: what is written, kept, refused, and how much memory it takes."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva
from iva import _iva
from iva.sweeping import kept
from patience import started, until


def sweep(count: int = 12, **more: Any) -> iva.Table:
    settings: dict[str, Any] = {
        "over": {"relative_clearance": np.linspace(0.4, 1.2, count), "mass_ratio": [0.05, 0.1]},
        "start": iva.Start(displacement=1.0),
        "periods": 6,
        "tables": ("summary", "impacts"),
    }
    return iva.sweep(
        iva.Siva(restitution=0.5, mass_ratio=0.1), iva.Primary(damping_ratio=0.01),
        **(settings | more),
    )  # fmt: skip


@pytest.mark.parametrize("style", ["parquet", "arrow", "csv"])
def test_what_is_written_is_what_is_gathered(tmp_path: Path, style: str) -> None:
    gathered = sweep()
    written = sweep(out=tmp_path / "out", format=style)
    assert written == gathered == iva.read(tmp_path / "out")
    scan = iva.scan(tmp_path / "out")
    assert scan.tables == ("summary", "impacts")
    assert scan.swept == gathered.swept
    assert scan.units == gathered.units
    assert_frame_equal(scan.summary.collect(), gathered.summary)
    assert_frame_equal(scan.impacts.collect(), gathered.impacts)
    assert_frame_equal(iva.best(scan.summary, count=3).collect(), iva.best(gathered, count=3))
    with pytest.raises(AttributeError, match="no table 'envelope'"):
        _ = scan.envelope


def test_polars_reads_the_folder(tmp_path: Path) -> None:
    table = sweep(out=tmp_path / "out")
    lazy = pl.scan_parquet(tmp_path / "out" / "summary" / "*.parquet")
    assert_frame_equal(lazy.collect(), table.summary)


def test_a_scan_can_be_shown_and_sent(tmp_path: Path) -> None:
    import pickle

    sweep(out=tmp_path / "out")
    scan = iva.scan(tmp_path / "out")
    assert "relative_clearance × mass_ratio: summary, impacts; 1 parts" in repr(scan)
    again = pickle.loads(pickle.dumps(scan))
    assert_frame_equal(again.summary.collect(), scan.summary.collect())


def test_the_study_beside_the_tables_gives_them_again(tmp_path: Path) -> None:
    record = iva.Recorded([0.0, 1.0, 2.0], [0.0, 0.1 + 0.2, 0.0], kind="force")
    driven: dict[str, Any] = {"force": [iva.Impulse(velocity=0.1), record], "periods": 3}
    written = sweep(out=tmp_path / "out", **driven)
    again = tmp_path / "again"
    study = str(tmp_path / "out" / "study.toml")
    assert _iva.main(["iva", "sweep", study, "--out", str(again), "--quiet"]) == 0
    assert iva.read(again) == written == sweep(**driven)
    sweep(out=tmp_path / "out", resume=True, **driven)


def test_a_folder_with_tables_is_refused_in_the_words_of_python(tmp_path: Path) -> None:
    out = tmp_path / "out"
    sweep(out=out)
    before = {file: file.read_bytes() for file in out.rglob("*.*")}
    with pytest.raises(ValueError, match="choose another folder as out, or give overwrite=True"):
        sweep(out=out)
    with pytest.raises(ValueError, match=r"run\.periods was 6\.0, is 7\.0"):
        sweep(out=out, resume=True, periods=7)
    assert before == {file: file.read_bytes() for file in out.rglob("*.*")}
    assert sweep(out=out, overwrite=True, periods=7) == sweep(periods=7)
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    with pytest.raises(ValueError, match="is a file"):
        sweep(out=tmp_path / "file")
    with pytest.raises(ValueError, match="cannot write into the folder"):
        sweep(out=tmp_path / "file" / "below")
    for wrong in ({"resume": True}, {"overwrite": True}, {"format": "csv"}):
        with pytest.raises(ValueError, match="it is about a folder; give out"):
            sweep(**wrong)
    with pytest.raises(ValueError, match='format = "xlsx": give "parquet", "arrow", "csv"'):
        sweep(out=out, format="xlsx")


def test_a_part_that_was_altered_is_said_and_computed_again(tmp_path: Path) -> None:
    out = tmp_path / "out"
    expected = sweep(out=out)
    file = out / "impacts" / "part-00000.parquet"
    whole = file.read_bytes()
    file.write_bytes(whole[:-1] + b"!")
    with pytest.warns(UserWarning, match=r"computed again: impacts/part-00000\.parquet") as told:
        again = sweep(out=out, resume=True)
    assert told[0].filename == __file__, "where the sweep was called"
    assert again == expected
    assert file.read_bytes() == whole


def test_a_file_of_another_size_is_not_read(tmp_path: Path) -> None:
    out = tmp_path / "out"
    sweep(out=out, format="csv")
    file = out / "impacts" / "part-00000.csv"
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    file.write_text("".join(lines[:-1]), encoding="utf-8")
    with pytest.raises(iva.IvaError, match="its size is not that of the manifest"):
        iva.read(out)
    file.unlink()
    with pytest.raises(iva.IvaError, match="impacts is missing, but the manifest lists it"):
        iva.read(out)


def test_the_manifest_says_what_sha256sum_says(tmp_path: Path) -> None:
    import hashlib

    out = tmp_path / "out"
    sweep(out=out)
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["points"] == 24
    assert manifest["swept"] == ["relative_clearance", "mass_ratio"]
    for name, contents in manifest["parts"]["0"]["tables"].items():
        file = out / name / "part-00000.parquet"
        assert hashlib.sha256(file.read_bytes()).hexdigest() == contents["sha256"]
        assert file.stat().st_size == contents["bytes"]
        assert pl.read_parquet(file).height == contents["rows"]


def test_a_result_that_would_not_fit_is_refused_at_once() -> None:
    axes = {name: np.linspace(0.1, 0.9, 400) for name in ("mass_ratio", "restitution")}
    over = axes | {"relative_clearance": np.linspace(0.5, 1.0, 500)}
    with pytest.raises(ValueError, match=r"sweep = 80000000 points: .* memory_limit = 4\.0 GB"):
        sweep(over=over, tables=("summary",))
    # Impacts are estimated from some runs.
    with pytest.raises(ValueError, match=r"give out= a folder"):
        sweep(over=axes | {"relative_clearance": [0.5, 0.6]}, memory_limit=2e8)
    assert sweep(memory_limit=1e6).summary.height == 24


# A million runs of 20 000 periods would take an hour; with errors parts are small.
INTERRUPTED = """
import sys
import numpy as np
import iva
try:
    iva.sweep(
        iva.Siva(restitution=0.5), iva.Primary(damping_ratio=0.01),
        over={"relative_clearance": np.linspace(0.3, 1.2, 400),
              "mass_ratio": np.linspace(0.05, 0.2, 2500)},
        start=iva.Start(displacement=1.0), periods=20_000, errors=True, out=sys.argv[1],
    )
except KeyboardInterrupt as interrupt:
    print(*interrupt.__notes__, flush=True)
    sys.exit(130)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal to one process")
def test_ctrl_c_keeps_the_complete_parts_and_says_how_to_go_on(tmp_path: Path) -> None:
    out = tmp_path / "out"
    summary = out / "summary"
    command = [sys.executable, "-c", INTERRUPTED, str(out)]
    with started(command, stdout=subprocess.PIPE) as job:
        until(lambda: summary.is_dir() and len(list(summary.iterdir())) >= 2, job)
        job.send_signal(signal.SIGINT)
        said = job.communicate()[0]
    assert job.returncode == 130
    assert "of 1000000 points are written to" in said
    assert "go on with resume=True" in said
    points = iva.read(out).summary.height
    assert 0 < points < 1_000_000
    assert f"{points} of" in said


def test_what_is_kept_of_an_interrupted_overwrite_is_said(tmp_path: Path) -> None:
    out = tmp_path / "out"
    sweep(out=out)
    before = iva.read(out)

    def stop(_done: int, _total: int) -> None:
        raise KeyboardInterrupt

    # A million points, which would take long after the first progress.
    over = {
        "relative_clearance": np.linspace(0.4, 1.2, 1000),
        "mass_ratio": np.linspace(0.05, 0.1, 1000),
    }
    with pytest.raises(KeyboardInterrupt) as caught:
        sweep(over=over, out=out, overwrite=True, periods=30_000, threads=1, progress=stop)
    (note,) = caught.value.__notes__
    assert note == f"nothing was finished; {out} is as it was" or note.endswith(
        "go on with overwrite=True, resume=True"
    )
    # The work is left to end by itself if that takes longer than a second.
    until(lambda: not (out / ".iva-work").exists())
    assert iva.read(out) == before
    # What an interrupt in a later part leaves.
    new = out / ".iva-new"
    shutil.rmtree(new, ignore_errors=True)
    new.mkdir()
    assert kept(out, replaces=True) == f"nothing was finished; {out} is as it was"
    new.rmdir()
    sweep(out=tmp_path / "other")
    (tmp_path / "other").rename(new)
    assert kept(out, replaces=True).endswith("go on with overwrite=True, resume=True")
    assert kept(out, replaces=False).endswith("go on with resume=True")


# Not ru_maxrss: it begins with the size of the process that started this one.
MEMORY = """
import re, sys
import numpy as np
import iva
iva.sweep(
    iva.Siva(restitution=0.5), iva.Primary(damping_ratio=0.01),
    over={"relative_clearance": np.linspace(0.3, 1.2, int(sys.argv[2])),
          "mass_ratio": np.linspace(0.05, 0.2, 1000)},
    start=iva.Start(displacement=1.0), periods=5, out=sys.argv[1],
)
print(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1])
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_does_not_grow_with_the_number_of_points(tmp_path: Path) -> None:
    peaks = []
    for count in (300, 1200):
        job = subprocess.run(
            [sys.executable, "-c", MEMORY, str(tmp_path / str(count)), str(count)],
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        peaks.append(int(job.stdout) * 1024)
    # In memory 900 000 rows more would take 240 MB.
    assert peaks[1] < 300e6
    assert peaks[1] - peaks[0] < 60e6
