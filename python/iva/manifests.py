"""The manifest of a sweep's folder: which parts are complete."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from stat import S_ISREG
from typing import Any

from iva.faults import fault

FILE = "manifest.json"
#: The newest layout of a manifest that this version reads, and the one that it writes.
LAYOUT = 1


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
    study : str
        Digest of all that decides the values, as files carry it under ``iva.study``.
    """

    points: int
    part_points: int
    parts: Mapping[int, Mapping[str, Any]]
    study: str = ""

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
    if not S_ISREG(state.st_mode):
        raise fault(f"{file} cannot be read: it is no regular file")
    return parsed(file, state.st_mtime_ns, state.st_size)


def bytes_of(part: Mapping[str, Any], table: str) -> int | None:
    """Return the size that the file of a table in a part has; None if there is no such table."""
    found = part["tables"].get(table)
    return None if found is None else int(found["bytes"])


def sum_of(part: Mapping[str, Any], table: str) -> str:
    """Return the SHA-256 that the file of a table in a part has; "" if there is no such table."""
    found = part["tables"].get(table)
    return "" if found is None else str(found["sha256"])


@lru_cache(maxsize=8)
def parsed(file: Path, _changed: int, _size: int) -> Manifest:
    """Read a file; as long as it does not change, once."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
        layout = int(found["manifest"])
        if layout > LAYOUT:
            raise fault(
                f"{file} has layout {layout}, this version of iva reads up to {LAYOUT}: "
                "install a newer iva-dynamics"
            )
        parts = {int(number): part for number, part in found["parts"].items()}
        for part in parts.values():
            int(part["points"]), int(part["failed"])
            [(int(it["rows"]), int(it["bytes"]), it["sha256"]) for it in part["tables"].values()]
        points, part_points = int(found["points"]), int(found["part_points"])
        if part_points < 1:
            raise ValueError("a part has no points")
        return Manifest(points, part_points, dict(sorted(parts.items())), str(found["study"]))
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        OverflowError,
        RecursionError,
    ) as error:
        raise fault(f"{file} cannot be read: it is no manifest of a sweep") from error
