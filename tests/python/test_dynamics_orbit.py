"""Periodic orbits: those of the 50-digit references, a closed form, units, what is refused."""

from __future__ import annotations

import json
import math
import pickle
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iva
from iva import dynamics, theory

REFERENCE = Path(__file__).parents[1] / "reference"
MASSES = {one["id"]: one for one in json.loads((REFERENCE / "orbits.json").read_text())}
PENDULUMS = {one["id"]: one for one in json.loads((REFERENCE / "orbits_piva.json").read_text())}

SIVA = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
PRIMARY = iva.Primary(damping_ratio=0.05)
FORCE = iva.Harmonic(amplitude=1.0, frequency=1.0)
#: Of the stable symmetric orbit of this scene, A1 of the references.
STATE = (-1.103, 0.327, -4.038, 3.256)


def scene(record: dict[str, Any]) -> tuple[iva.Siva | iva.Piva, iva.Primary, iva.Harmonic]:
    """Return the parts of the scene of a record."""
    given = {name: float(value) for name, value in record["scene"].items()}
    common: dict[str, Any] = {
        name: given[name] for name in ("mass_ratio", "restitution", "clearance")
    }
    absorber: iva.Siva | iva.Piva = iva.Siva(**common)
    if "frequency_ratio" in given:
        common["frequency_ratio"] = given["frequency_ratio"]
        small = record["angles"] == "small"
        kind: dict[str, Any] = {"angles": "small"} if small else {"length": record["length"]}
        absorber = iva.Piva(**common, **kind)
    force = iva.Harmonic(amplitude=given["force_amplitude_per_mass"], frequency=given["frequency"])
    return absorber, iva.Primary(damping_ratio=given["damping_ratio"]), force


def truth(record: dict[str, Any]) -> tuple[float, ...]:
    """Return the state of a record at time zero."""
    at = record["state_at_time_0"]
    names = ("displacement", "velocity", "gap_displacement", "gap_velocity")
    return tuple(float(at[name]) for name in names)


def complexes(pairs: list[list[str]]) -> list[complex]:
    """Return the numbers of a record."""
    return [complex(float(re), float(im)) for re, im in pairs]


def judge_multipliers(
    found: tuple[complex, ...] | None,
    errors: tuple[float, ...] | None,
    pairs: list[list[str]],
    impacts: int,
) -> None:
    """Check multipliers and their errors, each against a true one of its own."""
    assert found is not None
    assert errors is not None
    true = complexes(pairs)

    def off(order: tuple[complex, ...]) -> list[float]:
        return [abs(one - other) for one, other in zip(found, order, strict=True)]

    best = min((off(order) for order in permutations(true)), key=max)
    assert max(best) <= (1e-11 if impacts >= 8 else 1e-13)
    assert all(one <= bound for one, bound in zip(best, errors, strict=True))
    assert max(errors) < 1e-9


def judge(orbit: dynamics.Orbit | dynamics.Missed, record: dict[str, Any]) -> None:
    """Check an orbit against a record."""
    assert isinstance(orbit, dynamics.Orbit)
    count = record.get("impacts") or 0
    judge_multipliers(orbit.multipliers, orbit.multiplier_errors, record["multipliers"], count)
    assert orbit.symmetric is record["symmetric"]
    if orbit.symmetric:
        half = (orbit.half_multipliers, orbit.half_multiplier_errors)
        judge_multipliers(*half, record["half_map_multipliers"], count)
    else:
        assert orbit.half_multipliers is orbit.half_multiplier_errors is None
    assert orbit.stable is record["stable"]
    assert orbit.residual <= 50 * 2.0**-53
    assert orbit.least_periods == orbit.periods == record["forcing_periods"]
    margin = record.get("margin")
    if margin is not None:
        # The records have six digits or four, of the smallest sample of the motion.
        rounding = 2 * 10.0 ** -len(margin.partition(".")[2])
        assert orbit.grazing_margin == pytest.approx(float(margin), abs=rounding)
    if "episodes" in record:
        assert (orbit.rank, orbit.walls, orbit.determinant_error) == (2, "(+)(-)", None)
        assert orbit.multipliers[2:] == (0, 0)
        return
    assert orbit.rank == 4
    assert len(orbit.impacts) == count
    assert orbit.determinant_error is not None
    assert abs(orbit.determinant_error) < 1e-14


