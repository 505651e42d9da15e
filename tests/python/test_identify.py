"""Parameters from records with planted truth.

The records are made without iva (planted_decays, planted_pendulums): closed flights, or Runge and
Kutta's steps, through an own chain of sensors. Intervals are of 90 %; a test asks that the truth
lies within twice the interval, which a right fit misses once in 1000 numbers, and that the interval
is narrow where the record tells.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

import iva
from planted_decays import Chain, Planted, Truth, flights, law_of, record
from planted_pendulums import Laser, laser

pytest.importorskip("dynesty")
from iva.identification import Fit, identify

RIG = Truth(release=0.25, gap_displacement=0.2e-3, scatter=0.03)
SCALES = {"gap": 1e3, "displacement": 1e3, "gap_displacement": 1e3}


def truths(truth: Truth) -> dict[str, float]:
    """Return the truth by the names of the rows of a fit."""
    return {
        "frequency_hz": truth.frequency_hz,
        "damping_ratio": truth.damping_ratio,
        "mass_ratio": truth.mass_ratio,
        "restitution": truth.restitution,
        "gap_mm": truth.gap * 1e3,
        "displacement_mm": truth.displacement * 1e3,
        "gap_displacement_mm": truth.gap_displacement * 1e3,
        "release_s": truth.release,
    }


def row(fit: Fit, name: str) -> tuple[float, float, float, str]:
    """Return value, low, high and what determined a number."""
    found = fit.parameters.filter(pl.col("parameter") == name).row(0)
    return found[1], found[2], found[3], found[4]


def holds(fit: Fit, wanted: dict[str, float]) -> None:
    """Check that twice the interval holds each truth."""
    for name, truth in wanted.items():
        value, low, high, by = row(fit, name)
        if by != "given":
            assert 2 * low - value <= truth <= 2 * high - value, (name, truth, value, low, high)


def within(fit: Fit, wanted: dict[str, float], **limits: float) -> None:
    """Check that values are near the truth, relative."""
    for name, limit in limits.items():
        assert abs(row(fit, name)[0] / wanted[name] - 1) < limit, name


@pytest.fixture(scope="module")
def plain() -> tuple[Planted, Fit]:
    made = record(RIG, Chain(seed=21, seconds=2.0))
    return made, identify(made, iva.Siva(), iva.Primary())


def test_a_free_mass_is_found(plain: tuple[Planted, Fit]) -> None:
    made, fit = plain
    wanted = truths(made.truth)
    holds(fit, wanted)
    within(
        fit,
        wanted,
        frequency_hz=1e-3,
        damping_ratio=0.1,
        mass_ratio=0.03,
        restitution=0.05,
        gap_mm=0.03,
    )
    assert fit.adequate
    assert fit.combinations == ()
    assert set(fit.parameters["determined_by"]) == {"record"}


def test_each_impact_is_found(plain: tuple[Planted, Fit]) -> None:
    made, fit = plain
    assert fit.impacts.height == len(made.impacts)
    for name, key, margin in (
        ("jump", "jump", 1e-3),
        ("restitution", "restitution", 0.05),
    ):
        wanted = np.array([impact[key] for impact in made.impacts])
        found = fit.impacts[name].to_numpy()
        large = np.array([abs(impact["approach"]) for impact in made.impacts]) > 0.05
        assert np.max(np.abs(found - wanted)[large]) < margin, name
    instants = np.array([impact["time"] for impact in made.impacts]) + made.truth.release
    assert np.max(np.abs(fit.impacts["time"].to_numpy() - instants)) < 5e-5
    walls = np.sign([impact["approach"] for impact in made.impacts])
    assert fit.impacts["wall"].to_list() == walls.tolist()


def test_the_residual_is_the_noise(plain: tuple[Planted, Fit]) -> None:
    _, fit = plain
    used = fit.mask
    assert fit.noise == pytest.approx(0.05, rel=0.05)
    assert np.std(fit.residual[used]) == pytest.approx(0.05, rel=0.05)
    inside = (fit.values > fit.low) & (fit.values < fit.high)
    assert 0.87 < np.mean(inside[used]) < 0.93


def test_the_run_is_of_the_same_rig(plain: tuple[Planted, Fit]) -> None:
    made, fit = plain
    run = fit.run
    assert run.summary["outcome"].item() == "finished"
    first = run.impacts["time"][0]
    assert first == pytest.approx(made.impacts[0]["time"] + made.truth.release, abs=1e-3)


def test_the_same_seed_gives_the_same_fit() -> None:
    made = record(RIG, Chain(seed=22, seconds=0.7))
    one, two = (identify(made, iva.Siva(), iva.Primary(), seed=5) for _ in range(2))
    assert one.parameters.equals(two.parameters)
    assert one.impacts.equals(two.impacts)


def test_what_the_sensor_adds_is_told_apart() -> None:
    chain = Chain(
        seed=23,
        seconds=2.5,
        high_pass_hz=0.3,
        offset=0.4,
        drift=0.1,
        hum=0.02,
        ringing=(71.0, 0.015, 0.15),
        noise=0.04,
    )
    made = record(replace(RIG, displacement=-7.9e-3), chain)
    made = replace(made, time=made.time + 12.4)  # the clock of the recorder
    fit = identify(made, iva.Siva(), iva.Primary())
    wanted = truths(made.truth) | {"release_s": 12.65}
    holds(fit, wanted)
    within(fit, wanted, frequency_hz=1e-3, damping_ratio=0.1, mass_ratio=0.03, gap_mm=0.03)
    assert fit.adequate
    assert any("71 Hz" in note for note in fit.notes)


def test_one_impact_leaves_two_directions_open() -> None:
    truth = replace(RIG, gap=31e-3)
    free = flights(truth, 3.0, law_of(truth, np.random.default_rng(4)))
    seconds = truth.release + free[1]["time"] - 0.02
    made = record(truth, Chain(seed=4, seconds=seconds))
    assert len(made.impacts) == 1
    fit = identify(made, iva.Siva(), iva.Primary())
    # The first impact is on the wall +1: d − y₀ is known there.
    assert made.impacts[0]["approach"] > 0
    assert set(fit.combinations) == {
        "only clearance − rest position is determined",
        "only mass_ratio (1 + restitution) / (1 + mass_ratio) is determined",
    }
    for name, least in (("restitution", 0.5), ("gap_mm", 15.0), ("gap_displacement_mm", 8.0)):
        _, low, high, by = row(fit, name)
        assert high - low > least, name
        assert by == "prior", name
    # Nothing is said of restitution: its interval is that of the flat prior from 0 to 1.
    assert row(fit, "restitution")[1:3] == pytest.approx((0.05, 0.95), abs=0.05)
    draws = fit.draws
    distance = draws["gap_mm"] / 2 - draws["gap_displacement_mm"]
    assert np.quantile(distance.to_numpy(), [0.05, 0.95]) == pytest.approx(15.3, abs=0.6)


def test_a_rest_position_that_is_set_closes_one_direction() -> None:
    truth = replace(RIG, gap=31e-3)
    free = flights(truth, 3.0, law_of(truth, np.random.default_rng(4)))
    made = record(truth, Chain(seed=4, seconds=truth.release + free[1]["time"] - 0.02))
    fit = identify(
        made,
        iva.Siva(),
        iva.Primary(),
        start=iva.Start(gap_displacement=0.2e-3),
        known={"mass_ratio": iva.sampling.Normal(0.094, 0.001)},
    )
    assert row(fit, "gap_displacement_mm")[3] == "given"
    assert row(fit, "gap_displacement_mm")[:3] == pytest.approx((0.2, 0.2, 0.2))
    assert row(fit, "gap_mm")[3] == "record"
    assert row(fit, "mass_ratio")[3] == "prior"
    holds(fit, truths(truth))
    within(fit, truths(truth), gap_mm=0.02)


def test_restitution_that_falls_with_speed_is_no_model() -> None:
    made = record(
        replace(RIG, restitution=0.72, falling=0.25, scatter=0.03), Chain(seed=24, seconds=2.5)
    )
    fit = identify(made, iva.Siva(), iva.Primary())
    assert not fit.adequate
    assert any(reason.startswith("restitution falls with speed") for reason in fit.reasons)
    assert "not adequate" in repr(fit)


def test_a_pendulum_is_found() -> None:
    truth = Truth(1.83, 0.0113, 0.118, 0.55, 77.5e-3, 31e-3, release=0.2537, scatter=0.03)
    made = laser(truth, 0.41, Laser(seed=25, seconds=6.0))
    fit = identify(made, iva.Piva(), iva.Primary())
    wanted = truths(truth) | {"frequency_ratio": 0.41}
    holds(fit, wanted)
    within(fit, wanted, frequency_hz=1e-3, frequency_ratio=0.01, gap_mm=0.01, mass_ratio=0.02)
    assert fit.adequate
    assert fit.impacts.height == len(made.impacts)
    assert fit.run.impacts["time"][0] == pytest.approx(made.impacts[0]["time"] + 0.2537, abs=2e-3)


def test_a_first_impact_that_is_too_small_to_be_seen_is_found() -> None:
    truth = Truth(
        2.7873, 0.01034, 0.08823, 0.4555, 59.446e-3, 20.0e-3, release=0.39476, scatter=0.03
    )
    made = laser(truth, 0.4532, Laser(seed=1026, seconds=6.0))
    assert abs(made.impacts[0]["jump"]) < 0.15 * abs(made.impacts[1]["jump"])
    fit = identify(made, iva.Piva(), iva.Primary())
    holds(fit, truths(truth) | {"frequency_ratio": 0.4532})
    assert fit.adequate
    assert fit.impacts.height == len(made.impacts)


def test_no_impact_is_said() -> None:
    made = record(replace(RIG, gap=60e-3), Chain(seed=26, seconds=2.0))
    with pytest.raises(ValueError, match=r"^record: no impact is found in it; give a record"):
        identify(made, iva.Siva(), iva.Primary())


def test_a_record_too_short_is_said() -> None:
    made = record(RIG, Chain(seed=27, seconds=0.4))
    with pytest.raises(ValueError, match=r"^record: it ends .* s after the release, less than"):
        identify(made, iva.Siva(), iva.Primary())
    few = replace(made, time=made.time[:50], values=made.values[:50])
    with pytest.raises(ValueError, match=r"^record: it has 50 samples; give at least 200$"):
        identify(few, iva.Siva(), iva.Primary())


def test_a_release_before_the_record_is_asked_for() -> None:
    made = record(RIG, Chain(seed=28, seconds=2.0))
    later = made.time > 0.75 / made.truth.frequency_hz + made.truth.release
    cut = replace(made, time=made.time[later], values=made.values[later])
    with pytest.raises(ValueError, match=r"^start.time = None: the record begins in motion"):
        identify(cut, iva.Siva(), iva.Primary())


def test_a_quantity_that_does_not_tell_is_refused() -> None:
    made = record(RIG, Chain(seed=29, seconds=0.8, quantity="displacement", noise=5e-6, bit=1e-6))
    with pytest.raises(ValueError, match=r"of a free mass give an acceleration or a velocity$"):
        identify(made, iva.Siva(), iva.Primary())
    other = replace(made, quantity="acceleration")
    with pytest.raises(ValueError, match=r"of a pendulum give a displacement or a velocity$"):
        identify(other, iva.Piva(), iva.Primary())


def test_a_velocity_tells_as_well() -> None:
    made = record(RIG, Chain(seed=15, seconds=2.0, quantity="velocity", noise=1e-3, bit=1e-4))
    fit = identify(made, iva.Siva(), iva.Primary())
    wanted = truths(made.truth)
    holds(fit, wanted)
    within(fit, wanted, frequency_hz=1e-3, mass_ratio=0.03, gap_mm=0.03)


@pytest.mark.parametrize(
    ("known", "sentence"),
    [
        ({"mas_ratio": iva.sampling.Uniform(0, 1)}, "did you mean `mass_ratio`?"),
        (
            {"restitution": 0.5},
            "known\\['restitution'\\] = 0.5: give a distribution of iva.sampling",
        ),
        ({"restitution": iva.sampling.Uniform(2, 3)}, "give one that allows possible values"),
        ({"gap_mm": iva.sampling.Uniform(8, 9)}, "this number is set already; leave out one"),
    ],
)
def test_what_is_known_is_checked(known: dict[str, object], sentence: str) -> None:
    made = record(RIG, Chain(seconds=0.6))
    with pytest.raises((ValueError, TypeError), match=sentence):
        identify(made, iva.Siva(clearance=5e-3), iva.Primary(), known=known)  # type: ignore[arg-type]


def test_what_is_not_fitted_is_refused() -> None:
    made = record(RIG, Chain(seconds=0.6))
    with pytest.raises(ValueError, match=r"^absorber.restitution_minus = 0.5: leave it out"):
        identify(made, iva.Siva(restitution=0.6, restitution_minus=0.5), iva.Primary())
    with pytest.raises(ValueError, match=r"^start.impulse = 1.0: give primary.mass too"):
        identify(made, iva.Siva(), iva.Primary(), start=iva.Start(impulse=1.0))
    blow = iva.Start(impulse_velocity=0.3)
    for absorber in (None, iva.Piva()):
        with pytest.raises(ValueError, match=r"^start.impulse_velocity: .* with a free mass only"):
            identify(made, absorber, iva.Primary(), start=blow)
    known = {"displacement_mm": iva.sampling.Uniform(1, 2)}
    with pytest.raises(ValueError, match=r"^start.displacement: .* is at rest at 0 before"):
        identify(made, iva.Siva(), iva.Primary(), start=blow, known=known)
    with pytest.raises(ValueError, match=r"^start.velocity = 0.1: it must be 0"):
        identify(made, iva.Siva(), iva.Primary(), start=iva.Start(velocity=0.1))
    with pytest.raises(TypeError, match=r"^absorber = 3: give an iva.Siva, an iva.Piva, or None"):
        identify(made, 3, iva.Primary())  # type: ignore[arg-type]
