"""Tables from a folder that ``iva sweep``, ``iva run`` or :func:`iva.sweep` wrote."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from stat import S_ISREG

from iva import _iva
from iva.faults import fault
from iva.frames import NAMES, Frames
from iva.manifests import FILE, Manifest, bytes_of, manifest_of, sum_of
from iva.parameters import shown
from iva.parts import Sum, frame, metadata, part_files, tables_of_study
from iva.spelling import spell_checked
from iva.tables import Table
from iva.units import Units, from_metadata

#: There while new tables take the place of earlier ones.
EXCHANGE = Path(".iva-new") / "exchange.json"


@spell_checked
def read(folder: str | os.PathLike[str], *, check: bool = True) -> Table:
    """Open the tables of a folder that ``iva sweep`` or ``iva run`` wrote.

    Parameters
    ----------
    folder : str or path
        The folder, with ``<table>/part-*.parquet`` in it, or ``.arrow`` or ``.csv``. A table is
        read when first asked for. CSV files need the ``study.toml`` that was written with them:
        types, units and axes stand there.
    check : bool, default True
        Compare every file with the SHA-256 that ``manifest.json`` holds of it: the one that says
        what is swept and in which units at once, the others when their table is read. This takes a
        second for about a gigabyte a core where the processor has instructions for SHA-256. Of a
        folder without a manifest only the structure of the files is checked. Changes in
        ``study.toml`` are not noticed unless they concern the values.

    Returns
    -------
    Table
        The same tables that :func:`iva.sweep` returns.

    Raises
    ------
    TypeError
        If `folder` is not a path, or `check` neither True nor False.
    ValueError
        If there is no such folder, or no table in it.
    iva.IvaError
        If a file is not what was written, cannot be read, was written by a newer version with
        another layout, is missing between others, belongs to another run or table, or is of another
        format than the rest (a CSV file of another run shows only by its columns and points, and by
        its SHA-256). Of an interrupted sweep the
        parts that were complete can be read.

    Examples
    --------
    >>> iva.read("results/siva_clearance").summary  # doctest: +SKIP
    """
    found = found_in(folder, check=check)
    frames = Frames(
        {
            name: partial(frame, files, found.tables.get(name), found.sums.get(name))
            for name, files in found.parts.items()
        }
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
    sums : mapping of str to list of (path, bytes, SHA-256)
        What the files of each table must be; empty if that is not to be checked, or not known.
    """

    parts: Mapping[str, list[Path]]
    tables: Mapping[str, _iva.ArrowTable]
    swept: tuple[str, ...]
    units: Units
    sums: Mapping[str, list[Sum]]


def found_in(folder: str | os.PathLike[str], *, check: bool) -> Found:
    """Return what is in a folder, after a check that it belongs together.

    With `check` the file that says what is swept is compared with its SHA-256.

    Raises
    ------
    TypeError, ValueError, iva.IvaError
        As :func:`read`.
    """
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(f"folder = {shown(folder)}: give a path")
    if not isinstance(check, bool):
        raise TypeError(f"check = {shown(check)}: give True or False")
    path = Path(folder)
    if not path.exists():
        raise ValueError(f"folder = {str(path)!r}: there is no such folder")
    if not path.is_dir():
        raise ValueError(f"folder = {str(path)!r}: give a folder that `iva sweep` wrote")
    if (path / EXCHANGE).exists():
        raise fault(
            f"{path} cannot be read: a process was killed while it replaced the tables there; run "
            "any iva sweep or iva run into that folder to finish it"
        )
    manifest = manifest_of(path)
    parts = {name: listed(files, manifest) for name in NAMES if (files := part_files(path / name))}
    if not any(parts.values()):
        raise ValueError(f"folder = {str(path)!r}: {instead(path)}")
    sums = sums_of(parts, manifest) if check else {}
    tables = described(parts)
    common = checked(parts, tables, manifest)
    if sums:
        _iva.check_files(sums[longest(parts)][:1])
    swept = tuple(key for key in common.get("iva.swept", "").split(",") if key)
    return Found(parts, tables, swept, from_metadata(common, swept), sums)


def longest(parts: Mapping[str, list[Path]]) -> str:
    """Return the table with the most parts: the first of them says what all have in common."""
    return max(parts, key=lambda name: len(parts[name]))


def sums_of(parts: Mapping[str, list[Path]], manifest: Manifest | None) -> dict[str, list[Sum]]:
    """Return what the files of each table must be by the manifest; nothing without one."""
    if manifest is None:
        return {}
    return {
        name: [
            (file, bytes_of(part, name) or 0, sum_of(part, name))
            for file, part in zip(files, manifest.parts.values(), strict=False)
        ]
        for name, files in parts.items()
    }


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
        raise fault(f"{folder} cannot be read: {error}") from error
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
            raise fault(f"{first} and {file} are of two formats: keep the files of one run")
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
    most = parts[longest(parts)]
    first = most[0]
    common = metadata(first, tables.get(first.parent.name))
    numbers = range(len(most)) if manifest is None else list(manifest.parts)
    if manifest is not None and common.get("iva.study", manifest.study) != manifest.study:
        raise fault(f"{first} is of another study than {FILE} beside it: iva.study differs")
    for name in next(iter(manifest.parts.values()))["tables"] if manifest else ():
        if name not in parts:
            raise fault(f"{first.parent.parent / name} is missing, but the manifest lists it")
    for name, files in parts.items():
        for index, number in enumerate(numbers):
            expected = first.parent.parent / name / f"part-{number:05}{first.suffix}"
            if index >= len(files):
                beside = "the manifest lists it" if manifest else f"{most[index]} is there"
                raise fault(f"{expected} is missing, but {beside}")
            if files[index] != expected:
                raise fault(f"{expected} is missing, but {files[index].name} is there")
        begin = 0
        for number, file in zip(numbers, files, strict=False):
            found = metadata(file, tables.get(name))
            if found.get("iva.table", name) != name:
                raise fault(f"{file} is a part of the table {found['iva.table']}")
            for key in COMMON:
                if found.get(key) != common.get(key):
                    raise fault(f"{file} is not of the same run as {first}: {key} differs")
            begin = begin if manifest is None else number * manifest.part_points
            if found.get("iva.first_point", str(begin)) != str(begin):
                raise fault(
                    f"{file} begins with point {found['iva.first_point']}, but point {begin} is due"
                )
            size = size_of(file)
            if manifest is not None and size != bytes_of(manifest.parts[number], name):
                raise fault(
                    f"{file} is not what was written: its size is not that of the manifest; "
                    "resume the sweep to compute it again"
                )
            begin += int(found.get("iva.part_points", "0"))
        if len(files) > len(numbers):
            raise fault(f"{files[len(numbers)]} is no part of this sweep")
    return common


def size_of(file: Path) -> int:
    """Return the size of a file in bytes.

    Raises
    ------
    iva.IvaError
        If it is no regular file, or cannot be looked at.
    """
    try:
        state = file.stat()
    except OSError as error:
        raise fault(f"{file} cannot be read: {error.strerror}") from error
    if not S_ISREG(state.st_mode):
        raise fault(f"{file} cannot be read: it is no regular file")
    return state.st_size