def judge_events(orbit: dynamics.Orbit, record: dict[str, Any]) -> None:
    """Check the impacts and stick episodes of an orbit from time zero on."""
    impacts = orbit.impacts
    if "episodes" in record:
        impacts = tuple(one for one in impacts if abs(one.approach_velocity) > 1e-3)
        for episode, (stick, release, wall) in zip(orbit.episodes, record["episodes"], strict=True):
            assert episode.stick_time == pytest.approx(float(stick), rel=0, abs=1e-12)
            assert episode.release_time == pytest.approx(float(release), rel=0, abs=1e-12)
            assert episode.wall == wall
    else:
        assert orbit.walls == record["walls"]
        assert orbit.amplitude == pytest.approx(float(record["amplitude"]), rel=0, abs=1e-12)
    for impact, (time, wall, approach) in zip(impacts, record["impact_list"], strict=True):
        assert impact.time == pytest.approx(float(time), rel=0, abs=1e-12)
        assert impact.wall == wall
        assert impact.approach_velocity == pytest.approx(float(approach), rel=0, abs=1e-12)


@pytest.mark.parametrize("name", MASSES)
def test_the_reference_orbits_are_found_from_nearby(name: str) -> None:
    record = MASSES[name]
    absorber, primary, force = scene(record)
    # Off by 1e-3 in each coordinate; A4, … have a period of two cycles of the force.
    near = [value + 1e-3 * side for value, side in zip(truth(record), (1, -1, 1, -1), strict=True)]
    for start in (near, truth(record)):
        orbit = dynamics.orbit(
            absorber, primary, force=force, start=start, periods=record["forcing_periods"]
        )
        judge(orbit, record)
        assert isinstance(orbit, dynamics.Orbit)
        assert orbit.state == pytest.approx(truth(record), rel=0, abs=1e-12)
        assert orbit.start.time == 0.0
        judge_events(orbit, record)


@pytest.mark.parametrize("name", PENDULUMS)
def test_the_reference_orbits_of_pendulums_are_found_from_nearby(name: str) -> None:
    record = PENDULUMS[name]
    absorber, primary, force = scene(record)
    impact = record["impact"]
    wall = impact["wall"]
    place: dict[str, float] = {"gap_displacement": wall * (absorber.clearance or 0.0)}
    if record["angles"] == "small":
        place["gap_velocity"] = float(impact["gap_velocity_after"])
    else:
        place["angular_velocity"] = float(impact["angle_velocity_after"])
    start = iva.Start(
        displacement=float(impact["displacement"]) + 1e-3,
        velocity=float(impact["velocity_after"]) - 1e-3,
        time=float(impact["time"]),
        **place,
    )
    orbit = dynamics.orbit(absorber, primary, force=force, start=start)
    judge(orbit, record)
    assert isinstance(orbit, dynamics.Orbit)
    # The impact of the record is at the begin of the cycle or at its end, to rounding.
    near = [one for one in orbit.impacts if one.wall == wall]
    off = [math.remainder(one.time - float(impact["time"]), orbit.period) for one in near]
    [hit] = [one for one, gap in zip(near, off, strict=True) if abs(gap) < 1e-12]
    assert hit.displacement == pytest.approx(float(impact["displacement"]), rel=0, abs=1e-12)
    assert hit.velocity_before == pytest.approx(float(impact["velocity_before"]), abs=1e-12)
    assert hit.velocity_after == pytest.approx(float(impact["velocity_after"]), abs=1e-12)


