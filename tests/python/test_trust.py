"""What comes from outside is judged before it is believed: files, names, sizes."""

from __future__ import annotations

import json
import os
import shutil
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva
from crafted import arrow_claims, equal_rows
from iva import _iva

SCENE = """version = 1
[absorber]
kind = "siva"
mass_ratio = 0.1
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
"""
STUDY = SCENE + "[run]\nperiods = 5\n"
POINTS = SCENE.replace("mass_ratio = 0.1\n", "") + "[run]\nperiods = 5\n"
FORMATS = ("parquet", "arrow", "csv")
ESCAPE = "\x1b[31m"


@pytest.fixture
def fifo(tmp_path: Path) -> Path:
    """Return a pipe without a writer: to open it for reading takes for ever."""
    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes with names here")
    file = tmp_path / "pipe.csv"
    os.mkfifo(file)
    return file


def command(*args: object) -> int:
    return _iva.main(["iva", *(str(arg) for arg in args)])


def said(capfd: pytest.CaptureFixture[str], *args: object, code: int = 2) -> str:
    """Return the one error of a command."""
    assert command(*args) == code
    error = capfd.readouterr().err
    assert "panicked" not in error
    assert "\x1b" not in error
    return error


def written(folder: Path, text: str) -> Path:
    file = folder / "study.toml"
    file.write_text(text, encoding="utf-8")
    return file


def swept(out: Path, style: str = "parquet") -> Path:
    iva.sweep(
        iva.Siva(relative_clearance=0.6, restitution=0.5),
        iva.Primary(),
        over={"mass_ratio": [0.05, 0.1, 0.15]},
        start=iva.Start(displacement=1.0),
        periods=5,
        tables=("summary", "impacts"),
        out=out,
        format=style,
    )
    return out


def changed(file: Path) -> None:
    """Change a bit; in text the last digit behind a point, so that it is a number still."""
    content = bytearray(file.read_bytes())
    at = content.rindex(b".") + 1 if file.suffix == ".csv" else len(content) // 3
    content[at] ^= 1
    file.write_bytes(content)


@pytest.mark.parametrize("style", FORMATS)
def test_a_changed_file_is_not_read(tmp_path: Path, style: str) -> None:
    out = swept(tmp_path / "out", style)
    whole = iva.read(out)
    before = whole.impacts, whole.summary
    file = out / "impacts" / f"part-00000.{style}"
    changed(file)
    table = iva.read(out)
    assert_frame_equal(table.summary, before[1])
    with pytest.raises(iva.IvaError, match=rf"impacts.part-00000.{style} is not what was written"):
        _ = table.impacts
    with pytest.raises(iva.IvaError, match="its SHA-256 is not that of the manifest; resume"):
        iva.scan(out, check=True)
    assert iva.scan(out).tables == table.tables
    if style == "csv":
        assert not iva.read(out, check=False).impacts.equals(before[0])


@pytest.mark.parametrize("style", FORMATS)
def test_the_file_that_tells_units_is_checked_at_once(tmp_path: Path, style: str) -> None:
    out = swept(tmp_path / "out", style)
    file = out / "summary" / f"part-00000.{style}"
    changed(file)
    with pytest.raises(iva.IvaError, match="summary") as caught:
        iva.read(out)
    assert "\n" not in str(caught.value)


def test_a_study_of_other_values_beside_text_is_noticed(tmp_path: Path) -> None:
    out = swept(tmp_path / "out", "csv")
    study = out / "study.toml"
    study.write_text(
        study.read_text(encoding="utf-8").replace("restitution = 0.5", "restitution = 0.6")
    )
    with pytest.raises(iva.IvaError, match=r"of another study than manifest\.json"):
        iva.read(out)


@pytest.mark.parametrize("check", [1, "yes", None])
def test_check_is_true_or_false(tmp_path: Path, check: Any) -> None:
    with pytest.raises(TypeError, match=r"check = .*: give True or False"):
        iva.read(tmp_path, check=check)
    with pytest.raises(TypeError, match=r"check = .*: give True or False"):
        iva.scan(tmp_path, check=check)


@pytest.mark.parametrize("style", ["parquet", "arrow"])
def test_a_damaged_run_is_an_error_without_a_trace(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], style: str
) -> None:
    out = tmp_path / "out"
    assert command("run", written(tmp_path, STUDY), "--out", out, "--quiet", "--format", style) == 0
    file = out / "summary" / f"part-00000.{style}"
    content = file.read_bytes()
    faults: list[str] = []
    for place in range(0, len(content), 7):
        changed = bytearray(content)
        changed[place] ^= 0xFF
        file.write_bytes(changed)
        try:
            _ = iva.read(out).summary
        except iva.IvaError as error:
            faults.append(str(error))
    assert faults
    assert "\n" not in "".join(faults)
    assert capfd.readouterr().err == ""


