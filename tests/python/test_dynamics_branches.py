"""Branches of periodic orbits and curves of their special points, against 30-digit references."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import iva
from iva import dynamics

REFERENCE = Path(__file__).parents[1] / "reference"


def read(name: str) -> dict[str, Any]:
    return {one["id"]: one for one in json.loads((REFERENCE / name).read_text())}


POINTS, CURVES = read("bifurcations.json"), read("bifurcation_curves.json")


@pytest.fixture(scope="module")
def first() -> dynamics.Orbit:
    """Return the symmetric orbit with two impacts of family A, which a run settles on."""
    siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    force = iva.Harmonic(amplitude=1.0, frequency=1.0)
    primary = iva.Primary(damping_ratio=0.05)
    found = dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=200)
    assert isinstance(found, dynamics.Orbit)
    return found


@pytest.fixture(scope="module")
def branch(first: dynamics.Orbit) -> dynamics.Branch:
    found = dynamics.follow(first, over="clearance", between=(0.5, 13.0))
    assert isinstance(found, dynamics.Branch)
    return found


def near(branch: dynamics.Branch, name: str) -> dynamics.Point:
    """Return the point of a branch that a reference has, within 1e-12 (1e-11 for a grazing)."""
    truth = POINTS[name]
    value = float(truth["value"])
    found = min(
        (point for point in branch.points if point.kind == truth["type"]),
        key=lambda point: abs(point.value - value),
    )
    within = 1e-11 if found.kind == "grazing" else 1e-12
    assert abs(found.value - value) < within, name
    return found


def test_a_branch_has_the_points_of_the_references_and_leads_on(
    branch: dynamics.Branch,
) -> None:
    assert branch.symmetric
    assert branch.impacts == 2
    assert branch.ends[0] == "grazing"
    kinds = [point.kind for point in branch.points]
    assert kinds == ["grazing", "pitchfork", "neimark_sacker", "fold", "impact_vanishes"]
    for name in ("A-pitchfork", "A-neimark-sacker", "A-fold-symmetric", "A-grazing-symmetric"):
        near(branch, name)
    asymmetric = branch.switch(1)
    assert isinstance(asymmetric, dynamics.Branch)
    assert not asymmetric.symmetric
    assert asymmetric.ends == ("origin", "grazing")
    near(asymmetric, "A-grazing-asymmetric")
    flip = near(asymmetric, "A-flip")
    doubled = asymmetric.switch(asymmetric.points.index(flip))
    assert isinstance(doubled, dynamics.Branch)
    assert doubled.periods == 2
    near(doubled, "A-flip-2")
    near(doubled, "A-grazing-4:2")
    four = branch.switch(0)
    assert isinstance(four, dynamics.Branch)
    assert four.walls in ("--++", "++--", "-++-", "+--+")
    near(four, "A-fold-4:1")
    near(four, "A-pitchfork-4:1")
    assert not branch.switch(2)
    assert not branch.switch(3)


def test_the_orbit_of_a_row_is_one_and_has_its_multipliers(branch: dynamics.Branch) -> None:
    for index in range(5, len(branch.rows) - 5, 40):
        row, orbit = branch.rows[index], branch.orbit(index)
        assert isinstance(orbit, dynamics.Orbit)
        assert orbit.absorber.clearance == row.value
        assert len(orbit.impacts) == branch.impacts
        assert orbit.stable == row.stable
        assert orbit.residual < 1e-12
        assert orbit.amplitude == pytest.approx(row.amplitude, rel=1e-12)
        if row.grazing_margin is None:
            assert orbit.grazing_margin is None
        else:
            assert orbit.grazing_margin == pytest.approx(row.grazing_margin, rel=1e-9)
        assert abs(orbit.multipliers[0] - row.multipliers[0]) < 1e-11 * (
            1 + abs(row.multipliers[0])
        )
    special = branch.points[1].orbit
    assert isinstance(special, dynamics.Orbit)
    assert special.half_multipliers is not None
    assert abs(special.half_multipliers[0] + 1) < 1e-12


def test_what_a_branch_says_of_itself(branch: dynamics.Branch) -> None:
    table = branch.table
    assert isinstance(table, pl.DataFrame)
    assert table.height == len(branch.rows)
    assert table["impacts"].unique().to_list() == [2]
    assert table["arclength"].is_sorted()
    assert "pitchfork at 4.23982548" in repr(branch)
    assert "ωn = 1" in repr(branch)
    assert repr(branch.points[1]).startswith("Point: pitchfork at clearance = 4.2398")
    again = pickle.loads(pickle.dumps(branch))
    assert again == branch
    assert again.table.equals(table)


def test_a_scene_in_newtons_has_the_same_branch() -> None:
    """Ω and the times scale with ωn, forces with M ωn²; lengths are the same."""
    mass, frequency = 3.0, 7.0
    siva = iva.Siva(mass=0.2 * mass, restitution=0.7, clearance=4.5)
    primary = iva.Primary(mass=mass, natural_frequency=frequency, damping_ratio=0.05)
    force = iva.Harmonic(force=mass * frequency**2, frequency=frequency)
    start = iva.Start(gap_velocity=0.1 * frequency)
    orbit = dynamics.orbit(siva, primary, force=force, start=start, settle=200)
    assert isinstance(orbit, dynamics.Orbit)
    found = dynamics.follow(orbit, over="absorber.clearance", between=(3.0, 8.0))
    assert isinstance(found, dynamics.Branch)
    assert [point.kind for point in found.points] == ["pitchfork", "neimark_sacker"]
    near(found, "A-pitchfork")
    over_force = dynamics.follow(orbit, over="force.force", between=(100.0, 300.0))
    assert isinstance(over_force, dynamics.Branch)
    scaled = 4.5 / float(POINTS["A-pitchfork"]["value"]) * mass * frequency**2
    kinds = {point.kind: point.value for point in over_force.points}
    assert kinds["pitchfork"] == pytest.approx(scaled, rel=1e-13)


def test_curves_are_those_of_the_references(branch: dynamics.Branch) -> None:
    truth = CURVES["T1"]
    at = [float(frequency) for frequency, _ in truth["points"]]
    pitchfork = branch.points[1]
    found = dynamics.curve(
        pitchfork,
        over=("force.frequency", "clearance"),
        between=((0.89, 1.16), (1.0, 10.0)),
        at=at,
    )
    assert isinstance(found, dynamics.Curve)
    assert found.kind == "pitchfork"
    values = dict(found.values)
    for frequency, clearance in truth["points"]:
        assert abs(values[float(frequency)] - float(clearance)) < 1e-12
    assert found.table.columns == ["force.frequency", "clearance", "largest_multiplier"]
    assert pickle.loads(pickle.dumps(found)) == found
    assert repr(found).startswith("Curve: pitchfork")


def test_a_curve_tells_the_wanted_values_that_it_misses(branch: dynamics.Branch) -> None:
    """The clearance grows with the restitution: what is beyond a range is not on the curve."""
    value = branch.points[1].value
    found = dynamics.curve(
        branch.points[1],
        over=("clearance", "restitution"),
        between=((4.0, 4.3), (0.65, 0.9)),
        at=[4.1, value, 4.3, 4.2, 4.301, 6.0, 4.2],
    )
    assert isinstance(found, dynamics.Curve)
    clearances = [clearance for clearance, _ in found.values]
    assert clearances == sorted(clearances)
    assert clearances.count(4.2) == 1
    assert value in clearances
    assert found.missed == (4.1, 4.301, 6.0)
    assert "no point at clearance = 4.1, 4.301, 6" in repr(found)
    assert all(4.0 <= one <= 4.3 and 0.65 <= two <= 0.9 for one, two in found.values)


def test_pictures_say_what_they_show(branch: dynamics.Branch) -> None:
    pytest.importorskip("matplotlib")
    asymmetric = branch.switch(1)
    assert isinstance(asymmetric, dynamics.Branch)
    axes = iva.plots.branch([branch, asymmetric], "largest_multiplier")
    assert axes.get_xlabel() == "clearance d (unit of length)"
    # Where an impact vanishes a multiplier has no bound: it does not take the whole axis.
    assert (branch.table["largest_multiplier"] > 100.0).any()
    assert axes.get_ylim() == (0.0, 10.0)
    legend = axes.get_legend()
    assert legend is not None
    assert {"fold", "pitchfork", "stable"} <= {text.get_text() for text in legend.get_texts()}
    assert iva.plots.multipliers(branch).get_xlabel() == "Re λ"
    curve = dynamics.curve(
        branch.points[1],
        over=("clearance", "restitution"),
        between=((3.0, 6.0), (0.6, 0.8)),
    )
    assert isinstance(curve, dynamics.Curve)
    chart = iva.plots.stability_chart(curve)
    assert chart.get_ylabel() == "restitution e"
    with pytest.raises(ValueError, match="amplitude"):
        iva.plots.branch(branch, "height")
    with pytest.raises(ValueError, match="at least one"):
        iva.plots.stability_chart([])


def test_bad_input_is_one_sentence(first: dynamics.Orbit, branch: dynamics.Branch) -> None:
    with pytest.raises(ValueError, match="clearance"):
        dynamics.follow(first, over="clearance", between=(-1.0, 3.0))
    with pytest.raises(ValueError, match="outside the range"):
        dynamics.follow(first, over="clearance", between=(1.0, 3.0))
    with pytest.raises(ValueError, match="smaller one first"):
        dynamics.follow(first, over="clearance", between=(8.0, 3.0))
    with pytest.raises(ValueError, match="gap"):
        dynamics.follow(first, over="gap", between=(1.0, 13.0))
    with pytest.raises(ValueError, match="nonsense"):
        dynamics.follow(first, over="nonsense", between=(1.0, 3.0))
    with pytest.raises(ValueError, match="of the absorber, the primary system or the force"):
        dynamics.follow(first, over="displacement", between=(-2.0, 2.0))
    with pytest.raises(ValueError, match="step"):
        dynamics.follow(first, over="clearance", between=(1.0, 13.0), step=0.0)
    with pytest.raises(TypeError, match="orbit"):
        dynamics.follow("orbit", over="clearance", between=(1.0, 3.0))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="point"):
        dynamics.curve(branch, over=("clearance", "mass_ratio"), between=((1, 2), (1, 2)))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="one of them clearance"):
        dynamics.curve(
            branch.points[1], over=("restitution", "mass_ratio"), between=((0, 1), (0, 1))
        )


def test_an_orbit_with_sticks_is_followed_to_where_its_stick_begins() -> None:
    siva = iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=0.25)
    force = iva.Harmonic(amplitude=1.0, frequency=0.7)
    primary = iva.Primary(damping_ratio=0.02)
    orbit = dynamics.orbit(siva, primary, force=force, start=(0, 0, 0, 0.1), settle=300)
    assert isinstance(orbit, dynamics.Orbit)
    assert orbit.episodes
    found = dynamics.follow(orbit, over="clearance", between=(0.2, 0.4))
    assert isinstance(found, dynamics.Branch)
    assert found.walls in ("(+)(-)", "(-)(+)")
    assert found.impacts == 2
    assert found.ends == ("range", "stick_begins")
    assert found.table["walls"].unique().to_list() == [found.walls]
    middle = len(found.rows) // 2
    there = found.orbit(middle)
    assert isinstance(there, dynamics.Orbit)
    assert len(there.episodes) == 2
    assert there.walls in ("(+)(-)", "(-)(+)")
    assert there.rank == 2
    assert there.amplitude == pytest.approx(found.rows[middle].amplitude, rel=1e-12)
    for one, other in zip(there.multipliers, found.rows[middle].multipliers, strict=True):
        assert abs(one - other) < 1e-12
    (point,) = found.points
    assert point.kind == "stick_begins"
    # x scales with the force and the clearance: over the force the stick begins at one d/F.
    again = dynamics.follow(orbit, over="force.amplitude", between=(0.5, 1.1))
    assert isinstance(again, dynamics.Branch)
    assert again.ends == ("stick_begins", "range")
    assert 0.25 / again.points[0].value == pytest.approx(point.value, rel=1e-12)
    assert not found.switch(0)
    assert not dynamics.curve(
        point, over=("force.frequency", "clearance"), between=((0.6, 0.8), (0.2, 0.5))
    )
    # Rounding decides whether a run sticks there; if it does, it is for a moment only.
    last = point.orbit
    if isinstance(last, dynamics.Orbit):
        rides = [one.release_time - one.stick_time for one in last.episodes if one.release_time]
        assert len(rides) == 2
        assert max(rides) < 1e-6
    assert pickle.loads(pickle.dumps(found)) == found
