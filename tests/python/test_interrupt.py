"""Ctrl-C, with real signals, in calls that would take hours by themselves."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import polars as pl
import pytest

from patience import started

# The thread says "running" once the main thread is in compiled code: its line in the package stays
# the same while it holds up nobody. So the signal comes neither before the call nor after it.
PROGRAM = """
import sys, threading, time
from pathlib import Path
import numpy as np
import iva

def place():
    frame = sys._current_frames()[threading.main_thread().ident]
    return frame.f_code.co_filename, frame.f_lasti

def watch():
    before = None
    while (now := place()) != before or Path(iva.__file__).parent not in Path(now[0]).parents:
        before = now
        time.sleep(0.1)
    print("running", flush=True)

start = iva.Start(displacement=1.0)
elastic = {"absorber": iva.Siva(mass_ratio=0.1, restitution=1.0), "primary": iva.Primary()}
points = {
    "relative_clearance": np.linspace(0.1, 0.9, 1000), "mass_ratio": np.linspace(0.05, 0.2, 1000)
}
scene = {
    "absorber": iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.85),
    "primary": iva.Primary(damping_ratio=0.05),
    "force": iva.Harmonic(amplitude=1.0, frequency=1.0),
}
grid = {"displacement": np.linspace(-4, 4, 300), "velocity": np.linspace(-4, 4, 300)}
threading.Thread(target=watch, daemon=True).start()
try:
    iva.%s
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(130)
print("finished", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal to one process")
@pytest.mark.parametrize(
    "call",
    [
        "sweep(**elastic, over=points, start=start, periods=20_000, progress=True)",
        "dynamics.orbit(**scene, start=(0, 0, 0, 0.1), settle=10**9)",
        "dynamics.diagram(**scene, over={'clearance': np.linspace(1, 5, 99)}, discard=10**9)",
        "dynamics.lyapunov(**scene, discard=10**9)",
        "dynamics.attractors(**scene, starts=1000, most_cycles=10**9)",
        "dynamics.basins(**scene, over=grid, most_cycles=10**6)",
    ],
    ids=lambda call: call.partition("(")[0],
)
def test_a_signal_ends_a_call(call: str) -> None:
    with started([sys.executable, "-c", PROGRAM % call], stdout=subprocess.PIPE) as job:
        assert job.stdout is not None
        assert job.stdout.readline() == "running\n"
        job.send_signal(signal.SIGINT)
        assert job.stdout.read() == "interrupted\n"
        assert job.wait() == 130


STUDY = """version = 1
[primary]
damping_ratio = 0.05
[absorber]
kind = "siva"
mass_ratio = 0.2
restitution = {restitution}
clearance = {clearance}
[start]
gap_velocity = 0.1
[force]
amplitude = 1.0
frequency = 1.0
"""


def interrupted(folder: Path, study: dict[str, float], arguments: str, done: str) -> list[str]:
    """Run a command in a folder and interrupt it once its bar shows that something is done.

    Returns what it says in the end on standard error, and what it prints.
    """
    import pty
    import termios

    (folder / "my.toml").write_text(STUDY.format(**study), encoding="utf-8")
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(ours, (24, 80))
    command = [sys.executable, "-m", "iva", *arguments.split()]
    terminal = {**os.environ, "TERM": "xterm"}
    with started(command, cwd=folder, stdout=subprocess.PIPE, stderr=theirs, env=terminal) as job:
        os.close(theirs)
        said = b""
        while not re.search(done.encode(), said):
            said += os.read(ours, 4096)
        job.send_signal(signal.SIGINT)
        assert job.stdout is not None
        printed = job.stdout.read()
        assert job.wait() == 130
        said = b""
        while not said.endswith(b"\r\n"):
            said += os.read(ours, 4096)
        os.close(ours)
    return [said.decode().splitlines()[-1].rpartition("\x1b[2K")[2], printed]


needs_terminal = pytest.mark.skipif(sys.platform == "win32", reason="opens a terminal of POSIX")


@needs_terminal
@pytest.mark.parametrize("csv", ["found.csv", None])
def test_a_diagram_keeps_the_values_that_are_finished(tmp_path: Path, csv: str | None) -> None:
    """Both directions would take an hour; a value has 60 strobes, as is the default."""
    said, printed = interrupted(
        tmp_path,
        {"restitution": 0.7, "clearance": 4.5},
        "diagram my.toml --over clearance --from 4 --to 5 --count 10000 --discard 20000"
        + (f" --csv {csv}" if csv else ""),
        r"[1-9]\d*/20000",
    )
    found = re.fullmatch(
        r"error: interrupted: (\d+) of 10000 values upwards and (\d+) downwards "
        + ("are written to found.csv" if csv else "were found"),
        said,
    )
    assert found is not None, said
    up, down = map(int, found.groups())
    assert 1 <= up + down < 20000
    for way, count in (("up", up), ("down", down)):
        assert bool(count) == (f"{way}\n  clearance " in printed)
    if csv is None:
        assert list(tmp_path.iterdir()) == [tmp_path / "my.toml"]
        return
    rows = pl.read_csv(tmp_path / csv, infer_schema_length=None)
    steps = [k / 9999 for k in range(10000)]
    for way, count, values in (("up", up, steps), ("down", down, steps[::-1])):
        own = rows.filter(pl.col("direction") == way)
        assert own.height == 60 * count
        expected = sorted(4.0 + value for value in values[:count])
        assert own["clearance"].unique().sort().to_list() == pytest.approx(expected, rel=1e-15)


@needs_terminal
def test_a_branch_keeps_the_points_that_were_found(tmp_path: Path) -> None:
    """From 4.5 to either side, with steps of which there would be millions."""
    said, printed = interrupted(
        tmp_path,
        {"restitution": 0.7, "clearance": 4.5},
        "branch my.toml --settle 100 --over clearance --from 4 --to 5 --step 2e-7 "
        "--points 1000000000 --csv found.csv",
        r"following [1-9]",
    )
    found = re.fullmatch(
        r"error: interrupted: (\d+) points of the branch are written to found.csv", said
    )
    assert found is not None, said
    assert f"{found[1]} symmetric orbits with 2 impacts in 1 periods" in printed
    assert "cancelled" in printed
    rows = pl.read_csv(tmp_path / "found.csv", infer_schema_length=None)
    assert rows.height == int(found[1])
    assert rows["arclength"].is_sorted()
    assert rows.filter(pl.col("clearance") == 4.5).height == 1


@needs_terminal
def test_basins_keep_the_starts_that_are_decided(tmp_path: Path) -> None:
    """Nine million starts, which would take an hour; they are done by rows of a thousand."""
    said, printed = interrupted(
        tmp_path,
        {"restitution": 0.9, "clearance": 2.5},
        "basins my.toml --across displacement,-4,4,1000 --up velocity,-4,4,9000 "
        "--most-cycles 300 --csv found.csv",
        r"[1-9]\d*/9000000",
    )
    found = re.fullmatch(
        r"error: interrupted: (\d+) of 9000000 starts are written to found.csv", said
    )
    assert found is not None, said
    count = int(found[1])
    assert 1000 <= count < 9_000_000
    assert printed.startswith(f"{count} starts\n")
    assert "entropy" not in printed
    rows = pl.read_csv(tmp_path / "found.csv", infer_schema_length=None)
    assert rows.height == count
    # What is not decided has used up its cycles.
    assert rows.filter((pl.col("label") == -1) & (pl.col("likely") == -1))["cycles"].min() == 300


@needs_terminal
def test_a_command_without_anything_finished_says_so(tmp_path: Path) -> None:
    said, printed = interrupted(
        tmp_path,
        {"restitution": 0.7, "clearance": 4.5},
        "diagram my.toml --over clearance --from 4 --to 5 --discard 1000000000 --csv found.csv",
        r"0/400",
    )
    assert said == "error: interrupted: nothing was finished, so nothing was written"
    assert printed == ""
    assert not (tmp_path / "found.csv").exists()
