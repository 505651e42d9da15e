"""Attractors: which ones and how often, against the references; what is refused."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import pytest

import iva
from iva import dynamics

REFERENCE = Path(__file__).parents[1] / "reference"
RECORDS = {one["id"]: one for one in json.loads((REFERENCE / "attractors.json").read_text())}
STARTS = 60


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


def box(record: dict[str, Any]) -> dict[str, tuple[float, float]]:
    """Return the box of a record: |x|, |ẋ| ≤ 2, |y| ≤ .95 d, |ẏ| ≤ 2 d."""
    d = record["scene"]["clearance"]
    halves = {"displacement": 2.0, "velocity": 2.0, "gap_displacement": 0.95 * d}
    halves["gap_velocity"] = 2.0 * d
    return {name: (-half, half) for name, half in halves.items()}


@pytest.mark.parametrize("name", RECORDS)
def test_attractors_are_those_of_the_references(name: str) -> None:
    record = RECORDS[name]
    found = dynamics.attractors(
        **scene(record), starts=STARTS, seed=5, most_cycles=2000, box=box(record)
    )
    true = record["periodic_attractors"]
    # In all of them a second attractor of the same name is the mirror image of the first.
    assert [one.name for one in found.attractors] == sorted(set(true))
    assert [one.pair for one in found.attractors] == [len(true) == 2 for _ in set(true)]
    assert found.aperiodic == (STARTS if record["aperiodic_present"] else 0)
    assert sum(found.shares.values()) == pytest.approx(1.0)
    for one in found.attractors:
        assert one.orbit.stable
        assert one.orbit.residual < 1e-12
        assert one.orbit.symmetric is (name in ("I1@1.6", "I1@4.5", "I1@6.0", "I1@3.7"))


def test_several_attractors_are_told_apart() -> None:
    """Of basins.json: a pair of 2:1 and a pair of 3:1."""
    siva = iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=2.7)
    force = iva.Harmonic(amplitude=1.0, frequency=0.7)
    primary = iva.Primary(damping_ratio=0.02)
    found = dynamics.attractors(siva, primary, force=force, starts=200)
    assert sorted(one.name for one in found.attractors) == ["2:1", "3:1"]
    assert all(one.pair and not one.orbit.symmetric for one in found.attractors)
    assert found.table["count"].sum() == 200
    assert found.table["share"].to_list() == list(found.shares.values())
    assert repr(found).startswith("Attractors: of 200 starts")
    assert "mirror image" in repr(found)
    assert pickle.loads(pickle.dumps(found)) == found
    again = dynamics.attractors(siva, primary, force=force, starts=200)
    assert again == found
    other = dynamics.attractors(siva, primary, force=force, starts=200, seed=2)
    share = {one.name: one for one in other.attractors}
    for one in found.attractors:
        error = 4.0 * 2.0**0.5 * one.standard_error
        assert abs(share[one.name].share - one.share) < error


def test_motion_without_impacts_is_a_class() -> None:
    siva = iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=100.0)
    force = iva.Harmonic(amplitude=0.1, frequency=3.0)
    still = dict.fromkeys(("velocity", "gap_velocity"), (0.0, 0.0))
    box = {**still, "displacement": (-0.1, 0.1), "gap_displacement": (-1.0, 1.0)}
    primary = iva.Primary(damping_ratio=0.1)
    found = dynamics.attractors(siva, primary, force=force, starts=10, box=box)
    assert found.shares == {"no_impacts": 1.0}


def test_bad_input_is_one_sentence() -> None:
    def failing(match: str, **given: object) -> None:
        with pytest.raises((ValueError, TypeError), match=match):
            dynamics.attractors(**{**scene(RECORDS["I1@3.4"]), **given})

    failing("starts", starts=0)
    failing("most_periods", most_periods=0)
    failing("most_cycles", most_cycles=0)
    failing("box", box=3)
    failing("kind|absorber", absorber=None)


def test_ctrl_c_keeps_the_starts_that_are_finished() -> None:
    """A hundred thousand starts, cut when the first 64 are finished; all come to the same orbit."""
    told: list[tuple[int, int]] = []

    def interrupt(done: int, total: int) -> None:
        told.append((done, total))
        raise KeyboardInterrupt

    parts = scene(RECORDS["I1@3.4"])
    cut = dynamics.attractors(**parts, starts=100_000, progress=interrupt)
    [(done, total)] = told
    assert total == 100_000
    assert 64 <= done <= cut.starts
    assert cut.starts + cut.cancelled == total
    assert cut.cancelled > 0
    assert cut.unfinished == ()
    few = dynamics.attractors(**parts, starts=64)
    assert few.cancelled == 0
    assert cut.shares == few.shares == {"3:1": 1.0}
    [one], [other] = cut.attractors, few.attractors
    assert one.orbit.state == pytest.approx(other.orbit.state, rel=1e-12)
    assert f"cancelled: {cut.cancelled} more starts are not finished" in repr(cut)
