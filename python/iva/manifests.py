"""The manifest of a sweep's folder: which parts are complete."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from iva import _iva

FILE = "manifest.json"


@dataclass(frozen=True, slots=True)
class Manifest:
    """What ``manifest.json`` says.

    Parameters
    ----------
    points, part_points : int
        Points of the sweep, and of a part; the last may have fewer.
    parts : mapping of int to mapping
        The complete parts by number; each has ``points``, ``failed`` and ``tables``, by the name of
        the table ``rows``, ``bytes`` and ``sha256`` of its file.
    """

    points: int
    part_points: int
    parts: Mapping[int, Mapping[str, Any]]

    @property
    def done(self) -> int:
        """Points of complete parts."""
        return sum(part["points"] for part in self.parts.values())


def manifest_of(folder: Path) -> Manifest | None:
    """Return the manifest of a folder; None if it has none.

    Raises
    ------
    iva.IvaError
        If it cannot be read.
    """
    file = folder / FILE
    try:
        state = file.stat()
    except OSError:
        return None
    return parsed(file, state.st_mtime_ns, state.st_size)


def bytes_of(part: Mapping[str, Any], table: str) -> int | None:
    """Return the size that the file of a table in a part has; None if there is no such table."""
    found = part["tables"].get(table)
    return None if found is None else int(found["bytes"])


@lru_cache(maxsize=8)
def parsed(file: Path, _changed: int, _size: int) -> Manifest:
    """Read a file; as long as it does not change, once."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
        parts = {int(number): part for number, part in found["parts"].items()}
        for part in parts.values():
            int(part["points"]), int(part["failed"])
            [(int(it["rows"]), int(it["bytes"]), it["sha256"]) for it in part["tables"].values()]
        return Manifest(found["points"], found["part_points"], dict(sorted(parts.items())))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise _iva.IvaError(f"{file} cannot be read: it is no manifest of a sweep") from error
