"""The record that a sensor would have made of a run, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import iva

SIVA = iva.Siva(mass_ratio=0.1, restitution=0.6, gap_mm=9.0)
PRIMARY = iva.Primary(mass=3.0, frequency_hz=5.0, damping_ratio=0.008)
RUN = iva.simulate(SIVA, PRIMARY, start=iva.Start(displacement_mm=8.0), duration=2.0)
RATE = 2048.0


@pytest.mark.parametrize(
    ("kind", "contact"), [("linear phase", 2e-3), ("zero phase", 2e-3), (None, 5e-3)]
)
def test_each_pulse_has_the_area_of_its_jump(kind: str | None, contact: float) -> None:
    # Without a filter the samples' sum is off by the spectrum at the sampling rate, 1/(2 f T)².
    made = RUN.recorded(RATE, filter=kind, contact_time=contact)
    smooth = RUN.at(made.time)["acceleration"].to_numpy()
    times = RUN.impacts["time"].to_numpy()
    jumps = (RUN.impacts["velocity_after"] - RUN.impacts["velocity_before"]).to_numpy()
    for time, jump in zip(times[:5], jumps[:5], strict=True):
        near = np.abs(made.time - time) < 0.015
        extra = (made.values - smooth)[near]
        # The smooth acceleration steps by −2ζωΔv, which the filter spreads to both sides alike.
        assert np.sum(extra) / RATE == pytest.approx(jump, rel=0.01)
        middle = np.sum(extra * (made.time[near] - time)) / np.sum(extra)
        assert middle == pytest.approx(0.0, abs=2e-5)


def test_a_causal_filter_delays_the_motion() -> None:
    # Butterworth, order 4: slow motion comes later by Σ 2ζ_k/ω_c = 2.6131/ω_c.
    bare = iva.simulate(None, PRIMARY, start=iva.Start(displacement_mm=8.0), duration=2.0)
    made = bare.recorded(RATE, filter="causal", cutoff_hz=300.0)
    late = 2.6131 / (2 * np.pi * 300.0)
    inner = (made.time > 0.2) & (made.time < 1.9)
    wanted = bare.at(made.time[inner] - late)["acceleration"].to_numpy()
    assert made.values[inner] == pytest.approx(wanted, abs=2e-3)


@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
def test_what_moves_slowly_passes(quantity: str) -> None:
    made = RUN.recorded(RATE, quantity=quantity, before=0.25)  # type: ignore[arg-type]
    assert made.quantity == quantity
    assert made.time[0] == -0.25
    still = made.time < -0.05
    assert made.values[still] == pytest.approx(8e-3 * (quantity == "displacement"), abs=2e-5)
    times = RUN.impacts["time"].to_numpy()
    away = np.min(np.abs(made.time[:, None] - times), axis=1) > 0.02
    away &= (made.time > 0.02) & (made.time < 1.95)
    wanted = RUN.at(made.time[away])[quantity].to_numpy()
    assert made.values[away] == pytest.approx(wanted, abs=1e-3 * np.max(np.abs(wanted)))


def test_noise_is_that_of_its_seed() -> None:
    one, two, other = (RUN.recorded(RATE, noise=0.05, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(one.values, two.values)
    noise = (one.values - other.values) / np.sqrt(2)
    assert np.std(noise) == pytest.approx(0.05, rel=0.05)


def test_simulate_then_identify_closes_the_circle() -> None:
    pytest.importorskip("dynesty")
    for kind in ("linear phase", "causal"):
        made = RUN.recorded(RATE, noise=0.03, before=0.25, filter=kind, seed=4)
        fit = iva.identify(made, iva.Siva(), iva.Primary())
        rows = {row[0]: row[1:4] for row in fit.parameters.iter_rows()}
        truths = {"frequency_hz": 5.0, "damping_ratio": 0.008, "mass_ratio": 0.1, "gap_mm": 9.0}
        for name, truth in {**truths, "release_s": 0.0}.items():
            value, low, high = rows[name]
            assert 2 * low - value <= truth <= 2 * high - value, (kind, name, value, low, high)
        assert fit.adequate, fit.reasons
        assert f"{kind}" in fit.chain


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"rate_hz": 0.0}, r"^rate_hz = 0.0: give a number greater than 0$"),
        ({"rate_hz": 4.0}, r"^rate_hz = 4: the record would have 9 samples"),
        ({"noise": -1.0}, r"^noise = -1.0: give a number, 0 or greater$"),
        ({"filter": "causall"}, r"^filter = 'causall': there is no such filter.*`causal`"),
        ({"filter": None, "contact_time": 1e-5}, r"^contact_time = 1e-05: without a filter"),
    ],
)
def test_bad_arguments_are_named(arguments: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        RUN.recorded(**{"rate_hz": RATE, **arguments})  # type: ignore[arg-type]


def test_a_run_without_metres_has_no_record() -> None:
    run = iva.simulate(SIVA_OF_NUMBERS, iva.Primary(), start=iva.Start(displacement=1), periods=3)
    with pytest.raises(ValueError, match=r"^recorded: lengths are in no unit of their own here"):
        run.recorded(100.0)


SIVA_OF_NUMBERS = iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.5)
