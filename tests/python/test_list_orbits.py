"""Periodic orbits of several absorbers, and on structures with several modes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import iva
from iva import dynamics
from iva.dynamics import Missed, orbit

PRIMARY = iva.Primary(damping_ratio=0.03)
DAMPED = iva.Primary(damping_ratio=0.05)
FORCE = iva.Harmonic(amplitude=0.5, frequency=0.95)
MASS = iva.Siva(mass_ratio=0.08, restitution=0.6, clearance=0.5)
LIGHT = iva.Siva(mass_ratio=0.05, restitution=0.5, clearance=0.8)
RUBBING = iva.Siva(mass_ratio=0.05, restitution=0.5, clearance=0.6, friction=0.05, gravity=1.0)
PENDULUM = iva.Piva(
    mass_ratio=0.05, restitution=0.6, clearance=0.4, frequency_ratio=0.7, length=1.2
)
STRUCTURE = iva.Structure(
    frequencies=[10.0, 27.0],
    damping_ratios=[0.03, 0.02],
    points={"top": [0.1, 0.07], "mid": [0.06, -0.08]},
    absorber_at=["top", "mid"],
    force_at="top",
    seen_at="top",
)
ON_MODES = [
    iva.Siva(mass=6.0, restitution=0.6, gap_mm=30.0),
    iva.Siva(mass=4.0, restitution=0.5, gap_mm=20.0),
]
PUSH = iva.Harmonic(force=250.0, frequency=9.6)

#: Absorbers, structure, force and start; what the run from there settles on within 400 periods.
SCENES: dict[str, tuple[Any, Any, Any, iva.Start]] = {
    "two masses": ([MASS, LIGHT], PRIMARY, FORCE, iva.Start(gap_velocity=[0.1, 0.2])),
    "pendulum": ([MASS, PENDULUM], PRIMARY, FORCE, iva.Start(gap_velocity=[0.1, 0.2])),
    "friction": ([MASS, RUBBING], PRIMARY, FORCE, iva.Start(gap_velocity=[0.1, 0.2])),
    "two modes": (ON_MODES, STRUCTURE, PUSH, iva.Start(gap_velocity=[0.1, 0.2])),
}


def found(name: str, **more: Any) -> iva.dynamics.Orbit:
    """Return the orbit of a scene, of one to four periods."""
    absorber, primary, force, start = SCENES[name]
    for periods in (1, 2, 3, 4):
        one = orbit(
            absorber, primary, force=force, start=start, periods=periods, settle=400, **more
        )
        if one:
            return one
    raise AssertionError(f"{name}: {one}")


@pytest.mark.parametrize("name", SCENES)
def test_a_run_stays_on_an_orbit(name: str) -> None:
    """Its start comes back after a cycle, and its impacts are those of the run."""
    one = found(name)
    assert one.stable
    assert one.residual < 1e-11
    run = one.run()
    assert [hit.time for hit in one.impacts] == pytest.approx(
        run.impacts["time"].to_list(), rel=1e-9
    )
    assert [hit.absorber for hit in one.impacts] == run.impacts["absorber"].to_list()
    end: Any = run.state_at(one.period + (one.start.time or 0.0))
    for key in ("gap_displacement", "gap_velocity"):
        assert getattr(end, key) == pytest.approx(getattr(one.start, key), abs=1e-8)
    keys = ("displacements", "velocities") if name == "two modes" else ("displacement", "velocity")
    for key in keys:
        assert getattr(end, key) == pytest.approx(getattr(one.start, key), abs=1e-8)
    assert len(one.state) == 6
    assert f"multipliers {one.multipliers[0].real:.4g}"[:14] in repr(one)


@pytest.mark.parametrize("name", ["two masses", "pendulum", "two modes"])
def test_orbits_to_twice_the_precision(name: str) -> None:
    """By Newton's method once more, in numbers of 30 digits."""
    one = found(name, verify=True)
    assert one.residual < 1e-18
    assert one.state_error is not None
    assert one.state_error < 1e-12


def test_the_multipliers_of_two_masses_have_the_exact_product() -> None:
    """e² of each impact, and exp(−2ζ T) of the damper; six of them, four with both modes."""
    one = found("two masses")
    assert len(one.multipliers) == 6
    taken = math.prod([0.6, 0.5][hit.absorber] ** 2 for hit in one.impacts)
    truth = taken * math.exp(-2 * 0.03 * one.period)
    product = np.prod(one.multipliers).real
    if not one.episodes:
        assert product == pytest.approx(truth, abs=1e-13)
    assert len(found("two modes").multipliers) == 8


def test_multipliers_are_those_of_differences_of_runs() -> None:
    """The map over a cycle by central differences of runs to the end of it, from a flight."""
    settled: Any = found("two masses")
    for time in (1.0, 2.5, 4.0, 5.5):
        start = settled.run().state_at(time + (settled.start.time or 0.0))
        one: Any = orbit(
            settled.absorber, settled.primary, force=FORCE, start=start, periods=settled.periods
        )
        assert one
        begin: Any = one.start
        if max(abs(y) / d for y, d in zip(begin.gap_displacement, (0.5, 0.8), strict=True)) < 0.98:
            break
    at = np.array(
        [begin.displacement, begin.velocity]
        + [
            value
            for pair in zip(begin.gap_displacement, begin.gap_velocity, strict=True)
            for value in pair
        ]
    )

    def image(point: Any) -> Any:
        start = iva.Start(
            displacement=point[0],
            velocity=point[1],
            gap_displacement=point[2::2].tolist(),
            gap_velocity=point[3::2].tolist(),
            time=begin.time,
        )
        run = iva.simulate(
            one.absorber, one.primary, force=one.force, start=start, duration=one.period
        )
        end: Any = run.state_at((begin.time or 0.0) + one.period)
        gaps = zip(end.gap_displacement, end.gap_velocity, strict=True)
        return np.array(
            [end.displacement, end.velocity, *(value for pair in gaps for value in pair)]
        )

    step = 1e-6
    columns = [(image(at + step * e) - image(at - step * e)) / (2 * step) for e in np.eye(6)]
    values = sorted(np.linalg.eigvals(np.array(columns).T), key=abs, reverse=True)
    for own, other in zip(one.multipliers[:2], values, strict=False):
        assert abs(own) == pytest.approx(abs(other), rel=1e-5, abs=1e-6)


