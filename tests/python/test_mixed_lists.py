"""Free masses and pendulums on one structure, against an integration of Lagrange's equations."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

import iva
from planted_swings import Hit, Motion, Ride, Rider, Scene, alike

#: Impacts that are looked at; size of the changes of a start.
IMPACTS, BESIDE = 24, 1e-8
#: The integration misses the end of a hop within one of its steps: it counts up to the first one
#: slower than this.
SLOWEST = 0.02
#: Error of the integration where nothing grows: of the instants of events between its steps.
INTEGRATED = 1e-11


def drawn(index: int) -> Scene:
    """Return a scene of 2 to 5 absorbers, in decay, under a force or on a moving base."""
    random = np.random.default_rng([47, index])

    def between(low: float, high: float) -> float:
        return round(float(random.uniform(low, high)), 4)

    riders = []
    for k in range(2 + index % 4):
        d = between(0.3, 1.2)
        rider = Rider(
            between(0.02, 0.2),
            0.0 if k == 0 and index % 3 == 0 else between(0.4, 1.0),
            d,
            round(d * between(-0.9, 0.9), 4),
            between(-0.5, 0.5),
        )
        if k == 0 or random.random() < 0.5:
            rider = replace(
                rider,
                length=round(d * between(1.5, 6.0), 4),
                r=between(0.2, 1.2),
                kappa=1.0 if k % 2 else between(1.0, 1.5),
                contact=1.0 if random.random() < 0.5 else between(0.8, 1.3),
                pivot=between(0.0, 0.1) if random.random() < 0.3 else 0.0,
                spring=between(0.2, 0.8) if random.random() < 0.3 else 0.0,
            )
        riders.append(rider)
    return Scene(
        tuple(riders),
        0.0 if index % 4 == 3 else between(0.0, 0.05),
        between(0.6, 1.6) * (1 if random.random() < 0.5 else -1),
        between(-0.5, 0.5),
        25.0,
        (between(0.1, 0.4), between(0.6, 1.5), between(-3.0, 3.0)) if index % 5 >= 2 else None,
        index % 5 == 3,
    )


#: Pressed onto its stop by a strong push, so that it rides while others strike.
PRESSED = Scene(
    (
        Rider(0.1, 0.0, 0.4, 0.0, 0.3, length=3.0, r=0.4),
        Rider(0.05, 0.8, 0.6, 0.1, -0.4),
        Rider(0.08, 0.7, 0.5, -0.1, 0.2, length=2.0, r=0.5),
    ),
    0.03,
    1.4,
    0.0,
    25.0,
    (0.8, 0.5, 0.3),
)
SCENES = {f"drawn-{index}": drawn(index) for index in range(20)} | {
    "pressed": PRESSED,
    "pressed on a base": replace(PRESSED, base=True, harmonic=(0.9, 0.4, 1.0)),
}


@cache
def integrated(name: str) -> tuple[Motion, list[float]]:
    """Return the motion of a scene, and how much each impact moves per change of the start."""
    scene = SCENES[name]
    motion = Motion(scene, IMPACTS)
    growth = np.ones(len(motion.hits))
    beside = Motion(replace(scene, x=scene.x + BESIDE, v=scene.v - BESIDE), IMPACTS).hits
    same = alike(motion.hits, beside)
    slow = (k for k, hit in enumerate(motion.hits) if 0.0 < abs(hit.gap_after) < SLOWEST)
    same = min(same, next(slow, same))
    growth[:same] += [off(a, b) / BESIDE for a, b in zip(beside, motion.hits[:same], strict=False)]
    growth = np.maximum.accumulate(growth[:same])
    return motion, growth[: int(np.searchsorted(growth, 1e3))].tolist()


def off(a: Hit, b: Hit) -> float:
    """Return the largest difference of two impacts."""
    return max(abs(a.time - b.time), *(abs(p - q) for p, q in zip(a[3:], b[3:], strict=True)))


def hits_of(run: iva.Run, scene: Scene) -> list[Hit]:
    """Return the impacts of a run; the velocity of a mass centre beside that of the structure."""
    columns = ("time", "absorber", "wall", "velocity_before", "velocity_after", "approach_velocity")
    beside = pl.col("absorber_velocity_after") - pl.col("velocity_after")
    hits = []
    for row in run.impacts.select(*columns, beside.alias("after")).rows():
        hit, after = Hit(*row), row[-1]
        hits.append(hit._replace(gap_after=after * scene.riders[hit.absorber].contact))
    return hits


@pytest.mark.parametrize("name", SCENES)
def test_a_run_finds_the_integration(name: str) -> None:
    scene = SCENES[name]
    motion, growth = integrated(name)
    hits = motion.hits[: len(growth)]
    assert len(hits) >= 3
    last = hits[-1].time
    run = scene.run()
    found = hits_of(run, scene)[: len(hits)]
    assert [hit[1:3] for hit in found] == [hit[1:3] for hit in hits]
    for hit, true, factor in zip(found, hits, growth, strict=True):
        assert off(hit, true) < INTEGRATED * factor, (hit, true, factor)
    columns = ("absorber", "wall", "stick_time", "release_time")
    told = [Ride(*row) for row in run.episodes.select(*columns).rows()]
    told = sorted((ride for ride in told if ride.stick < last), key=lambda ride: ride.stick)
    rides = sorted((r for r in motion.rides if r.release < last), key=lambda ride: ride.stick)
    assert [ride[:2] for ride in told[: len(rides)]] == [ride[:2] for ride in rides]
    for ride, exact in zip(told, rides, strict=False):
        assert abs(ride.stick - exact.stick) < INTEGRATED * growth[-1]
        assert abs(ride.release - exact.release) < INTEGRATED * growth[-1]


def test_the_scenes_have_all_that_can_happen() -> None:
    rides, struck, sizes = 0, 0, set()
    for name, scene in SCENES.items():
        motion, growth = integrated(name)
        hits = motion.hits[: len(growth)]
        over = [ride for ride in motion.rides if ride.release < hits[-1].time]
        rides += sum(scene.riders[ride.absorber].length is not None for ride in over)
        struck += sum(
            any(ride.stick < hit.time <= ride.release for hit in hits if hit[1] != ride.absorber)
            for ride in over
        )
        sizes.add((len(scene.riders), scene.harmonic is None, scene.base))
    assert rides >= 6
    assert struck >= 3
    assert len(sizes) >= 8


PIVA = iva.Piva(mass_ratio=0.1, restitution=0.5, clearance=0.5, frequency_ratio=0.6, length=5)
SIVA = iva.Siva(mass_ratio=0.05, restitution=0.6, clearance=0.4)
PRIMARY = iva.Primary(damping_ratio=0.01)
START = iva.Start(displacement=1.0)


def simulate(absorber: object, **more: object) -> iva.Run:
    given = {"start": START, "periods": 6} | more
    return iva.simulate(absorber, PRIMARY, **given)  # type: ignore[arg-type]


def test_the_tables_tell_of_each() -> None:
    run = simulate([PIVA, SIVA], measures=["stroke", "energy_residual", "impacts"])
    counted = run.impacts.group_by("absorber").len().sort("absorber")["len"].to_list()
    assert run.absorbers["impacts"].to_list() == counted
    assert sum(counted) == run.summary["impacts"].item()
    of_masses = run.impacts.filter(pl.col("absorber") == 1)
    assert of_masses["angle"].null_count() == len(of_masses)
    of_pendulums = run.impacts.filter(pl.col("absorber") == 0)
    angle = math.asin(0.5 / 5)
    expected = (of_pendulums["wall"] * angle).to_list()
    assert of_pendulums["angle"].to_list() == pytest.approx(expected, rel=1e-15)
    path = run.trajectory(samples_per_period=10)
    ends = path.filter(pl.col("time") == path["time"].max())
    assert ends["absorber"].to_list() == [0, 1]
    assert abs(run.summary["energy_residual"].item()) < 1e-14
    assert run.absorbers["stroke"].null_count() == 0


def test_units_of_a_pendulum_in_one_gap_are_one() -> None:
    units = iva.Piva(
        mass_ratio=0.1, restitution=0.5, clearance=0.5, frequency_ratio=0.6, length=5, units=4
    )
    one, four = simulate(PIVA), simulate(units)
    assert four.summary["impacts"].item() == 4 * one.summary["impacts"].item()
    assert four.impacts["time"].to_list()[::4] == pytest.approx(
        one.impacts["time"].to_list(), rel=1e-12
    )


def test_an_angle_is_a_start_of_pendulums() -> None:
    angle = 0.05
    by_angle = simulate([PIVA, SIVA], start=iva.Start(displacement=1.0, angle=angle))
    place = [5 * math.sin(angle), 0.0]
    by_place = simulate([PIVA, SIVA], start=iva.Start(displacement=1.0, gap_displacement=place))
    assert by_angle.impacts["time"].to_list() == pytest.approx(
        by_place.impacts["time"].to_list(), rel=1e-12
    )


@pytest.mark.parametrize("place", [0, 1])
def test_gradients_are_central_differences(place: int) -> None:
    """Of an absorber's own numbers, of the pendulum and of the mass beside it."""
    name, change = ("length", 1e-5) if place == 0 else ("mass_ratio", 1e-6)
    both = (PIVA, SIVA)

    def times(more: float) -> np.ndarray:
        absorbers = list(both)
        absorbers[place] = replace(both[place], **{name: getattr(both[place], name) + more})
        return simulate(absorbers, periods=3).impacts["time"].to_numpy()

    run = simulate([PIVA, SIVA], periods=3, gradients=[f"absorber.{place}.{name}"])
    found = run.gradients[f"absorber.{place}.{name}"].impacts["time"]
    expected = (times(change) - times(-change)) / (2 * change)
    assert len(expected) > 6
    assert found.null_count() == 0
    assert found.to_list() == pytest.approx(expected.tolist(), rel=1e-5, abs=1e-7)


