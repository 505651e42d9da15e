"""Orbits, branches, basins and exponents of one member of any kind."""

from __future__ import annotations

import math

import pytest

import iva
from iva import dynamics

PRIMARY = iva.Primary(damping_ratio=0.05)
FORCE = iva.Harmonic(amplitude=1.0, frequency=1.0)
E, OMEGA = 0.8, 2.4


def test_the_impact_oscillator_doubles_its_period_where_the_closed_form_does() -> None:
    """x″ + x = cos ωt with a wall at σ (S. W. Shaw and P. J. Holmes, J. Sound Vib. 90, 1983).

    The determinant of its map is e², so that a multiplier is −1 where 1 + tr + e² = 0.
    """
    period, gain = 2.0 * math.pi / OMEGA, 1.0 / (1.0 - OMEGA**2)
    turned = math.tan(0.5 * period)
    lost = turned * (1.0 - E) / (1.0 + E)

    def impact(sigma: float) -> tuple[float, float, float]:
        size = abs(gain) * math.hypot(OMEGA, lost)
        phase = math.atan2(gain * OMEGA, lost * gain) - math.acos(lost * sigma / size)
        speed = -(sigma - gain * math.cos(phase)) * turned - gain * OMEGA * math.sin(phase)
        pull = (1.0 + E) * (math.cos(phase) - sigma) * math.sin(period) / speed
        return phase % (2.0 * math.pi), speed, 1.0 - 2.0 * E * math.cos(period) + pull + E**2

    low, high = 0.1, 0.2
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if impact(middle)[2] > 0.0 else (low, middle)
    phase, speed, _ = impact(0.1)
    stop = iva.Stop(clearance=0.1, restitution=E, walls="plus")
    structure, force = iva.Primary(damping_ratio=0.0), iva.Harmonic(amplitude=1.0, frequency=OMEGA)
    start = iva.Start(time=phase / OMEGA, displacement=0.1, velocity=-E * speed)
    orbit = dynamics.orbit(stop, structure, force=force, start=start, verify=True)
    assert orbit
    assert orbit.walls == "+"
    assert orbit.stable
    assert orbit.rank == 2
    assert orbit.multipliers[2:] == (0.0, 0.0)
    assert abs(orbit.multipliers[0] * orbit.multipliers[1]) == pytest.approx(E**2, abs=1e-12)
    assert orbit.state_error is not None
    assert orbit.state_error < 1e-13
    assert orbit.approach_speed_max == pytest.approx(speed, rel=1e-13)
    branch = dynamics.follow(orbit, over="clearance", between=(0.02, 0.4))
    assert branch
    kinds = [point.kind for point in branch.points]
    assert kinds == ["flip", "impact_vanishes"]
    assert branch.points[0].value == pytest.approx(low, abs=1e-11)
    assert branch.points[1].value == pytest.approx(-gain, abs=1e-9)
    doubled = branch.switch(0)
    assert doubled
    assert doubled.periods == 2


MEMBERS: dict[str, iva.Siva | iva.Piva | iva.Stop] = {
    "dashpot": iva.Siva(
        mass_ratio=0.2, clearance=4.5, restitution=0.7, gap_damping_ratio=0.004, spring_ratio=0.1
    ),
    "one wall": iva.Siva(
        mass_ratio=0.1,
        clearance=4.5,
        restitution=0.4,
        walls="minus",
        inclination_deg=20,
        gravity=8.0,
    ),
    "stop": iva.Stop(clearance=1.0, restitution=0.7, walls="minus"),
    "upright": iva.Piva(
        mass_ratio=0.1,
        clearance=4.5,
        restitution=0.3,
        frequency_ratio=0.5,
        length=11.25,
        inclination_deg=80,
    ),
}


@pytest.mark.parametrize("name", MEMBERS)
def test_orbits_repeat_and_attract(name: str) -> None:
    member = MEMBERS[name]
    found = dynamics.attractors(member, PRIMARY, force=FORCE, starts=24, most_cycles=2000)
    orbits = [one.orbit for one in found.attractors]
    assert orbits, found
    for orbit in orbits:
        assert orbit.stable
        assert orbit.residual < 1e-12
        end = orbit.run().state_at(orbit.period + (orbit.start.time or 0.0))
        assert end.displacement == pytest.approx(orbit.start.displacement, abs=1e-9)
        assert end.velocity == pytest.approx(orbit.start.velocity, abs=1e-9)
        again = dynamics.orbit(
            member, PRIMARY, force=FORCE, start=orbit, periods=orbit.periods, verify=True
        )
        assert again
        assert again.state_error is not None
        assert again.state_error < 1e-11


def test_the_sum_of_exponents_is_known_with_a_dashpot() -> None:
    spectrum = dynamics.lyapunov(
        MEMBERS["dashpot"], PRIMARY, force=FORCE, cycles=400, discard=200, seeds=2
    )
    assert spectrum.sum_error is not None
    assert abs(spectrum.sum_error) < 1e-9