def of_points(folder: Path, file: Path) -> Path:
    return written(folder, POINTS + f"[sampling]\npoints = '{file.name}'\n")


def test_equal_rows_are_read(tmp_path: Path) -> None:
    file = equal_rows(tmp_path / "points.parquet", 5)
    assert pl.read_parquet(file)["mass_ratio"].to_list() == [0.25] * 5
    out = tmp_path / "out"
    assert command("sweep", of_points(tmp_path, file), "--out", out, "--quiet") == 0
    assert iva.read(out).summary["mass_ratio"].to_list() == [0.25] * 5


# name, how it is made, what is said; 6·10⁸ rows take 4.8 GB, more than the 4 GB that are read
CLAIMS: list[tuple[str, Callable[[Path], Path], str]] = [
    ("rows.parquet", lambda file: equal_rows(file, 600_000_000), "would take 4.8 GB in memory"),
    ("more.parquet", lambda file: equal_rows(file, 10**15), "at most 2^32 are read"),
    ("less.parquet", lambda file: equal_rows(file, 500, claimed=5), "contradict each other"),
    ("none.parquet", lambda file: equal_rows(file, 5, claimed=-5), "contradict each other"),
    ("bytes.arrow", lambda file: arrow_claims(file, 10**15), "claims 1000000000000000 bytes"),
    ("minus.arrow", lambda file: arrow_claims(file, -1), "not an Arrow file, or not all of it"),
]


@pytest.mark.parametrize(("name", "make", "expected"), CLAIMS)
def test_what_a_file_claims_is_checked_before_room_is_made(
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    name: str,
    make: Callable[[Path], Path],
    expected: str,
) -> None:
    error = said(capfd, "check", of_points(tmp_path, make(tmp_path / name)))
    assert expected in error
    assert name in error


@pytest.mark.parametrize("ending", ["csv", "parquet", "arrow"])
def test_a_pipe_is_refused_at_once(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], fifo: Path, ending: str
) -> None:
    pipe = fifo.rename(tmp_path / f"pipe.{ending}")
    rule = "give a regular file"
    assert rule in said(capfd, "check", pipe)
    assert rule in said(capfd, "check", of_points(tmp_path, pipe))
    force = f"[force]\nrecord = '{pipe.name}'\nkind = 'force'\n"
    assert rule in said(capfd, "check", written(tmp_path, STUDY + force))
    study = written(tmp_path, STUDY)
    assert rule in said(capfd, "run", study, "--out", tmp_path / "out", "--log", pipe)
    with pytest.raises(iva.IvaError, match=rule):
        iva.Recorded.read(pipe)
    assert rule in said(capfd, "check", "/dev/null")
    assert "it is a folder" in said(capfd, "check", tmp_path)


@pytest.mark.parametrize("name", ["manifest.json", "summary/part-00000.parquet"])
def test_a_pipe_in_a_folder_is_refused_at_once(tmp_path: Path, fifo: Path, name: str) -> None:
    out = swept(tmp_path / "out")
    fifo.replace(out / name)
    with pytest.raises(iva.IvaError, match="regular file"):
        iva.read(out)


def test_a_study_of_more_than_ten_megabytes_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    study = written(tmp_path, STUDY + "#" * 10_000_000)
    expected = "has 10.0 MB; a study file has at most 10 MB"
    assert expected in said(capfd, "check", study)
    with pytest.raises(iva.IvaError, match=expected):
        _iva.empty_tables(study)
    # What would be written and could not be read again is refused before it is run.
    values = np.random.default_rng(1).uniform(0.1, 0.2, 600_000)
    with pytest.raises(ValueError, match=r"in study\.toml, and a study file has at most 10 MB"):
        iva.sweep(
            iva.Siva(relative_clearance=0.6, restitution=0.5),
            iva.Primary(),
            over={"mass_ratio": values},
            start=iva.Start(displacement=1.0),
            periods=0.1,
            out=tmp_path / "out",
        )


