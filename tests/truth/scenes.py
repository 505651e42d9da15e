"""Random scenes: an orbit is found or there is a reason, and what is called stable is."""

from __future__ import annotations

import random
from collections import Counter

import iva
from iva import dynamics
from report import Report

#: How far a run begins from an orbit, for how many periods it goes on, and how far from the orbit
#: the search that begins there may end.
OFF, PERIODS, SAME = 1e-7, 50, 1e-6


def scenes(report: Report, count: int) -> None:
    """Search an orbit in each scene from a random start, after 100 periods."""
    draw = random.Random(1)
    reasons: Counter[str] = Counter()
    found = stable = left = one_wall = unexplained = 0
    report.head(f"{count} random scenes of a free mass")
    for _ in range(count):
        siva, primary, force, start = drawn(draw)
        orbit = dynamics.orbit(siva, primary, force=force, start=start, settle=100)
        if isinstance(orbit, dynamics.Missed):
            reasons[orbit.reason] += 1
            unexplained += not orbit.message
            continue
        found += 1
        one_wall += not {"+", "-"} <= set(orbit.walls)
        if orbit.stable:
            stable += 1
            left += leaves(orbit, draw)
    report.told("orbits found", str(found))
    for reason, often in reasons.most_common():
        report.told(f"none: {reason}", str(often))
    report.told("stable orbits", str(stable))
    report.count("neither an orbit nor a reason", unexplained)
    # The impulses on a free mass add up to 0 in a cycle.
    report.count("orbits with impacts on one wall only", one_wall)
    report.count("orbits called stable that a run nearby leaves", left)


def drawn(
    draw: random.Random,
) -> tuple[iva.Siva, iva.Primary, iva.Harmonic, tuple[float, float, float, float]]:
    """Return a scene, and a start within its gap."""
    clearance = draw.uniform(0.3, 4.0)
    siva = iva.Siva(
        mass_ratio=draw.uniform(0.02, 0.3),
        restitution=draw.uniform(0.2, 0.95),
        clearance=clearance,
    )
    primary = iva.Primary(damping_ratio=draw.uniform(0.005, 0.1))
    force = iva.Harmonic(amplitude=1.0, frequency=draw.uniform(0.6, 1.6))
    x, v, w = draw.uniform(-2.0, 2.0), draw.uniform(-2.0, 2.0), draw.uniform(-1.0, 1.0)
    return siva, primary, force, (x, v, clearance * draw.uniform(-1.0, 1.0), w)


def leaves(orbit: dynamics.Orbit, draw: random.Random) -> bool:
    """Return whether a run from nearby does not come to the orbit."""
    absorber, primary, force = orbit.absorber, orbit.primary, orbit.force
    clearance = absorber.clearance
    assert clearance is not None
    x, v, y, w = (value + OFF * draw.uniform(-1.0, 1.0) for value in orbit.state)
    start = (x, v, max(-clearance, min(clearance, y)), w)
    there = dynamics.orbit(absorber, primary, force=force, start=start, settle=PERIODS)
    if isinstance(there, dynamics.Missed):
        return True
    return any(abs(a - b) > SAME for a, b in zip(there.state, orbit.state, strict=True))
