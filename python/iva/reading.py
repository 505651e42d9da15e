"""Tables from a folder that ``iva sweep``, ``iva run`` or :func:`iva.sweep` wrote."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path

from iva import _iva
from iva.frames import NAMES, Frames
from iva.manifests import Manifest, bytes_of, manifest_of
from iva.parameters import shown
from iva.parts import frame, metadata, part_files, tables_of_study
from iva.tables import Table
from iva.units import Units, from_metadata


def read(folder: str | os.PathLike[str]) -> Table:
    """Open the tables of a folder that ``iva sweep`` or ``iva run`` wrote.

    Parameters
    ----------
    folder : str or path
        The folder, with ``<table>/part-*.parquet`` in it, or ``.arrow`` or ``.csv``. A table is
        read when first asked for. CSV files need the ``study.toml`` that was written with them:
        types, units and axes stand there.

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
        between others, belongs to another run or table, or is of another format than the rest (a
        CSV file of another run shows only by its columns and points). Of an interrupted sweep the
        parts that were complete can be read.

    Examples
    --------
    >>> iva.read("results/siva_clearance").summary  # doctest: +SKIP
    """
    found = found_in(folder)
    frames = Frames(
        {name: partial(frame, files, found.tables.get(name)) for name, files in found.parts.items()}
    )
    return Table(found.swept, found.units, frames)


@dataclass(frozen=True, slots=True)
class Found:
    """The tables of a folder, not read yet.

    Parameters
    ----------
    parts : mapping of str to list of Path
        The parts of each table.
    tables : mapping of str to ArrowTable
        What describes the tables if the parts do not.
    swept : tuple of str
        Keys of the axes.
    units : Units
        Units of the columns.
    """

    parts: Mapping[str, list[Path]]
    tables: Mapping[str, _iva.ArrowTable]
    swept: tuple[str, ...]
    units: Units


def found_in(folder: str | os.PathLike[str]) -> Found:
    """Return what is in a folder, after a check that it belongs together.

    Raises
    ------
    TypeError, ValueError, iva.IvaError
        As :func:`read`.
    """
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(f"folder = {shown(folder)}: give a path")
    path = Path(folder)
    if not path.is_dir():
        raise ValueError(f"folder = {str(path)!r}: give a folder that `iva sweep` wrote")
    manifest = manifest_of(path)
    parts = {name: listed(files, manifest) for name in NAMES if (files := part_files(path / name))}
    if not any(parts.values()):
        raise ValueError(f"folder = {str(path)!r}: {instead(path)}")
    tables = described(parts)
    common = checked(parts, tables, manifest)
    swept = tuple(key for key in common.get("iva.swept", "").split(",") if key)
    return Found(parts, tables, swept, from_metadata(common, swept))


def listed(files: list[Path], manifest: Manifest | None) -> list[Path]:
    """Return the parts that count: not those which a killed sweep had not entered yet."""
    if manifest is None:
        return files

    def counts(file: Path) -> bool:
        number = file.stem.removeprefix("part-")
        return not number.isdecimal() or int(number) in manifest.parts

    return [file for file in files if counts(file)]


def instead(folder: Path) -> str:
    """Return what to give instead of a folder without tables."""
    if part_files(folder):
        return f"this is one table of a result, give {str(folder.parent)!r}"
    try:
        inner = sorted(entry for entry in folder.iterdir() if entry.is_dir())
    except OSError as error:
        raise _iva.IvaError(f"{folder} cannot be read: {error}") from error
    results = [entry.name for entry in inner if any(part_files(entry / name) for name in NAMES)]
    if not results:
        return "no tables in it, give one with <table>/part-*.parquet"
    more = f" and {len(results) - 10} more" if len(results) > 10 else ""
    return f"no tables in it, but results in {', '.join(results[:10])}{more}; give one of these"


# What the parts of one run have in common.
COMMON = ("iva.schema_version", "iva.version", "iva.units", "iva.swept", "iva.study", "iva.points")


def described(parts: Mapping[str, list[Path]]) -> dict[str, _iva.ArrowTable]:
    """Return what describes the tables if the parts do not, after a check of their format.

    Raises
    ------
    iva.IvaError
        If the parts are of two formats.
    """
    first, *others = chain.from_iterable(parts.values())
    for file in others:
        if file.suffix != first.suffix:
            raise _iva.IvaError(f"{first} and {file} are of two formats: keep the files of one run")
    return tables_of_study(first)


def checked(
    parts: Mapping[str, list[Path]],
    tables: Mapping[str, _iva.ArrowTable],
    manifest: Manifest | None,
) -> dict[str, str]:
    """Return the metadata of the first part, after a check that all belong to the same run.

    Parameters
    ----------
    parts : mapping of str to list of Path
        The parts of each table.
    tables : mapping of str to ArrowTable
        What :func:`described` returns.
    manifest : Manifest, optional
        Which parts there should be; without it all up to the last that is there.

    Raises
    ------
    iva.IvaError
        If one does not, or one is missing. Metadata that older files lack are not missed.
    """
    longest = max(parts.values(), key=len)
    first = longest[0]
    common = metadata(first, tables.get(first.parent.name))
    numbers = range(len(longest)) if manifest is None else list(manifest.parts)
    for name in next(iter(manifest.parts.values()))["tables"] if manifest else ():
        if name not in parts:
            raise _iva.IvaError(
                f"{first.parent.parent / name} is missing, but the manifest lists it"
            )
    for name, files in parts.items():
        for index, number in enumerate(numbers):
            expected = first.parent.parent / name / f"part-{number:05}{first.suffix}"
            if index >= len(files):
                beside = "the manifest lists it" if manifest else f"{longest[index]} is there"
                raise _iva.IvaError(f"{expected} is missing, but {beside}")
            if files[index] != expected:
                raise _iva.IvaError(f"{expected} is missing, but {files[index].name} is there")
        begin = 0
        for number, file in zip(numbers, files, strict=False):
            found = metadata(file, tables.get(name))
            if found.get("iva.table", name) != name:
                raise _iva.IvaError(f"{file} is a part of the table {found['iva.table']}")
            for key in COMMON:
                if found.get(key) != common.get(key):
                    raise _iva.IvaError(f"{file} is not of the same run as {first}: {key} differs")
            begin = begin if manifest is None else number * manifest.part_points
            if found.get("iva.first_point", str(begin)) != str(begin):
                raise _iva.IvaError(
                    f"{file} begins with point {found['iva.first_point']}, but point {begin} is due"
                )
            size = file.stat().st_size
            if manifest is not None and size != bytes_of(manifest.parts[number], name):
                raise _iva.IvaError(
                    f"{file} is not what was written: its size is not that of the manifest; "
                    "resume the sweep to compute it again"
                )
            begin += int(found.get("iva.part_points", "0"))
        if len(files) > len(numbers):
            raise _iva.IvaError(f"{files[len(numbers)]} is no part of this sweep")
    return common