@pytest.mark.parametrize("name", [name for name, one in MASSES.items() if one["stable"]])
def test_stable_orbits_are_found_from_a_plain_run(name: str) -> None:
    # From here the runs settle on the orbit of the record, or on its mirror image.
    record = MASSES[name]
    absorber, primary, force = scene(record)
    start = (0.0, -1.0, 0.0, 2.0) if name == "A4" else (0.0, 0.0, 0.0, 0.1)
    orbit = dynamics.orbit(
        absorber,
        primary,
        force=force,
        start=start,
        settle=600,
        periods=record["forcing_periods"],
    )
    judge(orbit, record)
    assert isinstance(orbit, dynamics.Orbit)

    def off(found: dynamics.Orbit) -> float:
        return max(abs(a - b) for a, b in zip(found.state, truth(record), strict=True))

    assert min(off(orbit), off(orbit.mirror())) <= 1e-12


@pytest.mark.parametrize("name", PENDULUMS)
def test_orbits_of_pendulums_are_found_from_a_plain_run(name: str) -> None:
    record = PENDULUMS[name]
    absorber, primary, force = scene(record)
    orbit = dynamics.orbit(absorber, primary, force=force, start=(0, 0, 0, 0.1), settle=600)
    judge(orbit, record)
    assert isinstance(orbit, dynamics.Orbit)
    true = float(record["impact"]["displacement"])
    hits = orbit.impacts + orbit.mirror().impacts
    assert min(abs(hit.displacement - true) for hit in hits) <= 1e-12


def test_starts_of_all_kinds_lead_to_the_same_orbit() -> None:
    known = theory.masri_caughey(SIVA, PRIMARY, FORCE).stable
    assert known is not None
    first = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=known)
    assert isinstance(first, dynamics.Orbit)
    assert first.amplitude == pytest.approx(known.amplitude, rel=0, abs=1e-13)
    assert first.half_multipliers == pytest.approx(known.multipliers, rel=0, abs=1e-13)
    run = iva.simulate(SIVA, PRIMARY, start=iva.Start(gap_velocity=0.1), force=FORCE, cycles=300)
    starts: tuple[Any, ...] = (known.start, STATE, first, run)
    for start in starts:
        orbit = dynamics.orbit(SIVA, PRIMARY, force=[FORCE], start=start)
        assert isinstance(orbit, dynamics.Orbit)
        # The phase of the end of a run of 300 cycles has an error of 1e-13.
        assert orbit.state == pytest.approx(first.state, rel=0, abs=1e-12)
    later = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=run)
    assert isinstance(later, dynamics.Orbit)
    assert later.start.time == pytest.approx(600 * math.pi)


def test_a_run_from_an_orbit_stays_on_it() -> None:
    orbit = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=STATE)
    assert isinstance(orbit, dynamics.Orbit)
    run = orbit.run()
    assert run.impacts["time"].to_list() == pytest.approx(orbit.table["time"].to_list(), abs=1e-13)
    names = [name for name in orbit.table.columns if name in run.impacts.columns]
    assert names == orbit.table.columns
    for name in names:
        assert orbit.table[name].to_list() == pytest.approx(run.impacts[name].to_list(), abs=1e-12)
    assert orbit.run(cycles=40).summary["regime"].item() == "2:1"
    later = orbit.run(3, tables=("stroboscope",)).stroboscope
    assert later["displacement"].to_list() == pytest.approx([orbit.state[0]] * later.height)


