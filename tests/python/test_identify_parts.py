"""The parts that an identification is made of, each against a closed form or planted truth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

pytest.importorskip("dynesty")
import scipy.signal
import scipy.stats

import iva
from iva.identification.chains import SensorChain, pulse_of
from iva.identification.choosing import chain_of
from iva.identification.combinations import in_words, null_directions
from iva.identification.detection import pulses_in
from iva.identification.kinks import kinks_in
from iva.identification.priors import prior_of
from iva.identification.pulses import Shape
from iva.identification.records import Inputs, Recording
from iva.identification.responses import Response, to_jump, to_release
from iva.identification.steps import instants
from iva.identification.walls import Absorber, contacts, residuals
from planted_decays import FINE, Chain, Truth, Values, filtered, flights, law_of, record
from planted_pendulums import Laser, between, laser, swung

NONE: Values = np.zeros(0)
RIG = Truth(release=0.25, gap_displacement=0.2e-3, scatter=0.05)


def inputs_of(truth: Truth, seconds: float, pulse: Values = NONE) -> Inputs:
    """Return the numbers of a record from its truth."""
    impacts = flights(truth, seconds, law_of(truth, np.random.default_rng(0)))
    head = [2 * np.pi * truth.frequency_hz, truth.damping_ratio, 0.5, truth.release]
    return Inputs(
        np.array([*head, truth.displacement]),
        np.array([impact["time"] for impact in impacts]) + truth.release,
        np.array([impact["jump"] for impact in impacts]),
        np.array([0.1, 0.2, 0.0, 0.0]),
        np.array([0.01, 0.02]),
        np.array([[60.0, 1.0, 450.0, 0.015]]),
        pulse,
        np.linspace(-0.02, 0.03, len(impacts)),
    )


@pytest.mark.parametrize("order", [0, 1, 2])
def test_answers_are_derivatives_of_each_other(order: int) -> None:
    # ẍ + 2ζωẋ + ω²x = 0 between jumps, and the release from 1 has ẍ = −ω² at once.
    omega, zeta, time = 30.0, 0.02, np.linspace(1e-6, 0.5, 4001)
    begin, one = np.zeros(1), np.ones(1)
    parts = [to_jump(omega, zeta, 0.0, n).total(time, begin, one) for n in range(3)]
    rest = parts[2] + 2 * zeta * omega * parts[1] + omega**2 * parts[0]
    assert np.max(np.abs(rest)) < 1e-9
    assert parts[1][0] == pytest.approx(1.0, abs=1e-5)
    slope = np.gradient(to_jump(omega, zeta, 0.0, order).total(time, begin, one), time)
    same = to_jump(omega, zeta, 0.0, order).slope().total(time, begin, one)
    assert slope[5:-5] == pytest.approx(same[5:-5], abs=1e-2 * omega**order)
    free = to_release(omega, zeta, 0.0, order).total(time, begin, one)
    assert free[0] == pytest.approx((1.0, 0.0, -(omega**2))[order], abs=1.0 if order == 2 else 1e-2)


@pytest.mark.parametrize("answer", [to_release, to_jump])
def test_the_high_pass_is_a_first_order_one(answer: Callable[..., Response]) -> None:
    # z' + a z = u' holds for what a high pass makes of u; a pulse of area 1 leaves −a at once.
    corner, time = 2.0, np.linspace(1e-6, 1.0, 40001)
    begin, one = np.zeros(1), np.ones(1)
    before = answer(30.0, 0.02, 0.0, 2).total(time, begin, one)
    after = answer(30.0, 0.02, corner, 2).total(time, begin, one)
    rest = np.gradient(after, time) + corner * after - np.gradient(before, time)
    assert np.max(np.abs(rest[5:-5])) < 1e-4 * np.max(np.abs(np.gradient(before, time)))
    left = corner if answer is to_jump else 0.0
    assert after[0] == pytest.approx(before[0] - left, abs=1e-2)


CHAINS = [
    SensorChain("linear phase", 0.42, 1.2),
    SensorChain("zero phase", 0.3, 2.0),
    SensorChain("causal", 0.35, 1.0),
    SensorChain("none", 0.5, 2.3),
]


@pytest.mark.parametrize("chain", CHAINS[:3])
def test_the_jacobian_is_that_of_the_record(chain: SensorChain) -> None:
    shape = Shape(chain)
    shares = 0.02 * np.random.default_rng(1).standard_normal(shape.size) * shape.deviations()
    inputs = inputs_of(RIG, 0.6, shares)
    time = np.arange(1800) / 2048
    recording = Recording(time, np.zeros(time.size), 2, 2048.0, (50.0,), shape=shape)
    slopes, numbers = recording.jacobian(inputs), inputs.vector()
    for place in range(numbers.size):
        step = 1e-6 * max(abs(numbers[place]), 1e-2)
        ahead, back = numbers.copy(), numbers.copy()
        ahead[place] += step
        back[place] -= step
        change = recording.model(inputs.with_vector(ahead)) - recording.model(
            inputs.with_vector(back)
        )
        wanted = change / (2 * step)
        if place == 3:
            # At the sample beside the release the record jumps: there is no derivative.
            near = np.abs(time - RIG.release) < 1e-3
            wanted[near] = slopes[near, place] = 0.0
        assert slopes[:, place] == pytest.approx(wanted, abs=2e-3 * np.max(np.abs(wanted)) + 1e-9)


@pytest.mark.parametrize("chain", CHAINS)
def test_a_pulse_has_the_area_and_the_instant_of_its_jump(chain: SensorChain) -> None:
    # Whatever is added to the pulse of a chain: ∫ g = 1 and ∫ p g = 0. A contact that is wider by
    # the variance v has the second moment v more.
    shape = Shape(chain)
    shares = shape.deviations() * np.random.default_rng(2).standard_normal(shape.size)
    near = np.zeros(shape.size)
    middle = slice(shape.size // 2 - 2, shape.size // 2 + 2)
    near[middle] = shares[middle]
    fine = np.arange(-60.0, 60.0, 1 / 64)[None, :]
    plain, more, wide = (
        shape.pulse(fine, added, np.array([width]))[0]
        for added, width in ((np.zeros(shape.size), 0.0), (near, 0.0), (np.zeros(shape.size), 0.1))
    )
    for made in (plain, more, wide):
        assert np.sum(made) / 64 == pytest.approx(1.0, abs=1e-2)
        assert np.sum(fine[0] * made) / 64 == pytest.approx(0.0, abs=2e-2)
    assert np.sum(fine[0] ** 2 * (wide - plain)) / 64 == pytest.approx(0.1, abs=1e-2)


def test_a_causal_pulse_is_that_of_its_transfer_function() -> None:
    # SciPy's analogue Butterworth filter; its impulse response comes later by the delay.
    chain = SensorChain("causal", 0.35, 1e-3)
    after = np.arange(0.0, 20.0, 1 / 16)
    poles = scipy.signal.butter(4, 2 * np.pi * 0.35, analog=True)
    _, wanted = scipy.signal.impulse(poles, T=after)
    height = pulse_of(chain).height
    assert height(after - chain.delay) == pytest.approx(wanted, abs=2e-3)
    assert np.max(np.abs(height(np.arange(-3.0, -0.5, 1 / 16) - chain.delay))) < 1e-3


@pytest.mark.parametrize(
    ("kind", "cutoff"),
    [("linear phase", 0.42), ("zero phase", 0.35), ("causal", 0.35), ("none", 0.5)],
)
def test_the_chain_is_that_of_the_pulses(kind: str, cutoff: float) -> None:
    # Filters of SciPy and of the planted records; the contact is 2 samples long.
    made = record(RIG, Chain(seed=5, seconds=2.0, contact=1e-3, filter=kind, cutoff=cutoff))
    release = int(RIG.release * 2048)
    chain = chain_of(made.values, 2048.0, ((release - 40, release + 40),))
    assert chain.kind == kind
    if kind != "none":
        assert chain.cutoff == pytest.approx(cutoff, abs=0.04)
    if kind in ("causal", "zero phase"):
        assert chain.contact == pytest.approx(2.05, rel=0.35)


def test_the_wall_conditions_hold_for_planted_flights() -> None:
    inputs = inputs_of(RIG, 2.0)
    hits = inputs.times.size
    size = inputs.vector().size
    found = contacts(inputs, np.zeros((size, size)), hits)
    true = Absorber(
        1 / RIG.mass_ratio, RIG.gap / 2, RIG.gap_displacement, RIG.restitution, 0.05, 1e-3
    )
    rest, _ = residuals(found, true)
    assert np.max(np.abs(rest[:hits])) < 1e-8  # m; the gap is 9.4e-3
    _, _, lost, speed, _ = found.values
    approach = speed - lost / RIG.mass_ratio
    impacts = flights(RIG, 2.0, law_of(RIG, np.random.default_rng(0)))
    assert approach == pytest.approx([impact["approach"] for impact in impacts], abs=1e-6)
    e = RIG.restitution + rest[hits:] / approach
    assert e == pytest.approx([impact["restitution"] for impact in impacts], abs=1e-5)


def test_pulses_are_found_where_they_are() -> None:
    made = record(RIG, Chain(seed=3, seconds=2.0, ringing=(71.0, 0.015, 0.15), hum=0.05))
    release = int(RIG.release * 2048)
    times, jumps = pulses_in(made.values, 2048.0, closed=((release - 30, release + 30),))
    wanted = np.array([impact["time"] for impact in made.impacts]) + RIG.release
    assert times == pytest.approx(wanted, abs=5e-5)
    sizes = np.array([impact["jump"] for impact in made.impacts])
    assert jumps / sizes == pytest.approx(np.ones(sizes.size), abs=0.15)


def test_kinks_are_found_where_they_are() -> None:
    truth = Truth(1.83, 0.0113, 0.118, 0.55, 77.5e-3, 31e-3, release=0.25)
    made = laser(truth, 0.41, Laser(seed=1, seconds=4.0))
    times, jumps, _, noise = kinks_in(made.values, 200.0, 1.83, 0, closed=((0, 69),))
    assert noise == pytest.approx(2e-5, rel=0.15)
    large = [impact for impact in made.impacts if abs(impact["jump"]) > 0.03]
    for impact in large:
        nearest = int(np.argmin(np.abs(times - impact["time"] - truth.release)))
        assert times[nearest] == pytest.approx(impact["time"] + truth.release, abs=4e-3)
        assert jumps[nearest] == pytest.approx(impact["jump"], rel=0.2)


class Level(Recording):
    """A velocity of steps alone, in which nothing moves."""

    def model(self, inputs: Inputs) -> Values:
        """Return the sum of steps."""
        since = self.time[:, None] - inputs.times
        total: Values = np.sum(inputs.jumps * (since > 0), axis=1)
        return total


@pytest.mark.parametrize("recorder", ["none", "linear phase"])
def test_steps_tell_their_instants_as_well_as_they_say(recorder: str) -> None:
    # Places spread evenly between samples. Without a filter a step shows no more than between which
    # samples it lies: the deviation of an even spread over one sample is 0.29.
    rate, count, random = 2000.0, 60, np.random.default_rng(6)
    places = 60.0 * np.arange(1, count + 1) + (np.arange(count) + 0.5) / count - 0.5
    jumps = random.uniform(0.02, 0.1, count) * np.where(np.arange(count) % 2, 1.0, -1.0)
    fine = np.arange(60 * (count + 2) * FINE) / FINE
    steps = np.cumsum(np.bincount(np.searchsorted(fine, places), jumps, fine.size)).astype(float)
    values = filtered(steps, Chain(filter=recorder))[::FINE]
    values = values + 1e-3 * random.standard_normal(values.size)
    time = np.arange(values.size) / rate
    head = np.array([2 * np.pi * 5.0, 0.01, 0.0, -10.0, 0.0])
    none = np.zeros(0)
    inputs = Inputs(
        head, np.rint(places) / rate, jumps, np.zeros(4), none, np.zeros((0, 4)), none, none
    )
    times, deviations = instants(Level(time, values, 1, rate), inputs, 1e-3)
    off = (times * rate - places) / (deviations * rate)
    assert np.max(np.abs(off)) < 3.0
    assert np.std(off) < 1.2
    if recorder == "none":
        assert np.mean(deviations) * rate == pytest.approx(0.289, rel=0.15)


def test_planted_pendulums_move_as_those_of_iva() -> None:
    # Two programs without a line in common: Runge and Kutta here, series with enclosures there.
    truth = Truth(1.83, 0.0113, 0.118, 0.55, 77.5e-3, 31e-3)
    times, states, impacts = swung(truth, 0.41, 2.0, lambda _: 0.55)
    length = 9.80665 / (0.41 * 2 * np.pi * 1.83) ** 2
    piva = iva.Piva(
        mass_ratio=0.118, restitution=0.55, gap=77.5e-3, frequency_ratio=0.41, length=length
    )
    primary = iva.Primary(frequency_hz=1.83, damping_ratio=0.0113)
    run = iva.simulate(piva, primary, start=iva.Start(displacement=31e-3), duration=2.0)
    hits = [impact["time"] for impact in impacts if impact["time"] < 2.0]
    assert run.impacts["time"].to_list() == pytest.approx(hits, abs=1e-6)
    asked = np.linspace(0.0, 1.99, 397)
    wanted = between(asked, times, states)
    assert run.at(asked)["displacement"].to_numpy() == pytest.approx(wanted, abs=1e-8)


def test_null_directions_are_named() -> None:
    names = ("mass_ratio", "gap", "rest position", "restitution")
    apart = np.array([[1e4, 0, 0, 8e3], [0, 0, 0, 0], [0, 0, 0, 0], [8e3, 0, 0, 6.4e3]])
    apart += 1e6 * np.outer([0, 1, -1, 0], [0, 1, -1, 0])
    found = null_directions(apart)
    assert {in_words(found[:, column], names) for column in range(found.shape[1])} == {
        "only clearance − rest position is determined",
        "only mass_ratio (1 + restitution) / (1 + mass_ratio) is determined",
    }
    other = 1e6 * np.diag([1.0, 1.0, 1.0, 0.0])
    found = null_directions(other)
    assert in_words(found[:, 0], names) == "restitution is not determined"
    assert null_directions(1e6 * np.eye(4)).shape == (4, 0)


@pytest.mark.parametrize(
    ("given", "same"),
    [
        (iva.sampling.Uniform(1.0, 3.0), scipy.stats.uniform(1.0, 2.0)),
        (iva.sampling.Normal(2.0, 0.5), scipy.stats.truncnorm(-4.0, np.inf, 2.0, 0.5)),
        (iva.sampling.Normal(2.0, 0.5, low=1.5), scipy.stats.truncnorm(-1.0, np.inf, 2.0, 0.5)),
        (iva.sampling.LogNormal(2.0, 0.3), scipy.stats.lognorm(0.3, scale=2.0)),
    ],
)
def test_priors_are_those_of_scipy(given: iva.sampling.Distribution, same: object) -> None:
    prior = prior_of("gap", given, 1.0, 0.0, np.inf)
    for share in (0.05, 0.3, 0.9):
        value = prior.at(share)
        assert value == pytest.approx(same.ppf(share), rel=1e-9)  # type: ignore[attr-defined]
        density = same.logpdf(value)  # type: ignore[attr-defined]
        assert prior.log_density(value) == pytest.approx(density, rel=1e-6)
    assert prior.log_density(-1.0) == -np.inf
