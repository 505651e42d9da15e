"""Several free masses on one structure, against an integration and against 50 digits.

The integration is that of `planted_rows`, which is held against `several.json` first. Of each row
of masses the same motion from two starts beside it tells how errors grow: ten changes of an instant
or of a velocity, per change of the start, are what rounding may make of it.
"""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import polars as pl
import pytest

from planted_rows import Hit, Mass, Motion, Ride, Row, alike

UNIT = 2.0**-53
#: Impacts slower than this may be summed by one program and listed by the other.
LISTED = 1e-4
#: Size of the changes of a start.
BESIDE = 1e-10
REFERENCE = {
    scene["id"]: scene
    for scene in json.loads(
        (Path(__file__).parents[1] / "reference" / "several.json").read_text(encoding="utf-8")
    )
}


def row_of(scene: dict[str, Any]) -> Row:
    """Return a scene of the reference."""
    start, force = scene["start"], scene["force"]
    columns = ("mass_ratios", "restitutions", "clearances", "offsets")
    masses = tuple(
        Mass(float(mu), float(e), float(d), float(y), float(w), float(offset))
        for mu, e, d, offset, (y, w) in zip(
            *(scene[name] for name in columns), start["gaps"], strict=True
        )
    )
    return Row(
        masses,
        float(scene["damping_ratio"]),
        float(start["displacement"]),
        float(start["velocity"]),
        float(scene["duration"]),
        force and tuple(float(force[name]) for name in ("amplitude", "frequency", "phase")),
    )


def fast(hits: list[Hit]) -> list[Hit]:
    """Return the impacts that every program lists."""
    return [hit for hit in hits if abs(hit.gap_before) > LISTED]


def impacts_of(scene: dict[str, Any]) -> tuple[list[Hit], list[float]]:
    """Return the impacts of the reference, without places, and their conditions."""
    columns = ("velocity_before", "velocity_after", "gap_velocity_before", "gap_velocity_after")
    chosen = [
        event
        for event in scene["events"]
        if event["kind"] == "impact" and abs(float(event["gap_velocity_before"])) > LISTED
    ]
    hits = [
        Hit(
            float(event["time"]),
            event["absorber"],
            event["wall"],
            math.nan,
            *(float(event[name]) for name in columns),
        )
        for event in chosen
    ]
    return hits, [event["condition"] for event in chosen]


def ends_of(scene: dict[str, Any], kind: str) -> tuple[list[tuple[int, int]], list[float]]:
    """Return masses and stops of the sticks or of the releases, and their instants."""
    events = [event for event in scene["events"] if event["kind"] == kind]
    who = [(event["absorber"], event["wall"]) for event in events]
    return who, [float(event["time"]) for event in events]


def off(found: Hit, true: Hit) -> float:
    """Return the largest error of an impact, the place of the structure left out."""
    pairs = [(found.time, true.time), *zip(found[4:], true[4:], strict=True)]
    return max(abs(a - b) for a, b in pairs)


@pytest.mark.parametrize("name", REFERENCE)
def test_the_integration_finds_the_reference(name: str) -> None:
    scene = REFERENCE[name]
    motion = Motion(row_of(scene))
    true, conditions = impacts_of(scene)
    found = fast(motion.hits)
    assert [hit[1:3] for hit in found] == [hit[1:3] for hit in true]
    for hit, exact, condition in zip(found, true, conditions, strict=True):
        assert off(hit, exact) < 1e-14 * max(condition, 1.0)
    over = sorted((r for r in motion.rides if r.release < math.inf), key=lambda r: r.release)
    who, sticks = ends_of(scene, "stick")
    assert [(ride.absorber, ride.wall) for ride in motion.rides] == who
    assert [ride.stick for ride in motion.rides] == pytest.approx(sticks, rel=0, abs=1e-11)
    who, releases = ends_of(scene, "release")
    assert [(ride.absorber, ride.wall) for ride in over] == who
    assert [ride.release for ride in over] == pytest.approx(releases, rel=0, abs=1e-11)
    end = scene["end"]
    expected = [float(end["displacement"]), float(end["velocity"])]
    places = zip(motion.gaps, motion.state[3::2], strict=True)
    state = [*motion.state[:2], *itertools.chain(*places)]
    expected += [float(value) for gap in end["gaps"] for value in gap]
    assert state == pytest.approx(expected, rel=0, abs=1e-14 * max(end["condition"], 1.0))


