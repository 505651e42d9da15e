"""Folders that the command wrote."""

from __future__ import annotations

import copy
import json
import pickle
import shutil
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import iva
from iva import _iva
from iva.manifests import LAYOUT
from iva.parts import part_files

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
    """Write a part as versions before the keys of parts wrote it."""
    (folder / "summary").mkdir(exist_ok=True)
    metadata = {"iva.units": "si"} | ({} if version is None else {"iva.schema_version": version})
    file = folder / "summary" / f"part-{part:05}.parquet"
    pl.DataFrame({"point": points}).write_parquet(file, metadata=metadata)


def test_parts_without_the_newer_keys_can_be_read(tmp_path: Path) -> None:
    for part in range(3):
        write(tmp_path, part, [2 * part, 2 * part + 1], "1")
    assert iva.read(tmp_path).summary["point"].to_list() == [0, 1, 2, 3, 4, 5]


def test_parts_follow_their_numbers(tmp_path: Path) -> None:
    for part in (100_000, 99_999, 0):
        (tmp_path / f"part-{part:05}.parquet").touch()
    names = [file.name for file in part_files(tmp_path)]
    assert names == ["part-00000.parquet", "part-99999.parquet", "part-100000.parquet"]


def test_a_newer_layout_is_refused(tmp_path: Path) -> None:
    write(tmp_path, 0, [0], "1")
    write(tmp_path, 1, [1], str(iva.SCHEMA_VERSION + 1))
    with pytest.raises(iva.IvaError, match="newer iva-dynamics") as caught:
        iva.read(tmp_path)
    assert "\n" not in str(caught.value)


def test_an_older_layout_is_read(tmp_path: Path) -> None:
    # There is none yet; what counts is that a smaller number is no reason to refuse.
    write(tmp_path, 0, [0, 1], "0")
    assert iva.read(tmp_path).summary["point"].to_list() == [0, 1]


def test_columns_that_a_version_does_not_know_are_read_as_they_are(tmp_path: Path) -> None:
    (tmp_path / "summary").mkdir()
    metadata = {"iva.units": "si", "iva.schema_version": str(iva.SCHEMA_VERSION)}
    rows = pl.DataFrame({"point": [0], "outcome": ["finished"], "of_tomorrow": [0.5]})
    rows.write_parquet(tmp_path / "summary" / "part-00000.parquet", metadata=metadata)
    assert_frame_equal(iva.read(tmp_path).summary, rows)


def test_a_manifest_of_a_newer_layout_is_refused(tmp_path: Path) -> None:
    out = command(tmp_path, "sweep", STUDY + SWEEP)
    file = out / "manifest.json"
    manifest = json.loads(file.read_text(encoding="utf-8"))
    assert manifest["manifest"] == LAYOUT
    file.write_text(json.dumps(manifest | {"manifest": LAYOUT + 1}), encoding="utf-8")
    with pytest.raises(iva.IvaError, match=f"has layout {LAYOUT + 1}.*newer iva-dynamics"):
        iva.read(out)


def test_files_of_others_are_refused(tmp_path: Path) -> None:
    write(tmp_path, 0, [0], None)
    with pytest.raises(iva.IvaError, match="not written by iva"):
        iva.read(tmp_path)


