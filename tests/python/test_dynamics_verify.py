"""Orbits to twice the precision: against the 30-digit references, and against themselves."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

import iva
from iva import dynamics

REFERENCE = Path(__file__).parents[1] / "reference"
MASSES = {one["id"]: one for one in json.loads((REFERENCE / "orbits.json").read_text())}
NAMES = ("displacement", "velocity", "gap_displacement", "gap_velocity")
PRIMARY = iva.Primary(damping_ratio=0.05)
FORCE = iva.Harmonic(amplitude=1.0, frequency=1.0)


def verified(record: dict[str, Any], *, verify: bool) -> dynamics.Orbit:
    """Return the orbit of a record, from a start beside it."""
    given = {name: float(value) for name, value in record["scene"].items()}
    siva = iva.Siva(**{key: given[key] for key in ("mass_ratio", "restitution", "clearance")})
    force = iva.Harmonic(amplitude=given["force_amplitude_per_mass"], frequency=given["frequency"])
    start = [float(record["state_at_time_0"][name]) + 1e-5 for name in NAMES]
    found = dynamics.orbit(
        siva,
        iva.Primary(damping_ratio=given["damping_ratio"]),
        force=force,
        start=start,
        periods=record["forcing_periods"],
        verify=verify,
    )
    assert isinstance(found, dynamics.Orbit)
    return found


@pytest.mark.parametrize("name", MASSES)
def test_states_and_impacts_are_those_of_the_references(name: str) -> None:
    record = MASSES[name]
    orbit = verified(record, verify=True)
    # The references have the decimals of the scene, a run the doubles next to them: that moves an
    # orbit by a few rounding units.
    close = 8 * 2.0**-53 * max(1.0, *(abs(value) for value in orbit.state))
    for value, key in zip(orbit.state, NAMES, strict=True):
        assert value == pytest.approx(float(record["state_at_time_0"][key]), rel=0, abs=close)
    if "episodes" not in record:
        for impact, (time, wall, _) in zip(orbit.impacts, record["impact_list"], strict=True):
            assert impact.time == pytest.approx(float(time), rel=0, abs=close)
            assert impact.wall == wall
    assert orbit.residual < 1e-20


@pytest.mark.parametrize("name", ["A1", "A3", "S1"])
def test_the_error_told_is_how_far_doubles_were_off(name: str) -> None:
    record = MASSES[name]
    plain, exact = (verified(record, verify=verify) for verify in (False, True))
    assert plain.state_error is None
    assert exact.state_error is not None
    assert 0 < exact.state_error < 50 * 2.0**-53
    assert plain.multipliers == exact.multipliers
    # At another phase of the force the error is another one, by the motion in between.
    off = math.dist(plain.state, exact.state)
    assert off < 100 * exact.state_error
    image = exact.mirror()
    assert image.walls == exact.walls.translate(str.maketrans("+-", "-+")) or exact.symmetric
    assert len(image.impacts) == len(exact.impacts)


def test_pendulums_and_units() -> None:
    piva = iva.Piva(mass=2.0, restitution=0.6, gap_mm=4.0, frequency_ratio=0.4, length=0.25)
    primary = iva.Primary(mass=20.0, stiffness=8000.0, damping_ratio=0.02)
    force = iva.Harmonic(amplitude=20.0, frequency=19.0)
    asked: dict[str, Any] = {"force": force, "start": iva.Start(gap_velocity=0.05), "settle": 300}
    plain = dynamics.orbit(piva, primary, **asked)
    exact = dynamics.orbit(piva, primary, verify=True, **asked)
    assert isinstance(plain, dynamics.Orbit)
    assert isinstance(exact, dynamics.Orbit)
    assert exact.residual < 1e-18
    assert exact.state == pytest.approx(plain.state, rel=1e-9)
    assert exact.walls == plain.walls
    assert exact.period == plain.period


def test_verify_is_a_truth_value() -> None:
    siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    with pytest.raises(TypeError, match="verify = 1: give True or False"):
        dynamics.orbit(siva, PRIMARY, force=FORCE, start=(0, 0, 0, 0.1), verify=1)  # type: ignore[arg-type]
