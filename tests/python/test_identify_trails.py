"""How far the impacts of a free mass are followed: instants, impacts that hide, interruptions.

The records are made without iva (planted_decays); their chains and noise are named at each test.
"""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest

import iva
from planted_decays import Chain, Planted, Truth, flights, law_of, record

pytest.importorskip("dynesty")
from iva.identification import Fit, identify
from iva.identification.ahead import next_after
from iva.identification.chains import SensorChain, pulse_of
from iva.identification.explaining import explained
from iva.identification.instants import seen
from iva.identification.pulses import Shape
from iva.identification.records import MODE, TREND, Inputs, Recording
from iva.identification.responses import Values
from iva.identification.walls import Absorber

#: With EVERY_CASE in the environment all cases are tried, else the quicker ones of each feature.
EVERY_CASE = "EVERY_CASE" in os.environ
RIG = Truth(release=0.25, gap_displacement=0.2e-3)


def holds(fit: Fit, made: Planted) -> None:
    """Check that twice the interval (90 %) of each number holds the truth."""
    truth = made.truth
    wanted = {
        "frequency_hz": truth.frequency_hz,
        "damping_ratio": truth.damping_ratio,
        "mass_ratio": truth.mass_ratio,
        "restitution": truth.restitution,
        "gap_mm": 1e3 * truth.gap,
        "displacement_mm": 1e3 * truth.displacement,
        "gap_displacement_mm": 1e3 * truth.gap_displacement,
        "release_s": truth.release,
    }
    for name, value, low, high, _ in fit.parameters.rows():
        if name in wanted:
            assert 2 * low - value <= wanted[name] <= 2 * high - value, (name, value, low, high)


class Still(Recording):
    """A record of pulses alone."""

    def motion(self, inputs: Inputs) -> Values:
        """Return nothing, whatever the impacts: what jumps do to the motion is left out."""
        return np.zeros(self.time.size + 0 * inputs.times.size)


@pytest.mark.parametrize("contact", [1.3, 1.7, 2.2])
def test_samples_of_a_short_contact_tell_length_and_instants(contact: float) -> None:
    # Pulses alone, no motion: 24 half sines of `contact` samples at places that are spread evenly
    # between samples, of jumps from 0.02 to 0.1 m/s that are known to 1 %. An instant near a sample
    # may be on either side of it: the deviation has to say so.
    rate, hits = 2000.0, 24
    random = np.random.default_rng(3)
    places = 60.0 * np.arange(1, hits + 1) + (np.arange(hits) + 0.5) / hits - 0.5
    jumps = random.uniform(0.02, 0.1, hits) * np.where(np.arange(hits) % 2, 1.0, -1.0)
    time = np.arange(60 * (hits + 2)) / rate
    pulse = pulse_of(SensorChain("none", 0.5, contact))
    values = 0.1 * random.standard_normal(time.size)
    for place, jump in zip(places, jumps, strict=True):
        values += jump * rate * pulse.height(np.clip(np.arange(time.size) - place, -60.0, 60.0))
    shape = Shape(SensorChain("none", 0.5, 1.5))
    head = np.array([2 * np.pi * 5.0, 0.01, 0.0, -10.0, 0.0])
    inputs = Inputs(
        head,
        np.rint(places) / rate,
        jumps,
        np.zeros(TREND),
        np.zeros(0),
        np.zeros((0, MODE)),
        np.zeros(shape.size),
        np.zeros(hits),
    )
    recording = Still(time, values, 2, rate, shape=shape)
    told = seen(recording, inputs, 0.1, np.array([jumps, 0.01 * np.abs(jumps)]))
    assert told.contact == pytest.approx(contact, rel=0.05)
    off = (told.times[0] * rate - places) / (told.times[1] * rate)
    assert np.all(np.abs(off) < 4.0)
    assert np.mean(np.abs(off) < 2.0) > 0.9
    # Between two samples both show the pulse, and the instant is told to some hundredths of one.
    between = np.abs(places - np.rint(places)) > 0.4
    assert np.all(told.times[1][between] * rate < 0.05)


@pytest.mark.parametrize("contact", [0.65e-3, 0.9e-3] if EVERY_CASE else [0.9e-3])
def test_short_contacts_without_a_filter_are_identified(contact: float) -> None:
    # 1.3 and 1.8 samples at 2 kHz.
    chain = Chain(
        seed=41, seconds=2.0, sampling_hz=2000.0, filter="none", contact=contact, noise=0.05
    )
    made = record(RIG, chain)
    fit = identify(made, iva.Siva(), iva.Primary())
    assert fit.adequate, fit.reasons
    assert fit.chain.startswith("no filter")
    assert fit.impacts.height == len(made.impacts)
    holds(fit, made)
    instants = np.array([impact["time"] for impact in made.impacts]) + RIG.release
    # Never off by more than the width of the contact.
    assert np.max(np.abs(fit.impacts["time"].to_numpy() - instants)) < contact


def test_a_velocity_with_noise_is_followed_through_impacts_that_hide() -> None:
    # Jumps down to the noise of a sample, 1 mm/s, and impacts a twelfth of a period apart.
    truth = Truth(4.97, 0.0052, 0.058, 0.79, 6.3e-3, 4.6e-3, 0.3e-3, release=0.17)
    chain = Chain(seed=9, quantity="velocity", sampling_hz=2000.0, noise=1e-3, bit=1e-4)
    made = record(truth, chain)
    fit = identify(made, iva.Siva(), iva.Primary())
    assert fit.adequate, fit.reasons
    holds(fit, made)
    jumps = np.abs([impact["jump"] for impact in made.impacts])
    assert fit.impacts.height >= np.sum(np.cumprod(jumps > 2e-3))


