"""The structure alone: frequency and damping from decays in closed form.

x = x0 Re(exp(λt)(1 − i ζ/√(1−ζ²))) is a release from rest; a second mode, noise and friction are
added. An interval of 90 % must hold the truth within twice its width.
"""

from __future__ import annotations

import numpy as np
import polars as pl
import pytest

import iva

pytest.importorskip("dynesty")
from iva.identification import Fit, identify
from planted_decays import Chain, Truth, record

OMEGA, ZETA, SIZE = 2 * np.pi * 5.0, 0.008, 6e-3
RATE = OMEGA * complex(-ZETA, np.sqrt(1 - ZETA**2))


def released(time: np.ndarray, order: int) -> np.ndarray:
    """Return displacement, velocity or acceleration after a release from rest at 0."""
    share = SIZE * complex(1.0, -ZETA / np.sqrt(1 - ZETA**2))
    made: np.ndarray = np.where(time >= 0, (share * RATE**order * np.exp(RATE * time)).real, 0.0)
    return made if order else np.where(time >= 0, made, SIZE)


def row(fit: Fit, name: str) -> tuple[float, float, float]:
    """Return value, low and high of a number."""
    found = fit.parameters.filter(pl.col("parameter") == name).row(0)
    return found[1], found[2], found[3]


def near(fit: Fit, **truths: float) -> None:
    """Check that twice the interval holds each truth."""
    for name, truth in truths.items():
        value, low, high = row(fit, name)
        assert 2 * low - value <= truth <= 2 * high - value, (name, value, low, high)


@pytest.mark.parametrize(
    ("quantity", "order", "noise"),
    [("displacement", 0, 2e-5), ("velocity", 1, 1e-3), ("acceleration", 2, 0.03)],
)
def test_a_structure_is_found_from_any_quantity(quantity: str, order: int, noise: float) -> None:
    time = np.arange(4096) / 512
    values = released(time - 0.25, order)
    values = values + noise * np.random.default_rng(order).standard_normal(time.size)
    fit = identify(iva.Measured(time, values, quantity), None, iva.Primary())  # type: ignore[arg-type]
    near(fit, frequency_hz=5.0, damping_ratio=ZETA, displacement_mm=6.0, release_s=0.25)
    assert row(fit, "damping_ratio")[2] - row(fit, "damping_ratio")[1] < 2e-4
    assert fit.adequate, fit.reasons
    assert fit.absorber is None
    assert fit.impacts.height == 0
    assert fit.noise == pytest.approx(noise, rel=0.1)
    end = fit.run.at([7.0])["displacement"].item()
    assert end == pytest.approx(released(np.array([6.75]), 0)[0], abs=1e-4)


def test_nine_in_ten_intervals_of_noise_alone_hold_the_truth() -> None:
    # 60 records: of a share of 0.9 fewer than 46 or all 60 have a chance of 0.2 % each.
    time, held = np.arange(2048) / 256, np.zeros(2)
    for seed in range(60):
        noise = 1e-3 * np.random.default_rng(seed).standard_normal(time.size)
        values = released(time, 1) + noise
        fit = identify(
            iva.Measured(time, values, "velocity"), None, iva.Primary(), start=iva.Start(time=0.0)
        )
        for place, (name, truth) in enumerate((("frequency_hz", 5.0), ("damping_ratio", ZETA))):
            _, low, high = row(fit, name)
            held[place] += low <= truth <= high
    assert np.all(held >= 46)
    assert np.all(held <= 59)


def test_a_record_may_begin_in_motion_and_have_a_second_mode() -> None:
    time = np.arange(8192) / 1024
    values = released(time + 0.53, 2)
    fast = 2 * np.pi * 33.0
    values = values + 2.0 * np.exp(-0.004 * fast * time) * np.sin(fast * time)
    values = values + 0.02 * np.random.default_rng(3).standard_normal(time.size) + 0.4
    fit = identify(iva.Measured(time + 9.0, values, "acceleration"), None, iva.Primary())
    begin = released(np.array([0.53]), 0)[0], released(np.array([0.53]), 1)[0]
    near(fit, frequency_hz=5.0, damping_ratio=ZETA, displacement_mm=1e3 * begin[0])
    assert row(fit, "velocity")[0] == pytest.approx(begin[1], abs=2e-3)
    assert fit.adequate, fit.reasons
    assert fit.notes == ("oscillations at 33 Hz were fitted along",)


