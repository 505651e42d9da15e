"""Basins: cell by cell against the references; pictures; what is refused."""

from __future__ import annotations

import json
import math
import pickle
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
    assert axes.get_xlabel() == "start displacement x₀ (unit of x₀)"
    assert axes.get_ylabel() == "start velocity ẋ₀ (unit of x₀ · ωₙ)"
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
