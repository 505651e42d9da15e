"""Exponents, basins, diagrams and regimes of several absorbers, of units and on several modes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import iva
from iva import dynamics

PRIMARY = iva.Primary(damping_ratio=0.05)
FORCE = iva.Harmonic(amplitude=0.5, frequency=1.1)
#: Masses of one restitution, which settle on an orbit with 12 impacts in two periods.
PAIR = [
    iva.Siva(mass_ratio=0.08, restitution=0.7, clearance=0.8),
    iva.Siva(mass_ratio=0.05, restitution=0.7, clearance=1.1),
]
UNLIKE = [PAIR[0], iva.Siva(mass_ratio=0.05, restitution=0.6, clearance=1.1)]
STRUCTURE = iva.Structure(
    frequencies=[10.0, 27.0],
    damping_ratios=[0.03, 0.02],
    points={"top": [0.1, 0.07]},
    absorber_at="top",
    force_at="top",
    seen_at="top",
)
ON_MODES = iva.Siva(mass=6.0, restitution=0.6, gap_mm=30.0)
PUSH = iva.Harmonic(force=250.0, frequency=9.6)

NAMES = ("displacement", "velocity", "gap_displacement", "gap_velocity")
#: Absorbers, structure and force.
SCENES: dict[str, tuple[Any, Any, Any]] = {
    "list": (PAIR, PRIMARY, FORCE),
    "units": (
        iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.6, units=2, clearance_spread=0.2),
        PRIMARY,
        FORCE,
    ),
    "modes": (ON_MODES, STRUCTURE, PUSH),
}


def orbit_of(name: str) -> dynamics.Orbit:
    """Return the stable orbit that most of a few starts of a scene end in."""
    absorber, primary, force = SCENES[name]
    found = dynamics.attractors(
        absorber, primary, force=force, starts=6, most_cycles=600, most_periods=4
    )
    return max(found.attractors, key=lambda one: one.count).orbit


@pytest.mark.parametrize("name", ["list", "modes"])
def test_exponents_at_a_stable_orbit_are_those_of_its_multipliers(name: str) -> None:
    """Ln |λ| over the time of a cycle: the largest, and the sum of those that are not lost."""
    one = orbit_of(name)
    absorber, primary, force = SCENES[name]
    found = dynamics.lyapunov(
        absorber, primary, force=force, start=one, cycles=400, discard=100, seeds=2
    )
    truth = [math.log(abs(it)) / one.period if it else -math.inf for it in one.multipliers]
    assert len(found.exponents) == len(truth) == 6
    assert found.exponents[0] == pytest.approx(truth[0], abs=2.0 / found.time)
    kept = [it for it in truth if it > -math.inf]
    assert sum(found.exponents[: len(kept)]) == pytest.approx(sum(kept), rel=1e-6)
    assert found.sign == -1


def test_the_sum_of_the_exponents_is_known() -> None:
    """Of masses with one restitution: 2 ln e times the impacts per time, less 2 ζ."""
    one = orbit_of("list")
    found = dynamics.lyapunov(
        PAIR, PRIMARY, force=FORCE, start=one, cycles=100, discard=20, seeds=3, seed=4
    )
    assert found.rides == 0
    assert found.sum_error is not None
    assert abs(found.sum_error) < 1e-11
    unlike = dynamics.lyapunov(UNLIKE, PRIMARY, force=FORCE, cycles=20, discard=20, seeds=2)
    assert unlike.sum_error is None


@pytest.mark.parametrize("name", ["list", "modes"])
def test_cells_around_an_orbit_end_in_it(name: str) -> None:
    """Each that is decided: what a run from it comes to has the amplitude of its label."""
    absorber, primary, force = SCENES[name]
    one = orbit_of(name)
    across, place = ("gap_velocity", 3) if name == "modes" else ("gap_velocity.1", 5)
    moved = np.array([-0.01, 0.0, 0.01]) * abs(one.state[place])
    values = {across: one.state[place] + moved, "gap_displacement": one.state[2] + moved[1:]}
    found = dynamics.basins(
        absorber, primary, force=force, start=one, over=values, most_cycles=400, most_periods=4
    )
    assert found.labels.shape == (2, 3)
    assert found.labels[0, 1] >= 0
    for (row, column), label in np.ndenumerate(found.labels):
        if label < 0:
            continue
        numbers: Any = list(one.state)
        numbers[place] = values[across][column]
        numbers[2] = values["gap_displacement"][row]
        start = replace(one.start, gap_displacement=numbers[2::2], gap_velocity=numbers[3::2])
        run = iva.simulate(absorber, primary, force=force, start=start, cycles=900)
        label_of = found.attractors[label]
        end: Any = dynamics.orbit(
            absorber, primary, force=force, start=run, periods=label_of.periods
        )
        assert end.amplitude == pytest.approx(label_of.amplitude, rel=1e-6)


def test_cells_of_units_go_by_the_index_of_the_unit() -> None:
    """A unit has the numbers of an absorber of the list."""
    absorber, primary, force = SCENES["units"]
    over = {"gap_velocity.0": [0.0, 0.1], "gap_velocity.1": [0.2]}
    found = dynamics.basins(absorber, primary, force=force, over=over, most_cycles=3)
    assert found.labels.shape == (1, 2)
    assert found.over == ("gap_velocity.0", "gap_velocity.1")


def test_a_diagram_has_the_numbers_of_each_absorber() -> None:
    """Its strobes at one value are those of a run."""
    over = {"force.frequency": [1.1, 1.12]}
    found = dynamics.diagram(PAIR, PRIMARY, force=FORCE, over=over, discard=3, keep=2)
    table = found.table
    assert table.columns[3:9] == [
        "displacement",
        "velocity",
        "gap_displacement.0",
        "gap_velocity.0",
        "gap_displacement.1",
        "gap_velocity.1",
    ]
    run = iva.simulate(PAIR, PRIMARY, force=FORCE, start=iva.Start(), cycles=4)
    row = table.filter(direction="up", value=1.1).row(0, named=True)
    period = 2 * math.pi / 1.1
    end: Any = run.state_at(4 * period)
    assert row["displacement"] == pytest.approx(end.displacement, abs=1e-9)
    assert row["gap_velocity.1"] == pytest.approx(end.gap_velocity[1], abs=1e-9)
    iva.plots.diagram(found, y="velocity").figure.clear()


def test_regimes_of_a_list() -> None:
    """Their shares are those of all starts."""
    found = dynamics.regimes(PAIR, PRIMARY, force=FORCE, starts=6, most_cycles=400, cycles=60)
    assert sum(one.share for one in found) == pytest.approx(1.0)


def test_a_box_has_a_range_of_each_gap() -> None:
    """One for all, or a list."""
    box: dict[str, Any] = {"displacement": (0, 0), "velocity": (0, 0), "gap_velocity": (0, 0.1)}
    ranges = [(-0.5, 0.5), (0.0, 0.2)]
    cases: list[Any] = [(ranges, ranges), (ranges[0], [ranges[0]] * 2)]
    for given, shown in cases:
        found = dynamics.attractors(
            PAIR,
            PRIMARY,
            force=FORCE,
            starts=2,
            most_cycles=3,
            box=box | {"gap_displacement": given},
        )
        assert [found.box[2], found.box[4]] == shown


@pytest.mark.parametrize(
    ("ask", "match"),
    [
        (
            lambda: dynamics.basins(
                PAIR, PRIMARY, force=FORCE, over={"gap_velocity.2": [0.0], "velocity": [0.0]}
            ),
            r"gap_velocity.2.*: give values of two of displacement, .*gap_velocity.1",
        ),
        (
            lambda: dynamics.attractors(
                PAIR,
                PRIMARY,
                force=FORCE,
                box=dict.fromkeys(NAMES, (0.0, 1.0)) | {"gap_displacement": [(0.0, 1.0)]},
            ),
            "box.gap_displacement has 1 ranges: give a range, or a list of 2",
        ),
        (
            lambda: dynamics.basins(
                ON_MODES,
                STRUCTURE,
                force=PUSH,
                over={"gap_velocity": [0.0], "velocity": [0.0]},
                attractors=[orbit_of("modes")],
            ),
            "attractors.*of several modes they are found from the cells",
        ),
        (
            lambda: dynamics.basins(
                [PAIR[0], iva.Stop(restitution=0.6, clearance=2.0)],
                PRIMARY,
                force=FORCE,
                over={"gap_velocity.1": [0.0], "velocity": [0.0]},
            ),
            "over = gap_velocity.1: a stop on the ground has no start",
        ),
    ],
)
def test_what_cannot_be_asked_is_told_in_a_sentence(ask: Any, match: str) -> None:
    """Names of numbers, ranges, orbits."""
    with pytest.raises(ValueError, match=match):
        ask()