@pytest.mark.parametrize("name", ["A7", "E2", "V1", "V5"])
def test_the_grazing_margin_is_that_of_the_exact_motion(name: str) -> None:
    record = (MASSES | PENDULUMS)[name]
    absorber, primary, force = scene(record)
    orbit = dynamics.orbit(
        absorber,
        primary,
        force=force,
        start=(0.0, 0.0, 0.0, 0.1),
        periods=record["forcing_periods"],
        settle=600,
    )
    assert isinstance(orbit, dynamics.Orbit)
    # The largest |y| at a turn of y among many samples, those next to an impact left out: it is
    # smaller than the truth by at most ½ ÿ h², some 1e-8.
    count = 100_000
    times = [orbit.period * index / count for index in range(count)]
    y = orbit.run().at(times)["gap_displacement"].to_list()
    hits = {
        math.floor(one.time / orbit.period * count) + by for one in orbit.impacts for by in (0, 1)
    }
    turns = [
        abs(y[k])
        for k in range(1, count - 1)
        if (y[k] - y[k - 1]) * (y[k + 1] - y[k]) < 0 and k not in hits
    ]
    assert absorber.clearance is not None
    assert orbit.grazing_margin == pytest.approx(absorber.clearance - max(turns), rel=0, abs=2e-8)


def test_what_an_orbit_says_of_itself() -> None:
    orbit = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=STATE)
    assert isinstance(orbit, dynamics.Orbit)
    assert bool(orbit) is True
    again = pickle.loads(pickle.dumps(orbit))
    assert again == orbit
    assert hash(again) == hash(orbit)
    assert repr(orbit).splitlines() == [
        "Orbit: stable, symmetric, 2 impacts +- in a period",
        "  multipliers 0.5506+0.4673j, 0.5506-0.4673j, 0.3137+0.3837j, 0.3137-0.3837j",
        f"  amplitude {orbit.amplitude:.4g}",
        "  Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)",
        "  Primary(damping_ratio=0.05)",
        "  Harmonic(amplitude=1.0, frequency=1.0)",
        *repr(orbit).splitlines()[6:],
    ]
    with pytest.raises(AttributeError):
        orbit.stable = False  # type: ignore[misc]


def test_the_mirror_image_of_an_orbit() -> None:
    record = MASSES["A3"]
    absorber, primary, force = scene(record)
    orbit = dynamics.orbit(absorber, primary, force=force, start=truth(record))
    assert isinstance(orbit, dynamics.Orbit)
    image = orbit.mirror()
    assert image.mirror() == orbit
    assert image.state != pytest.approx(orbit.state, abs=0.1)
    # It is an orbit itself, found from there.
    found = dynamics.orbit(absorber, primary, force=force, start=image.start)
    assert isinstance(found, dynamics.Orbit)
    assert found.state == pytest.approx(image.state, rel=0, abs=1e-12)
    assert found.walls == image.walls
    for hit, other in zip(found.impacts, image.impacts, strict=True):
        assert hit.time == pytest.approx(other.time, rel=0, abs=1e-12)
        assert hit.approach_velocity == pytest.approx(other.approach_velocity, rel=0, abs=1e-12)
    # A symmetric one is its own, of an even number of periods too.
    alone = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=STATE)
    assert isinstance(alone, dynamics.Orbit)
    assert alone.mirror().state == pytest.approx(alone.state, rel=0, abs=1e-12)
    twice = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=STATE, periods=2)
    assert isinstance(twice, dynamics.Orbit)
    assert (twice.least_periods, twice.symmetric) == (1, False)
    assert twice.multipliers[0] == pytest.approx(alone.multipliers[0] ** 2, rel=0, abs=1e-13)
    assert twice.mirror().mirror() == twice
    unlike = iva.Siva(mass_ratio=0.2, restitution=0.7, restitution_minus=0.6, clearance=4.5)
    uneven = dynamics.orbit(unlike, PRIMARY, force=FORCE, start=STATE)
    assert isinstance(uneven, dynamics.Orbit)
    assert uneven.symmetric is False
    assert uneven.determinant_error == pytest.approx(0.0, abs=1e-14)
    with pytest.raises(ValueError, match=r"mirror: walls that are not alike"):
        uneven.mirror()


