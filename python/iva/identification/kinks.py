"""Impacts found in a record of displacement or velocity: kinks or steps of a smooth curve."""

from __future__ import annotations

import numpy as np
from scipy.special import chdtri

from iva.identification.responses import Values

#: How many deviations of the noise a kink stands out.
CLEAR = 7.0
#: Noise that is assumed at least, over the standard deviation of the record.
LITTLE = 3e-4
#: Degree of the polynomial that the motion is beside it.
DEGREE = 4
#: Part of a period on each side of a place that is compared with one with a kink in it.
SIDE = 0.16
#: Least number of samples on a side.
FEWEST = 6


def kinks_in(
    values: Values,
    sampling_hz: float,
    frequency_hz: float,
    order: int,
    noise: float | None = None,
    closed: tuple[tuple[int, int], ...] = (),
) -> tuple[Values, Values, Values, float]:
    """Return instants from the first sample, jumps of velocity and their deviations.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Displacement or velocity.
    sampling_hz, frequency_hz : float
        Of the record, and of the motion beside the impacts.
    order : int
        0 for a displacement, 1 for a velocity.
    noise : float, optional
        Standard deviation of a sample; by default from the record.
    closed : tuple of (first, last)
        Samples between which none is looked for.

    Returns
    -------
    times, jumps, deviations : ndarray, shape (k,)
    noise : float
    """
    side = max(int(SIDE * sampling_hz / frequency_hz), FEWEST)
    place = np.arange(-side, side + 1) / side
    smooth = place[:, None] ** np.arange(DEGREE + 1)
    if order == 1:
        # A velocity between impacts is a wave: three powers of a curve and it leave less over.
        phase = 2 * np.pi * frequency_hz * place * side / sampling_hz
        smooth = np.column_stack([smooth[:, :3], np.cos(phase), np.sin(phase)])
    basis, _ = np.linalg.qr(smooth)
    if noise is None:
        noise = noise_of(values, basis)
    noise = max(noise, LITTLE * float(np.std(values)))
    size, variance, parts = values.size, np.inf, np.linspace(-0.5, 0.5, 11)
    best = np.zeros(size)
    jump, offset = np.zeros(size), np.zeros(size)
    windows = np.lib.stride_tricks.sliding_window_view(values, 2 * side + 1)
    span = side / sampling_hz
    for part in parts:
        since = place - part / side
        corner = np.where(since > 0, since * span if order == 0 else 1.0, 0.0)
        corner = corner - basis @ (basis.T @ corner)
        energy = float(corner @ corner)
        answer = windows @ corner / energy
        strength = np.abs(answer) * np.sqrt(energy)
        inner = slice(side, size - side)
        better = strength > best[inner]
        best[inner] = np.where(better, strength, best[inner])
        jump[inner] = np.where(better, answer, jump[inner])
        offset[inner] = np.where(better, part, offset[inner])
        variance = min(variance, noise**2 / energy)
    for first, last in closed:
        best[max(first, 0) : max(last + 1, 0)] = 0.0
    found: list[tuple[float, float]] = []
    while len(found) < 400:
        at = int(np.argmax(best))
        if best[at] < CLEAR * noise:
            break
        found.append(((at + offset[at]) / sampling_hz, jump[at]))
        # A kink is seen, weaker, wherever it stands in the window.
        best[max(at - side, 0) : at + side + 1] = 0.0
    found.sort()
    times = np.array([time for time, _ in found])
    jumps = np.array([size for _, size in found])
    return times, jumps, np.full(times.size, np.sqrt(variance)), noise


def noise_of(values: Values, basis: Values) -> float:
    """Return the standard deviation of what a smooth curve leaves over, from the median window."""
    windows = np.lib.stride_tricks.sliding_window_view(values, basis.shape[0])[::3]
    rest = np.sum(windows**2, axis=1) - np.sum((windows @ basis) ** 2, axis=1)
    # Most windows may have a kink in them: a low quantile, against that of χ².
    degrees = basis.shape[0] - basis.shape[1]
    low = float(np.quantile(np.maximum(rest, 0), 0.25))
    return float(np.sqrt(low / chdtri(degrees, 0.75)))


__all__ = ["kinks_in"]
