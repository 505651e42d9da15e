"""Design limits: units, nulls, sweeps, gradients, true errors, and the column `impulse`."""

from __future__ import annotations

import math
from typing import Any

import polars as pl
import pytest

import iva

DEFAULT = ("approach_speed_max", "impulse_max", "reduction_rms")
NAMED = ("acceleration_max", "gap_displacement_max", "stroke", "absorber_displacement_max")
ALL = (*DEFAULT, *NAMED)
EPS = 2.0**-52
START = iva.Start(displacement=1.0)
SIVA: dict[str, Any] = {"mass_ratio": 0.15, "restitution": 0.6, "clearance": 0.5}
PIVA: dict[str, Any] = {**SIVA, "frequency_ratio": 0.5, "length": 2.0, "inertia_ratio": 1.2}
HARMONIC = iva.Harmonic(amplitude=0.3, frequency=0.95)
BASE = iva.Harmonic(base_acceleration=0.3, frequency=0.95, phase=1.0)
QUAKE = iva.Recorded([0.5, 2.0, 3.0, 5.0], [0.4, 1.2, -0.9, 0.0], "base_acceleration")
ABSORBERS: dict[str, Any] = {
    "level": iva.Siva(**SIVA),
    "upright": iva.Siva(**SIVA, inclination_deg=90.0, gravity=0.3),
    "plastic": iva.Siva(**(SIVA | {"restitution": 0.0})),
    "pendulum": iva.Piva(**PIVA, contact_distance=2.5),
    "small": iva.Piva(**PIVA, contact_distance=2.5, angles="small"),
    "printed": iva.Piva(**PIVA, impact_law="printed"),
}
FORCES: dict[str, Any] = {"none": None, "force": HARMONIC, "base": BASE, "quake": QUAKE}


def simulate(absorber: Any, **run: Any) -> iva.Run:
    """Run it for 25 time units unless told otherwise, slightly damped."""
    given: dict[str, Any] = {"start": START, "duration": 25.0} | run
    return iva.simulate(absorber, given.pop("primary", iva.Primary(damping_ratio=0.03)), **given)


def values(run: Any, names: tuple[str, ...] = ALL) -> list[Any]:
    """Return some of the summary of a run, in the order of the names."""
    return list(run.summary.select(names).row(0))


def factor(kind: str) -> float:
    """Return |Δẋ| over |w| by the impact law: (L/b) μ(1+e)/(1+μ), as printed with Lθ̇ for w.

    At the stop of the printed one sin θ = 0.25, so that cos θ = √0.9375.
    """
    share = {"pendulum": 0.8, "small": 0.8, "printed": 1.0 / math.sqrt(0.9375)}.get(kind, 1.0)
    return float(share * 0.15 * (1.0 + ABSORBERS[kind].restitution) / 1.15)


@pytest.mark.parametrize("force", FORCES)
@pytest.mark.parametrize("kind", ABSORBERS)
def test_the_largest_impulse(kind: str, force: str) -> None:
    """M |Δẋ| of the rows, up to the rounding of the two velocities; M = 2.5 kg, ωn = 1 rad/s."""
    primary = iva.Primary(mass=2.5, natural_frequency=1.0, damping_ratio=0.03)
    run = simulate(ABSORBERS[kind], force=FORCES[force], primary=primary)
    hits, found = run.impacts, values(run, ALL[:2])
    assert hits.height > 3
    size = max(*hits["velocity_before"].abs(), 1.0)
    changes = max((hits["velocity_after"] - hits["velocity_before"]).abs())
    assert found[1] == pytest.approx(2.5 * changes, rel=0, abs=2.5 * 4 * EPS * size)
    largest = max(hits["approach_velocity"].abs())
    assert found[0] == largest
    assert found[1] == pytest.approx(2.5 * factor(kind) * largest, rel=8 * EPS)


@pytest.mark.parametrize("kind", ["level", "pendulum"])
def test_the_largest_of_the_rows(kind: str) -> None:
    """Contract: where nothing was summed, the columns are the largest of the rows, to the bit."""
    run = simulate(ABSORBERS[kind], duration=9.0)
    assert run.episodes.height == 0
    hits = run.impacts
    assert values(run, ALL[:1]) == [hits["approach_velocity"].abs().max()]
    # Also of a run that ended early, of which nothing else is known.
    short = simulate(ABSORBERS[kind], max_impacts=2, measures=ALL)
    hits = short.impacts
    assert (short.summary["outcome"].item(), hits.height) == ("impact_limit", 2)
    largest = max(hits["approach_velocity"].abs())
    impulse = pytest.approx(factor(kind) * largest, rel=8 * EPS)
    assert values(short) == [largest, impulse, *[None] * 5]