def test_friction_makes_damping_depend_on_amplitude() -> None:
    # With dry friction the amplitude falls by a constant more each second: A' = −ζωA − c.
    time, loss = np.arange(8192) / 1024, 4e-4
    decay = ZETA / 2 * OMEGA
    size = np.maximum((SIZE + loss / decay) * np.exp(-decay * time) - loss / decay, 0.0)
    values = size * np.cos(OMEGA * time)
    values = values + 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    made = iva.Measured(time, values, "displacement")
    fit = identify(made, None, iva.Primary(), start=iva.Start(time=0.0))
    assert not fit.adequate
    assert any("dry friction" in reason for reason in fit.reasons)


def test_impacts_are_no_structure_alone() -> None:
    made = record(Truth(release=0.25), Chain(seed=2, seconds=3.0))
    fit = identify(made, None, iva.Primary())
    assert any("impacts" in reason for reason in fit.reasons)


def test_what_is_known_counts() -> None:
    time = np.arange(2048) / 256
    noise = 1e-3 * np.random.default_rng(0).standard_normal(time.size)
    made = iva.Measured(time, released(time, 1) + noise, "velocity")
    start = iva.Start(time=0.0)
    fit = identify(made, None, iva.Primary(frequency_hz=5.0), start=start)
    assert row(fit, "frequency_hz") == (5.0, 5.0, 5.0)
    near(fit, damping_ratio=ZETA)
    known = {"damping_ratio": iva.sampling.Normal(ZETA, 1e-6)}
    narrow = row(identify(made, None, iva.Primary(), start=start, known=known), "damping_ratio")
    assert narrow[2] - narrow[1] < 5e-6
    wrong = {"damping_ratio": iva.sampling.Normal(0.5, 1e-3)}
    with pytest.raises(ValueError, match=r"^known: its damping_ratio contradicts the record"):
        identify(made, None, iva.Primary(), start=start, known=wrong)
    with pytest.raises(ValueError, match=r"^gap: it is of an absorber, and there is none"):
        identify(made, None, iva.Primary(), known={"gap_mm": iva.sampling.Uniform(1, 2)})


@pytest.mark.parametrize(("absorber", "wanted"), [(None, [2, 4]), (iva.Siva(), [1, 2, 3, 4])])
def test_it_is_told_how_far_it_is(absorber: iva.Siva | None, wanted: list[int]) -> None:
    made = record(Truth(release=0.25), Chain(seed=3, seconds=1.5))
    told: list[tuple[int, int]] = []
    identify(made, absorber, iva.Primary(), progress=lambda *pair: told.append(pair))
    assert told == [(done, 4) for done in wanted]


def test_a_user_may_end_it() -> None:
    made = record(Truth(release=0.25), Chain(seed=3, seconds=1.5))

    def ended(*_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        identify(made, iva.Siva(), iva.Primary(), progress=ended)
    with pytest.raises(TypeError, match=r"^progress = 3: give True, False or a callable"):
        identify(made, None, iva.Primary(), progress=3)  # type: ignore[arg-type]


def test_what_does_not_oscillate_is_said() -> None:
    time = np.arange(1000) / 100
    noise = np.random.default_rng(5).standard_normal(time.size)
    with pytest.raises(ValueError, match=r"^record: nothing in it oscillates; give a decay"):
        identify(iva.Measured(time, noise, "velocity"), None, iva.Primary())
    short = iva.Measured(time[:300] / 16, released(time[:300] / 16, 1), "velocity")
    with pytest.raises(ValueError, match=r"^record: it has .* periods of the structure"):
        identify(short, None, iva.Primary(), start=iva.Start(time=0.0))