def test_broken_files_are_a_fault(tmp_path: Path) -> None:
    write(tmp_path, 0, [0], "1")
    (tmp_path / "summary" / "part-00001.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(iva.IvaError, match="cannot be read"):
        iva.read(tmp_path)


LARGE = (
    STUDY.replace("periods = 6", 'periods = 0.1\ntables = ["summary", "impacts"]')
    + """
[sweep]
restitution = {{ start = {start}, stop = 1.0, count = 600000 }}
"""
)
PART_POINTS = 1 << 18  # points that a part of such short runs covers


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return the folders of two sweeps of three parts each."""
    folders = [tmp_path_factory.mktemp(name) for name in ("one", "other")]
    first, second = (
        command(folder, "sweep", LARGE.format(start=start))
        for folder, start in zip(folders, (0.5, 0.6), strict=True)
    )
    return first, second


@pytest.fixture
def folder(large: tuple[Path, Path], tmp_path: Path) -> Path:
    """Return a copy of the first folder."""
    return Path(shutil.copytree(large[0], tmp_path / "copy"))


def part(number: int) -> str:
    return f"part-{number:05}.parquet"


def refuse(folder: Path, *pieces: str) -> None:
    with pytest.raises(iva.IvaError) as caught:
        iva.read(folder)
    assert "\n" not in str(caught.value)
    for piece in pieces:
        assert piece in str(caught.value)


def test_parts_of_one_run_make_one_table(folder: Path) -> None:
    assert iva.read(folder).summary["point"].to_list() == list(range(600_000))


def without(folder: Path, number: int) -> None:
    """Take a part out of the manifest, as if the sweep had been interrupted before."""
    file = folder / "manifest.json"
    manifest = json.loads(file.read_text(encoding="utf-8"))
    del manifest["parts"][str(number)]
    file.write_text(json.dumps(manifest, indent=2), encoding="utf-8")


@pytest.mark.parametrize("number", [0, 1, 2])
@pytest.mark.parametrize("there", [False, True])
def test_an_interrupted_sweep_can_be_read(folder: Path, number: int, there: bool) -> None:
    without(folder, number)
    for name in ("summary", "impacts"):
        if not there:  # else killed before it was entered
            (folder / name / part(number)).unlink()
    points = iva.read(folder).summary["point"]
    assert points.to_list() == iva.scan(folder).summary.collect()["point"].to_list()
    gone = range(number * PART_POINTS, min(600_000, (number + 1) * PART_POINTS))
    assert set(points) == set(range(600_000)) - set(gone)


def test_a_manifest_that_cannot_be_read_is_named(folder: Path) -> None:
    (folder / "manifest.json").write_text("{}", encoding="utf-8")
    refuse(folder, "manifest.json", "no manifest of a sweep")


def test_parts_state_what_they_cover(folder: Path) -> None:
    found = [pl.read_parquet_metadata(folder / "impacts" / part(number)) for number in range(3)]
    assert [keys["iva.first_point"] for keys in found] == ["0", "262144", "524288"]
    assert [keys["iva.part_points"] for keys in found] == ["262144", "262144", "75712"]
    assert {keys["iva.points"] for keys in found} == {"600000"}


def test_a_missing_part_is_named(folder: Path) -> None:
    (folder / "summary" / part(1)).unlink()
    refuse(folder, str(Path("summary", part(1))), "missing")


def test_a_missing_first_part_is_named(folder: Path) -> None:
    for name in ("summary", "impacts"):
        (folder / name / part(0)).unlink()
    refuse(folder, part(0), "missing")


def test_a_part_missing_at_the_end_of_one_table_is_named(folder: Path) -> None:
    (folder / "impacts" / part(2)).unlink()
    refuse(folder, str(Path("impacts", part(2))), "missing")


def test_a_part_of_another_run_is_named(folder: Path, large: tuple[Path, Path]) -> None:
    shutil.copy(large[1] / "summary" / part(1), folder / "summary" / part(1))
    refuse(folder, str(Path("summary", part(1))), "not of the same run")


def test_a_table_of_another_run_is_named(folder: Path, large: tuple[Path, Path]) -> None:
    shutil.rmtree(folder / "impacts")
    shutil.copytree(large[1] / "impacts", folder / "impacts")
    refuse(folder, str(Path("impacts", part(0))), "not of the same run")


def test_a_part_of_another_table_is_named(folder: Path) -> None:
    shutil.copy(folder / "impacts" / part(1), folder / "summary" / part(1))
    refuse(folder, str(Path("summary", part(1))), "table impacts")


def test_a_renamed_part_is_named(folder: Path) -> None:
    shutil.copy(folder / "summary" / part(0), folder / "summary" / part(1))
    refuse(folder, str(Path("summary", part(1))), "point 0", "point 262144")


def test_a_strange_name_is_named(folder: Path) -> None:
    shutil.copy(folder / "summary" / part(1), folder / "summary" / "part-00001 (1).parquet")
    refuse(folder, "part-00001 (1).parquet")


def test_defaults_count_the_same_written_or_left_out(tmp_path: Path) -> None:
    def digest(folder: str, study: str) -> str:
        (tmp_path / folder).mkdir()
        out = command(tmp_path / folder, "run", study)
        return pl.read_parquet_metadata(out / "summary" / part(0))["iva.study"]

    plain = digest("plain", STUDY)
    assert digest("tables", STUDY + 'tables = ["summary"]\n') == plain
    assert digest("limit", STUDY + "max_impacts = 10_000_000\n") == plain
    assert digest("zero", STUDY.replace("[run]", "velocity = 0.0\n[run]")) == plain
    assert digest("other", STUDY.replace("[run]", "velocity = 0.1\n[run]")) != plain
    assert digest("measures", STUDY + 'measures = ["impacts"]\n') != plain


def test_results_further_down_are_named(tmp_path: Path) -> None:
    for name in ("b", "a"):
        (tmp_path / name).mkdir()
        command(tmp_path / name, "run", STUDY)
        (tmp_path / name / "out").rename(tmp_path / f"result_{name}")
    with pytest.raises(ValueError, match="results in result_a, result_b; give one of these"):
        iva.read(tmp_path)
    with pytest.raises(ValueError, match=r"one table of a result, give .*result_a"):
        iva.read(tmp_path / "result_a" / "summary")


@pytest.mark.parametrize("folder", [None, 5, ["results"]])
def test_what_is_no_path(folder: Any) -> None:
    with pytest.raises(TypeError, match=r"folder = .*: give a path"):
        iva.read(folder)


def test_folders_without_tables(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no tables"):
        iva.read(tmp_path)
    with pytest.raises(ValueError, match="nowhere"):
        iva.read(tmp_path / "nowhere")


def test_a_folder_in_the_middle_of_an_exchange_is_not_read(tmp_path: Path) -> None:
    # As a process leaves it that is killed while it replaces tables.
    folder = tmp_path / "out"
    iva.sweep(
        iva.Siva(mass_ratio=0.1, restitution=0.5),
        iva.Primary(damping_ratio=0.01),
        start=iva.Start(displacement=1.0),
        periods=2,
        over={"relative_clearance": [0.5, 0.6]},
        out=folder,
    )
    (folder / ".iva-new").mkdir()
    (folder / ".iva-new" / "exchange.json").write_text("{}")
    with pytest.raises(iva.IvaError, match="a process was killed while it replaced the tables"):
        iva.read(folder)


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"nothing': there is no such folder$"):
        iva.read(tmp_path / "nothing")