@pytest.mark.parametrize("kind", ABSORBERS)
def test_only_what_is_named(kind: str) -> None:
    """Contract: three columns by default, four only where named; naming does not change values."""
    given: dict[str, Any] = {"force": HARMONIC}
    plain, full = (simulate(ABSORBERS[kind], measures=m, **given) for m in (None, ALL))
    assert values(plain) == [*values(full, DEFAULT), *[None] * 4]
    assert None not in values(full)
    for name in ALL:
        alone = simulate(ABSORBERS[kind], measures=[name], **given)
        expected = [
            value if of == name else None for of, value in zip(ALL, values(full), strict=True)
        ]
        assert values(alone) == expected
    assert plain.summary.select(pl.exclude(NAMED)).columns == [
        name for name in full.summary.columns if name not in NAMED
    ]


UNITS = {
    "approach_speed_max": "m/s", "impulse_max": "N s", "reduction_rms": "1",
    "acceleration_max": "m/s²", "gap_displacement_max": "m", "stroke": "m",
    "absorber_displacement_max": "m",
}  # fmt: skip


@pytest.mark.parametrize("kind", ["level", "upright", "pendulum"])
def test_units(kind: str) -> None:
    """One scene three ways: M = 2 kg, ωn = 20/s, lengths in m. ω of speeds, ω² of accelerations."""
    omega, mass, absorber = 20.0, 2.0, ABSORBERS[kind]
    found = []
    for unit, structure in (
        (1.0, {}),
        (omega, {"natural_frequency": omega}),
        (omega, {"natural_frequency": omega, "mass": mass}),
    ):
        if kind == "upright":
            absorber = iva.Siva(**SIVA, inclination_deg=90.0, gravity=0.3 * unit**2)
        run = simulate(
            absorber,
            primary=iva.Primary(**structure, damping_ratio=0.03),
            force=iva.Harmonic(base_acceleration=0.3 * unit**2, relative_frequency=0.95, phase=1.0),
            duration=9.0 / unit,
            measures=ALL,
        )
        weight = structure.get("mass", 1.0)
        scales = (unit, weight * unit, 1.0, unit**2, 1.0, 1.0, 1.0)
        motion = run.at([3.0 / unit, 8.0 / unit])
        rows = [value / scale for value, scale in zip(values(run), scales, strict=True)]
        for name in ("acceleration", "absorber_acceleration"):
            rows += (motion[name] / unit**2).to_list()
        found.append(rows)
    assert len(found[0]) == 11
    assert found[1] == pytest.approx(found[0], rel=1e-11, abs=1e-12)
    assert found[2] == pytest.approx(found[0], rel=1e-11, abs=1e-12)
    assert {name: run.units["summary"][name] for name in ALL} == UNITS
    assert {
        run.units["trajectory"][name] for name in ("acceleration", "absorber_acceleration")
    } == {"m/s²"}


def test_units_without_a_mass() -> None:
    """Contract: an impulse per unit primary mass, which has the size of a velocity."""
    units = simulate(ABSORBERS["level"]).units
    assert "per unit primary mass" in units["summary"]["impulse_max"]
    assert units["summary"]["approach_speed_max"] == units["impacts"]["velocity_before"]
    assert units["summary"]["acceleration_max"] == units["summary"]["gravity"]
    assert units["summary"]["stroke"] == units["summary"]["amplitude_max"]


@pytest.mark.parametrize("force", FORCES)
@pytest.mark.parametrize("kind", ABSORBERS)
def test_a_sweep_is_its_runs(kind: str, force: str) -> None:
    """Contract: the bits of single runs, whatever runs side by side."""
    clearances = [0.2, 0.35, 0.5, 0.65, 0.8, 0.95, 1.1, 1.4, 1.7]
    given: dict[str, Any] = {"start": START, "duration": 25.0, "force": FORCES[force]}
    if force in {"force", "base"}:
        given["discard"] = 1.5
    absorber, primary = ABSORBERS[kind], iva.Primary(damping_ratio=0.03)
    over = {"clearance": clearances}
    plain = iva.sweep(absorber, primary, over=over, **given)
    named = iva.sweep(absorber, primary, over=over, measures=ALL, **given)
    assert plain.summary.select(NAMED).rows() == [(None,) * 4] * len(clearances)
    fields = {name: getattr(absorber, name) for name in type(absorber).__slots__}
    for point, clearance in enumerate(clearances):
        run = simulate(type(absorber)(**(fields | {"clearance": clearance})), measures=ALL, **given)
        assert list(plain.summary.select(DEFAULT).row(point)) == values(run, DEFAULT)
        assert list(named.summary.select(ALL).row(point)) == values(run)
    assert len(set(named.summary["approach_speed_max"])) > 5


