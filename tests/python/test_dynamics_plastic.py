"""Plastic impacts, e = 0, after which the absorber leaves its wall at once: rank 3.

The truth is the closed form of S. F. Masri and T. K. Caughey with e = 0, and what e = 0 means: an
impact takes one of the four dimensions.
"""

from __future__ import annotations

import math
from typing import Any

import pytest

import iva
from iva import dynamics, theory

SIVA = iva.Siva(mass_ratio=0.07, restitution=0.0, clearance=3.47)
PARTS: dict[str, Any] = {
    "absorber": SIVA,
    "primary": iva.Primary(damping_ratio=0.04),
    "force": iva.Harmonic(amplitude=1.0, frequency=1.22),
}


@pytest.fixture(scope="module")
def orbit() -> dynamics.Orbit:
    found = dynamics.orbit(**PARTS, start=(0, 0, 0, 0.5), settle=100)
    assert isinstance(found, dynamics.Orbit)
    return found


def test_a_plastic_impact_takes_one_multiplier(orbit: dynamics.Orbit) -> None:
    known = theory.masri_caughey(**PARTS).stable
    assert known is not None
    assert orbit.rank == 3
    assert orbit.episodes == ()
    assert orbit.walls == "-+"
    assert orbit.stable
    assert orbit.amplitude == pytest.approx(known.amplitude, rel=0, abs=1e-13)
    assert orbit.half_multipliers is not None
    assert orbit.half_multipliers[:3] == pytest.approx(known.multipliers[:3], rel=0, abs=1e-13)
    # Exactly 0, without error.
    assert orbit.multipliers[3] == orbit.half_multipliers[3] == 0.0
    assert orbit.multiplier_errors[3] == 0.0
    assert orbit.determinant_error == 0.0
    # Leaving a wall from rest is no grazing.
    assert orbit.grazing_margin is None
    again = dynamics.orbit(**PARTS, start=orbit, periods=2)
    assert isinstance(again, dynamics.Orbit)
    assert again.rank == 3
    assert again.multipliers[3] == 0.0
    squares = [one**2 for one in orbit.multipliers]
    assert again.multipliers == pytest.approx(squares, rel=0, abs=1e-13)


def test_leaving_a_wall_after_a_ride_is_no_grazing() -> None:
    """Record S1: chatter, ride and release on each wall, and no extremum in between."""
    siva = iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=0.25)
    force = iva.Harmonic(amplitude=1.0, frequency=0.7)
    primary = iva.Primary(damping_ratio=0.02)
    found = dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=300)
    assert isinstance(found, dynamics.Orbit)
    assert len(found.episodes) == 2
    assert found.grazing_margin is None


def test_a_plastic_impact_takes_one_exponent(orbit: dynamics.Orbit) -> None:
    """The others are ln |λ| over the period; the sum is −∞, so that no identity holds."""
    found = dynamics.lyapunov(**PARTS, start=orbit, cycles=400, discard=100, seeds=2)
    for one, multiplier in zip(found.exponents[:3], orbit.multipliers[:3], strict=True):
        assert one == pytest.approx(math.log(abs(multiplier)) / orbit.period, abs=1e-2)
    assert found.exponents[3] == -math.inf
    assert found.standard_errors[3] == 0.0
    assert found.sum_error is None
    assert found.rides == 0
    assert found.dimension == 0.0
    assert found.sign == -1


def test_plastic_orbits_have_a_branch_and_a_basin(orbit: dynamics.Orbit) -> None:
    """The fold is the largest clearance of the closed form."""
    branch = dynamics.follow(orbit, over="clearance", between=(3.3, 5.0), step=0.1)
    assert isinstance(branch, dynamics.Branch)
    largest = theory.masri_caughey(**PARTS).largest_clearance
    [fold] = [point for point in branch.points if point.kind == "fold"]
    assert fold.value == pytest.approx(largest, rel=0, abs=1e-12)
    there = branch.orbit(0)
    assert isinstance(there, dynamics.Orbit)
    assert there.rank == 3
    over: dict[str, Any] = {"gap_displacement": [-3.0, 0.0, 3.0], "gap_velocity": [-1.0, 1.0]}
    found = dynamics.basins(**PARTS, over=over, attractors=[orbit])
    assert found.left_out == ()
    for (row, column), label in enumerate_cells(found):
        start = (0.0, 0.0, over["gap_displacement"][column], over["gap_velocity"][row])
        there = dynamics.orbit(**PARTS, start=start, settle=300)
        assert (label == 0) is (isinstance(there, dynamics.Orbit) and near(there, orbit))


def enumerate_cells(found: dynamics.Basins) -> list[tuple[tuple[int, int], int]]:
    """Return row and column of each cell, with its label."""
    rows, columns = found.labels.shape
    places = [(row, column) for row in range(rows) for column in range(columns)]
    return [(place, int(found.labels[place])) for place in places]


def near(one: dynamics.Orbit, other: dynamics.Orbit) -> bool:
    """Return whether two orbits are the same."""
    return math.dist(one.state, other.state) < 1e-9
