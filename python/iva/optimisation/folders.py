"""The folder of an optimisation: its mark, its batches of runs, and the tables at the end."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

from iva import _iva
from iva.optimisation.logbook import RUNS
from iva.own_files import replacing

if TYPE_CHECKING:
    from iva.optimisation.optimum import Optimum

#: The file by which a folder is known.
FILE = "optimum.json"
#: The tables, each in a file of its own.
TABLES = ("fresh", "as_good", "front", "table")


def prepared(folder: Path, mark: str, resume: bool, overwrite: bool) -> Path:
    """Return a folder that batches of runs can be written into.

    Raises
    ------
    ValueError
        If it holds something else, or an optimisation and neither `resume` nor `overwrite` is said,
        or one that asked something else.
    iva.IvaError
        If it cannot be made.
    """
    file = folder / FILE
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            if not file.is_file() or "asked" not in of_file(file):
                raise ValueError(f"out = {folder}: it holds something else; give a new folder")
            if overwrite:
                emptied(folder)
            elif not resume:
                raise ValueError(
                    f"out = {folder}: it holds an optimisation; give resume=True or overwrite=True"
                )
            elif of_file(file).get("asked") != mark:
                raise ValueError(
                    f"out = {folder}: it holds an optimisation that asks something else; give "
                    "overwrite=True or another folder"
                )
        if (folder / RUNS).is_symlink():
            raise ValueError(f"out = {folder}: {RUNS} in it is a link; give a new folder")
        (folder / RUNS).mkdir(parents=True, exist_ok=True)
        if not file.exists():
            file.write_text(json.dumps({"asked": mark, "complete": False}), encoding="utf-8")
    except OSError as fault:
        raise _iva.IvaError(f"{folder} cannot be written: {fault.strerror}") from fault
    return folder


def of_file(file: Path) -> dict[str, object]:
    """Return what the file of a folder says; nothing if it is damaged."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def emptied(folder: Path) -> None:
    """Remove what an optimisation wrote into a folder, and nothing else."""
    runs = folder / RUNS
    if runs.is_dir() and not runs.is_symlink():
        for path in runs.iterdir():
            if re.fullmatch(r"\d{6,}\.npz", path.name):
                path.unlink()
    for name in (FILE, *(f"{table}.parquet" for table in TABLES)):
        (folder / name).unlink(missing_ok=True)


def saved(folder: Path, found: Optimum) -> None:
    """Write the tables, then what was found.

    Raises
    ------
    iva.IvaError
        If a file cannot be written.
    """
    for name in TABLES:
        with replacing(folder / f"{name}.parquet") as made:
            getattr(found, name).write_parquet(made)
    told = of_file(folder / FILE) | {
        "best": found.best,
        "absorber": found.best_absorber,
        "runs": found.runs,
        "complete": found.is_complete,
    }
    with replacing(folder / FILE) as made:
        made.write_text(json.dumps(told, indent=1), encoding="utf-8")