def test_a_sweep_and_a_verification_run() -> None:
    table = iva.sweep(
        [PIVA, SIVA],
        PRIMARY,
        over={"absorber.0.length": [4.0, 5.0], "absorber.1.mass_ratio": [0.02, 0.05]},
        start=START,
        periods=6,
    )
    assert table.summary["outcome"].to_list() == ["finished"] * 4
    alone = simulate([PIVA, SIVA])
    assert table.summary["impacts"].to_list()[3] == alone.summary["impacts"].item()
    verified = simulate([PIVA, SIVA], verify=True)
    assert verified.impacts["time"].to_list() == alone.impacts["time"].to_list()


def test_estimates_cover_the_errors_that_a_verification_finds() -> None:
    """In a decay and under a force."""
    for drive in ({}, {"force": iva.Harmonic(amplitude=0.2, frequency=1.0)}):
        found = simulate([PIVA, SIVA], verify=True, **drive).verification.impacts["time"]
        run = simulate([PIVA, SIVA], errors=True, **drive)
        estimates = run.impacts["time_error"].to_numpy()
        assert len(found) == len(estimates) > 20
        assert found.null_count() == 0
        assert (np.abs(found.to_numpy()) <= estimates).all()
        assert estimates.max() < 1e-10
        digits = run.summary["digits"].item()
        assert 10 < digits < 16
        assert run.summary["condition"].item() > 1


