"""What comes from outside is judged before it is believed: files, names, sizes."""

from __future__ import annotations

import os
import subprocess
import sys
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
from patience import PATIENCE
from trust import SCENE, STUDY, command, of_points, said, written

FORMATS = ("parquet", "arrow", "csv")


@pytest.fixture
def fifo(tmp_path: Path) -> Path:
    """Return a pipe without a writer: to open it for reading takes for ever."""
    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes with names here")
    file = tmp_path / "pipe.csv"
    os.mkfifo(file)
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
    """Change a bit of a value; in text the last digit behind a point: a number still."""
    content = bytearray(file.read_bytes())
    # Values come first in Parquet, and after the schema in Arrow.
    places = {".csv": content.rindex(b".") + 1, ".parquet": 100, ".arrow": len(content) // 2}
    content[places[file.suffix]] ^= 1
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


# what is swept; a check of everything would take for ever, minutes or a moment
LARGE = [
    "periods = 9e18\ntables = ['summary']\n",
    "periods = 5\n[sampling]\nmethod = 'sobol'\ncount = 4294967296\n"
    "[sweep]\nrestitution = { low = 0.1, high = 0.9 }\n",
    "periods = 5\n[sweep]\nrestitution = { start = 0.1, stop = 0.9, count = 10_000_000 }\n",
]


@pytest.mark.parametrize("run", LARGE)
def test_a_check_of_much_looks_at_some_of_it(tmp_path: Path, run: str) -> None:
    study = written(tmp_path, SCENE + "[run]\n" + run)
    # A process of its own can be ended if it hangs.
    done = subprocess.run(
        [sys.executable, "-m", "iva", "check", str(study)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=PATIENCE,
        check=True,
    )
    assert ("more than" if "9e18" in run else "at some points") in done.stdout
