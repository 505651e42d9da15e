"""The numbers of a scene come from the compiled part, whatever alternatives they were given by."""

from __future__ import annotations

import math
from typing import Any

import pytest

import iva
from iva.design import design_of

START = iva.Start(displacement_mm=20.0)


def of(absorber: Any, primary: iva.Primary, **more: Any) -> Any:
    return design_of(iva.simulate(absorber, primary, start=START, periods=0.5, **more))


def test_a_free_mass_of_stiffness_and_play() -> None:
    primary = iva.Primary(mass=50.0, stiffness=2e4, damping=40.0)
    found = of(iva.Siva(mass=5.0, gap_mm=12.0, restitution=0.5), primary)
    assert (found.mass, found.natural_frequency) == (50.0, 20.0)
    assert found.damping_ratio == pytest.approx(0.02, rel=1e-15)
    assert (found.mass_ratio, found.clearance) == (0.1, pytest.approx(0.006, rel=1e-15))
    assert found.pendulum is None
    assert found.beside({"gap_displacement": 0.2, "gap_velocity": 3.0}) == (0.2, 3.0)


def test_a_free_mass_under_force_has_no_pendulum() -> None:
    primary = iva.Primary(mass=50.0, frequency_hz=2.0)
    siva = iva.Siva(mass_ratio=0.1, relative_clearance=0.5, restitution=0.5)
    found = of(siva, primary, force=iva.Harmonic(amplitude=1.0, frequency_hz=2.0))
    assert found.pendulum is None
    assert found.natural_frequency == pytest.approx(4.0 * math.pi, rel=1e-15)
    assert found.clearance == pytest.approx(0.01, rel=1e-15)


def test_length_and_gravity_of_a_pendulum() -> None:
    primary = iva.Primary(mass=50.0, natural_frequency=20.0)
    common: dict[str, Any] = {"mass_ratio": 0.1, "clearance": 0.01, "restitution": 0.5}
    pendulum = of(iva.Piva(length=0.4, inertia_ratio=1.2, **common), primary).pendulum
    assert pendulum.frequency == pytest.approx(math.sqrt(9.80665 / (1.2 * 0.4)), rel=1e-15)
    assert (pendulum.length, pendulum.contact_distance) == (0.4, 0.4)
    pendulum = of(iva.Piva(frequency_ratio=0.5, gravity=9.0, **common), primary).pendulum
    assert pendulum.frequency == 10.0
    assert pendulum.length == pytest.approx(0.09, rel=1e-15)
    pendulum = of(iva.Piva(frequency_ratio=0.5, angles="small", **common), primary).pendulum
    assert (pendulum.length, pendulum.lever, pendulum.small) == (None, 1.0, True)
