"""Periodic orbits of pendulums, and the special points of a branch of them."""

from __future__ import annotations

import math
from typing import Any

import iva
from iva import dynamics
from report import Report, apart, read


def found(record: dict[str, Any]) -> dynamics.Orbit | dynamics.Missed:
    """Return the orbit that is found from 1e-3 away from an impact of a record."""
    given = {name: float(value) for name, value in record["scene"].items()}
    small = record["angles"] == "small"
    kind: dict[str, Any] = {"angles": "small"} if small else {"length": record["length"]}
    common = ("mass_ratio", "restitution", "clearance", "frequency_ratio")
    kind |= {name: given[name] for name in common}
    piva = iva.Piva(**kind)
    impact = record["impact"]
    if small:
        rate = {"gap_velocity": float(impact["gap_velocity_after"])}
    else:
        rate = {"angular_velocity": float(impact["angle_velocity_after"])}
    start = iva.Start(
        displacement=float(impact["displacement"]) + 1e-3,
        velocity=float(impact["velocity_after"]) - 1e-3,
        gap_displacement=impact["wall"] * given["clearance"],
        time=float(impact["time"]),
        **rate,
    )
    force = iva.Harmonic(amplitude=given["force_amplitude_per_mass"], frequency=given["frequency"])
    primary = iva.Primary(damping_ratio=given["damping_ratio"])
    return dynamics.orbit(piva, primary, force=force, start=start)


def pendulums(report: Report) -> None:
    """Compare orbits and special points with the records."""
    records = read("orbits_piva.json")
    orbits = {name: found(record) for name, record in records.items()}
    report.head(f"{len(records)} orbits of pendulums, from 1e-3 away")
    worst = dict.fromkeys(("impact", "multipliers"), 0.0)
    for name, record in records.items():
        orbit, impact = orbits[name], record["impact"]
        if not isinstance(orbit, dynamics.Orbit):
            report.fault(f"{name}: {orbit.message}")
            continue
        off = [
            max(
                abs(math.remainder(one.time - float(impact["time"]), orbit.period)),
                abs(one.displacement - float(impact["displacement"])),
                abs(one.velocity_after - float(impact["velocity_after"])),
            )
            for one in orbit.impacts
        ]
        worst["impact"] = max(worst["impact"], min(off))
        error = apart(orbit.multipliers, record["multipliers"])
        worst["multipliers"] = max(worst["multipliers"], error)
    report.line("time, displacement and velocity at an impact", worst["impact"], 1e-12)
    report.line("multipliers", worst["multipliers"], 1e-13)
    first = orbits["V1"]
    assert isinstance(first, dynamics.Orbit), first
    branch = dynamics.follow(first, over="clearance", between=(1.0, 5.0))
    assert isinstance(branch, dynamics.Branch), branch
    for name, record in read("bifurcations_piva.json").items():
        value = float(record["value"])
        away = [abs(one.value - value) for one in branch.points if one.kind == record["type"]]
        allowed = 1e-11 if record["type"] == "grazing" else 1e-12
        report.line(name, min(away, default=math.inf), allowed)