# what is swept; a check of everything would take minutes or hours
LARGE = [
    "periods = 9e18\ntables = ['summary']\n",
    "periods = 5\n[sampling]\nmethod = 'sobol'\ncount = 4294967296\n"
    "[sweep]\nrestitution = { low = 0.1, high = 0.9 }\n",
    "periods = 5\n[sweep]\nrestitution = { start = 0.1, stop = 0.9, count = 10_000_000 }\n",
]


@pytest.mark.parametrize("run", LARGE)
def test_a_check_of_much_takes_a_moment(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], run: str
) -> None:
    start = time.monotonic()
    assert command("check", written(tmp_path, SCENE + "[run]\n" + run)) == 0
    # It takes less than a second by itself; a busy machine has some more.
    assert time.monotonic() - start < 10.0
    out = capfd.readouterr().out
    assert ("more than" if "9e18" in run else "at some points") in out


def test_a_name_that_is_not_utf8(tmp_path: Path) -> None:
    if sys.platform != "linux":
        pytest.skip("names are bytes on Linux only")
    study = tmp_path / os.fsdecode(b"caf\xe9.toml")
    study.write_text(STUDY, encoding="utf-8")
    log = tmp_path / "log.jsonl"
    out = tmp_path / "out"
    ended = subprocess.run(
        [sys.executable, "-m", "iva", "run", study, "--quiet", "--out", out, "--log", log],
        capture_output=True,
        check=False,
    )
    assert (ended.returncode, ended.stderr) == (0, b"")
    assert "caf" in json.loads(log.read_text(encoding="utf-8").splitlines()[0])["study"]


def test_names_are_shown_not_obeyed(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / f"{ESCAPE}red"
    folder.mkdir()
    shown = "\\u{1b}[31m"
    study = written(folder, STUDY)
    assert shown in said(capfd, "check", folder / "missing.toml")
    assert shown in said(capfd, "check", written(folder, STUDY.replace("0.5", "1.5")))
    # The line of a study is drawn with symbols for what would act.
    said(capfd, "check", written(folder, STUDY + f'"{ESCAPE}" = 1\n'))
    assert shown in said(capfd, "sweep", study, "--tables", ESCAPE)
    written(folder, STUDY)
    assert command("check", study) == command("run", study, "--out", folder / "out") == 0
    printed = capfd.readouterr().out
    assert shown in printed
    assert "\x1b" not in printed
    (folder / "out" / "summary" / "part-00000.parquet").write_bytes(b"PAR1")
    for call in (
        lambda: iva.read(folder / "out"),
        lambda: iva.Recorded.read(folder / "missing.csv"),
        lambda: _iva.empty_tables(folder / "missing.toml"),
        lambda: iva.sweep(
            iva.Siva(restitution=0.5),
            iva.Primary(),
            over={f"{ESCAPE}mass": [1.0]},
            start=iva.Start(displacement=1.0),
            periods=1,
        ),
    ):
        with pytest.raises((iva.IvaError, ValueError)) as caught:
            call()
        assert shown in str(caught.value)
        assert "\x1b" not in str(caught.value)
    file = folder / "points.csv"
    file.write_text(f"{ESCAPE}x\n1\n", encoding="utf-8")
    assert shown in said(capfd, "check", of_points(folder, file))


def test_the_threads_of_the_environment_have_the_same_limit(tmp_path: Path) -> None:
    study = written(tmp_path, STUDY + "[sweep]\nmass_ratio = [0.05, 0.1]\n")
    for threads, code in (("20000", 2), ("1024", 0), ("3", 0), ("many", 0)):
        ended = subprocess.run(
            [sys.executable, "-m", "iva", "check", study],
            env=os.environ | {"RAYON_NUM_THREADS": threads},
            capture_output=True,
            check=False,
            text=True,
        )
        assert ended.returncode == code, ended.stderr
        rule = "RAYON_NUM_THREADS = 20000: give a whole number from 1 to 1024"
        assert (rule in ended.stderr) == (code == 2)


def test_a_seed_that_a_double_does_not_hold(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text = (
        POINTS + "[sampling]\nmethod = 'random'\ncount = 4\nseed = {seed}\n"
        "[sweep]\nmass_ratio = {{ low = 0.1, high = 0.2 }}\n"
    )
    rule = "a whole number from 0 to 9007199254740992"
    # 2⁵³ + 1 is the first that would be rounded.
    assert rule in said(capfd, "check", written(tmp_path, text.format(seed=2**53 + 1)))
    assert command("check", written(tmp_path, text.format(seed=2**53))) == 0
    with pytest.raises(ValueError, match=rule):
        iva.sampling.Random(4, seed=2**53 + 1)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1.O 2.O\n1 2\n2 3\n", '"1.O" is not a number'),
        ("-- --\n1 2\n2 3\n", '"--" is not a number'),
        ("0,1e400\n1,2\n", '"1e400" is not finite'),
        (".;,\n1;2\n", '"." is not a number'),
    ],
)
def test_the_first_line_of_a_record_is_not_left_out(
    tmp_path: Path, text: str, expected: str
) -> None:
    file = tmp_path / "record.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r":1:") as caught:
        iva.Recorded.read(file)
    assert expected in str(caught.value)
    file.write_text('"time [s]";θ\n0;1\n1;2\n', encoding="utf-8")
    assert iva.Recorded.read(file).values.tolist() == [1.0, 2.0]


