"""Records of decays with a pendulum, with planted truth, made without iva.

Lagrange's equations of a point bob by Runge and Kutta's fourth order in small steps; the instant of
an impact is that of the cubic through the states beside it. Restitution may scatter or fall.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planted_decays import Planted, Truth, Values, law_of

GRAVITY = 9.80665


@dataclass(frozen=True)
class Laser:
    """A sensor of displacement: rate, length, noise and bit of the recorder, in SI units."""

    sampling_hz: float = 200.0
    seconds: float = 12.0
    noise: float = 2e-5
    bit: float = 1e-5
    seed: int = 0


def slope(state: Values, truth: Truth, length: float) -> Values:
    """Return the derivative of x, v, θ, θ'."""
    x, v, angle, turn = state
    omega = 2 * np.pi * truth.frequency_hz
    mu, c, s = truth.mass_ratio, np.cos(angle), np.sin(angle)
    # (1+μ) a + μ L (α c − θ'² s) = −2ζω v − ω² x  and  L α + a c + g s = 0.
    force = -2 * truth.damping_ratio * omega * v - omega**2 * x + mu * length * turn**2 * s
    a = (force + mu * GRAVITY * s * c) / (1 + mu - mu * c**2)
    return np.array([v, a, turn, -(a * c + GRAVITY * s) / length])


def stepped(state: Values, truth: Truth, length: float, step: float) -> Values:
    """Return the state a step later."""
    one = slope(state, truth, length)
    two = slope(state + step / 2 * one, truth, length)
    three = slope(state + step / 2 * two, truth, length)
    four = slope(state + step * three, truth, length)
    made: Values = state + step / 6 * (one + 2 * two + 2 * three + four)
    return made


def struck(state: Values, truth: Truth, length: float, e: float) -> tuple[Values, float, float]:
    """Return the state after an impact, the jump of the structure and the approach velocity."""
    x, v, angle, turn = state
    c = np.cos(angle)
    # The stop acts along x: momentum of both, and restitution of the gap velocity.
    approach = length * turn * c
    new = -e * turn
    jump = truth.mass_ratio * length * c * (turn - new) / (1 + truth.mass_ratio)
    return np.array([x, v + jump, angle, new]), float(jump), float(approach)


def swung(
    truth: Truth, ratio: float, seconds: float, law: Callable[[float], float], step: float = 1e-3
) -> tuple[Values, Values, list[dict[str, float]]]:
    """Return instants from the release, states x and v there (n, 2), and impacts.

    The instant of an impact stands twice, with the states before and after it.
    """
    length = GRAVITY / (ratio * 2 * np.pi * truth.frequency_hz) ** 2
    wall = np.arcsin(truth.gap / 2 / length)
    state = np.array([truth.displacement, 0.0, 0.0, 0.0])
    times, states, impacts = [0.0], [state[:2]], []
    now = 0.0
    while now < seconds:
        after = stepped(state, truth, length, step)
        if abs(after[2]) > wall and after[2] * after[3] > 0:
            low, high = 0.0, step
            for _ in range(40):
                middle = (low + high) / 2
                if abs(stepped(state, truth, length, middle)[2]) > wall:
                    high = middle
                else:
                    low = middle
            state = stepped(state, truth, length, low)
            times.append(now + low)
            states.append(state[:2])
            e = law(abs(length * state[3] * np.cos(state[2])))
            state, jump, approach = struck(state, truth, length, e)
            impacts.append(
                {"time": now + low, "jump": jump, "approach": approach, "restitution": e}
            )
            now += low
        else:
            state = after
            now += step
        times.append(now)
        states.append(state[:2])
    return np.array(times), np.array(states), impacts


def between(asked: Values, times: Values, states: Values) -> Values:
    """Return the displacement at instants, by cubics through the states beside each, shape (n,).

    Straight lines would be short of the swing by 2e-6 m at its crest in steps of 1 ms, always to
    the same side: as much as a record of a thousand samples tells of the displacement.
    """
    left = np.clip(np.searchsorted(times, asked, side="right") - 1, 0, times.size - 2)
    step = times[left + 1] - times[left]
    u = np.clip((asked - times[left]) / step, 0.0, 1.0)
    (x, v), (new_x, new_v) = states[left].T, states[left + 1].T
    rise, first, last = new_x - x, v * step, new_v * step
    made: Values = x + u * (
        first + u * (3 * rise - 2 * first - last + u * (first + last - 2 * rise))
    )
    return made


def laser(truth: Truth, ratio: float, sensor: Laser) -> Planted:
    """Return the record of the displacement."""
    random = np.random.default_rng(sensor.seed)
    times, states, impacts = swung(
        truth, ratio, sensor.seconds - truth.release, law_of(truth, random)
    )
    count = round(sensor.seconds * sensor.sampling_hz)
    time = np.arange(count) / sensor.sampling_hz
    values = between(np.maximum(time - truth.release, 0.0), times, states)  # before it x stands
    values = values + sensor.noise * random.standard_normal(count)
    values = np.round(values / sensor.bit) * sensor.bit
    return Planted(time, values, "displacement", sensor.sampling_hz, truth, impacts)