def hits_of(impacts: pl.DataFrame) -> list[Hit]:
    """Return the impacts of a run that every program lists, those at one instant by their mass."""
    fast = impacts.filter(pl.col("approach_velocity").abs() > LISTED).sort("time", "absorber")
    rebound = pl.col("absorber_velocity_after") - pl.col("velocity_after")
    columns = ("time", "absorber", "wall", "displacement", "velocity_before", "velocity_after")
    rows = fast.select(*columns, "approach_velocity", rebound.alias("rebound")).rows()
    return [Hit(*row) for row in rows]


def rides_of(episodes: pl.DataFrame) -> list[Ride]:
    """Return what rode on a stop in a run."""
    rows = episodes.sort("stick_time", "absorber")
    rows = rows.with_columns(pl.col("release_time").fill_null(math.inf))
    return [
        Ride(*row) for row in rows.select("absorber", "wall", "stick_time", "release_time").rows()
    ]


def long(rides: list[Ride], k: int) -> list[Ride]:
    """Return the rides of a mass that last: between the impacts of a chatter there is no end."""
    return [r for r in rides if r.absorber == k and r.release - r.stick > 10 * LISTED]


@pytest.mark.parametrize("name", REFERENCE)
def test_a_run_finds_the_reference(name: str) -> None:
    """In rounding units, as the README of the reference says; numbers of it were decimals."""
    scene = REFERENCE[name]
    run = row_of(scene).run()
    true, conditions = impacts_of(scene)
    found = hits_of(run.impacts)
    assert [hit[1:3] for hit in found] == [hit[1:3] for hit in true]
    for hit, exact, condition in zip(found, true, conditions, strict=True):
        assert off(hit, exact) < 20 * UNIT * (max(condition, 1.0) + exact.time)
    rides = rides_of(run.episodes)
    who, sticks = ends_of(scene, "stick")
    assert [(ride.absorber, ride.wall) for ride in rides] == who
    assert [ride.stick for ride in rides] == pytest.approx(sticks, rel=0, abs=1e-12)
    releases = sorted(ride.release for ride in rides if ride.release < math.inf)
    assert releases == pytest.approx(ends_of(scene, "release")[1], rel=0, abs=1e-12)


def drawn(index: int) -> Row:
    """Return a row of 2 to 5 masses: in decay, on a base or under a force, every fourth undamped.

    Every third has a plastic mass in a narrow gap, so that others strike while it rides.
    """
    random = np.random.default_rng([46, index])

    def between(low: float, high: float) -> float:
        return round(float(random.uniform(low, high)), 4)

    masses = []
    for k in range(2 + index % 4):
        plastic = k == 0 and index % 3 == 0
        d = between(0.15, 0.4) if plastic else between(0.3, 1.2)
        offset = between(-0.2, 0.2) if random.random() < 0.4 else 0.0
        masses.append(
            Mass(
                between(0.02, 0.15),
                0.0 if plastic else between(0.3, 1.0),
                d,
                round(offset + d * between(-0.9, 0.9), 4),
                between(-0.5, 0.5),
                offset,
                between(0.2, 1.0) if random.random() < 0.3 else None,
            )
        )
    kind = index % 5
    return Row(
        tuple(masses),
        0.0 if index % 4 == 3 else between(0.0, 0.05),
        between(0.6, 1.6) * (1 if random.random() < 0.5 else -1),
        between(-0.5, 0.5),
        30.0,
        (between(0.1, 0.4), between(0.6, 1.5), between(-3.0, 3.0)) if kind >= 2 else None,
        kind == 3,
    )


