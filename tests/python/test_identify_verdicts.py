"""What iva.identify says of records that are no decay with impacts, and of hard ones that are."""

from __future__ import annotations

import numpy as np
import pytest

import iva
from planted_decays import Chain, Planted, Truth, flights, law_of, record

pytest.importorskip("dynesty")
from iva.identification import Fit, identify
from iva.identification.adequacy import cut_off

RIG = Truth(release=0.25, gap_displacement=0.2e-3)
OMEGA = 2 * np.pi * 5.0
BARE = r"^record: no impact is found in it; .* the motion is that of the structure alone \(5"


def bare(time: np.ndarray, order: int) -> np.ndarray:
    """Return displacement, velocity or acceleration of 6 mm exp(−0.25 t) cos(2π 5 t)."""
    rate = complex(-0.25, OMEGA)
    made: np.ndarray = (6e-3 * rate**order * np.exp(rate * time)).real
    return made


def said(values: np.ndarray, rate: float, quantity: str, absorber: object = None) -> str:
    """Return what is said of a record that is let go at its first sample."""
    made = iva.Measured(np.arange(values.size) / rate, values, quantity)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^record") as caught:
        identify(made, absorber or iva.Siva(), iva.Primary(), start=iva.Start(time=0.0))  # type: ignore[arg-type]
    return str(caught.value)


@pytest.mark.parametrize("noise", [0.0, 1e-4, 1e-3])
def test_a_structure_alone_is_named(noise: float) -> None:
    time = np.arange(2048) / 1024
    values = bare(time, 1) + noise * np.random.default_rng(0).standard_normal(time.size)
    assert "the motion is that of the structure alone (5 Hz" in said(values, 1024, "velocity")


def test_a_beam_with_three_modes_is_a_structure_alone() -> None:
    # At 350 Hz a mode looks like pulses to a search that does not know it.
    time = np.arange(20000) / 2048
    values = bare(time, 2) + 0.02 * np.random.default_rng(1).standard_normal(time.size)
    for hertz, size in ((31.5, 2.0), (350.0, 1.0)):
        values = values + size * np.exp(-0.02 * hertz * time) * np.sin(2 * np.pi * hertz * time)
    assert "the motion is that of the structure alone (5 Hz" in said(values, 2048, "acceleration")


def test_what_does_not_decay_is_named() -> None:
    time = np.arange(4096) / 1024
    values = np.sin(OMEGA * time) + 0.01 * np.random.default_rng(2).standard_normal(time.size)
    values[[700, 1200, 2222, 3100]] += 4.0
    assert "it is not a decay" in said(values, 1024, "acceleration")


def test_a_second_event_is_named() -> None:
    made = record(RIG, Chain(seed=31, seconds=3.0))
    twice = np.concatenate([made.values, made.values[512:]])
    words = said(twice[512:], 2048, "acceleration")
    assert "its motion begins anew at about" in words
    assert float(words.split("about ")[1].split(" s")[0]) == pytest.approx(2.75, abs=0.6)


def test_an_acceleration_without_pulses_has_no_impacts() -> None:
    # What a run has at its instants: the smooth motion, without the pulses of the contacts.
    siva = iva.Siva(mass_ratio=0.1, restitution=0.6, gap_mm=9.0)
    primary = iva.Primary(mass=3.0, frequency_hz=5.0, damping_ratio=0.008)
    run = iva.simulate(siva, primary, start=iva.Start(displacement_mm=8.0), duration=4.0)
    values = run.at(np.arange(4000) / 1024)["acceleration"].to_numpy()
    values = values + 0.03 * np.random.default_rng(3).standard_normal(values.size)
    assert said(values, 1024, "acceleration").endswith("with the pulses of its contacts")


def values_of(fit: Fit) -> dict[str, float]:
    """Return the value of each number."""
    return dict(fit.parameters.select("parameter", "value").iter_rows())


@pytest.mark.parametrize(
    ("rate", "noise"), [(2048.0, 0.0), (1024.0, 1e-3), (1024.0, 1e-5), (1024.0, 0.0)]
)
def test_a_velocity_of_any_noise_will_do(rate: float, noise: float) -> None:
    # A velocity of steps, as a run has it; less noise must not be worse.
    siva = iva.Siva(mass_ratio=0.1, restitution=0.6, gap_mm=9.0)
    primary = iva.Primary(mass=3.0, frequency_hz=5.0, damping_ratio=0.008)
    run = iva.simulate(siva, primary, start=iva.Start(displacement_mm=8.0), duration=2.0)
    time = np.arange(int(2 * rate)) / rate
    values = run.at(time)["velocity"].to_numpy()
    values = values + noise * np.random.default_rng(1).standard_normal(time.size)
    made = iva.Measured(time, values, "velocity")
    fit = identify(made, iva.Siva(), iva.Primary(), start=iva.Start(time=0.0))
    assert fit.adequate, fit.reasons
    assert fit.impacts.height == run.impacts.height
    found = values_of(fit)
    assert found["mass_ratio"] == pytest.approx(0.1, rel=0.02)
    assert found["gap_mm"] == pytest.approx(9.0, rel=0.02)
    assert found["damping_ratio"] == pytest.approx(0.008, rel=0.05)


@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_few_samples_a_period_are_enough(noise: float) -> None:
    # 400 Hz: some 75 samples a period, and impacts that are 15 samples apart.
    chain = Chain(seed=32, seconds=3.0, sampling_hz=400.0, noise=noise, bit=0.0)
    made = record(Truth(), chain)
    fit = identify(made, iva.Siva(), iva.Primary(), start=iva.Start(time=0.0))
    found = values_of(fit)
    assert found["mass_ratio"] == pytest.approx(RIG.mass_ratio, rel=0.03)
    assert found["gap_mm"] == pytest.approx(RIG.gap * 1e3, rel=0.03)
    assert fit.impacts.height > 0.8 * len(made.impacts)


def test_values_that_are_cut_off_are_named() -> None:
    made = record(RIG, Chain(seed=33, seconds=2.0))
    limit = 0.5 * np.max(np.abs(made.values))
    cut = np.clip(made.values, -limit, limit)
    short = Planted(made.time, cut, made.quantity, made.sampling_hz, made.truth)
    fit = identify(short, iva.Siva(), iva.Primary())
    assert any("values are cut off at" in reason for reason in fit.reasons)
    assert cut_off(made.values) == []
    # The top of a wave that a coarse recorder has rounded is no such end.
    assert cut_off(np.round(10 * np.sin(np.arange(4000) / 50)) / 10) == []


def test_impacts_that_do_not_follow_are_a_result() -> None:
    # A mode of its own beats with the structure; its motion is in no impact.
    made = record(RIG, Chain(seed=34, seconds=2.0))
    after = np.maximum(made.time - RIG.release, 0.0)
    beat = 3.0 * np.exp(-0.3 * after) * np.sin(2 * np.pi * 6.0 * after)
    both = Planted(made.time, made.values + beat, made.quantity, made.sampling_hz, made.truth)
    fit = identify(both, iva.Siva(), iva.Primary())
    assert not fit.adequate
    assert np.all(np.isfinite(fit.parameters["value"].to_numpy()))


def test_the_impacts_of_a_planted_record_are_those_of_its_chain() -> None:
    made = record(RIG, Chain(seed=35, seconds=1.0, contact=1e-3))
    fit = identify(made, iva.Siva(), iva.Primary())
    assert fit.chain.startswith("a filter of linear phase, its corner near ")
    count = len(flights(RIG, 0.75, law_of(RIG, np.random.default_rng(0))))
    assert fit.impacts.height == count