def test_a_search_goes_on_from_a_run_and_an_orbit() -> None:
    absorber, primary, force, start = SCENES["two modes"]
    run = iva.simulate(absorber, primary, start=start, force=force, cycles=400)
    one = found("two modes")
    for begin in (run, one):
        again = orbit(absorber, primary, force=force, start=begin, periods=one.periods)
        assert again
        assert again.amplitude == pytest.approx(one.amplitude, rel=1e-9)


@pytest.mark.parametrize("name", ["two masses", "friction", "two modes"])
def test_attractors_are_what_runs_settle_on(name: str) -> None:
    """Each start of a few ends in the orbit of the scene, or in what a run from it does."""
    absorber, primary, force, _ = SCENES[name]
    all_ = dynamics.attractors(absorber, primary, force=force, starts=6, most_periods=4)
    assert all_.starts == 6
    assert sum(all_.counts().values()) == 6
    assert len(all_.box) == 6
    assert all_.attractors
    likely = max(all_.attractors, key=lambda one: one.count)
    assert likely.orbit.stable
    one: Any = found(name)
    amplitudes: Any = [other.orbit.amplitude for other in all_.attractors]
    assert min(abs(size - one.amplitude) for size in amplitudes) < 1e-9 * one.amplitude
    assert "gap_velocity.1 " in repr(all_)


def units(count: int = 2, spread: float = 0.0) -> iva.Siva:
    """Return a mass in units."""
    return iva.Siva(
        mass_ratio=0.2, restitution=0.7, clearance=4.5, units=count, clearance_spread=spread
    )


def written(spread: float) -> list[iva.Siva]:
    """Return two units as a list: of half the mass, in gaps of 1 ∓ spread times the clearance."""
    half = {"mass_ratio": 0.1, "restitution": 0.7}
    return [iva.Siva(**half, clearance=4.5 * (1 + by * spread)) for by in (-1, 1)]


#: Absorbers with units, and the same as a list.
DIVIDED: dict[str, tuple[Any, list[iva.Siva]]] = {
    "alike": (units(), written(0.0)),
    "spread": (units(spread=0.1), written(0.1)),
    "in a list": ([LIGHT, units(spread=0.1)], [LIGHT, *written(0.1)]),
}
LARGE = iva.Harmonic(amplitude=1.0, frequency=1.0)


@pytest.mark.parametrize("name", DIVIDED)
def test_orbits_and_attractors_of_units_are_those_of_the_list(name: str) -> None:
    """To the bit; a start has a place for each unit, and ``verify`` finds the orbit as well."""
    count = len(DIVIDED[name][1])
    start = iva.Start(gap_displacement=[0.1, -0.2, 0.3][-count:], gap_velocity=0.1)
    asked: dict[str, Any] = {"force": LARGE, "start": start, "settle": 300}
    one, other = (orbit(absorbers, DAMPED, **asked) for absorbers in DIVIDED[name])
    assert one
    assert other
    assert (one.start, one.state, one.walls) == (other.start, other.state, other.walls)
    assert (one.impacts, one.multipliers) == (other.impacts, other.multipliers)
    begin: Any = one.start
    assert len(begin.gap_displacement) == len(begin.gap_velocity) == count
    assert len(one.state) == len(one.multipliers) == 2 + 2 * count
    again = orbit(one.absorber, DAMPED, force=LARGE, start=one.run(), verify=True)
    assert again
    assert again.residual < 1e-18
    assert again.amplitude == pytest.approx(one.amplitude, rel=1e-9)
    limits: dict[str, Any] = {"starts": 4, "most_periods": 4, "most_cycles": 400}
    found, expected = (
        dynamics.attractors(absorbers, DAMPED, force=LARGE, **limits) for absorbers in DIVIDED[name]
    )
    assert (found.counts(), found.box) == (expected.counts(), expected.box)
    assert found.aperiodic_start == expected.aperiodic_start
    starts = [[it.orbit.start for it in all_.attractors] for all_ in (found, expected)]
    assert starts[0] == starts[1]


def test_what_orbits_of_lists_do_not_take() -> None:
    start = iva.Start(gap_velocity=0.1)
    masses: Any = [MASS] * 5
    with pytest.raises(ValueError, match="at most four absorbers"):
        orbit(masses, PRIMARY, force=FORCE, start=start)
    with pytest.raises(ValueError, match=r"5 on 1 modes.*at most four absorbers or units"):
        orbit(units(count=5), PRIMARY, force=FORCE, start=start)
    for absorber in ([MASS, LIGHT], units(spread=0.1)):
        with pytest.raises(ValueError, match=r"give an iva\.Start"):
            orbit(absorber, PRIMARY, force=FORCE, start=(0, 0, 0, 0.1))
    still = orbit(
        [MASS, LIGHT], PRIMARY, force=iva.Harmonic(amplitude=1e-6, frequency=3.0), start=start
    )
    assert isinstance(still, Missed)
