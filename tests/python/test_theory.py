"""Exact steady states: the published numbers, in the user's units, and what simulations say."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace

import pytest

import iva
from iva import theory

SIVA = iva.Siva(mass_ratio=0.05, restitution=0.8, clearance=2.0)
PRIMARY = iva.Primary(damping_ratio=0.02)
FORCE = iva.Harmonic(amplitude=0.1, frequency=1.0)


def test_the_stable_orbit() -> None:
    # Evaluated from the formulas of Masri and Caughey (1966) with 40 digits.
    found = theory.masri_caughey(SIVA, PRIMARY, FORCE)
    orbit = found.stable
    assert orbit is found.orbits[0]
    assert orbit is not None
    assert orbit.speed == pytest.approx(1.452072978709073, rel=1e-14)
    assert orbit.displacement == pytest.approx(0.2809109011943361, rel=1e-13)
    assert orbit.velocity_before == pytest.approx(-0.2420121631181788, rel=1e-13)
    assert orbit.velocity_after == pytest.approx(-0.09680486524727154, rel=1e-13)
    assert orbit.phase == pytest.approx(4.59047988735129 - math.pi / 2, rel=1e-13)
    assert orbit.amplitude == pytest.approx(0.3532853191886, rel=1e-12)
    parts = sorted((z.real, z.imag) for z in orbit.multipliers)
    for (re, im), truth in zip(
        parts,
        [
            (0.06222103944, -0.8045647798),
            (0.06222103944, 0.8045647798),
            (0.9217639412, -0.1307669925),
            (0.9217639412, 0.1307669925),
        ],
        strict=True,
    ):
        assert (re, im) == pytest.approx(truth, rel=1e-8)
    assert found.amplitude_without_absorber == pytest.approx(2.5, rel=1e-15)
    assert pickle.loads(pickle.dumps(found)) == found
    assert hash(found) == hash(pickle.loads(pickle.dumps(found)))


def test_an_unstable_orbit_and_none() -> None:
    siva = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=1.0)
    found = theory.masri_caughey(
        siva, iva.Primary(damping_ratio=0.01), iva.Harmonic(amplitude=0.2, frequency=1.0)
    )
    assert found.stable is None
    orbit = found.orbits[0]
    assert orbit is not None
    assert orbit.multipliers[0].real == pytest.approx(-2.56749605, rel=1e-8)
    wide = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=3.0)
    none = theory.masri_caughey(
        wide, iva.Primary(damping_ratio=0.005), iva.Harmonic(amplitude=0.02, frequency=1.0)
    )
    assert none.orbits == (None, None)
    assert none.largest_clearance == pytest.approx(2.015122467300952, rel=1e-13)


def test_a_run_in_si_units_stays_on_the_orbit() -> None:
    # The same scene with 3 kg at 7 rad/s: velocities times ωn, lengths the same, force in N.
    primary = iva.Primary(mass=3.0, natural_frequency=7.0, damping_ratio=0.02)
    force = iva.Harmonic(force=3.0 * 49.0 * 0.1, relative_frequency=1.0, phase=0.4)
    found = theory.masri_caughey(SIVA, primary, force)
    orbit = found.stable
    assert orbit is not None
    assert orbit.speed == pytest.approx(7.0 * 1.452072978709073, rel=1e-13)
    run = iva.simulate(SIVA, primary, start=orbit.start, force=force, cycles=200)
    gaps = run.impacts["time"].diff().drop_nulls().to_numpy()
    assert gaps == pytest.approx(math.pi / 7.0, rel=1e-9)
    assert run.summary["amplitude_max"].item() == pytest.approx(orbit.amplitude, rel=1e-10)
    assert run.summary["regime"].item() == "2:1"


def test_the_slow_manifold() -> None:
    # ρ = (2/π)(1 − e)/(1 + e) = 1/(2π) for e = 0.6; ξ² = (θ − 1)² + ρ²θ².
    siva = iva.Siva(mass_ratio=0.01, restitution=0.6, clearance=2.0)
    manifold = theory.slow_manifold(siva)
    rho = 0.5 / math.pi
    assert manifold.rho == pytest.approx(rho, rel=1e-15)
    assert manifold.activation_amplitude == pytest.approx(2 * rho / math.hypot(1, rho), rel=1e-15)
    assert manifold.stable_theta[1] == pytest.approx(math.pi**2 / (math.pi**2 - 4), rel=1e-15)
    assert manifold.largest_added_damping == pytest.approx(0.08 / math.pi, rel=1e-14)
    assert manifold.best_amplitude == pytest.approx(2 * rho, rel=1e-15)
    assert manifold.amplitude(1.0) == pytest.approx(rho, rel=1e-15)
    assert manifold.added_damping(1.0) == pytest.approx(0.08 / math.pi, rel=1e-14)
    assert manifold.admissible(1.0)
    in_mm = iva.Siva(mass=0.02, restitution=0.6, clearance_mm=2000)
    same = theory.slow_manifold(in_mm, iva.Primary(mass=2, frequency_hz=3))
    assert same.activation_amplitude == pytest.approx(manifold.activation_amplitude, rel=1e-15)
    assert same.largest_added_damping == pytest.approx(manifold.largest_added_damping, rel=1e-14)
    assert pickle.loads(pickle.dumps(manifold)) == manifold
    assert "scene" not in repr(manifold)
    assert hash(manifold) == hash(pickle.loads(pickle.dumps(manifold)))
    with pytest.raises(ValueError, match="theta = nan: give a number greater than 0"):
        manifold.amplitude(math.nan)


def test_an_offset_of_the_gap_moves_the_origin_of_y_only() -> None:
    # y counts from another point: the start is at y + offset, and nothing else is another.
    moved = replace(SIVA, gap_offset=0.75)
    found, same = (theory.masri_caughey(siva, PRIMARY, FORCE) for siva in (moved, SIVA))
    assert found.orbits[1] is same.orbits[1] is None
    orbit, other = found.stable, same.stable
    assert orbit is not None
    assert other is not None
    place = other.start.gap_displacement
    assert isinstance(place, float)
    start = replace(other.start, gap_displacement=0.75 + place)
    assert orbit == replace(other, start=start)
    run, plain = (
        iva.simulate(siva, PRIMARY, start=one.start, force=FORCE, cycles=30)
        for siva, one in ((moved, orbit), (SIVA, other))
    )
    assert run.summary["regime"].item() == "2:1"
    times, expected = (one.impacts["time"].to_list() for one in (run, plain))
    assert times == pytest.approx(expected, rel=1e-12)
    between = [10.1, 33.3, 150.0]
    y, from_middle = (one.at(between)["gap_displacement"] for one in (run, plain))
    assert (y - from_middle).to_list() == pytest.approx([0.75] * 3, rel=1e-11)
    in_mm = theory.masri_caughey(
        iva.Siva(mass_ratio=0.05, restitution=0.8, clearance=2.0, gap_offset_mm=-1500.0),
        iva.Primary(mass=3.0, natural_frequency=7.0, damping_ratio=0.02),
        iva.Harmonic(force=3.0 * 49.0 * 0.1, relative_frequency=1.0),
    ).stable
    assert in_mm is not None
    assert in_mm.start.gap_displacement == pytest.approx(place - 1.5, rel=1e-13)
    manifold, centred = (theory.slow_manifold(siva) for siva in (moved, SIVA))
    assert replace(manifold, scene=centred.scene) == centred


def test_what_cannot_be_answered() -> None:
    piva = iva.Piva(mass_ratio=0.1, restitution=0.6, clearance=1.0, frequency_ratio=0.4, length=4)
    with pytest.raises(TypeError, match=r"give an iva\.Siva"):
        theory.masri_caughey(piva, PRIMARY, FORCE)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"give an iva\.Harmonic"):
        theory.masri_caughey(SIVA, PRIMARY, iva.Impulse(velocity=1))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"primary = 3: give an iva\.Primary"):
        theory.slow_manifold(SIVA, 3)  # type: ignore[arg-type]
    relative = iva.Siva(mass_ratio=0.1, restitution=0.6, relative_clearance=1.0)
    rising = iva.Siva(
        mass_ratio=0.01, restitution=0.6, clearance=1.0, inclination_deg=30, gravity=1.0
    )
    with pytest.raises(ValueError, match=r"inclination_deg = 30: the theory is of a level motion"):
        iva.theory.slow_manifold(rising)
    unlike = replace(SIVA, restitution_minus=0.5)
    with pytest.raises(
        ValueError, match=r"restitution_minus = 0\.5: the theory is of one mass between two walls"
    ):
        theory.masri_caughey(unlike, PRIMARY, FORCE)
    with pytest.raises(ValueError, match="use clearance instead"):
        theory.slow_manifold(relative)
    with pytest.raises(ValueError, match="damping"):
        theory.masri_caughey(SIVA, iva.Primary(), FORCE)
    with pytest.raises(ValueError, match=r"force\.frequency is missing"):
        theory.masri_caughey(SIVA, PRIMARY, iva.Harmonic(amplitude=1))