def test_two_exponents_of_a_stop_are_lost() -> None:
    spectrum = dynamics.lyapunov(
        MEMBERS["stop"], PRIMARY, force=FORCE, cycles=200, discard=100, seeds=2
    )
    assert spectrum.exponents[2:] == (-math.inf, -math.inf)
    assert math.isfinite(spectrum.exponents[0])


@pytest.mark.parametrize("name", ["dashpot", "stop"])
def test_basins_and_diagrams(name: str) -> None:
    member = MEMBERS[name]
    axes = {"displacement": [-0.5, 0.0, 0.5], "velocity": [-5.0, 0.0, 5.0]}
    map_ = dynamics.basins(member, PRIMARY, force=FORCE, over=axes, most_cycles=1500)
    assert (map_.labels >= 0).sum() + (map_.labels == -2).sum() >= 6
    strobes = dynamics.diagram(
        member,
        PRIMARY,
        force=FORCE,
        over={"absorber.clearance": [1.0, 2.0, 4.5]},
        discard=200,
        keep=3,
    )
    assert len(strobes.strobes) == 18
    kinds = dynamics.regimes(member, PRIMARY, force=FORCE, starts=8, cycles=400, most_cycles=600)
    assert sum(one.share for one in kinds) == pytest.approx(1.0)


def test_what_rubs_has_orbits_and_branches() -> None:
    rubs = iva.Siva(mass_ratio=0.2, clearance=4.5, restitution=0.7, friction=0.05, gravity=1.0)
    found = dynamics.attractors(rubs, PRIMARY, force=FORCE, starts=6, most_cycles=2000)
    orbit = found.attractors[0].orbit
    end = orbit.run().state_at(orbit.period)
    assert end.displacement == pytest.approx(orbit.start.displacement, abs=1e-9)
    verified = dynamics.orbit(
        rubs, PRIMARY, force=FORCE, start=orbit, periods=orbit.periods, verify=True
    )
    assert verified
    assert verified.state_error is not None
    assert verified.state_error < 1e-12
    branch = dynamics.follow(orbit, over="friction", between=(0.03, 0.08))
    assert isinstance(branch, dynamics.Branch), branch
    assert branch.ends == ("range", "range")
    last = branch.orbit(-1)
    assert isinstance(last, dynamics.Orbit)
    assert last.run().state_at(last.period).displacement == pytest.approx(
        last.start.displacement, abs=1e-9
    )


def test_two_halves_of_a_force_are_the_force() -> None:
    member = iva.Siva(mass_ratio=0.2, clearance=4.5, restitution=0.7)
    start = (0, 0, 0, 0.1)
    halves = [iva.Harmonic(amplitude=0.5, frequency=1.0)] * 2
    one = dynamics.orbit(member, PRIMARY, force=FORCE, start=start, settle=200)
    both = dynamics.orbit(member, PRIMARY, force=halves, start=start, settle=200)
    assert one
    assert both
    assert both.symmetric
    assert both.force == tuple(halves)
    assert both.period == one.period
    assert both.state == pytest.approx(one.state, rel=1e-12)
    assert [abs(it) for it in both.multipliers] == pytest.approx(
        [abs(it) for it in one.multipliers], rel=1e-9
    )


@pytest.mark.parametrize(
    ("frequency", "periods", "mirrors"), [(3.0, 1, True), (2.0, 1, False), (1.5, 2, False)]
)
def test_forces_with_a_common_period(frequency: float, periods: int, mirrors: bool) -> None:
    member = iva.Siva(mass_ratio=0.2, clearance=4.5, restitution=0.7)
    forces = [FORCE, iva.Harmonic(amplitude=0.5, frequency=frequency, phase=0.4)]
    found = dynamics.orbit(
        member, PRIMARY, force=forces, start=(0, 0, 0, 0.1), settle=400, verify=True
    )
    assert found
    assert found.period == pytest.approx(2.0 * math.pi * periods, rel=1e-15)
    assert found.state_error is not None
    assert found.state_error < 1e-12
    assert (found.image is not None) == mirrors
    end = found.run().state_at(found.period)
    assert end.displacement == pytest.approx(found.start.displacement, abs=1e-9)
    assert "1.5" in repr(found) or frequency != 1.5
    branch = dynamics.follow(found, over="clearance", between=(4.0, 5.0))
    assert branch
    drawn = dynamics.basins(
        member,
        PRIMARY,
        force=forces,
        over={"displacement": [-1.0, 1.0], "velocity": [-1.0, 1.0]},
        most_cycles=1000,
    )
    assert (drawn.labels >= 0).any()


def test_forces_without_a_common_period_are_refused() -> None:
    forces = [FORCE, iva.Harmonic(amplitude=0.5, frequency=math.sqrt(2.0))]
    with pytest.raises(ValueError, match="fractions of each other"):
        dynamics.orbit(MEMBERS["stop"], PRIMARY, force=forces, start=iva.Start())