def test_symmetric_and_any_orbit_can_be_asked_for() -> None:
    record = MASSES["A3"]
    absorber, primary, force = scene(record)
    assert isinstance(absorber, iva.Siva)
    known = theory.masri_caughey(absorber, primary, force)
    start = next(one for one in known.orbits if one is not None and one.admissible)
    found = [
        dynamics.orbit(absorber, primary, force=force, start=start, symmetric=symmetric)
        for symmetric in (True, False, None)
    ]
    assert [one.symmetric for one in found if isinstance(one, dynamics.Orbit)] == [True] * 3
    states = [one.state for one in found if isinstance(one, dynamics.Orbit)]
    assert states[1] == pytest.approx(states[0], rel=0, abs=1e-11)


def test_si_units_are_the_natural_ones_scaled() -> None:
    # 3 kg at 7 rad/s, lengths in mm: times over ωn, velocities times ωn, energies times M ωn².
    omega, mass, length = 7.0, 3.0, 1e-3
    natural = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=STATE)
    given = iva.Siva(mass=mass * 0.2, restitution=0.7, clearance_mm=4.5)
    primary = iva.Primary(mass=mass, natural_frequency=omega, damping_ratio=0.05)
    force = iva.Harmonic(force=mass * omega**2 * length, frequency_hz=omega / (2 * math.pi))
    start = iva.Start(
        displacement_mm=STATE[0],
        velocity=STATE[1] * omega * length,
        gap_displacement=STATE[2] * length,
        gap_velocity=STATE[3] * omega * length,
    )
    orbit = dynamics.orbit(given, primary, force=force, start=start)
    assert isinstance(natural, dynamics.Orbit)
    assert isinstance(orbit, dynamics.Orbit)
    x, v, y, w = natural.state
    scaled = [x * length, v * omega * length, y * length, w * omega * length]
    assert orbit.state == pytest.approx(scaled, rel=1e-12)
    assert orbit.period == pytest.approx(2 * math.pi / omega, rel=1e-14)
    assert orbit.multipliers == pytest.approx(natural.multipliers, rel=0, abs=1e-13)
    for one, other in zip(orbit.impacts, natural.impacts, strict=True):
        assert one.time == pytest.approx(other.time / omega, rel=1e-12)
        assert one.approach_velocity == pytest.approx(
            other.approach_velocity * omega * length, rel=1e-12
        )
        energy = mass * (omega * length) ** 2
        assert one.energy_loss == pytest.approx(other.energy_loss * energy, rel=1e-12)
    assert orbit.amplitude == pytest.approx((natural.amplitude or 0.0) * length, rel=1e-12)
    assert "SI units" in repr(orbit)


def test_a_relative_clearance_stays_what_it_was() -> None:
    siva = iva.Siva(mass_ratio=0.2, restitution=0.7, relative_clearance=4.5)
    start = iva.Start(displacement=1.0, gap_velocity=0.1)
    orbit = dynamics.orbit(siva, PRIMARY, force=FORCE, start=start, settle=300)
    plain = dynamics.orbit(SIVA, PRIMARY, force=FORCE, start=start, settle=300)
    assert isinstance(orbit, dynamics.Orbit)
    assert isinstance(plain, dynamics.Orbit)
    assert orbit.state == plain.state
    assert orbit.start.reference == 1.0
    assert plain.start.reference is None
    assert orbit.run(20).summary["regime"].item() == "2:1"


def test_a_motion_of_the_base_has_orbits() -> None:
    force = iva.Harmonic(base_acceleration=1.0, frequency=1.0)
    orbit = dynamics.orbit(SIVA, PRIMARY, force=force, start=(0, 0, 0, 0.1), settle=300)
    assert isinstance(orbit, dynamics.Orbit)
    assert orbit.stable
    assert orbit.determinant_error == pytest.approx(0.0, abs=1e-14)
    assert orbit.run(50).summary["regime"].item() == "2:1"


