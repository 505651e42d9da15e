"""Lyapunov exponents: those of the references, units, regimes, what is refused."""

from __future__ import annotations

import json
import math
import pickle
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import iva
from iva import dynamics
from iva.dynamics.kinds import amplitude, burst_length

REFERENCE = Path(__file__).parents[1] / "reference"
RECORDS = {one["id"]: one for one in json.loads((REFERENCE / "exponents.json").read_text())}


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


@pytest.mark.parametrize("name", ["L1", "L2"])
def test_exponents_of_chaos_are_those_of_the_references(name: str) -> None:
    """Of ten runs of a million periods each, in another way: within four standard errors."""
    record = RECORDS[name]
    found = dynamics.lyapunov(**scene(record), cycles=4000, seed=3)
    pairs = zip(record["spectrum"], record["standard_error"], strict=True)
    for k, (true, error) in enumerate(pairs):
        within = 4.0 * math.hypot(found.standard_errors[k], error)
        assert abs(found.exponents[k] - true) < within < 0.01, k
    assert found.sum_error is not None
    assert abs(found.sum_error) < 1e-12
    assert found.sign == 1
    assert found.rides == 0
    assert found.cycles == 8 * 4000
    assert found.impacts_per_cycle == pytest.approx(record["impacts_per_period"], abs=0.01)
    dimension = record["kaplan_yorke_dimension_of_the_stroboscopic_map"]
    assert found.dimension == pytest.approx(dimension, abs=0.02)


def test_a_torus_has_the_exponent_0() -> None:
    """Around its unstable orbit; contraction in the torus takes many periods."""
    record = RECORDS["Q1"]
    x, v, y, w = record["centre_strobe"]
    around = (x + 0.1, v, y, w)
    found = dynamics.lyapunov(**scene(record), start=around, cycles=5000, discard=2000, seeds=2)
    assert found.sign == 0
    assert abs(found.exponents[0]) < 1e-4
    for one, true in zip(found.exponents[1:], record["spectrum"][1:], strict=True):
        assert one == pytest.approx(true, abs=1e-3)


def test_exponents_of_an_orbit_are_those_of_its_multipliers() -> None:
    """Ln |λ| over the period; in SI units per second."""
    mass, frequency = 3.0, 7.0
    parts: dict[str, Any] = {
        "absorber": iva.Siva(mass=0.2 * mass, restitution=0.7, clearance=4.5),
        "primary": iva.Primary(mass=mass, natural_frequency=frequency, damping_ratio=0.05),
        "force": iva.Harmonic(force=mass * frequency**2, frequency=frequency),
    }
    orbit = dynamics.orbit(**parts, start=(0, 0, 0, 0.7), settle=300)
    assert isinstance(orbit, dynamics.Orbit)
    found = dynamics.lyapunov(**parts, start=orbit, cycles=2000, seeds=2)
    for one, multiplier in zip(found.exponents, orbit.multipliers, strict=True):
        assert one == pytest.approx(math.log(abs(multiplier)) / orbit.period, abs=1e-2)
    assert found.sign == -1


def test_with_rides_two_exponents_are_lost() -> None:
    siva = iva.Siva(mass_ratio=0.1, restitution=0.5, clearance=0.25)
    force = iva.Harmonic(amplitude=1.0, frequency=0.7)
    primary = iva.Primary(damping_ratio=0.02)
    found = dynamics.lyapunov(siva, primary, force=force, cycles=200, seeds=2)
    assert found.rides > 0
    assert found.sum_error is None
    assert found.exponents[2:] == (-math.inf, -math.inf)


def test_what_a_spectrum_says_of_itself() -> None:
    parts = scene(RECORDS["L1"])
    settings: dict[str, Any] = {"cycles": 200, "seeds": 2}
    found = dynamics.lyapunov(**parts, **settings)
    assert repr(found).startswith("Spectrum: 0.")
    assert "impacts per period" in repr(found)
    assert pickle.loads(pickle.dumps(found)) == found
    assert dynamics.lyapunov(**parts, **settings) == found
    assert dynamics.lyapunov(**parts, **settings, seed=2).exponents != found.exponents
    # Amplitude without absorber: F/(2ζ) = 10 at Ω = 1.
    assert found.box == ((-10.0, 10.0), (-10.0, 10.0), (-3.85, 3.85), (-10.0, 10.0))


