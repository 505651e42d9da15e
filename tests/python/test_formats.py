"""Folders of Parquet, Arrow and CSV files: the same tables, to the bit."""

from __future__ import annotations

import contextlib
import json
import shutil
from pathlib import Path

import polars as pl
import pytest

import iva
from iva import _iva

# Chatter and sticking, runs that do not settle and runs without an impact: nulls in every table.
SCENE = """
version = 1
[primary]
damping_ratio = 0.01
[absorber]
kind = "siva"
mass_ratio = 0.15
restitution = 0.5
relative_clearance = 0.1
[start]
displacement = 1.0
[run]
periods = 6
"""
SWEEP = """tables = ["summary", "impacts", "episodes", "envelope"]
[sweep]
relative_clearance = [0.1, 0.6, 3.0]
absorber.mass_ratio = { start = 0.05, stop = 0.1, count = 3 }
"""
STYLES = {
    "arrow": ["--format", "arrow"],
    "csv": ["--format", "csv"],
    "csv with units": ["--format", "csv", "--units-row"],
}


def command(folder: Path, study: str, *options: str) -> Path:
    folder.mkdir()
    file = folder / "study.toml"
    file.write_text(study, encoding="utf-8")
    out = folder / "out"
    name = "sweep" if "[sweep]" in study else "run"
    assert _iva.main(["iva", name, str(file), "--out", str(out), "--quiet", *options]) == 0
    return out


def bits(frame: pl.DataFrame) -> pl.DataFrame:
    """Return the frame with the bits of its floats, for 0 = -0 otherwise."""
    return frame.with_columns(pl.col(pl.Float64).map_elements(float.hex, return_dtype=pl.String))


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("study", [SCENE, SCENE + SWEEP], ids=["run", "sweep"])
def test_every_format_reads_the_same(tmp_path: Path, study: str, style: str) -> None:
    parquet = iva.read(command(tmp_path / "parquet", study))
    # A pattern, if names were patterns.
    other = iva.read(command(tmp_path / "[other]", study, *STYLES[style]))
    assert other.tables == parquet.tables
    assert len(parquet.tables) == (4 if "[sweep]" in study else 7)
    assert other.swept == parquet.swept
    assert other.units == parquet.units
    for name in parquet.tables:
        expected, found = getattr(parquet, name), getattr(other, name)
        assert found.schema == expected.schema
        assert bits(found).equals(bits(expected)), name
    assert other == parquet
    # The scenes are worth comparing.
    assert parquet.summary["settling_time_2"].null_count() > 0
    assert parquet.episodes.height > 0


@pytest.mark.parametrize("style", STYLES)
def test_tables_without_rows(tmp_path: Path, style: str) -> None:
    study = SCENE.replace("relative_clearance = 0.1", "relative_clearance = 5.0")
    parquet = iva.read(command(tmp_path / "parquet", study))
    other = iva.read(command(tmp_path / "other", study, *STYLES[style]))
    assert parquet.impacts.height == parquet.episodes.height == 0
    assert other == parquet


PART_POINTS = 1 << 18  # points that a part of such short runs covers
LARGE = (
    SCENE.replace("periods = 6", 'periods = 0.3\ntables = ["summary", "impacts"]')
    + "[sweep]\nrestitution = { start = 0.5, stop = 1.0, count = 270000 }\n"
)


