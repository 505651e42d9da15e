"""Periodic orbits of free masses: states, impact times, multipliers."""

from __future__ import annotations

import random
from functools import cache

from iva import dynamics
from report import NAMES, ULP, Report, apart, read, scene


@cache
def searched() -> dict[str, dynamics.Orbit | dynamics.Missed]:
    """Return what is found from 1e-3 away from each record."""
    draw, found = random.Random(1), {}
    for name, record in read("orbits.json").items():
        truth = [float(record["state_at_time_0"][key]) for key in NAMES]
        start = [value + draw.uniform(-1e-3, 1e-3) for value in truth]
        siva, primary, force = scene(record)
        periods = int(record["forcing_periods"])
        found[name] = dynamics.orbit(siva, primary, force=force, start=start, periods=periods)
    return found


def orbits(report: Report) -> None:
    """Compare the orbits with the records."""
    worst = dict.fromkeys(("state", "times", "few", "many", "residual", "share"), 0.0)
    report.head(f"{len(searched())} orbits of free masses, from 1e-3 away")
    for name, record in read("orbits.json").items():
        orbit = searched()[name]
        if not isinstance(orbit, dynamics.Orbit):
            report.fault(f"{name}: {orbit.message}")
            continue
        truth = [float(record["state_at_time_0"][key]) for key in NAMES]
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
    report.line("state at time 0", worst["state"], 1e-12)
    report.line("impact times", worst["times"], 1e-12)
    report.line("multipliers, fewer than 8 impacts", worst["few"], 1e-13)
    report.line("multipliers, 8 impacts or more", worst["many"], 1e-11)
    report.line("error of a multiplier over its bound", worst["share"], 1.0)
    report.line("residual, in 2^-53", worst["residual"] / ULP, 50.0)
    verified(report)


def verified(report: Report) -> None:
    """Solve the orbits again to twice the precision, and compare them with the records."""
    residual = off = 0.0
    for name, record in read("orbits.json").items():
        siva, primary, force = scene(record)
        truth = [float(record["state_at_time_0"][key]) for key in NAMES]
        periods = int(record["forcing_periods"])
        orbit = dynamics.orbit(
            siva, primary, force=force, start=truth, periods=periods, verify=True
        )
        if not isinstance(orbit, dynamics.Orbit):
            report.fault(f"{name}: {orbit.message}")
            continue
        size = max(1.0, *(abs(value) for value in truth))
        apart = max(abs(a - b) for a, b in zip(orbit.state, truth, strict=True))
        residual, off = max(residual, orbit.residual), max(off, apart / size)
    report.line("residual with verify, in 2^-53", residual / ULP, 1.0)
    # The records have the decimals of the scenes, runs the doubles next to them.
    report.line("state with verify, in 2^-53 of its size", off / ULP, 8.0)