def test_a_search_that_finds_nothing_says_why() -> None:
    wide = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=50.0)
    missed = dynamics.orbit(wide, PRIMARY, force=FORCE, start=(0, 0, 0, 0))
    assert isinstance(missed, dynamics.Missed)
    assert not missed
    assert missed.reason == "no_impacts"
    assert missed.message.startswith("the motion has no impacts")
    assert pickle.loads(pickle.dumps(missed)) == missed


@pytest.mark.parametrize(
    ("changes", "kind", "message"),
    [
        ({"force": None}, ValueError, "force is missing: an orbit is one under harmonic"),
        ({"force": iva.Impulse(velocity=1)}, ValueError, "force = one that is not harmonic"),
        ({"force": 3}, TypeError, "force"),
        ({"absorber": None, "start": iva.Start()}, ValueError, "absorber.kind = none: an orbit is"),
        ({"periods": 0}, ValueError, "periods = 0: give a whole number from 1 to 1000"),
        ({"periods": 1.5}, TypeError, "periods = 1.5: give a whole number"),
        ({"settle": -1}, ValueError, "settle = -1: give a whole number from 0 to 1000000000"),
        ({"settle": True}, TypeError, "settle = True: give a whole number"),
        ({"symmetric": 1}, TypeError, "symmetric = 1: give True, False or None"),
        ({"symmetric": True, "periods": 2}, ValueError, "symmetric = True: an orbit of an even"),
        ({"start": (1, 2, 3)}, ValueError, "start has 3 numbers: give displacement, velocity,"),
        ({"start": "rest"}, TypeError, "start = 'rest': give an iva.Start, four numbers"),
        ({"start": (0, 0, 9, 0)}, ValueError, "start.gap_displacement = 9"),
        ({"start": (0, 0, 0, None)}, TypeError, "start"),
        ({"strat": 1}, TypeError, "strat = 1: orbit has no such argument; did you mean `start`"),
    ],
)
def test_bad_input_is_refused_in_a_sentence(
    changes: dict[str, Any], kind: type[Exception], message: str
) -> None:
    given: dict[str, Any] = {"absorber": SIVA, "primary": PRIMARY, "force": FORCE, "start": STATE}
    given |= changes
    parts = (given.pop("absorber"), given.pop("primary"))
    with pytest.raises(kind) as raised:
        dynamics.orbit(*parts, **given)
    assert message in str(raised.value)


def test_unlike_walls_have_no_symmetric_orbit() -> None:
    siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5, restitution_minus=0.5)
    with pytest.raises(ValueError, match=r"symmetric = True: the mirror image of a motion"):
        dynamics.orbit(siva, PRIMARY, force=FORCE, start=STATE, symmetric=True)


def test_an_offset_of_the_gap_moves_the_origin_of_y_only() -> None:
    middle = 0.3

    def scene(clearance: float, offset: float) -> iva.Siva:
        return iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=clearance, gap_offset=offset)

    for clearance, symmetric in ((4.5, True), (3.4, False)):
        one, other = (
            dynamics.orbit(
                scene(clearance, offset),
                PRIMARY,
                force=FORCE,
                start=(0.0, 0.0, offset, 0.1),
                settle=400,
            )
            for offset in (0.0, middle)
        )
        assert isinstance(one, dynamics.Orbit)
        assert isinstance(other, dynamics.Orbit)
        assert (one.symmetric, other.symmetric) == (symmetric, symmetric)
        moved = np.array(other.state) - [0.0, 0.0, middle, 0.0]
        assert moved == pytest.approx(np.array(one.state), abs=1e-9)
        image = np.array(other.mirror().state) - [0.0, 0.0, middle, 0.0]
        assert image == pytest.approx(np.array(one.mirror().state), abs=1e-9)
        assert np.array(other.multipliers) == pytest.approx(np.array(one.multipliers), abs=1e-8)
    found = dynamics.attractors(scene(3.4, middle), PRIMARY, force=FORCE, starts=30)
    assert [(attractor.name, attractor.pair) for attractor in found.attractors] == [("3:1", True)]
