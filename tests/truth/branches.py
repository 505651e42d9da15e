"""Branches of periodic orbits, their special points, and curves of these over two numbers."""

from __future__ import annotations

import time
from functools import cache
from typing import Any

from iva import dynamics
from orbits import searched
from report import Report, read

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


#: Numbers by the names that the records have for them.
KEYS = {"force.amplitude": "force_amplitude_per_mass", "force.frequency": "frequency"}


@cache
def followed(name: str, over: str, between: tuple[float, float]) -> dynamics.Branch:
    """Return the branch of an orbit."""
    orbit = searched()[name]
    assert isinstance(orbit, dynamics.Orbit), orbit
    branch = dynamics.follow(orbit, over=over, between=between)
    assert isinstance(branch, dynamics.Branch), branch
    return branch


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


def branches(report: Report) -> None:
    """Compare the special points with the records."""
    points: list[tuple[str, str, int, dynamics.Point]] = []
    seconds, rows = 0.0, 0
    for name, over, between, depth in FAMILIES:
        assert searched()
        begun = time.perf_counter()
        branch = followed(name, over, between)
        seconds, rows = seconds + time.perf_counter() - begun, rows + len(branch.rows)
        for one in grown(branch, depth):
            points += [(name, over, one.impacts, point) for point in one.points]
    worst = {"grazing": 0.0, "other": 0.0}
    records = read("bifurcations.json")
    originals = read("orbits.json")
    report.head(f"{len(records)} special points on branches from {len(FAMILIES)} orbits")
    for name, record in records.items():
        off = [
            abs(point.value - float(record["value"]))
            for of, over, impacts, point in points
            if point.kind == record["type"]
            and impacts == record["impacts"]
            and fits(originals[of], record, KEYS.get(over, over))
        ]
        kind = "grazing" if record["type"] == "grazing" else "other"
        worst[kind] = max(worst[kind], min(off, default=float("inf")))
        if not off:
            report.fault(f"{name} was not found")
    report.line("folds, flips, pitchforks, Neimark-Sacker points", worst["other"], 1e-12)
    report.line("grazings, from the admissible side", worst["grazing"], 1e-11)
    report.told("a point of a branch, with its multipliers", f"{1000 * seconds / rows:.2f} ms")


def curves(report: Report) -> None:
    """Follow special points over two numbers, and compare them."""
    wide = (0.5, 13.0)
    of = {"T1": "A1", "T5": "G1", "T6": "E2"}
    worst = 0.0
    report.head("3 curves over frequency and clearance")
    for name, record in read("bifurcation_curves.json").items():
        branch = followed(of[name], "clearance", wide)
        point = next(one for one in branch.points if one.kind == record["type"])
        at = [float(one[0]) for one in record["points"]]
        curve = dynamics.curve(
            point,
            over=("force.frequency", "clearance"),
            between=((min(at) - 0.01, max(at) + 0.01), wide),
            at=at,
        )
        assert isinstance(curve, dynamics.Curve), curve
        for value in curve.missed:
            report.fault(f"{name} has no point at the frequency {value}")
        values = dict(curve.values)
        for frequency, clearance in record["points"]:
            if float(frequency) in values:
                worst = max(worst, abs(values[float(frequency)] - float(clearance)))
    report.line("clearance at given frequencies", worst, 1e-12)
