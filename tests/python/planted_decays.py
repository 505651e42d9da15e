"""Records of decays with planted truth, made without iva: closed flights, then a sensor.

The structure between impacts is x = Re of one complex exponential, the free mass flies straight;
the next impact is the first root of |y| = d, bracketed on a fine grid and refined by bisection. The
law of restitution is any function of the approach speed, so that it may scatter or fall. The chain:
half sine pulses of a finite contact, a linear-phase anti-alias filter without delay, high pass,
ringing, hum, drift, offset, noise, rounding to the bit of the recorder. The filter may be another.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

#: How many points a sample the chain works on before the recorder takes its samples.
FINE = 16


@dataclass(frozen=True)
class Truth:
    """A free mass on a structure let go from rest; SI units."""

    frequency_hz: float = 5.37
    damping_ratio: float = 0.0082
    mass_ratio: float = 0.094
    restitution: float = 0.63
    gap: float = 9.4e-3
    displacement: float = 7.9e-3
    gap_displacement: float = 0.0
    release: float = 0.0  # on the clock of the record, in s
    scatter: float = 0.0  # relative standard deviation of restitution from impact to impact
    blow: float = 0.0  # velocity that a blow gives the structure, from rest at 0
    falling: float = 0.0  # e(w) = restitution · (1 − falling · |w| / v), v = ω x0


@dataclass(frozen=True)
class Chain:
    """What stands between the motion and the record; SI units."""

    sampling_hz: float = 2048.0
    seconds: float = 4.0
    quantity: str = "acceleration"
    contact: float = 0.8e-3
    hammer: float = 3e-3  # length of a blow
    noise: float = 0.05
    bit: float = 0.001
    offset: float = 0.0
    drift: float = 0.0  # per second
    hum: float = 0.0
    hum_hz: float = 50.0
    high_pass_hz: float = 0.0
    ringing: tuple[float, float, float] | None = None  # Hz, damping ratio, share of the jump
    cutoff: float = 0.42  # of the sampling rate
    filter: str = "linear phase"  # or "zero phase", "causal", "none"
    seed: int = 0


@dataclass(frozen=True)
class Planted:
    """A record of the shape that ``iva.identify`` takes, and what is true of it."""

    time: Values
    values: Values
    quantity: str
    sampling_hz: float
    truth: Truth
    impacts: list[dict[str, float]] = field(default_factory=list)


def exponential(truth: Truth) -> complex:
    """Return λ of the structure's motion, Re(c exp(λ t))."""
    omega = 2 * np.pi * truth.frequency_hz
    return omega * complex(-truth.damping_ratio, np.sqrt(1 - truth.damping_ratio**2))


def flights(truth: Truth, seconds: float, law: Callable[[float], float]) -> list[dict[str, float]]:
    """Return all impacts within `seconds` after the release, in order.

    Each has ``time``, ``jump`` of the structure's velocity, ``approach`` and ``restitution``.
    """
    rate = exponential(truth)
    half = truth.gap / 2
    place = complex(truth.displacement, 0)  # x = Re(amplitude exp(λ τ)) since the last impact
    speed = 0.0

    def amplitude(x: float, v: float) -> complex:
        return complex(x, (rate.real * x - v) / rate.imag)

    held = amplitude(place.real, speed)
    mass, mass_speed = truth.displacement + truth.gap_displacement, 0.0
    if truth.blow:
        held, mass = amplitude(0.0, truth.blow), truth.gap_displacement
    now, found = 0.0, []
    step = 1 / truth.frequency_hz / 400
    grid = np.arange(1, 2000) * step
    while now < seconds:
        begin, hit = 0.0, None
        while hit is None and now + begin < seconds:
            times = begin + np.concatenate([[0.0], grid])
            gap = mass + mass_speed * times - (held * np.exp(rate * times)).real
            if begin == 0.0:
                gap[0] *= 1 - 1e-12  # it stands on the wall that it has just left
            outside = np.flatnonzero(np.abs(gap[1:]) > half)
            if outside.size:
                index = int(outside[0])
                wall = float(np.sign(gap[index + 1]))
                low, high = times[index], times[index + 1]
                for _ in range(60):
                    middle = (low + high) / 2
                    y = mass + mass_speed * middle - (held * np.exp(rate * middle)).real
                    if wall * y > half:
                        high = middle
                    else:
                        low = middle
                hit = high
            begin = float(times[-1])
        if hit is None or now + hit >= seconds:
            break
        after = held * np.exp(rate * hit)
        x, v = after.real, (rate * after).real
        approach = mass_speed - v
        if abs(approach) < 1e-5 or hit < 1e-6:
            break  # chatter that ends in stick: the record is taken as it is up to here
        e = law(abs(approach))
        jump = truth.mass_ratio * (1 + e) * approach / (1 + truth.mass_ratio)
        now += hit
        mass = x + np.sign(approach) * half
        mass_speed -= jump / truth.mass_ratio
        held = amplitude(x, v + jump)
        found.append({"time": now, "jump": jump, "approach": approach, "restitution": e})
    return found


def law_of(truth: Truth, random: np.random.Generator) -> Callable[[float], float]:
    """Return restitution as a function of the approach speed, one draw a call."""
    scale = abs(truth.blow) or 2 * np.pi * truth.frequency_hz * abs(truth.displacement)

    def law(speed: float) -> float:
        e = truth.restitution * (1 - truth.falling * speed / scale)
        return float(np.clip(e * (1 + truth.scatter * random.standard_normal()), 0.0, 0.999))

    return law


