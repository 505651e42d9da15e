"""Tables from a folder that the command ``iva`` wrote."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from iva import _iva
from iva.frames import NAMES, Frames
from iva.parameters import shown
from iva.sweeping import Table
from iva.units import from_metadata

if TYPE_CHECKING:
    import polars as pl


def read(folder: str | os.PathLike[str]) -> Table:
    """Open the tables of a folder that ``iva sweep`` or ``iva run`` wrote.

    Parameters
    ----------
    folder : str or path
        The folder, with ``<table>/part-*.parquet`` in it. A table is read when first asked for.

    Returns
    -------
    Table
        The same tables that :func:`iva.sweep` returns.

    Raises
    ------
    TypeError
        If `folder` is not a path.
    ValueError
        If there is no such folder, or no table in it.
    iva.IvaError
        If a file cannot be read, was written by a newer version with another layout, is missing
        between others, or belongs to another run or table. An interrupted sweep leaves the first
        parts of every table: these can be read.

    Examples
    --------
    >>> iva.read("results/siva_clearance").summary  # doctest: +SKIP
    """
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(f"folder = {shown(folder)}: give a path")
    path = Path(folder)
    if not path.is_dir():
        raise ValueError(f"folder = {str(path)!r}: give a folder that `iva sweep` wrote")
    parts = {name: files for name in NAMES if (files := part_files(path / name))}
    if not parts:
        raise ValueError(f"folder = {str(path)!r}: {instead(path)}")
    found = checked(parts)
    swept = tuple(key for key in found.get("iva.swept", "").split(",") if key)
    frames = Frames({name: source(files) for name, files in parts.items()})
    return Table(swept, from_metadata(found, swept), frames)


def instead(folder: Path) -> str:
    """Return what to give instead of a folder without tables."""
    if part_files(folder):
        return f"this is one table of a result, give {str(folder.parent)!r}"
    if others := [file for name in NAMES for file in sorted((folder / name).glob("part-*"))]:
        return f"only Parquet files are read here, and it has {others[0].relative_to(folder)}"
    try:
        inner = sorted(entry for entry in folder.iterdir() if entry.is_dir())
    except OSError as error:
        raise _iva.IvaError(f"{folder} cannot be read: {error}") from error
    results = [entry.name for entry in inner if any(part_files(entry / name) for name in NAMES)]
    if not results:
        return "no tables in it, give one with <table>/part-*.parquet"
    more = f" and {len(results) - 10} more" if len(results) > 10 else ""
    return f"no tables in it, but results in {', '.join(results[:10])}{more}; give one of these"


def part_files(folder: Path) -> list[Path]:
    """Return the parts of a table in the order of their numbers."""
    return sorted(folder.glob("part-*.parquet"), key=lambda file: (len(file.name), file.name))


# What the parts of one run have in common.
COMMON = ("iva.schema_version", "iva.version", "iva.units", "iva.swept", "iva.study", "iva.points")


def checked(parts: Mapping[str, list[Path]]) -> dict[str, str]:
    """Return the metadata of the first part, after a check that all belong to the same run.

    Raises
    ------
    iva.IvaError
        If one does not, or one is missing. Metadata that older files lack are not missed.
    """
    longest = max(parts.values(), key=len)
    first = longest[0]
    common = metadata(first)
    for name, files in parts.items():
        for index, beside in enumerate(longest):
            expected = files[0].parent / f"part-{index:05}.parquet"
            if index >= len(files):
                raise _iva.IvaError(f"{expected} is missing, but {beside} is there")
            if files[index] != expected:
                raise _iva.IvaError(f"{expected} is missing, but {files[index].name} is there")
        begin = 0
        for file in files:
            found = metadata(file)
            if found.get("iva.table", name) != name:
                raise _iva.IvaError(f"{file} is a part of the table {found['iva.table']}")
            for key in COMMON:
                if found.get(key) != common.get(key):
                    raise _iva.IvaError(f"{file} is not of the same run as {first}: {key} differs")
            if found.get("iva.first_point", str(begin)) != str(begin):
                raise _iva.IvaError(
                    f"{file} begins with point {found['iva.first_point']}, but point {begin} is due"
                )
            begin += int(found.get("iva.part_points", "0"))
    return common


def metadata(file: Path) -> dict[str, str]:
    """Return the metadata of a part, after a check that this version can read it.

    Raises
    ------
    iva.IvaError
        If it cannot.
    """
    import polars as pl

    try:
        found = pl.read_parquet_metadata(file)
    except (OSError, pl.exceptions.PolarsError) as error:
        raise _iva.IvaError(f"{file} cannot be read: {error}") from error
    version = found.get("iva.schema_version", "")
    points = found.get("iva.part_points", "0")
    if not version.isdecimal() or not points.isdecimal() or "iva.units" not in found:
        raise _iva.IvaError(f"{file} was not written by iva: its metadata lack the table layout")
    if int(version) > _iva.SCHEMA_VERSION:
        raise _iva.IvaError(
            f"{file} has table layout {version}, this version of iva reads up to "
            f"{_iva.SCHEMA_VERSION}: install a newer iva-dynamics"
        )
    return found


def source(files: list[Path]) -> Callable[[], pl.DataFrame]:
    """Return the function that reads some parts as one frame."""

    def load() -> pl.DataFrame:
        import polars as pl

        try:
            return pl.read_parquet(files, glob=False, hive_partitioning=False)
        except (OSError, pl.exceptions.PolarsError) as error:
            raise _iva.IvaError(f"{files[0].parent} cannot be read: {error}") from error

    return load
