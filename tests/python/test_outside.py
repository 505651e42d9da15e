"""What comes from outside is shown as it is and refused in one sentence: names, values, targets."""

from __future__ import annotations

import json
import os
import shutil
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

import iva
from iva import _iva
from trust import POINTS, STUDY, command, of_points, said, written

ESCAPE = "\x1b[31m"


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
    turns = reads = 0
    reading = False
    done = threading.Event()

    def count() -> None:
        nonlocal turns
        while not done.wait(0.001):
            turns += reading

    thread = threading.Thread(target=count)
    before = sys.getswitchinterval()
    # Nobody is made to hand Python over, so a turn while it reads is one that the reading gives.
    sys.setswitchinterval(1e6)
    thread.start()
    try:
        # The system may have had no time for the other thread, but hardly a hundred times.
        while turns == 0 and reads < 100:
            reading = True
            _iva.read_record(file)
            reading = False
            reads += 1
    finally:
        sys.setswitchinterval(before)
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


@pytest.mark.skipif(sys.platform == "win32", reason="there are no named pipes")
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
    (lambda table: iva.robust(table, within=0.1), "within = 0.1: give a mapping"),  # type: ignore[call-overload]
    (
        lambda table: iva.robust(table, within={"mass_ratio": 0.1}, quantiles=0.5),  # type: ignore[call-overload]
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
