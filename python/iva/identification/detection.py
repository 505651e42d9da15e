"""Impacts found in a record of acceleration.

Only a pulse has much in the upper part of the spectrum: motion, ringing and hum lie below. What
passes a high pass is compared with one pulse at every place, the largest agreement is taken and
subtracted, and so on while what is left stands out of the noise.
"""

from __future__ import annotations

import numpy as np

from iva.identification.chains import SensorChain
from iva.identification.pulses import WIDE, Shape
from iva.identification.responses import Values

#: Corner of the high pass over the sampling rate.
UPPER = 0.15
#: Half length of its kernel in samples.
HALF = 24
TAPS = np.arange(-HALF, HALF + 1)
LOWER = 2 * UPPER * np.sinc(2 * UPPER * TAPS) * np.hanning(TAPS.size + 2)[1:-1]
#: That kernel: what a low pass leaves out.
KERNEL = (TAPS == 0) - LOWER / LOWER.sum()
#: How many deviations of the noise an impact stands out.
CLEAR = 6.0
#: Size of the smallest pulse that is looked for, over the largest that is left.
DYNAMIC = 3e-3
#: Places between two samples at which a pulse is tried.
PARTS = 20
#: A smaller one within this many samples of a larger counts only above `SHARE` of it.
NEAR = 45
#: Pulses of a usual recorder.
GUESS = Shape(SensorChain())


def above(values: Values) -> Values:
    """Return the part of a record above the corner, shape (..., n); its ends are constant."""
    padded = np.pad(values, [(0, 0)] * (values.ndim - 1) + [(HALF, HALF)], mode="edge")
    made: Values = np.lib.stride_tricks.sliding_window_view(padded, 2 * HALF + 1, -1) @ KERNEL
    return made


def deviation(values: Values) -> float:
    """Return the standard deviation of noise, from its median."""
    return float(1.4826 * np.median(np.abs(values - np.median(values))))


def pulses_in(
    values: Values,
    sampling_hz: float,
    shape: Shape = GUESS,
    shares: Values | None = None,
    share: float = 0.3,
    closed: tuple[tuple[int, int], ...] = (),
    present: tuple[Values, Values] = (np.zeros(0), np.zeros(0)),
    limit: int = 400,
) -> tuple[Values, Values]:
    """Return instants from the first sample in s and jumps of velocity of all pulses.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Acceleration in m/s².
    sampling_hz : float
        Sampling rate.
    shape : Shape
        What the pulse is made of.
    shares : ndarray, shape (s,), optional
        The pulse where it is known already.
    share : float
        Size below which a pulse beside a larger one is taken for what that one has left over.
    closed : tuple of (first, last)
        Samples between which no impact is looked for.
    present : tuple of ndarray, shape (m,)
        Instants and jumps of pulses that have been taken out of the values before.
    limit : int
        Most impacts.

    Returns
    -------
    times, jumps : ndarray, shape (k,)
    """
    rest = above(values)
    count, span = rest.size, 2 * WIDE
    table = high_pulses(shape, shares, np.arange(PARTS) / PARTS) * sampling_hz
    energy = np.sum(table**2, axis=1)
    match = np.convolve(rest, table[0][::-1], mode="same") / energy[0]
    largest = max(float(np.max(np.abs(match))), float(np.max(np.abs(present[1]), initial=0.0)))
    noise = max(deviation(match), DYNAMIC * largest / CLEAR, 1e-300)
    barred = np.zeros(count, dtype=bool)
    for first, last in closed:
        barred[max(first, 0) : max(last + 1, 0)] = True
    found: list[tuple[float, float]] = []
    others = list(zip(present[0] * sampling_hz, present[1], strict=True))
    padded = np.pad(rest, span)  # sample i stands at i + span
    while len(found) < limit:
        strength = np.where(barred, 0.0, np.abs(match))
        place = int(np.argmax(strength))
        if strength[place] < CLEAR * noise:
            break
        # The side lobes of the match are nearly as high as its peak: look around.
        starts = np.arange(max(place - 3, 0), min(place + 3, count - 1) + 1)
        windows = np.stack([padded[at : at + 2 * span + 1] for at in starts])
        sizes = windows @ table.T / energy
        which, part = np.unravel_index(int(np.argmax(sizes**2 * energy)), sizes.shape)
        middle, size = int(starts[which]), float(sizes[which, part])
        at = middle + int(part) / PARTS
        padded[middle : middle + 2 * span + 1] -= size * table[part]
        around = slice(max(middle - 2 * span, 0), min(middle + 2 * span + 1, count))
        local = padded[around.start : around.stop + 2 * span]
        match[around] = np.correlate(local, table[0], mode="valid") / energy[0]
        beside = [abs(other) for spot, other in found + others if abs(spot - at) < NEAR]
        close = min((abs(spot - at) for spot, _ in found), default=np.inf)
        if close < 2.0 or (beside and abs(size) < share * max(beside)):
            barred[max(place - 3, 0) : place + 4] = True
            continue
        found.append((at, size))
    found.sort()
    times = np.array([place / sampling_hz for place, _ in found])
    return times, np.array([size for _, size in found])


def high_pulses(shape: Shape, shares: Values | None, places: Values) -> Values:
    """Return what the high pass leaves of pulses `places` samples after the middle one.

    Shape (k, 4 WIDE + 1), for a jump of 1 m/s at one sample a second.
    """
    offset = np.arange(-2 * WIDE, 2 * WIDE + 1)[None, :] - places[:, None]
    known = np.zeros(shape.size) if shares is None else shares
    inside = np.abs(offset) <= WIDE
    made = np.where(inside, shape.pulse(offset, known, np.zeros(places.size)), 0.0)
    return above(made)


__all__ = ["CLEAR", "above", "deviation", "high_pulses", "pulses_in"]
