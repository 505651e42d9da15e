"""A record as a sum of decaying oscillations: the motion of a structure with nothing in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from iva.identification.records import TREND, Recording
from iva.identification.responses import Values

#: Most oscillations.
MOST = 5
#: Power of a line over the median of its neighbourhood from which it is an oscillation.
LINE = 60.0
#: Logarithm of a ratio of frequencies within which two lines are one.
BESIDE = 0.4
#: Damping ratios from which a fit begins.
DAMPINGS = (0.001, 0.005, 0.02)
#: Samples that the search looks at.
LOOKED_AT = 4000


@dataclass(frozen=True)
class Decay:
    """Oscillations Re(c exp(λ t)), t from the first sample that counts.

    Attributes
    ----------
    omegas, dampings : ndarray, shape (m,)
        Circular frequencies in rad/s and damping ratios, the largest oscillation first.
    shares : ndarray, shape (m,)
        c, complex, in the unit of the record.
    first : int
        Number of the first sample.
    rest : ndarray, shape (n - first,)
        What is left over.
    """

    omegas: Values
    dampings: Values
    shares: np.ndarray
    first: int
    rest: Values

    @property
    def noise(self) -> float:
        """Root mean square of what is left over."""
        return float(np.sqrt(np.mean(self.rest**2)))

    def motion(self, since: Values) -> Values:
        """Return the first oscillation at instants after the first sample, shape (n,)."""
        rate = rates(self.omegas[:1], self.dampings[:1])[0]
        made: Values = (self.shares[0] * np.exp(rate * since)).real
        return made


def rates(omegas: Values, dampings: Values) -> np.ndarray:
    """Return λ of each oscillation, in 1/s."""
    made: np.ndarray = omegas * (-dampings + 1j * np.sqrt(1 - np.clip(dampings, -0.9, 0.9) ** 2))
    return made


def columns(time: Values, omegas: Values, dampings: Values) -> Values:
    """Return cosine and sine of each oscillation, shape (n, 2 m)."""
    waves = np.exp(np.outer(time, rates(omegas, dampings)))
    return np.concatenate([waves.real, -waves.imag], axis=1)


def decay_of(
    recording: Recording, first: int, floor: float, fixed: tuple[float | None, float | None]
) -> Decay:
    """Return the oscillations of a record from a sample on.

    Parameters
    ----------
    recording : Recording
        The record.
    first : int
        Number of the first sample that counts.
    floor : float
        Standard deviation of what is noise at any rate.
    fixed : tuple of float or None
        Frequency in rad/s and damping ratio of the structure, where they are known exactly.
    """
    time, values = recording.time[first:] - recording.time[first], recording.values[first:]
    trends = np.delete(recording.trends[first:], np.arange(recording.powers, TREND), axis=1)
    found = np.zeros((0, 2))
    rest = values - trends @ np.linalg.lstsq(trends, values, rcond=None)[0]
    while len(found) < MOST:
        if np.std(rest) <= floor:
            break
        taken = [omega / 2 / np.pi for omega in found[:, 0]] + list(recording.hum_hz)
        omega = strongest(rest, recording.sampling_hz, taken)
        if omega is None:
            break
        found = refined(time, values, trends, np.vstack([found, [omega, 0.005]]), fixed)
        design = np.column_stack([columns(time, *found.T), trends])
        answer = np.linalg.lstsq(design, values, rcond=None)[0]
        rest = values - design @ answer
    if not len(found):
        return Decay(np.zeros(0), np.zeros(0), np.zeros(0, complex), first, rest)
    shares = answer[: len(found)] + 1j * answer[len(found) : 2 * len(found)]
    if fixed[0] is None and fixed[1] is None:
        # The structure is what moves most; a sensor of acceleration shows fast modes larger.
        order = np.argsort(-np.abs(shares) / found[:, 0] ** recording.order)
        found, shares = found[order], shares[order]
    return Decay(found[:, 0], found[:, 1], shares, first, rest)


def strongest(rest: Values, sampling_hz: float, taken: list[float]) -> float | None:
    """Return the circular frequency of the strongest line, ``None`` if there is none.

    Beside lines that are taken none is looked for: there an oscillation would stand for what the
    first one does beyond a constant damping.
    """
    # It falls from the first sample on, so that what dies soon is seen.
    window = np.hanning(2 * rest.size)[rest.size :]
    power = np.abs(np.fft.rfft(rest * window)) ** 2
    hertz = np.fft.rfftfreq(rest.size, 1 / sampling_hz)
    inside = (hertz > 2 * sampling_hz / rest.size) & (hertz < 0.45 * sampling_hz)
    for other in taken:
        inside &= np.abs(np.log(np.maximum(hertz, 1e-9) / other)) > BESIDE
    if not inside.any() or not power[inside].max() > 0:
        return None
    best = int(np.argmax(np.where(inside, power, 0.0)))
    wide = max(power.size // 10, 100)
    near = power[max(best - wide, 0) : best + wide]
    floor = max(float(np.median(near)), 1e-12 * float(power[inside].max()))
    if power[best] < LINE * floor:
        return None
    return 2 * np.pi * float(hertz[best])


def refined(
    time: Values,
    values: Values,
    trends: Values,
    begun: Values,
    fixed: tuple[float | None, float | None],
) -> Values:
    """Return frequencies and damping ratios (m, 2) at which the oscillations leave least over."""
    step = max(1, time.size // LOOKED_AT)
    # Neighbours stand for each other only where no oscillation is faster than they are dense.
    step = max(1, min(step, int(np.pi / (3 * begun[:, 0].max() * (time[1] - time[0])))))
    time, values, trends = time[::step], values[::step], trends[::step]

    def left(numbers: Values) -> Values:
        modes = placed(numbers, begun, fixed)
        design = np.column_stack([columns(time, *modes.T), trends])
        made: Values = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
        return made

    best, least = np.zeros(2 * len(begun)), np.inf
    for damping in DAMPINGS:
        numbers = np.zeros(2 * len(begun))
        numbers[-1] = damping - begun[-1, 1]
        cost = float(np.sum(left(numbers) ** 2))
        if cost < least:
            best, least = numbers, cost
    scale = np.concatenate([np.full(len(begun), 1e-4), np.full(len(begun), 1e-3)])
    scale = scale.reshape(2, -1).T.ravel()
    found = least_squares(left, best, x_scale=scale, max_nfev=15)
    return placed(found.x, begun, fixed)


def placed(numbers: Values, begun: Values, fixed: tuple[float | None, float | None]) -> Values:
    """Return frequencies and damping ratios (m, 2) from their changes: relative, and absolute."""
    change = numbers.reshape(-1, 2)
    made = np.column_stack([begun[:, 0] * np.exp(change[:, 0]), begun[:, 1] + change[:, 1]])
    for place, value in enumerate(fixed):
        if value is not None:
            made[0, place] = value
    made[:, 1] = np.clip(made[:, 1], -0.5, 0.9)
    return made


__all__ = ["Decay", "columns", "decay_of", "rates"]
