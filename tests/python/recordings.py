"""A record that tests write: 40 samples at 100 Hz, of ±1.2 with three decimal places."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

TIMES = [k / 100 for k in range(40)]
VALUES = [round(1.2 * math.cos(0.37 * k), 3) for k in range(40)]


def written(folder: Path, contents: str | bytes, name: str = "decay.csv") -> Path:
    """Write a file and return its path."""
    path = folder / name
    path.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
    return path


def rows(delimiter: str = ";", values: Sequence[float | str] = VALUES) -> list[str]:
    """Return the lines of the record: a time and a value."""
    return [f"{t}{delimiter}{v}" for t, v in zip(TIMES, values, strict=True)]


def table(header: str = "time [s],a1 [m/s^2]", values: Sequence[float | str] = VALUES) -> str:
    """Return the text of the record below a header, divided by commas."""
    return "\n".join([header, *rows(",", values)]) + "\n"
