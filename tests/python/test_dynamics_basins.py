"""Basins: cell by cell against the references; pictures; what is refused."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iva
from iva import dynamics

REFERENCE = Path(__file__).parents[1] / "reference"
RECORDS = {one["id"]: one for one in json.loads((REFERENCE / "basins.json").read_text())}
AXIS = np.linspace(-4.0, 4.0, 64)


def scene(record: dict[str, Any]) -> dict[str, Any]:
    """Return the parts of the scene of a record."""
    given = record["scene"]
    names = ("mass_ratio", "restitution", "clearance")
    force = iva.Harmonic(amplitude=given["force_amplitude_per_mass"], frequency=given["frequency"])
    return {
        "absorber": iva.Siva(**{name: given[name] for name in names}),
        "primary": iva.Primary(damping_ratio=given["damping_ratio"]),
        "force": force,
    }


def labels(record: dict[str, Any]) -> np.ndarray:
    """Return the labels of a record; of its axes the second goes up."""
    return np.array([[int(label) for label in row] for row in record["labels"]]).T


@pytest.fixture(scope="module", params=RECORDS)
def pair(request: pytest.FixtureRequest) -> tuple[dict[str, Any], dynamics.Basins]:
    record = RECORDS[request.param]
    over: dict[str, Any] = {"displacement": AXIS, "velocity": AXIS}
    return record, dynamics.basins(**scene(record), over=over)


def test_cells_are_those_of_the_references(pair: tuple[dict[str, Any], dynamics.Basins]) -> None:
    record, found = pair
    # The label that the reference has for each of ours: that of the strobe that is the nearest.
    strobes = np.array([one["strobe_state"] for one in record["attractors"]])
    order = [int(np.abs(strobes - orbit.state).max(axis=1).argmin()) for orbit in found.attractors]
    assert sorted(order) == list(range(len(strobes)))
    true, hard = labels(record), np.zeros(4096, bool)
    hard[record["hard_cells"]] = True
    sure = found.labels >= 0
    ours = np.array([*order, -2, -1])[found.labels]
    wrong = sure & (ours != true) & ~hard.reshape(64, 64).T
    assert not wrong.any()
    assert found.undecided < 2.0 * hard.mean()
    for mine, theirs in enumerate(order):
        count, unsure = record["counts"][theirs], found.undecided * 4096
        likely = found.fractions[mine] * 4096
        assert abs(likely - count) <= 3.0 * math.sqrt(unsure)
    assert found.entropy == pytest.approx(record["basin_entropy_4x4_boxes"], abs=0.02)
    assert found.boundary_entropy == pytest.approx(record["boundary_basin_entropy"], abs=0.02)


def test_what_basins_say_of_themselves(pair: tuple[dict[str, Any], dynamics.Basins]) -> None:
    record, found = pair
    assert found.labels.shape == (64, 64)
    assert found.over == ("displacement", "velocity")
    assert sum(found.fractions.values()) == pytest.approx(1.0)
    assert repr(found).startswith("Basins: 64 values of displacement, 64 of velocity")
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    assert again != "basins"
    assert found.left_out == ()
    # The attractors of a search give the same cells.
    few = {"displacement": AXIS[:9], "velocity": AXIS[:7]}
    known = dynamics.attractors(**scene(record), starts=100)
    by_search = dynamics.basins(**scene(record), over=few, attractors=known)
    by_orbits = dynamics.basins(**scene(record), over=few, attractors=list(found.attractors))
    assert np.array_equal(by_orbits.labels, found.labels[:7, :9])
    states = {orbit.state: k for k, orbit in enumerate(found.attractors)}
    nearest = [
        min(states.items(), key=lambda one: math.dist(one[0], orbit.state))[1]
        for orbit in by_search.attractors
    ]
    assert np.array_equal(np.array([*nearest, -2, -1])[by_search.labels], found.labels[:7, :9])


def test_a_cell_is_where_a_run_ends(pair: tuple[dict[str, Any], dynamics.Basins]) -> None:
    record, found = pair
    for row, column in ((5, 40), (33, 12), (50, 50)):
        start = (found.x[column], found.y[row], 0.0, 0.0)
        label = found.labels[row, column]
        orbit = dynamics.orbit(**scene(record), start=start, settle=200)
        assert isinstance(orbit, dynamics.Orbit)
        assert label < 0 or math.dist(orbit.state, found.attractors[label].state) < 1e-6


def test_pictures_have_units(pair: tuple[dict[str, Any], dynamics.Basins]) -> None:
    _, found = pair
    axes = iva.plots.basins(found)
    assert axes.get_xlabel() == "start displacement x₀ (unit of length)"
    assert axes.get_ylabel() == "start velocity ẋ₀ (unit of length · ωₙ)"
    legend = axes.get_legend()
    assert legend is not None
    assert len(legend.get_texts()) >= len(found.attractors)


def test_what_stays_open_is_undecided() -> None:
    """Chaos at d = 3.85 (exponents.json)."""
    record = RECORDS["P-basin-1"]
    parts = scene(record)
    parts["absorber"] = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.85)
    over: dict[str, Any] = {"gap_displacement": [-1.0, 0.5], "gap_velocity": [0.1, 0.2]}
    found = dynamics.basins(**parts, over=over, most_cycles=20)
    assert found.undecided == 1.0
    assert found.fractions == {-1: 1.0}
    assert found.entropy is None
    assert found.attractors == ()


def coexisting() -> dict[str, Any]:
    """Return a scene with a pair of 2:1 and a pair of 3:1 (P-basin-2)."""
    return scene(RECORDS["P-basin-2"])


@pytest.fixture(scope="module")
def orbits() -> list[dynamics.Orbit]:
    """Return its four orbits, found from the strobes of the record."""
    strobes = [one["strobe_state"] for one in RECORDS["P-basin-2"]["attractors"]]
    found = [dynamics.orbit(**coexisting(), start=strobe) for strobe in strobes]
    return [orbit for orbit in found if isinstance(orbit, dynamics.Orbit)]


FEW: dict[str, Any] = {"displacement": AXIS[::12], "velocity": AXIS[::12]}


def test_labels_are_places_in_the_list_that_is_given(orbits: list[dynamics.Orbit]) -> None:
    """In the order of the record they are its labels."""
    found = dynamics.basins(**coexisting(), over=FEW, attractors=orbits)
    assert found.attractors == tuple(orbits)
    assert found.left_out == ()
    sure = found.labels >= 0
    assert np.array_equal(found.labels[sure], labels(RECORDS["P-basin-2"])[::12, ::12][sure])
    # One that is no orbit keeps its place, and is told.
    elsewhere = replace(orbits[1], state=(0.1, 0.2, 0.3, 0.1))
    given = [orbits[0], elsewhere, orbits[2], orbits[3], orbits[2]]
    without = dynamics.basins(**coexisting(), over=FEW, attractors=given)
    assert without.attractors == tuple(given)
    assert np.array_equal(without.labels, np.where(found.labels == 1, -1, found.labels))
    assert without.left_out == (
        "attractor 1: a run from it comes to another orbit",
        "attractor 4: it is the same orbit as attractor 2",
    )
    assert "left out: attractor 1: a run from it" in repr(without)


def test_an_orbit_that_is_not_stable_is_refused() -> None:
    """The symmetric 2:1 at d = 3.4 is unstable below its pitchfork, 4.2398 (bifurcations.json)."""
    parts = scene(RECORDS["P-basin-1"])
    wide = {**parts, "absorber": replace(parts["absorber"], clearance=4.5)}
    first = dynamics.orbit(**wide, start=(0, 0, 0, 0.1), settle=200)
    assert isinstance(first, dynamics.Orbit)
    branch = dynamics.follow(first, over="clearance", between=(3.4, 4.5))
    assert isinstance(branch, dynamics.Branch)
    unstable = branch.orbit(0)
    assert isinstance(unstable, dynamics.Orbit)
    assert unstable.absorber.clearance == 3.4
    size = f"{abs(unstable.multipliers[0]):.6g}"
    with pytest.raises(ValueError, match=rf"attractors\[1\] has a multiplier of size {size}"):
        dynamics.basins(**parts, over=FEW, attractors=[replace(unstable, stable=True), unstable])


def test_an_orbit_that_takes_longer_than_is_sought_has_its_label() -> None:
    """30 impacts in 11 periods at d = 3.7 (attractors.json): what is given may be longer."""
    parts = scene(RECORDS["P-basin-1"])
    parts["absorber"] = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=3.7)
    found = dynamics.attractors(**parts, starts=2)
    over: dict[str, Any] = {"displacement": [0.5], "velocity": [0.5]}
    cell = dynamics.basins(**parts, over=over, attractors=found, most_periods=1, most_cycles=1000)
    assert cell.left_out == ()
    assert cell.likely.tolist() == [[0]]


def test_an_orbit_that_nothing_stays_with_is_told() -> None:
    """The orbit G1 is stable up to its grazing (bifurcations.json), and 1e-9 from it on a verge."""
    primary, force = iva.Primary(damping_ratio=0.06), iva.Harmonic(amplitude=1.0, frequency=0.62)
    siva = iva.Siva(mass_ratio=0.07, restitution=0.4, clearance=1.8522673068662248 + 1e-9)
    start = (1.5394300017920721, 0.13040217441528326, 0.8347525387084471, 1.567147501817912)
    orbit = dynamics.orbit(siva, primary, force=force, start=start)
    assert isinstance(orbit, dynamics.Orbit)
    over = {"displacement": [start[0]], "velocity": [start[1]]}
    found = dynamics.basins(
        siva, primary, force=force, over=over, start=orbit, attractors=[orbit], most_cycles=5
    )
    assert found.labels.tolist() == [[-1]]
    assert found.left_out == ("attractor 0: no neighbourhood was found that runs stay in",)


def test_ctrl_c_ends_basins_with_the_cells_that_are_finished(
    orbits: list[dynamics.Orbit],
) -> None:
    """A million cells, which would take minutes; those of a row are the same in a grid of it."""
    told: list[tuple[int, int]] = []

    def interrupt(done: int, total: int) -> None:
        told.append((done, total))
        raise KeyboardInterrupt

    wide = np.linspace(-4.0, 4.0, 1000)
    over: dict[str, Any] = {"displacement": wide, "velocity": wide}
    cut = dynamics.basins(**coexisting(), over=over, attractors=orbits, progress=interrupt)
    [(done, total)] = told
    assert total == cut.labels.size == 10**6
    cancelled = cut.labels == -3
    assert np.array_equal(cancelled, cut.likely == -3)
    whole = np.flatnonzero(~cancelled.any(axis=1))
    assert 1000 <= done <= 1000 * len(whole) < total
    alone: dict[str, Any] = {"displacement": wide, "velocity": [wide[whole[0]]]}
    row = dynamics.basins(**coexisting(), over=alone, attractors=orbits)
    assert np.array_equal(row.labels[0], cut.labels[whole[0]])
    assert np.array_equal(row.cycles[0], cut.cycles[whole[0]])
    assert cut.entropy is None
    assert cut.boundary_entropy is None
    assert cut.fractions[-3] == cancelled.mean() > 0.0
    finished = total - np.count_nonzero(cancelled)
    assert f"cancelled: {finished} of 1000000 cells are finished" in repr(cut)
    legend = iva.plots.basins(cut).get_legend()
    assert legend is not None
    assert "cancelled" in [text.get_text() for text in legend.get_texts()]


def test_bad_input_is_one_sentence() -> None:
    def failing(match: str, **given: object) -> None:
        over = {"displacement": [0.0, 1.0], "velocity": [0.0]}
        with pytest.raises((ValueError, TypeError), match=match):
            dynamics.basins(**{**scene(RECORDS["P-basin-1"]), "over": over, **given})

    failing("two of", over={"displacement": [1.0]})
    failing("two of", over={"displacement": [1.0], "clearance": [1.0]})
    failing("cells", over={"displacement": [], "velocity": [1.0]})
    failing("gap", over={"gap_displacement": [9.0], "velocity": [1.0]})
    failing("most_cycles", most_cycles=0)
    failing("there is none", attractors=[])
    failing("no orbit", attractors=["3:1"])
    failing("side", side=0)