def test_a_record_of_some_size_leaves_python_to_others(tmp_path: Path) -> None:
    file = tmp_path / "long.csv"
    file.write_text("dt = 0.01\n" + "0.25\n" * 2_000_000, encoding="utf-8")
    turns = 0
    done = threading.Event()

    def count() -> None:
        nonlocal turns
        while not done.wait(0.001):
            turns += 1

    thread = threading.Thread(target=count)
    thread.start()
    try:
        _iva.read_record(file)
    finally:
        done.set()
        thread.join()
    assert turns > 0


def exports(run: iva.Run, path: Path) -> list[tuple[str, Callable[[Path], object]]]:
    ways: list[tuple[str, Callable[[Path], object]]] = []
    for package, ending, write in (
        ("scipy", ".mat", run.write_mat),
        ("pyuff", ".uff", run.write_uff),
        ("matplotlib", ".gif", lambda file: iva.plots.animate(run, file, frames=3)),
        ("matplotlib", ".html", lambda file: iva.plots.animate(run, file, frames=3)),
    ):
        pytest.importorskip(package)
        ways.append((str(path) + ending, write))
    return ways


def test_exports_replace_regular_files_only(tmp_path: Path, run: iva.Run) -> None:
    for name, write in exports(run, tmp_path / "file"):
        file = Path(name)
        os.mkfifo(file)
        with pytest.raises(ValueError, match="this is a pipe or a device"):
            write(file)
        assert stat.S_ISFIFO(file.stat().st_mode)
        file.unlink()
        behind = tmp_path / f"behind{file.suffix}"
        behind.write_text("mine", encoding="utf-8")
        file.symlink_to(behind)
        write(file)
        assert file.is_symlink()
        assert behind.stat().st_size > 100
        file.unlink()
        behind.unlink()
        if os.geteuid() != 0:
            sealed = tmp_path / "sealed"
            sealed.mkdir(mode=0o500)
            with pytest.raises(iva.IvaError, match="cannot be written"):
                write(sealed / file.name)
            shutil.rmtree(sealed)
        assert [entry.name for entry in tmp_path.iterdir()] == []


# what is called, what is said of it
CHOICES: list[tuple[Callable[[iva.Table], object], str]] = [
    (lambda _: iva.best(1), "table = 1: give an iva.Table or a polars frame"),  # type: ignore[type-var]
    (lambda table: iva.best(table, "regime"), "the column 'regime' is of String: give one of num"),
    (lambda table: iva.best(table, 3), "3 is no name of a column: give a text"),  # type: ignore[arg-type]
    (lambda table: iva.best(table, count="3"), "count = '3': give a whole number"),  # type: ignore[arg-type]
    (lambda table: iva.best(table, where="x"), "where = 'x': give expressions of polars"),  # type: ignore[arg-type]
    (lambda table: iva.pareto(table, "impacts"), "by = 'impacts': give a list of columns"),
    (lambda table: iva.pareto(table, ["outcome"]), "the column 'outcome' is of String"),
    (
        lambda table: iva.robust(table, within={"mass_ratio": "20%"}),  # type: ignore[dict-item]
        "within['mass_ratio'] = '20%'",
    ),
    (lambda table: iva.robust(table, within=0.1), "within = 0.1: give a mapping"),  # type: ignore[arg-type]
    (
        lambda table: iva.robust(table, within={"mass_ratio": 0.1}, quantiles=0.5),  # type: ignore[arg-type]
        "quantiles = 0.5: give a list of numbers from 0 to 1",
    ),
]


@pytest.mark.parametrize(("call", "expected"), CHOICES)
def test_a_choice_of_the_wrong_type(
    table: iva.Table, call: Callable[[iva.Table], object], expected: str
) -> None:
    with pytest.raises(TypeError) as caught:
        call(table)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)