RIDER = Mass(0.12, 0.0, 0.3, 0.3)
ROWS = {f"drawn-{index}": drawn(index) for index in range(20)}
#: One begins on a stop, pressed; the other strikes the same stop, or the opposite one.
ROWS |= {
    "begins on a stop": Row((RIDER, Mass(0.08, 0.7, 0.5, 0.1, 0.2)), 0.02, 1.0, 0.0, 20.0),
    "two ride at once": Row(
        (RIDER, Mass(0.05, 0.0, 0.4, 0.1, 0.3), Mass(0.1, 0.8, 0.6, -0.2, -0.9)), 0.05, 1.2
    ),
    "pushed": Row(
        (replace(RIDER, e=0.4), Mass(0.1, 0.8, 0.6, -0.2, -0.9), Mass(0.05, 0.9, 0.5, 0.1, -1.8)),
        0.03,
        1.4,
        harmonic=(0.3, 0.8, 0.5),
    ),
    "pushed on a base": Row(
        (Mass(0.1, 0.3, 0.4, -0.4), Mass(0.08, 0.0, 0.3, -0.3), Mass(0.06, 0.9, 0.5, 0.1, 1.8)),
        0.03,
        -1.4,
        harmonic=(0.3, 0.8, 3.0),
        base=True,
    ),
    "eight": Row(
        tuple(Mass(0.01 + 0.01 * k, 0.5 + 0.05 * k, 0.4 + 0.1 * k) for k in range(8)), 0.01, 1.5
    ),
}


class Truth(NamedTuple):
    """Impacts and rides of an integration, and how much each impact moves per change of a start."""

    motion: Motion
    hits: list[Hit]
    growth: list[float]


@cache
def integrated(name: str) -> Truth:
    """Return the truth of a row, up to where rounding could be told apart no more."""
    row = ROWS[name]
    motion = Motion(row, impacts=40, listed=LISTED)
    hits = fast(motion.hits)
    growth, same = np.ones(len(hits)), len(hits)
    for seed in (1, 2):
        beside = fast(Motion(row.shifted(BESIDE, seed), impacts=40, listed=LISTED).hits)
        same = min(same, alike(hits, beside))
        moved = [off(a, b) / BESIDE for a, b in zip(beside[:same], hits[:same], strict=True)]
        growth[:same] = np.maximum(growth[:same], moved)
    growth = np.maximum.accumulate(growth[:same])
    kept = int(np.searchsorted(growth, 1e6))
    return Truth(motion, hits[:kept], growth[:kept].tolist())


@pytest.mark.parametrize("name", ROWS)
def test_a_run_finds_the_integration(name: str) -> None:
    motion, hits, growth = integrated(name)
    assert len(hits) >= 8
    last = hits[-1].time
    run = replace(ROWS[name], duration=min(ROWS[name].duration, last + 0.5)).run()
    found = hits_of(run.impacts)
    assert [hit[1:3] for hit in found[: len(hits)]] == [hit[1:3] for hit in hits]
    for hit, exact, factor in zip(found, hits, growth, strict=False):
        assert off(hit, exact) < 1e-14 * (10.0 * factor + exact.time)
        assert abs(hit.x - exact.x) < 1e-14 * (10.0 * factor + exact.time)
    worst = 1e-14 * (10.0 * growth[-1] + last)
    for k in range(len(ROWS[name].masses)):
        rides = [ride for ride in long(motion.rides, k) if ride.stick < last]
        told = long(rides_of(run.episodes), k)[: len(rides)]
        assert [ride.wall for ride in told] == [ride.wall for ride in rides]
        for one, other in zip(told, rides, strict=True):
            assert abs(one.stick - other.stick) < worst + other.doubt
            if other.release < last:
                assert abs(one.release - other.release) < worst


def test_the_rows_have_all_that_can_happen() -> None:
    """Impacts while another rides: its stop is pushed against it, or taken away from it."""
    carried, left, together, kinds = 0, 0, 0, set()
    for name in ROWS:
        motion, hits, _ = integrated(name)
        rides = [ride for ride in motion.rides if ride.stick < hits[-1].time]
        for ride, hit in itertools.product(rides, hits):
            carried += ride.absorber != hit.absorber and ride.stick < hit.time < ride.release
            left += ride.release == hit.time
        pairs = itertools.combinations(rides, 2)
        together += sum(a.stick < b.release and b.stick < a.release for a, b in pairs)
        kinds |= {(len(ROWS[name].masses), ROWS[name].harmonic is None, ROWS[name].base)}
    assert carried >= 5
    assert left >= 5
    assert together >= 5
    assert len(kinds) >= 10
