"""Folders that the command wrote."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva
from iva import _iva

STUDY = """
version = 1
[primary]
damping_ratio = 0.01
[absorber]
kind = "siva"
mass_ratio = 0.15
restitution = 0.5
relative_clearance = 0.6
[start]
displacement = 1.0
[run]
periods = 6
"""
SWEEP = """tables = ["summary", "impacts", "episodes", "envelope"]
[sweep]
relative_clearance = [0.4, 0.6, 0.8]
mass_ratio = [0.05, 0.1]
"""


def command(folder: Path, name: str, study: str) -> Path:
    file = folder / "study.toml"
    file.write_text(study, encoding="utf-8")
    out = folder / "out"
    assert _iva.main(["iva", name, str(file), "--out", str(out), "--quiet"]) == 0
    return out


def test_read_gives_what_sweep_gives(tmp_path: Path, table: iva.Table) -> None:
    read = iva.read(command(tmp_path, "sweep", STUDY + SWEEP))
    assert read == table
    assert read.swept == ("relative_clearance", "mass_ratio")
    assert read.units["impacts"] == table.units["impacts"]
    assert pickle.loads(pickle.dumps(read)) == copy.deepcopy(read) == table


def test_read_gives_what_simulate_gives(tmp_path: Path, run: iva.Run) -> None:
    read = iva.read(str(command(tmp_path, "run", STUDY)))
    assert_frame_equal(read.summary, run.summary)
    assert_frame_equal(read.impacts, run.impacts)
    assert_frame_equal(read.envelope, run.envelope)
    assert read.trajectory.columns == run.trajectory().columns
    assert read.units["trajectory"] == run.units["trajectory"]


def write(folder: Path, part: int, points: list[int], version: str | None) -> None:
    (folder / "summary").mkdir(exist_ok=True)
    metadata = {"iva.units": "si"} | ({} if version is None else {"iva.schema_version": version})
    file = folder / "summary" / f"part-{part:05}.parquet"
    pl.DataFrame({"point": points}).write_parquet(file, metadata=metadata)


def test_parts_follow_their_numbers(tmp_path: Path) -> None:
    write(tmp_path, 100_000, [3], "1")
    write(tmp_path, 1, [2], "1")
    write(tmp_path, 0, [0, 1], "1")
    assert iva.read(tmp_path).summary["point"].to_list() == [0, 1, 2, 3]


def test_a_newer_layout_is_refused(tmp_path: Path) -> None:
    write(tmp_path, 0, [0], "1")
    write(tmp_path, 1, [1], str(iva.SCHEMA_VERSION + 1))
    with pytest.raises(iva.IvaError, match="newer iva-dynamics") as caught:
        iva.read(tmp_path)
    assert "\n" not in str(caught.value)


def test_files_of_others_are_refused(tmp_path: Path) -> None:
    write(tmp_path, 0, [0], None)
    with pytest.raises(iva.IvaError, match="not written by iva"):
        iva.read(tmp_path)


def test_broken_files_are_a_fault(tmp_path: Path) -> None:
    write(tmp_path, 0, [0], "1")
    (tmp_path / "summary" / "part-00001.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(iva.IvaError, match="cannot be read"):
        iva.read(tmp_path)


def test_folders_without_tables(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no tables"):
        iva.read(tmp_path)
    with pytest.raises(ValueError, match="nowhere"):
        iva.read(tmp_path / "nowhere")
