"""Pendulums: stops beyond 60 degrees, attractors, basins; runs say what is true."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import iva
from iva import dynamics

#: Stops at 68 degrees, where the angle tells the place better than the gap displacement does.
WIDE: dict[str, Any] = {
    "absorber": iva.Piva(
        mass_ratio=0.1, restitution=0.6, length=1.0, clearance=0.93, frequency_ratio=1.0
    ),
    "primary": iva.Primary(damping_ratio=0.05),
    "force": iva.Harmonic(amplitude=1.0, frequency=1.0),
}


@pytest.fixture(scope="module")
def found() -> dynamics.Attractors:
    return dynamics.attractors(**WIDE, starts=6, most_cycles=300)


def test_attractors_are_what_runs_end_in(found: dynamics.Attractors) -> None:
    """A pair of asymmetric 4:1."""
    [one] = found.attractors
    assert found.shares == {"4:1": 1.0}
    assert found.left_out == ()
    assert one.pair
    assert one.orbit.stable
    assert one.orbit.walls in ("++--", "--++", "+--+", "-++-")
    assert one.orbit.residual < 1e-13
    assert found.box[2] == (-0.93, 0.93)
    for start in ((0.3, 0.2, 0.8, -0.5), (-1.0, 0.5, -0.9, 0.3)):
        there = dynamics.orbit(**WIDE, start=start, settle=400)
        assert isinstance(there, dynamics.Orbit)
        both = (one.orbit.state, one.orbit.mirror().state)
        assert min(math.dist(there.state, state) for state in both) < 1e-9
    # A run stays on it, through stops that it meets at 68 degrees.
    run = one.orbit.run(cycles=3)
    end = run.stroboscope.row(-1, named=True)
    for name, value in zip(dynamics.search.NAMES, one.orbit.state, strict=True):
        assert end[name] == pytest.approx(value, abs=1e-9)


def test_an_orbit_near_a_stop_begins_with_its_angle(found: dynamics.Attractors) -> None:
    """From an instant at which it leaves a stop: the search, a run, and a basin begin there."""
    orbit = found.attractors[0].orbit
    hit = next(impact for impact in orbit.impacts if impact.wall == 1)
    there = orbit.run(cycles=2).state_at(hit.time + 1e-3)
    assert there.angle == pytest.approx(math.asin(0.93), abs=5e-3)
    again = dynamics.orbit(**WIDE, start=there)
    assert isinstance(again, dynamics.Orbit)
    assert again.start.angle == pytest.approx(there.angle, abs=1e-9)
    assert again.start.gap_displacement is None
    for one, other in zip(again.multipliers, orbit.multipliers, strict=True):
        assert one == pytest.approx(other, abs=1e-11)
    x, v, _, w = again.state
    over: dict[str, Any] = {"displacement": [x, x + 1e-3], "velocity": [v, v - 1e-3]}
    basins = dynamics.basins(
        **WIDE, over=over, start=again, attractors=[again.mirror(), again], most_cycles=300
    )
    assert basins.left_out == ()
    assert basins.labels[0, 0] == 1
    assert basins.attractors[1].state[3] == w


def test_a_cell_is_where_a_run_ends(found: dynamics.Attractors) -> None:
    over: dict[str, Any] = {"gap_velocity": [-0.5, 0.5]}
    over = {"gap_displacement": np.linspace(-0.92, 0.92, 4), **over}
    basins = dynamics.basins(**WIDE, over=over, attractors=found)
    assert len(basins.attractors) == 2
    assert basins.left_out == ()
    assert set(np.unique(basins.labels)) <= {-1, 0, 1}
    assert basins.undecided < 0.5
    for row, column in ((0, 0), (0, 2), (1, 1), (1, 3)):
        label = int(basins.labels[row, column])
        start = (0.0, 0.0, float(basins.x[column]), float(basins.y[row]))
        there = dynamics.orbit(**WIDE, start=start, settle=400)
        assert isinstance(there, dynamics.Orbit)
        assert label < 0 or math.dist(there.state, basins.attractors[label].state) < 1e-6
    alone = dynamics.basins(**WIDE, over={"displacement": [0.0], "velocity": [0.0]})
    assert len(alone.attractors) == 1


def test_stops_out_of_reach_leave_the_usual_box_in_reach() -> None:
    """A bob at 1 from the pivot never meets stops at 1.2: no start is drawn beyond its reach."""
    parts: dict[str, Any] = {
        **WIDE,
        "absorber": iva.Piva(
            mass_ratio=0.1, restitution=0.6, length=1.0, clearance=1.2, frequency_ratio=0.3
        ),
        "force": iva.Harmonic(amplitude=0.01, frequency=2.0),
    }
    found = dynamics.attractors(**parts, starts=3, most_cycles=30)
    assert found.box[2] == (-1.0, 1.0)
    assert found.attractors == ()
    small = iva.Piva(
        mass_ratio=0.1, restitution=0.6, clearance=1.2, frequency_ratio=0.9, angles="small"
    )
    spectrum = dynamics.lyapunov(**{**parts, "absorber": small}, cycles=2, discard=0, seeds=1)
    assert spectrum.box[2] == (-1.2, 1.2)


def test_a_wide_pendulum_has_a_branch(found: dynamics.Attractors) -> None:
    orbit = found.attractors[0].orbit
    branch = dynamics.follow(orbit, over="clearance", between=(0.92, 0.94), step=0.3)
    assert isinstance(branch, dynamics.Branch)
    assert branch.impacts == 4
    there = branch.orbit(0)
    assert isinstance(there, dynamics.Orbit)
    assert there.residual < 1e-12
    settled = dynamics.orbit(
        there.absorber, there.primary, force=there.force, start=there, settle=20
    )
    assert isinstance(settled, dynamics.Orbit)
    assert not there.stable or math.dist(settled.state, there.state) < 1e-9
