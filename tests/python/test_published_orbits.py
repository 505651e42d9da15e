"""Branches of orbits of which a publication has an exact solution.

S. F. Masri and T. K. Caughey (J. Appl. Mech. 33 (1966) 586-592) solve the motion with two impacts
in a period, S. F. Masri (J. Appl. Mech. 40 (1973) 127-132) that on a structure with many modes,
C. N. Bapat and S. Sankar (J. Sound Vib. 103 (1985) 457-469) that of units which move in step.
J. P. Den Hartog (Trans. ASME 53 (1931) APM-53-9) solves the forced vibration of a mass on a spring
with Coulomb friction. The formulas are derived anew here, in the notation of this package.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import iva
from iva import dynamics


@dataclass(frozen=True)
class Modes:
    """A structure: its frequencies, damping ratios, and shapes at the absorber and at the force."""

    frequencies: tuple[float, ...]
    damping_ratios: tuple[float, ...]
    absorber: tuple[float, ...]
    force: tuple[float, ...]


ONE = Modes((1.0,), (0.05,), (1.0,), (1.0,))
TWO = Modes((1.0, 2.7), (0.05, 0.03), (1.0, 0.6), (0.5, -0.8))


def approach_speed(
    modes: Modes, drive: float, mass: float, restitution: float, clearance: float
) -> float:
    """Return the approach speed of the symmetric motion with two impacts a period under cos Ωt.

    Impacts change the rates of the modes by φ P in turn, which they answer by φ·q and φ·q̇ in
    proportion to P just before; the mass moves uniformly in between, so that −2 μ u = P and
    u T/2 = −2 (x + d). With the law of impact x and ẋ by the force alone are linear in P, and
    their squares add up to that of the amplitude: a quadratic equation, whose larger root it is.
    """
    period = 2.0 * np.pi / drive
    place, rate, transfer = 0.0, 0.0, 0j
    for omega, zeta, phi, forced in zip(
        modes.frequencies, modes.damping_ratios, modes.absorber, modes.force, strict=True
    ):
        decay, turn = zeta * omega, omega * np.sqrt(1.0 - zeta * zeta)
        c, s = np.cos(turn * period / 2), np.sin(turn * period / 2) / turn
        flow = np.array([[c + decay * s, s], [-omega * omega * s, c - decay * s]])
        flow *= np.exp(-decay * period / 2)
        before = -np.linalg.solve(np.eye(2) + flow, flow @ [0.0, phi])
        place, rate = place + phi * before[0], rate + phi * before[1]
        transfer += phi * forced / (omega**2 - drive**2 + 2j * zeta * omega * drive)
    whole = sum(phi * phi for phi in modes.absorber)
    of_rate = -((1.0 - restitution) / (2.0 * mass) + whole) / (1.0 + restitution)
    a, b = period / (8.0 * mass) - place, (of_rate - rate) / drive
    roots = np.roots([a * a + b * b, -2.0 * a * clearance, clearance**2 - abs(transfer) ** 2])
    return max(float(impulse) * (0.5 / mass - of_rate) for impulse in roots.real)


def speeds_agree(branch: dynamics.Branch, modes: Modes, mass: float, unit: float = 1.0) -> None:
    """Check the approach speeds of all points."""
    table = branch.table
    exact = [approach_speed(modes, 1.0, mass, 0.6, value * unit) for value in table["value"]]
    assert table.height > 40
    np.testing.assert_allclose(table["approach_speed_min"], exact, rtol=1e-13)


def test_two_masses_in_step_are_one() -> None:
    units = [iva.Siva(mass_ratio=0.05, restitution=0.6, clearance=4.5)] * 2
    orbit = dynamics.orbit(
        units,
        iva.Primary(damping_ratio=0.05),
        force=iva.Harmonic(amplitude=1.0, frequency=1.0),
        start=iva.Start(gap_velocity=0.1),
        settle=400,
        symmetric=True,
    )
    assert isinstance(orbit, dynamics.Orbit)
    branch = dynamics.follow(orbit, over="clearance", between=(4.0, 8.0))
    assert isinstance(branch, dynamics.Branch)
    assert branch.ends == ("range", "range")
    speeds_agree(branch, ONE, 0.1)


def test_a_mass_on_two_modes() -> None:
    structure = iva.Structure(
        frequencies=TWO.frequencies,
        damping_ratios=TWO.damping_ratios,
        points={"top": TWO.absorber, "middle": TWO.force},
        absorber_at="top",
        force_at="middle",
    )
    orbit = dynamics.orbit(
        iva.Siva(mass=0.1, restitution=0.6, clearance_mm=2500.0),
        structure,
        force=iva.Harmonic(force=1.0, frequency=1.0),
        start=iva.Start(gap_velocity=0.1),
        settle=400,
        symmetric=True,
    )
    assert isinstance(orbit, dynamics.Orbit)
    branch = dynamics.follow(orbit, over="clearance_mm", between=(2000.0, 4000.0))
    assert isinstance(branch, dynamics.Branch)
    speeds_agree(branch, TWO, 0.1, 1e-3)


@pytest.mark.parametrize(("drive", "tuned"), [(0.8, 1.25), (1.3, 1.0), (0.9, 0.7)])
def test_a_mass_that_friction_holds_at_times(drive: float, tuned: float) -> None:
    """A structure that a light mass does not move shakes it: its amplitude, and where it pauses.

    With the base acceleration A, the ratio β of the drive to the frequency of the spring,
    V = 1/(1 − β²) and U = sin(π/β)/(β (1 + cos(π/β))) the amplitude is (A²V² − R²U²)^½ over the
    square of that frequency, up to the friction R at which it is R/(β² · that square).
    """
    clearance, light = 50.0, 1e-13
    structure = iva.Primary(damping_ratio=0.05)
    moved = 1.0 / abs(1.0 - drive**2 + 0.1j * drive)
    shaken = moved * drive**2
    beta = drive / tuned
    v, u = 1.0 / (1.0 - beta**2), np.sin(np.pi / beta) / (beta * (1.0 + np.cos(np.pi / beta)))
    pauses = shaken * abs(v) / np.hypot(u, beta**-2)

    def rubbing(friction: float) -> dynamics.Orbit:
        found = dynamics.orbit(
            iva.Siva(
                mass_ratio=light,
                restitution=0.5,
                clearance=clearance,
                spring_ratio=tuned,
                friction=friction,
                gravity=1.0,
            ),
            structure,
            force=iva.Harmonic(amplitude=1.0, frequency=drive),
            start=iva.Start(displacement=moved, gap_velocity=0.3),
            settle=300,
            symmetric=True,
        )
        assert isinstance(found, dynamics.Orbit)
        return found

    def followed(friction: float) -> dynamics.Branch:
        branch = dynamics.follow(
            rubbing(friction), over="friction", between=(0.2 * pauses, 1.1 * pauses)
        )
        assert isinstance(branch, dynamics.Branch)
        return branch

    slides = followed(0.5 * pauses)
    assert slides.ends == ("range", "slide_changes")
    friction = slides.table["value"].to_numpy()
    assert abs(friction[-1] / pauses - 1.0) < 1e-9
    exact = np.sqrt((shaken * v) ** 2 - (friction * u) ** 2) / tuned**2
    np.testing.assert_allclose(clearance - slides.table["grazing_margin"], exact, rtol=1e-11)
    # From the other side: the motion in which it is held twice a period.
    held = followed(1.05 * pauses)
    assert held.ends == ("slide_changes", "range")
    assert abs(held.table["value"][0] / pauses - 1.0) < 1e-9
