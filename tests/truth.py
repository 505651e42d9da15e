"""Print what `iva.dynamics` computes beside 30-digit references: run by ``make truth``.

Each line has a quantity, how far the worst of its kind is from the reference, and how far it may
be.
The exit code is 1 if one is farther.
"""

from __future__ import annotations

import json
import random
import sys
import time
from itertools import permutations
from pathlib import Path
from typing import Any

import iva
from iva import dynamics

REFERENCE = Path(__file__).parent / "reference"
NAMES = ("displacement", "velocity", "gap_displacement", "gap_velocity")
#: Rounding of a double, relative.
ULP = 2.0**-53
#: The orbits that branches begin with: the number, its range, and to which depth the branches that
#: begin on them are followed.
FAMILIES = [
    ("A1", "clearance", (0.5, 13.0), 2),
    ("A5", "clearance", (0.5, 13.0), 0),
    ("A7", "clearance", (0.5, 13.0), 0),
    ("A3", "damping_ratio", (0.03, 0.07), 0),
    ("D1", "force.amplitude", (0.03, 0.3), 0),
    ("E1", "clearance", (0.5, 13.0), 1),
    ("G1", "clearance", (0.5, 13.0), 0),
    ("G1", "force.frequency", (0.5, 1.3), 0),
]


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

    def line(self, what: str, worst: float, allowed: float) -> None:
        """Print a line."""
        self.well &= worst <= allowed
        mark = "" if worst <= allowed else "   <-- too far"
        print(f"{what:<58} {worst:10.2e}  of {allowed:7.0e}{mark}")


def orbits(report: Report) -> dict[str, dynamics.Orbit]:
    """Find the orbits of free masses from 1e-3 away, and compare them."""
    draw, found = random.Random(1), {}
    worst = dict.fromkeys(("state", "times", "few", "many", "residual", "share"), 0.0)
    for name, record in read("orbits.json").items():
        truth = [float(record["state_at_time_0"][key]) for key in NAMES]
        start = [value + draw.uniform(-1e-3, 1e-3) for value in truth]
        siva, primary, force = scene(record)
        periods = int(record["forcing_periods"])
        orbit = dynamics.orbit(siva, primary, force=force, start=start, periods=periods)
        if not isinstance(orbit, dynamics.Orbit):
            print(f"{name}: {orbit.message}")
            report.well = False
            continue
        found[name] = orbit
        off = max(abs(a - b) for a, b in zip(orbit.state, truth, strict=True))
        worst["state"] = max(worst["state"], off)
        if not orbit.episodes:
            listed = [float(one[0]) for one in record["impact_list"]]
            times = [abs(a.time - b) for a, b in zip(orbit.impacts, listed, strict=True)]
            worst["times"] = max(worst["times"], *times)
        count = "many" if len(orbit.impacts) >= 8 else "few"
        error = apart(orbit.multipliers, record["multipliers"])
        worst[count] = max(worst[count], error)
        worst["share"] = max(worst["share"], error / max(orbit.multiplier_errors))
        worst["residual"] = max(worst["residual"], orbit.residual)
    print(f"{len(found)} orbits of free masses, from 1e-3 away")
    report.line("  state at time 0", worst["state"], 1e-12)
    report.line("  impact times", worst["times"], 1e-12)
    report.line("  multipliers, fewer than 8 impacts", worst["few"], 1e-13)
    report.line("  multipliers, 8 impacts or more", worst["many"], 1e-11)
    report.line("  error of a multiplier over its bound", worst["share"], 1.0)
    report.line("  residual, in 2^-53", worst["residual"] / ULP, 50.0)
    return found


def grown(branch: dynamics.Branch, depth: int) -> list[dynamics.Branch]:
    """Return a branch with those that begin on it, to a depth."""
    every = [branch]
    for index in range(len(branch.points) if depth else 0):
        other = branch.switch(index)
        if isinstance(other, dynamics.Branch):
            every += grown(other, depth - 1)
    return every


def fits(orbit: dict[str, Any], record: dict[str, Any], key: str) -> bool:
    """Return whether a point is one of the family of an orbit over a number."""
    unlike = orbit["scene"].items() - record["scene"].items()
    return key == record["parameter"] and {name for name, _ in unlike} <= {key}


def branches(report: Report, found: dict[str, dynamics.Orbit]) -> dict[str, dynamics.Branch]:
    """Follow branches, and compare their special points."""
    first: dict[str, dynamics.Branch] = {}
    points: list[tuple[str, str, int, dynamics.Point]] = []
    seconds, rows = 0.0, 0
    for name, over, between, depth in FAMILIES:
        begun = time.perf_counter()
        branch = dynamics.follow(found[name], over=over, between=between)
        assert isinstance(branch, dynamics.Branch), branch
        seconds, rows = seconds + time.perf_counter() - begun, rows + len(branch.rows)
        first.setdefault(f"{name} {over}", branch)
        for one in grown(branch, depth):
            points += [(name, over, one.impacts, point) for point in one.points]
    keys = {"force.amplitude": "force_amplitude_per_mass", "force.frequency": "frequency"}
    worst = {"grazing": 0.0, "other": 0.0}
    records = read("bifurcations.json")
    originals = read("orbits.json")
    for name, record in records.items():
        off = [
            abs(point.value - float(record["value"]))
            for of, over, impacts, point in points
            if point.kind == record["type"]
            and impacts == record["impacts"]
            and fits(originals[of], record, keys.get(over, over))
        ]
        kind = "grazing" if record["type"] == "grazing" else "other"
        worst[kind] = max(worst[kind], min(off, default=float("inf")))
        if not off:
            print(f"  {name} was not found")
    print(f"{len(records)} special points on branches from {len(first)} orbits")
    report.line("  folds, flips, pitchforks, Neimark-Sacker points", worst["other"], 1e-12)
    report.line("  grazings, from the admissible side", worst["grazing"], 1e-11)
    print(f"  {1000 * seconds / rows:.2f} ms a point of a branch, with its multipliers")
    return first


def curves(
    report: Report, first: dict[str, dynamics.Branch], found: dict[str, dynamics.Orbit]
) -> None:
    """Follow special points over two numbers, and compare them."""
    e2 = dynamics.follow(found["E2"], over="clearance", between=(0.5, 13.0))
    assert isinstance(e2, dynamics.Branch)
    of = {"T1": first["A1 clearance"], "T5": first["G1 clearance"], "T6": e2}
    worst = 0.0
    for name, record in read("bifurcation_curves.json").items():
        point = next(one for one in of[name].points if one.kind == record["type"])
        at = [float(one[0]) for one in record["points"]]
        curve = dynamics.curve(
            point,
            over=("force.frequency", "clearance"),
            between=((min(at) - 0.01, max(at) + 0.01), (0.5, 13.0)),
            at=at,
        )
        assert isinstance(curve, dynamics.Curve), curve
        values = dict(curve.values)
        for frequency, clearance in record["points"]:
            worst = max(worst, abs(values[float(frequency)] - float(clearance)))
    print("3 curves over frequency and clearance")
    report.line("  clearance at given frequencies", worst, 1e-12)


def main() -> int:
    """Print all, and return the exit code."""
    report = Report()
    found = orbits(report)
    first = branches(report, found)
    curves(report, first, found)
    return 0 if report.well else 1


if __name__ == "__main__":
    sys.exit(main())
