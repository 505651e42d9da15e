"""Tables from a folder that the command ``iva`` wrote."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from iva import _iva
from iva.frames import NAMES, Frames
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
    ValueError
        If there is no such folder, or no table in it.
    iva.IvaError
        If a file cannot be read, or was written by a newer version with another layout.

    Examples
    --------
    >>> iva.read("results/siva_clearance").summary  # doctest: +SKIP
    """
    path = Path(folder)
    if not path.is_dir():
        raise ValueError(f"folder = {str(path)!r}: give a folder that `iva sweep` wrote")
    parts = {name: files for name in NAMES if (files := part_files(path / name))}
    if not parts:
        raise ValueError(
            f"folder = {str(path)!r}: no tables in it, give one with <table>/part-*.parquet"
        )
    found = [metadata(file) for files in parts.values() for file in files]
    swept = tuple(key for key in found[0].get("iva.swept", "").split(",") if key)
    frames = Frames({name: source(files) for name, files in parts.items()})
    return Table(swept, from_metadata(found[0], swept), frames)


def part_files(folder: Path) -> list[Path]:
    """Return the parts of a table in the order of their numbers."""
    return sorted(folder.glob("part-*.parquet"), key=lambda file: (len(file.name), file.name))


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
    if not version.isdecimal() or "iva.units" not in found:
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