def test_regimes_are_those_of_the_references() -> None:
    def kinds(name: str, **settings: Any) -> list[tuple[str, str]]:
        found = dynamics.regimes(**scene(RECORDS[name]), starts=4, most_cycles=300, **settings)
        return [(one.kind, one.name) for one in found]

    assert kinds("L1", cycles=500) == [("chaotic", "chaotic")]


def test_a_response_beyond_the_torus_is_modulated() -> None:
    """Record M1 at clearance 7: .017 of the periods are without impact, λ₁ = .0789."""
    parts = scene(RECORDS["Q1"])
    parts["absorber"] = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=7.0)
    box = {"displacement": (-2, 2), "velocity": (-2, 2), "gap_displacement": (-6, 6)}
    box["gap_velocity"] = (-14, 14)
    found = dynamics.regimes(**parts, starts=4, most_cycles=500, cycles=500, box=box)
    [one] = [regime for regime in found if regime.kind == "modulated"]
    assert one.quiet == pytest.approx(0.01698, abs=0.006)
    # The record has 1.9696 for the rms displacement at four phases; harmonics make half a percent.
    assert one.amplitude is not None
    assert one.amplitude / math.sqrt(2) == pytest.approx(1.9696, rel=0.03)
    assert one.spectrum is not None
    assert one.spectrum.exponents[0] == pytest.approx(0.079, abs=0.03)


def test_bursts_are_counted_between_pauses() -> None:
    made: Any = SimpleNamespace(
        strobes=[(3.0, 8.0, 0.0, 0.0, hits) for hits in (1, 0, 2, 1, 0, 0, 1, 1, 3, 1, 0, 5)]
    )
    # Two whole bursts, of two and of four periods.
    assert burst_length(made) == 3.0
    assert amplitude(made, 2.0) == 5.0
    still: Any = SimpleNamespace(strobes=[(0.0, 0.0, 0.0, 0.0, 1)] * 5)
    assert burst_length(still) is None


def test_bad_input_is_one_sentence() -> None:
    def failing(match: str, **given: object) -> None:
        with pytest.raises((ValueError, TypeError), match=match):
            dynamics.lyapunov(**{**scene(RECORDS["L1"]), **given})

    failing("cycles", cycles=0)
    failing("seeds", seeds=0)
    failing("seed", seed=-1)
    failing("without a start", start=(0, 0, 0, 0), box={})
    failing("give a range for each", box={"displacement": (0, 1)})
    everywhere = dict.fromkeys(("displacement", "velocity", "gap_velocity"), (-9.0, 9.0))
    failing("gap", box={**everywhere, "gap_displacement": (-9.0, 9.0)})
    failing("smaller one first", box={**everywhere, "gap_displacement": (1.0, -1.0)})
    failing("force", force=iva.Impulse(velocity=1.0))


def test_ctrl_c_keeps_the_periods_that_were_run() -> None:
    """Four hundred runs, cut when the first four are finished."""
    told: list[tuple[int, int]] = []

    def interrupt(done: int, total: int) -> None:
        told.append((done, total))
        raise KeyboardInterrupt

    parts = scene(RECORDS["L1"])
    cut = dynamics.lyapunov(**parts, cycles=20_000, seeds=400, progress=interrupt)
    [(done, total)] = told
    assert 4 <= done < total == 400
    assert cut.outcome == "cancelled"
    assert 20_000 * done <= cut.cycles < 20_000 * total
    assert cut.sum_error is not None
    assert abs(cut.sum_error) < 1e-12
    # Four standard errors of each.
    whole = dynamics.lyapunov(**parts, cycles=2000)
    within = 4.0 * math.hypot(cut.standard_errors[0], whole.standard_errors[0])
    assert abs(cut.exponents[0] - whole.exponents[0]) < within
