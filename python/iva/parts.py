"""The parts of a table on disk: what each says of itself, and its rows.

Parquet and Arrow files carry their metadata. CSV files have none: types, units and axes are those
of the resolved study in the same folder.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from iva import _iva
from iva.faults import fault
from iva.frames import to_polars
from iva.manifests import manifest_of

if TYPE_CHECKING:
    import polars as pl

#: A file with its size in bytes and its SHA-256.
Sum: TypeAlias = "tuple[Path, int, str]"

FORMATS = ("parquet", "arrow", "csv")


def part_files(folder: Path) -> list[Path]:
    """Return the parts of a table, of any format, in the order of their numbers."""
    found = [file for name in FORMATS for file in folder.glob(f"part-*.{name}")]
    return sorted(found, key=lambda file: (len(file.stem), file.name))


def tables_of_study(file: Path) -> dict[str, _iva.ArrowTable]:
    """Return the tables that the study beside a CSV file describes, without rows.

    For other files it is empty: they describe themselves.

    Raises
    ------
    iva.IvaError
        If the study is missing or cannot be read.
    """
    if file.suffix != ".csv":
        return {}
    study = file.parent.parent / "study.toml"
    if not study.is_file():
        raise fault(f"{study} is missing: CSV files cannot be read without the study")
    return _iva.empty_tables(study)


def metadata(file: Path, table: _iva.ArrowTable | None = None) -> dict[str, str]:
    """Return the metadata of a part, after a check that this version can read it.

    Parameters
    ----------
    file : Path
        The part.
    table : ArrowTable, optional
        For CSV files: the table without rows, of :func:`tables_of_study`.

    Raises
    ------
    iva.IvaError
        If it cannot.
    """
    found = _iva.metadata(file) if table is None else of_csv(file, table)
    version = found.get("iva.schema_version", "")
    points = found.get("iva.part_points", "0")
    if not version.isdecimal() or not points.isdecimal() or "iva.units" not in found:
        raise fault(f"{file} was not written by iva: its metadata lack the table layout")
    if int(version) > _iva.SCHEMA_VERSION:
        raise fault(
            f"{file} has table layout {version}, this version of iva reads up to "
            f"{_iva.SCHEMA_VERSION}: install a newer iva-dynamics"
        )
    return found


def frame(
    files: list[Path], table: _iva.ArrowTable | None = None, sums: Sequence[Sum] | None = None
) -> pl.DataFrame:
    """Return all rows of some parts of one table and format.

    Parameters
    ----------
    files : list of Path
        The parts.
    table : ArrowTable, optional
        As in :func:`metadata`.
    sums : sequence of (path, bytes, SHA-256), optional
        What each of the files must be; without it nothing says that they are as they were written.

    Raises
    ------
    iva.IvaError
        If one is not what `sums` says, or cannot be read.
    """
    import polars as pl

    if sums is not None:
        _iva.check_files(sums)
    try:
        if table is not None:
            return pl.concat([rows_of_csv(file, table) for file in files])
        if sums is None:
            # polars would panic over some damaged files, and print where.
            return pl.concat([to_polars(_iva.read_table(file)) for file in files])
        if files[0].suffix == ".parquet":
            return pl.read_parquet(files, glob=False, hive_partitioning=False)
        # Of a path polars would take [ and * for a pattern, and map the file into memory.
        return pl.concat([pl.read_ipc(file.read_bytes()) for file in files])
    except (OSError, pl.exceptions.PolarsError, pl.exceptions.PanicException) as error:
        raise fault(f"{files[0].parent} cannot be read: {sentence(error)}") from error


def lazy(files: list[Path], table: _iva.ArrowTable | None = None) -> pl.LazyFrame:
    """Return the rows of some parts of one table and format, to be read when they are needed.

    `table` is that of :func:`metadata`.
    """
    import polars as pl

    if files[0].suffix == ".parquet":
        return pl.scan_parquet(files, glob=False, hive_partitioning=False)
    if files[0].suffix == ".arrow":
        return pl.concat(
            [pl.scan_ipc(file) for file in files]
        )  # polars 1.30 has no glob=False here
    assert table is not None
    return pl.concat([scan_of_csv(file, table) for file in files])


def of_csv(file: Path, table: _iva.ArrowTable) -> dict[str, str]:
    """Return what a Parquet file would carry, as far as a CSV file and its study tell."""
    first = head(file, table)[2].partition(",")[0]
    manifest = manifest_of(file.parent.parent)
    points = int(table.metadata["iva.points"])
    part_points = points if manifest is None else manifest.part_points
    found = table.metadata | {"iva.part_points": str(part_points)}
    if first.isdecimal():  # else it has no rows
        begin = int(first) // part_points * part_points
        summary = found["iva.table"] == "summary"
        found["iva.first_point"] = first if summary else str(begin)
    return found


def rows_of_csv(file: Path, table: _iva.ArrowTable) -> pl.DataFrame:
    """Return the rows of a CSV file, with the column types of its table."""
    import polars as pl

    columns, units, _ = head(file, table)
    types = to_polars(table).schema
    rows = pl.read_csv(
        file,
        schema={name: types[name] for name in columns},
        skip_rows_after_header=1 if units else 0,
        glob=False,
    )
    # polars 1.30 makes a row of nulls out of a skipped row with nothing below it.
    return rows.filter(pl.col("point").is_not_null())


def scan_of_csv(file: Path, table: _iva.ArrowTable) -> pl.LazyFrame:
    """Return the rows of a CSV file lazily, with the column types of its table."""
    import polars as pl

    columns, units, _ = head(file, table)
    types = to_polars(table).schema
    return pl.scan_csv(
        file,
        schema={name: types[name] for name in columns},
        skip_rows_after_header=1 if units else 0,
        glob=False,
    ).filter(pl.col("point").is_not_null())


def head(file: Path, table: _iva.ArrowTable) -> tuple[list[str], bool, str]:
    """Return the columns of a CSV file, whether their units follow, and the first row.

    Raises
    ------
    iva.IvaError
        If the file cannot be read, or has columns of another table or study.
    """
    try:
        with file.open(encoding="utf-8") as lines:
            names, first, second = (lines.readline().rstrip("\n") for _ in range(3))
    except (OSError, UnicodeDecodeError) as error:
        raise fault(f"{file} cannot be read: {sentence(error)}") from error
    columns = names.split(",")
    known = table.units
    needed = ["point"]
    if table.metadata["iva.table"] == "summary":
        needed += [key for key in table.metadata["iva.swept"].split(",") if key]
    strange = [name for name in columns if name not in known]
    strange += [name for name in needed if name not in columns]
    if strange or len(set(columns)) < len(columns):
        name = strange[0] if strange else "one column twice"
        raise fault(
            f"{file} does not fit the study beside it: in the table {table.metadata['iva.table']} "
            f"of study.toml the columns differ, by {name!r}"
        )
    # The unit of a count is 1, so that the first cell alone could be the number of a point.
    units = first == ",".join(known[name] for name in columns)
    return columns, units, second if units else first


def sentence(error: BaseException) -> str:
    """Return the first line of what an error says: polars adds advice to programmers below it."""
    return str(error).partition("\n")[0]
