"""Impacts found in a record of acceleration.

Only a pulse has much in the upper part of the spectrum: motion, ringing and hum lie below. What
passes a high pass is compared with one pulse at every place, the largest agreement is taken and
subtracted, and so on while what is left stands out of the noise.
"""

from __future__ import annotations

import numpy as np

from iva.identification.pulses import REACH, WIDE, first_guess, shapes, whole
from iva.identification.responses import Values

#: Corner of the high pass over the sampling rate.
UPPER = 0.15
#: Half length of its kernel in samples.
HALF = 24
#: How many deviations of the noise an impact stands out.
CLEAR = 6.0
#: Places between two samples at which a pulse is tried.
PARTS = 20
#: A smaller one within this many samples of a larger counts only above `SHARE` of it.
NEAR = 45


def above(values: Values) -> Values:
    """Return the part of a record above the corner, shape (n,); its ends are taken as constant."""
    taps = np.arange(-HALF, HALF + 1)
    kernel = -2 * UPPER * np.sinc(2 * UPPER * taps) * np.hanning(taps.size + 2)[1:-1]
    kernel *= 1 / -kernel.sum()
    kernel[HALF] += 1.0
    padded = np.pad(values, HALF, mode="edge")
    made: Values = np.convolve(padded, kernel, mode="valid")
    return made


def deviation(values: Values) -> float:
    """Return the standard deviation of noise, from its median."""
    return float(1.4826 * np.median(np.abs(values - np.median(values))))


def pulses_in(
    values: Values,
    sampling_hz: float,
    pulse: Values | None = None,
    share: float = 0.3,
    closed: tuple[tuple[int, int], ...] = (),
    limit: int = 400,
) -> tuple[Values, Values]:
    """Return instants from the first sample in s and jumps of velocity of all pulses.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Acceleration in m/s².
    sampling_hz : float
        Sampling rate.
    pulse : ndarray, shape (REACH,), optional
        The pulse where it is known already.
    share : float
        Size below which a pulse beside a larger one is taken for what that one has left over.
    closed : tuple of (first, last)
        Samples between which no impact is looked for.
    limit : int
        Most impacts.

    Returns
    -------
    times, jumps : ndarray, shape (k,)
    """
    shares = whole(first_guess() if pulse is None else pulse)
    rest = above(values)
    count, span = rest.size, 2 * WIDE
    table = np.stack([high_pulse(shares, part / PARTS) * sampling_hz for part in range(PARTS)])
    energy = np.sum(table**2, axis=1)
    match = np.convolve(rest, table[0][::-1], mode="same") / energy[0]
    noise = max(deviation(match), 1e-300)
    barred = np.zeros(count, dtype=bool)
    for first, last in closed:
        barred[max(first, 0) : max(last + 1, 0)] = True
    found: list[tuple[float, float]] = []
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
        beside = [abs(other) for spot, other in found if abs(spot - at) < NEAR]
        close = min((abs(spot - at) for spot, _ in found), default=np.inf)
        if close < 2.0 or (beside and abs(size) < share * max(beside)):
            barred[max(place - 3, 0) : place + 4] = True
            continue
        found.append((at, size))
    found.sort()
    times = np.array([place / sampling_hz for place, _ in found])
    return times, np.array([size for _, size in found])


def high_pulse(shares: Values, place: float) -> Values:
    """Return what the high pass leaves of a pulse `place` samples after the middle one.

    Shape (4 WIDE + 1,), for a jump of 1 m/s at one sample a second.
    """
    middle = 2 * WIDE
    samples, parts, _ = shapes(np.array([middle + place]), 2 * middle + 1)
    shape = np.zeros(2 * middle + 1)
    np.add.at(shape, samples[0], parts[0] @ shares)
    return above(shape)


__all__ = ["CLEAR", "REACH", "above", "deviation", "pulses_in"]
