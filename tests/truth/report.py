"""The lines that are printed, and the records that they are compared with."""

from __future__ import annotations

import json
from itertools import permutations
from pathlib import Path
from typing import Any

import iva

REFERENCE = Path(__file__).parents[1] / "reference"
NAMES = ("displacement", "velocity", "gap_displacement", "gap_velocity")
#: Rounding of a double, relative.
ULP = 2.0**-53


def read(name: str) -> dict[str, Any]:
    """Return the records of a file by their names."""
    return {one["id"]: one for one in json.loads((REFERENCE / name).read_text())}


def scene(record: dict[str, Any]) -> tuple[iva.Siva, iva.Primary, iva.Harmonic]:
    """Return the scene of a record."""
    given = {name: float(value) for name, value in record["scene"].items()}
    siva = iva.Siva(**{key: given[key] for key in ("mass_ratio", "restitution", "clearance")})
    force = iva.Harmonic(amplitude=given["force_amplitude_per_mass"], frequency=given["frequency"])
    return siva, iva.Primary(damping_ratio=given["damping_ratio"]), force


def apart(found: tuple[complex, ...], pairs: list[list[str]]) -> float:
    """Return how far multipliers are from those of a record, in the order that fits best."""
    truth = [complex(float(re), float(im)) for re, im in pairs]
    return min(
        max(abs(a - b) for a, b in zip(found, order, strict=True)) for order in permutations(truth)
    )


class Report:
    """The lines that are printed, and whether all is well."""

    def __init__(self) -> None:
        """Begin with none."""
        self.well = True

    def head(self, text: str) -> None:
        """Print what the lines that follow are about."""
        print(text, flush=True)

    def line(self, what: str, worst: float, allowed: float) -> None:
        """Print how far the worst of its kind is from the reference, and how far it may be."""
        self.well &= worst <= allowed
        mark = "" if worst <= allowed else "   <-- too far"
        print(f"  {what:<56} {worst:10.2e}  of {allowed:7.0e}{mark}", flush=True)

    def count(self, what: str, found: int, allowed: int = 0) -> None:
        """Print how many there are of what may not be, or only so often."""
        self.well &= found <= allowed
        mark = "" if found <= allowed else "   <-- too many"
        print(f"  {what:<56} {found:10}  of {allowed:7}{mark}", flush=True)

    def fault(self, text: str) -> None:
        """Print what is not there that should be."""
        self.well = False
        print(f"  {text}   <-- missing", flush=True)

    def told(self, what: str, value: str, asked: str = "") -> None:
        """Print what is neither right nor wrong."""
        print(f"  {what:<56} {value:>10}  {asked}".rstrip(), flush=True)