@pytest.mark.parametrize(
    ("absorbers", "more", "says"),
    [
        (
            [
                SIVA,
                iva.Piva(
                    mass_ratio=0.1, restitution=0.5, clearance=6, frequency_ratio=0.6, length=5
                ),
            ],
            {},
            ("absorber.1.clearance", "6", "reach", "5"),
        ),
        (
            [
                SIVA,
                iva.Piva(mass_ratio=0.1, restitution=0.5, clearance=0.5, frequency_ratio=0.6),
            ],
            {},
            ("absorber.1.length", "give it"),
        ),
        (
            [SIVA, iva.Piva(mass_ratio=0.1, restitution=0.5, clearance=0.5, length=5)],
            {},
            ("absorber.1.frequency_ratio", "gravity"),
        ),
        (
            [
                SIVA,
                iva.Piva(
                    mass_ratio=0.1,
                    restitution=0.5,
                    clearance=0.5,
                    frequency_ratio=0.6,
                    length=5,
                    impact_law="printed",
                ),
            ],
            {},
            ("absorber.1.impact_law", "consistent"),
        ),
        (
            [PIVA, SIVA],
            {"start": iva.Start(displacement=1.0, gap_displacement=[0.6, 0.0])},
            ("start.0.gap_displacement", "0.6"),
        ),
    ],
)
def test_what_a_list_does_not_take(
    absorbers: list[iva.Siva | iva.Piva], more: dict[str, object], says: tuple[str, ...]
) -> None:
    with pytest.raises(ValueError, match=".*".join(says)):
        simulate(absorbers, **more)


def test_standard_gravity_is_that_of_each_pendulum() -> None:
    primary = iva.Primary(mass=100.0, frequency_hz=1.0, damping_ratio=0.01)
    pendulum = iva.Piva(mass=5.0, restitution=0.5, clearance=0.01, length=0.25)
    mass = iva.Siva(mass=3.0, restitution=0.5, clearance=0.01)
    run = iva.simulate([mass, pendulum], primary, start=iva.Start(displacement=0.02), periods=5)
    assert run.summary["gravity"].item() == pytest.approx(9.80665, rel=1e-15)
    assert run.summary["impacts"].item() > 5


def test_two_masses_on_one_wall_go_on_beside_a_pendulum() -> None:
    # A pendulum of the mass ratio μ moves the structure by some 6 μ: without it the list is one of
    # free masses, computed in another way. Both masses stick to one wall, and leave it together.
    primary, start = iva.Primary(damping_ratio=0.01), iva.Start(displacement=1.0)
    masses = [
        iva.Siva(mass_ratio=0.05, restitution=0.0, clearance=0.3),
        iva.Siva(mass_ratio=0.07, restitution=0.0, clearance=0.5),
    ]

    def moved(*more: iva.Piva) -> NDArray[np.float64]:
        absorbers: list[iva.Siva | iva.Piva] = [*masses, *more]
        run = iva.simulate(absorbers, primary, start=start, duration=25.0)
        assert run.summary["outcome"].item() == "finished"
        assert abs(run.summary["energy_residual"].item()) < 1e-14
        seen = run.at(np.linspace(0.0, 25.0, 60))["displacement"].to_numpy()
        return seen[:: len(absorbers)]

    alone = moved()
    for ratio in (1e-6, 1e-9):
        pendulum = iva.Piva(
            mass_ratio=ratio, restitution=0.8, clearance=0.9, length=4.0, gravity=1.0
        )
        assert np.abs(moved(pendulum) - alone).max() < 10 * ratio
    moved(iva.Piva(mass_ratio=0.3, restitution=0.8, clearance=0.9, length=4.0, gravity=1.0))