@pytest.fixture(scope="module", params=STYLES)
def large(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep of two parts."""
    home = tmp_path_factory.mktemp("large")
    return command(home / "run", LARGE, *STYLES[request.param])


@pytest.fixture
def folder(large: Path, tmp_path: Path) -> Path:
    """Return a copy of it."""
    return Path(shutil.copytree(large, tmp_path / "copy"))


def part(folder: Path, table: str, number: int) -> Path:
    (found,) = (folder / table).glob(f"part-{number:05}.*")
    return found


def refuse(folder: Path, *pieces: str) -> None:
    with pytest.raises(iva.IvaError) as caught:
        iva.read(folder)
    assert "\n" not in str(caught.value)
    for piece in pieces:
        assert piece in str(caught.value)


def test_parts_of_one_run_make_one_table(folder: Path) -> None:
    table = iva.read(folder)
    assert table.summary["point"].to_list() == list(range(270_000))
    assert table.summary["restitution"][269_999] == 1.0
    assert table.impacts["point"].is_sorted()
    assert table.impacts["point"][-1] > PART_POINTS


def test_an_interrupted_sweep_can_be_read(folder: Path) -> None:
    file = folder / "manifest.json"
    manifest = json.loads(file.read_text(encoding="utf-8"))
    del manifest["parts"]["1"]
    file.write_text(json.dumps(manifest), encoding="utf-8")
    for name in ("summary", "impacts"):
        part(folder, name, 1).unlink()
    assert iva.read(folder).summary.height == PART_POINTS


def test_a_missing_part_is_named(folder: Path) -> None:
    gone = part(folder, "impacts", 0)
    gone.unlink()
    refuse(folder, str(gone), "missing")


@pytest.mark.parametrize("table", ["summary", "impacts"])
def test_a_renamed_part_is_named(folder: Path, table: str) -> None:
    shutil.copy(part(folder, table, 0), part(folder, table, 1))
    refuse(folder, str(part(folder, table, 1)), "point 0", "point 262144")


def test_a_part_of_another_table_is_named(folder: Path) -> None:
    shutil.copy(part(folder, "impacts", 1), part(folder, "summary", 1))
    pieces = ("column", "summary") if part(folder, "summary", 1).suffix == ".csv" else ("impacts",)
    refuse(folder, str(part(folder, "summary", 1)), *pieces)


def test_a_broken_file_is_named(folder: Path) -> None:
    file = part(folder, "impacts", 1)
    file.write_bytes(b"ARROW1\0\0\xff and no more")
    refuse(folder, str(file))


def test_two_formats_are_refused(folder: Path, tmp_path: Path) -> None:
    other = command(tmp_path / "run", SCENE)
    shutil.copy(other / "impacts" / "part-00000.parquet", folder / "impacts")
    refuse(folder, "two formats", "part-00000.parquet", str(part(folder, "summary", 0)))


@pytest.fixture
def csv(tmp_path: Path) -> Path:
    """Return the folder of a small sweep as CSV files."""
    return command(tmp_path / "run", SCENE + SWEEP, "--format", "csv")


def test_csv_without_its_study(csv: Path) -> None:
    (csv / "study.toml").unlink()
    refuse(csv, str(csv / "study.toml"), "missing")


def test_csv_with_a_study_that_cannot_be_read(csv: Path) -> None:
    text = "version = 1\n[absorber]\nkind = 'siva'\nmas = 1\n"
    (csv / "study.toml").write_text(text, encoding="utf-8")
    refuse(csv, f"{csv / 'study.toml'}:4:1", "mas")


def test_csv_of_other_axes(csv: Path) -> None:
    study = csv / "study.toml"
    text = study.read_text(encoding="utf-8")
    study.write_text(text.replace("absorber.mass_ratio", "restitution"), encoding="utf-8")
    refuse(csv, str(csv / "summary" / "part-00000.csv"), "study.toml", "absorber.mass_ratio")


def test_csv_with_a_cell_that_is_no_number(csv: Path) -> None:
    file = csv / "impacts" / "part-00000.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    lines[2] = lines[2].replace(",", ",x", 1)
    file.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(iva.IvaError, match="is not what was written"):
        _ = iva.read(csv).impacts
    # The checksum tells it first; without it the cell does.
    table = iva.read(csv, check=False)
    assert table.summary.height == 9
    with pytest.raises(iva.IvaError, match="impacts cannot be read") as caught:
        _ = table.impacts
    assert "\n" not in str(caught.value)


def test_broken_arrow_files_are_a_fault(tmp_path: Path) -> None:
    out = command(tmp_path / "run", SCENE, "--format", "arrow")
    file = out / "impacts" / "part-00000.arrow"
    whole = file.read_bytes()
    # Cut anywhere it is no Arrow file; with any byte of its end changed it is one or not.
    for length in (0, 5, 9, 10, len(whole) // 2, len(whole) - 1):
        file.write_bytes(whole[:length])
        refuse(out, str(file), "not an Arrow file")
    for place in range(1, 600):
        file.write_bytes(whole[:-place] + bytes([whole[-place] ^ 0x5A]) + whole[-place:][1:])
        with contextlib.suppress(iva.IvaError):
            _iva.metadata(file)