def test_the_next_impact_follows_from_the_last_one() -> None:
    made = flights(RIG, 2.0, law_of(RIG, np.random.default_rng(0)))
    omega = 2 * np.pi * RIG.frequency_hz
    head = np.array([omega, RIG.damping_ratio, 0.0, 0.0, RIG.displacement])
    times = np.array([impact["time"] for impact in made])
    jumps = np.array([impact["jump"] for impact in made])
    none = np.zeros(0)
    inputs = Inputs(head, times, jumps, np.zeros(TREND), none, np.zeros((0, MODE)), none, none)
    mass = Absorber(
        1 / RIG.mass_ratio, RIG.gap / 2, RIG.gap_displacement, RIG.restitution, 0.01, 1e-3
    )
    for hits in range(1, times.size):
        at, jump = next_after(inputs, hits, mass, 3.0)
        # The walls are looked at 400 times a period.
        assert at == pytest.approx(times[hits], abs=1.5 / RIG.frequency_hz / 400)
        assert jump == pytest.approx(jumps[hits], rel=0.03, abs=1e-4)
    assert next_after(inputs, 3, mass, float(times[3]) - 0.01)[0] == np.inf


def test_a_record_is_used_up_to_an_impact_that_hides() -> None:
    # An impact is taken out of the record: all that follows is of another motion, and the trail
    # ends where it would be.
    made = record(RIG, Chain(seed=42, seconds=2.0))
    hidden = made.impacts[12]
    rate = 2 * np.pi * RIG.frequency_hz * complex(-RIG.damping_ratio, np.sqrt(1 - 0.0082**2))
    since = made.time - RIG.release - hidden["time"]
    answer = np.where(since > 0, (rate**2 * np.exp(rate * np.maximum(since, 0.0))).imag, 0.0)
    without = made.values - hidden["jump"] * answer / rate.imag
    beside = np.abs(since) < 40 / made.sampling_hz
    line = np.interp(made.time[beside], made.time[~beside], without[~beside])
    without[beside] = line + 0.05 * np.random.default_rng(1).standard_normal(line.size)
    fit = identify(replace(made, values=without), iva.Siva(), iva.Primary())
    assert fit.impacts.height <= 12
    assert any("were used, up to" in note or "none is seen" in note for note in fit.notes)


@pytest.mark.parametrize("release", [0.0, 0.25] if EVERY_CASE else [0.25])
@pytest.mark.parametrize("noise", [0.0, 0.003] if EVERY_CASE else [0.0])
def test_few_samples_a_period_and_no_known_release_are_a_result(
    noise: float, release: float
) -> None:
    # 400 Hz: impacts are closer than a filter rings for.
    chain = Chain(seed=32, seconds=2.5, sampling_hz=400.0, noise=noise, bit=0.0)
    made = record(replace(RIG, release=release), chain)
    fit = identify(made, iva.Siva(), iva.Primary())
    found = dict(fit.parameters.select("parameter", "value").iter_rows())
    assert found["release_s"] == pytest.approx(release, abs=1e-3)
    assert found["mass_ratio"] == pytest.approx(RIG.mass_ratio, rel=0.05)


@pytest.mark.parametrize("stage", [2, 3] if EVERY_CASE else [2])
def test_an_interrupted_fit_is_what_there_is(stage: int) -> None:
    made = record(RIG, Chain(seed=43, seconds=1.2))

    def stop(done: int, _total: int) -> None:
        if done == stage:
            raise KeyboardInterrupt

    fit = identify(made, iva.Siva(), iva.Primary(), progress=stop)
    assert not fit.adequate
    assert fit.reasons[0].startswith("interrupted: ")
    found = dict(fit.parameters.select("parameter", "value").iter_rows())
    assert found["mass_ratio"] == pytest.approx(RIG.mass_ratio, rel=0.05)
    assert found["gap_mm"] == pytest.approx(1e3 * RIG.gap, rel=0.05)


def test_before_a_trail_an_interruption_goes_through() -> None:
    made = record(RIG, Chain(seed=43, seconds=1.2))

    def stop(_done: int, _total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        identify(made, iva.Siva(), iva.Primary(), progress=stop)


def test_an_interruption_between_two_windows_keeps_the_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from iva.identification import trails

    calls = []

    def twice(*arguments: object) -> object:
        calls.append(arguments)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return explained(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(trails, "explained", twice)
    chain = Chain(seed=9, quantity="velocity", sampling_hz=2000.0, noise=1e-3, bit=1e-4)
    made = record(Truth(4.97, 0.0052, 0.058, 0.79, 6.3e-3, 4.6e-3, 0.3e-3, release=0.17), chain)
    fit = identify(made, iva.Siva(), iva.Primary())
    assert len(calls) == 2
    assert any(reason.startswith("interrupted: ") for reason in fit.reasons)


def test_a_lopsided_pulse_of_a_symmetrical_filter_is_unlikely() -> None:
    # Of a causal filter the odd part of a pulse may be as large as the even one.
    even = Shape(SensorChain("linear phase", 0.42, 1.2)).deviations()
    odd = Shape(SensorChain("causal", 0.42, 1.2)).deviations()
    pairs = Shape(SensorChain()).sincs.size
    assert np.all(even[pairs : 2 * pairs] < 0.2 * odd[pairs : 2 * pairs])
    assert np.all(even[:pairs] == odd[:pairs])