def record(truth: Truth, chain: Chain) -> Planted:
    """Return the record of a decay."""
    random = np.random.default_rng(chain.seed)
    impacts = flights(truth, chain.seconds - truth.release, law_of(truth, random))
    rate, omega = exponential(truth), 2 * np.pi * truth.frequency_hz
    count = round(chain.seconds * chain.sampling_hz)
    pad = 64
    step = 1 / chain.sampling_hz / FINE
    ticks = np.arange((count + 2 * pad) * FINE) - pad * FINE
    fine = np.asarray(ticks * step - truth.release, dtype=np.float64)

    def ringing(since: Values, order: int) -> Values:
        # Derivatives of the response to a unit jump of velocity.
        return np.where(
            since > 0, (rate**order * np.exp(rate * np.maximum(since, 0))).imag / rate.imag, 0.0
        )

    order = {"displacement": 0, "velocity": 1, "acceleration": 2}[chain.quantity]
    if order == 0:
        total = np.where(
            fine > 0, ringing(fine, 1) + 2 * truth.damping_ratio * omega * ringing(fine, 0), 1.0
        )
        total = total * truth.displacement
    else:
        total = -(omega**2) * truth.displacement * ringing(fine, order - 1)
    if truth.blow:
        total = truth.blow * ringing(fine, order)
        if order == 2:
            total = total + truth.blow * half_sine(fine, step, chain.hammer)
    for impact in impacts:
        since = fine - impact["time"]
        total = total + impact["jump"] * ringing(since, order)
        if order == 2:
            total = total + impact["jump"] * half_sine(since, step, chain.contact)
            if chain.ringing is not None:
                hertz, damping, part = chain.ringing
                own = 2 * np.pi * hertz
                after = np.maximum(since, 0)
                wave = np.exp(-damping * own * after) * np.sin(own * after)
                total = total + np.where(since > 0, part * impact["jump"] * own * wave, 0.0)
    if chain.high_pass_hz > 0:
        total = high_passed(total, chain.high_pass_hz, step)
    middle = pad * FINE
    values = filtered(total, chain)[middle : middle + count * FINE : FINE]
    time = np.arange(count) / chain.sampling_hz
    values = values + chain.offset + chain.drift * time
    values = values + chain.hum * np.sin(2 * np.pi * chain.hum_hz * time + 0.3)
    values = values + chain.noise * random.standard_normal(count)
    values = np.round(values / chain.bit) * chain.bit if chain.bit > 0 else values
    return Planted(time, values, chain.quantity, chain.sampling_hz, truth, impacts)


def half_sine(since: Values, step: float, length: float) -> Values:
    """Return a half sine of area 1 about 0, averaged over steps, in 1/s."""
    edges = np.clip((since + np.array([[-step / 2], [step / 2]])) / length, -0.5, 0.5)
    share = np.sin(np.pi * edges) / 2  # the integral
    made: Values = (share[1] - share[0]) / step
    return made


def filtered(values: Values, chain: Chain) -> Values:
    """Return what the filter of the recorder makes of values on the fine steps."""
    from scipy.signal import butter, filtfilt, lfilter

    if chain.filter == "none":
        return values
    if chain.filter == "causal":
        causal: Values = lfilter(*butter(4, 2 * chain.cutoff / FINE), values)
        return causal
    if chain.filter == "zero phase":
        twice: Values = filtfilt(*butter(2, 2 * chain.cutoff / FINE), values)
        return twice
    taps = np.arange(-25 * FINE, 25 * FINE + 1) / FINE
    kernel = np.sinc(2 * chain.cutoff * taps) * np.blackman(taps.size)
    kernel /= kernel.sum()
    size = 1 << int(np.ceil(np.log2(values.size + kernel.size)))
    spectrum = np.fft.rfft(values, size) * np.fft.rfft(kernel, size)
    made: Values = np.fft.irfft(spectrum, size)[25 * FINE : 25 * FINE + values.size]
    return made


def high_passed(values: Values, corner_hz: float, step: float) -> Values:
    """Return what a first-order high pass makes of values, by trapezoids."""
    from scipy.signal import lfilter

    half = np.pi * corner_hz * step
    made: Values = lfilter([1 / (1 + half), -1 / (1 + half)], [1, -(1 - half) / (1 + half)], values)
    return made


def drawn(seed: int, scatter: float = 0.05, **chain: object) -> tuple[Truth, Chain]:
    """Return a random rig of the kind of the public records."""
    random = np.random.default_rng(seed + 10_000)
    hertz = random.uniform(4, 9)
    x0 = random.uniform(3e-3, 9e-3)
    gap = x0 * random.uniform(0.9, 1.6)
    truth = Truth(
        frequency_hz=hertz,
        damping_ratio=random.uniform(0.003, 0.012),
        mass_ratio=random.uniform(0.05, 0.13),
        restitution=random.uniform(0.5, 0.8),
        gap=gap,
        displacement=x0,
        gap_displacement=random.uniform(-0.1, 0.1) * gap,
        release=random.uniform(0.1, 0.4),
        scatter=scatter,
    )
    made = Chain(contact=random.uniform(0.4e-3, 1e-3), noise=random.uniform(0.02, 0.08), seed=seed)
    return truth, replace(made, **chain)  # type: ignore[arg-type]
