"""Masses of absorbers as points of the structure: pushed, stopped, and ridden on.

Numbers come from Newton's equations in absolute coordinates, which SciPy's DOP853 integrates from
event to event: nothing of it is the product's.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import iva

Array = NDArray[np.float64]
MASS = np.array([2.0, 1.0])
STIFFNESS = np.array([[5.0, -2.0], [-2.0, 3.0]])
DAMPING = 0.01 * STIFFNESS
OMEGA = 1.3


def structure(**more: Any) -> iva.Structure:
    return iva.Structure(
        points=["low", "top"],
        mass=np.diag(MASS).tolist(),
        stiffness=STIFFNESS.tolist(),
        damping=DAMPING.tolist(),
        start_velocities=[0.4, 1.0],
        **more,
    )


#: (one, other, sign, distance, restitution): s (x_one − x_other) ≤ d; other −1 is the ground.
Contact = tuple[int, int, int, float, float]


def integrated(
    masses: Array,
    ties: list[tuple[int, int, float, float]],
    push: tuple[int, float],
    contacts: list[Contact],
    end: float,
) -> list[tuple[float, int]]:
    """Return instant and contact of all impacts of the structure and further bodies."""
    n = len(masses)

    def rates(t: float, z: Array) -> Array:
        x, v = z[:n], z[n:]
        force = np.zeros(n)
        force[:2] = -STIFFNESS @ x[:2] - DAMPING @ v[:2]
        for a, b, k, c in ties:
            pull = k * (x[a] - x[b]) + c * (v[a] - v[b])
            force[a] -= pull
            force[b] += pull
        force[push[0]] += push[1] * math.cos(OMEGA * t)
        return np.concatenate([v, force / masses])

    def apart(contact: Contact, z: Array, offset: int) -> float:
        one, other, _, _, _ = contact
        return float(z[offset + one] - (z[offset + other] if other >= 0 else 0.0))

    def meets(contact: Contact) -> Any:
        def left(_: float, z: Array) -> float:
            return contact[3] - contact[2] * apart(contact, z, 0)

        left.terminal, left.direction = True, -1.0  # type: ignore[attr-defined]
        return left

    start = np.array([0.4, 1.0] + [1.0] * (n - 2))
    t, z = 0.0, np.concatenate([np.zeros(n), start])
    found: list[tuple[float, int]] = []
    while t < end:
        way = solve_ivp(
            rates,
            (t, end),
            z,
            "DOP853",
            rtol=1e-12,
            atol=1e-13,
            max_step=0.2,
            events=[meets(contact) for contact in contacts],
        )
        t, z = float(way.t[-1]), way.y[:, -1].copy()
        if way.status != 1:
            break
        [place] = [k for k, times in enumerate(way.t_events) if len(times)]
        one, other, _, _, e = contacts[place]
        w = apart(contacts[place], z, n)
        reduced = masses[one] if other < 0 else 1 / (1 / masses[one] + 1 / masses[other])
        impulse = (1 + e) * w * reduced
        z[n + one] -= impulse / masses[one]
        if other >= 0:
            z[n + other] += impulse / masses[other]
        found.append((t, place))
    return found


def compared(run: iva.Run, found: list[tuple[float, int]], numbers: list[int]) -> None:
    """Compare instants and absorbers of all impacts; `numbers`: those of the contacts."""
    impacts = run.impacts.sort("time")
    assert run.summary["outcome"].item() == "finished"
    assert impacts["absorber"].to_list() == [numbers[place] for _, place in found]
    times = np.array([t for t, _ in found])
    assert np.abs(impacts["time"].to_numpy() - times).max() < 1e-8
    assert abs(run.summary["energy_residual"].item()) < 1e-12


def test_a_force_acts_on_a_mass_that_meets_the_ground() -> None:
    """A mass on a spring in its gap, pushed itself, between stops that stand on the ground."""
    spring, dashpot, gap, ground = 0.4, 0.02, 0.7, 0.9
    mass = iva.Siva(mass=0.5, clearance=gap, restitution=0.6, spring=spring, gap_damping=dashpot)
    stop = iva.Stop(clearance=ground, restitution=0.8)
    frame = structure(absorber_at=["top", "absorber.0"], force_at="absorber.0", seen_at="top")
    end = 40.0
    run = iva.simulate(
        [mass, stop],
        frame,
        start=iva.Start(),
        force=iva.Harmonic(force=0.3, frequency=OMEGA),
        duration=end,
    )
    contacts = [(2, 1, s, gap, 0.6) for s in (1, -1)] + [(2, -1, s, ground, 0.8) for s in (1, -1)]
    masses = np.append(MASS, 0.5)
    found = integrated(masses, [(2, 1, spring, dashpot)], (2, 0.3), contacts, end)
    assert len({place for _, place in found}) >= 3
    assert len(found) > 12
    compared(run, found, [0, 0, 1, 1])


def test_a_force_on_a_free_mass() -> None:
    """Without spring and dashpot the mass is pushed all the same; one alone is `absorber`."""
    frame = structure(absorber_at="top", force_at="absorber")
    run = iva.simulate(
        iva.Siva(mass=0.5, clearance=0.7, restitution=0.6),
        frame,
        start=iva.Start(),
        force=iva.Harmonic(force=0.3, frequency=OMEGA),
        duration=40.0,
    )
    contacts = [(2, 1, s, 0.7, 0.6) for s in (1, -1)]
    found = integrated(np.append(MASS, 0.5), [], (2, 0.3), contacts, 40.0)
    assert len(found) > 12
    compared(run, found, [0, 0])


def test_an_absorber_rides_on_another() -> None:
    """A mass in a gap of a mass on a spring, and both seen by errors and sweeps."""
    outer = iva.Siva(mass=0.5, clearance=0.9, restitution=0.7, spring=0.3)
    inner = iva.Siva(mass=0.1, clearance=0.4, restitution=0.8)
    frame = structure(absorber_at=["top", "absorber.0"])
    common: dict[str, Any] = {"start": iva.Start(), "duration": 30.0}
    run = iva.simulate([outer, inner], frame, errors=True, **common)
    contacts = [(2, 1, s, 0.9, 0.7) for s in (1, -1)] + [(3, 2, s, 0.4, 0.8) for s in (1, -1)]
    masses = np.append(MASS, [0.5, 0.1])
    found = integrated(masses, [(2, 1, 0.3, 0.0)], (0, 0.0), contacts, 30.0)
    assert {place // 2 for _, place in found} == {0, 1}
    compared(run, found, [0, 0, 1, 1])
    swept = iva.sweep([outer, inner], frame, over={"absorber.1.restitution": [0.5, 0.8]}, **common)
    assert swept.summary["impacts"][1] == len(found)


@pytest.mark.parametrize(
    ("at", "absorbers", "told"),
    [
        (["top", "absorber.5"], ["mass", "stop"], "one absorber of the list"),
        (["top", "absorber.0"], ["units", "stop"], "without units"),
        (["absorber.1", "top"], ["mass", "stop"], "free mass"),
        (["absorber.1", "top"], ["mass", "mass"], "before"),
        (["top", "nowhere"], ["mass", "stop"], "absorber.0 for the mass of the first absorber"),
    ],
)
def test_what_is_no_point_is_said(at: list[str], absorbers: list[str], told: str) -> None:
    mass: dict[str, Any] = {"mass": 0.5, "clearance": 0.7, "restitution": 0.6}
    kinds: dict[str, iva.Siva | iva.Stop] = {
        "mass": iva.Siva(**mass),
        "units": iva.Siva(**mass, units=2),
        "stop": iva.Stop(clearance=2.0, restitution=0.5),
    }
    with pytest.raises(ValueError, match="absorber_at") as error:
        iva.simulate(
            [kinds[kind] for kind in absorbers],
            structure(absorber_at=at, seen_at="top"),
            start=iva.Start(),
            duration=1.0,
        )
    assert told in str(error.value)
    assert "\n" not in str(error.value)