@pytest.mark.parametrize("force", ["none", "force"])
def test_the_fast_tier(force: str) -> None:
    """Contract of `tolerance`: a summary that is off by some rounding units, times the chaos.

    Nine time units hold a few impacts, whose conditions are of the order of 10.
    """
    given: dict[str, Any] = {"force": FORCES[force], "duration": 9.0, "tables": []}
    for measures in (None, ALL):
        exact, fast = (
            simulate(iva.Siva(**SIVA), tolerance=tolerance, measures=measures, **given)
            for tolerance in (0.0, 1e-9)
        )
        for have, want in zip(values(fast), values(exact), strict=True):
            assert have == (None if want is None else pytest.approx(want, rel=1e-12))


def test_gradients_of_closed_forms() -> None:
    """Without damping from rest at X: the wall comes at the speed ωn √(d(2X − d)) =: ωn s.

    The impulse is μ(1+e)/(1+μ) ωn s; ẍ is at most ωn² X, the mass rests at X.
    """
    x, d, omega, mu, e = 1.2, 0.5, 2.0, 0.15, 0.6
    keys = ("start.displacement", "clearance", "natural_frequency", "mass_ratio", "restitution")
    s = math.sqrt(d * (2.0 * x - d))
    by = dict(zip(keys, (omega * d / s, omega * (x - d) / s, s, 0.0, 0.0), strict=True))
    share = mu * (1.0 + e) / (1.0 + mu)
    # It begins at rest at x: accelerations and the place of the mass are largest then.
    run = simulate(
        iva.Siva(**SIVA),
        primary=iva.Primary(natural_frequency=omega),
        start=iva.Start(displacement=x),
        duration=(math.acos(1.0 - d / x) + 0.01) / omega,
        measures=ALL,
        gradients=keys,
    )
    impulses = {key: share * slope for key, slope in by.items()}
    impulses["mass_ratio"] = (1.0 + e) / (1.0 + mu) ** 2 * omega * s
    impulses["restitution"] = mu / (1.0 + mu) * omega * s
    accelerations = {"start.displacement": omega**2, "natural_frequency": 2.0 * omega * x}
    for key in keys:
        found = run.gradients[key]
        expected = [by[key], impulses[key], None, accelerations.get(key, 0.0)]
        expected += [float(key == "clearance")] * 2 + [float(key == "start.displacement")]
        have = values(found)
        assert have.pop(2) is expected.pop(2) is None
        assert have == pytest.approx(expected, rel=1e-13, abs=1e-13), key


@pytest.mark.parametrize("kind", ["level", "upright", "pendulum", "small"])
@pytest.mark.parametrize("force", ["none", "force", "base", "quake"])
def test_gradients_are_those_of_differences(kind: str, force: str) -> None:
    """Central differences over ±1e-5 of each parameter, of runs with the same impacts.

    They are off by some 1e-10 of third derivatives, and by rounding, 1e-15/1e-5.
    """
    absorber, size = ABSORBERS[kind], 1e-5
    given: dict[str, Any] = {"force": FORCES[force], "duration": 7.0, "measures": ALL}
    fields = {name: getattr(absorber, name) for name in type(absorber).__slots__}
    run = simulate(absorber, gradients=("clearance", "mass_ratio"), **given)
    for key in ("clearance", "mass_ratio"):
        low, high = (
            simulate(type(absorber)(**(fields | {key: fields[key] + sign * size})), **given)
            for sign in (-1, 1)
        )
        assert run.impacts.height == low.impacts.height == high.impacts.height > 0
        slopes = values(run.gradients[key])
        for name, slope, a, b in zip(ALL, slopes, values(low), values(high), strict=True):
            if a is None:
                assert (name, slope) == ("reduction_rms", None)
                continue
            assert slope == pytest.approx((b - a) / (2.0 * size), rel=1e-5, abs=1e-6), name


@pytest.mark.parametrize("kind", ABSORBERS)
@pytest.mark.parametrize("force", FORCES)
def test_true_errors_are_those_of_rounding(kind: str, force: str) -> None:
    """A second run in numbers of twice the precision: values of the order of 1, few impacts."""
    run = simulate(ABSORBERS[kind], force=FORCES[force], duration=7.0, measures=ALL, verify=True)
    assert run.verification.agrees
    for value, error in zip(values(run), values(run.verification), strict=True):
        assert (value is None) == (error is None)
        assert abs(error or 0.0) < 1e-13


def test_what_is_asked_for_wrongly() -> None:
    """Contract of `measures`: an unknown column is refused; columns of other tables are none."""
    for name in ("acceleration", "impulse", "stroke_max"):
        with pytest.raises(ValueError, match=name):
            simulate(ABSORBERS["level"], measures=[name])
