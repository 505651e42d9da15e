"""Impacts found in a record of velocity as steps, and when these are.

A recorder smears a step over some samples, and so far as its filter is symmetrical the step stays
where it was. The smeared samples are not fitted with the motion: they tell the instants only. How
far it smears is told by all steps together: without a filter a step may be anywhere between two
samples.
"""

from __future__ import annotations

import numpy as np
from scipy.special import logsumexp, ndtr

from iva.identification.detection import CLEAR, pulses_in
from iva.identification.records import Inputs, Recording
from iva.identification.responses import Values

#: Samples on each side of a step that are compared, and standard deviations of its smear.
BESIDE, SMEARS = 6, (0.02, 0.1, 0.2, 0.3, 0.4, 0.5)
#: Samples beside a step that a recorder smears most.
SMEARED = 4
#: Instants that are compared, in samples from where the step was thought to be.
PLACES = np.linspace(-3.5, 3.5, 141)
#: How far steps may be from that shape, and what is known of their sizes, relative.
ROUGH, KNOWN = 0.1, 0.2
#: Deviation of an instant at least, in samples.
FINE = 0.1


def steps_in(
    values: Values,
    sampling_hz: float,
    closed: tuple[tuple[int, int], ...] = (),
    noise: float = 0.0,
) -> tuple[Values, Values]:
    """Return instants from the first sample in s and jumps of velocity of all steps.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Velocity in m/s.
    sampling_hz : float
        Sampling rate.
    closed : tuple of (first, last)
        Samples between which none is looked for.
    noise : float
        Standard deviation of a sample, where it is known.
    """
    times, jumps = pulses_in(np.diff(values) * sampling_hz, sampling_hz, closed=closed)
    clear = np.abs(jumps) > CLEAR * noise
    return times[clear] + 0.5 / sampling_hz, jumps[clear]


def smooth_of(
    values: Values, sampling_hz: float, hertz: float, times: Values, jumps: Values
) -> Values:
    """Return values without steps and the cosines that follow them, shape (n,).

    Parameters
    ----------
    values : ndarray, shape (n,)
        Velocity in m/s.
    sampling_hz, hertz : float
        Of the record, and of the structure.
    times, jumps : ndarray, shape (k,)
        Of the steps.
    """
    time = np.arange(values.size) / sampling_hz
    made, smeared = values.copy(), np.zeros(values.size, dtype=bool)
    for at, jump in zip(times, jumps, strict=True):
        since = time - at
        made -= np.where(since > 0, jump * np.cos(2 * np.pi * hertz * since), 0.0)
        smeared |= np.abs(since) * sampling_hz < SMEARED
    if smeared.any() and not smeared.all():
        made[smeared] = np.interp(time[smeared], time[~smeared], made[~smeared])
    return made


def instants(recording: Recording, inputs: Inputs, noise: float) -> tuple[Values, Values]:
    """Return instants of steps in s and their deviations, shape (k,) each.

    Parameters
    ----------
    recording : Recording
        Of a velocity.
    inputs : Inputs
        Its numbers.
    noise : float
        Standard deviation of a sample.
    """
    rate = recording.sampling_hz
    rest = recording.values - recording.model(inputs)
    away = np.arange(-BESIDE, BESIDE + 1)
    middle = np.rint(inputs.times * rate).astype(int)
    samples = middle[:, None] + away
    inside = (samples >= 0) & (samples < rest.size)
    behind = samples > (inputs.times * rate)[:, None]
    size = np.abs(inputs.jumps)[:, None]
    window = rest[np.clip(samples, 0, rest.size - 1)] * np.sign(inputs.jumps)[:, None]
    window = window + size * behind
    near = np.exp(-0.5 * ((away[None, :] - PLACES[:, None]) / 1.5) ** 2)
    variance = noise**2 + (ROUGH * size[:, :, None] * near) ** 2
    weight = np.where(inside[:, None, :], 1 / variance, 0.0)
    known = np.sum(np.log(variance) * inside[:, None, :], axis=2)
    told = [-0.5 * (misfit(window, weight, size, smear) + known) for smear in SMEARS]
    # Of each step the mean over its places; the smear is that of all steps.
    likely = [np.sum(logsumexp(each, axis=1)) for each in told]
    best = told[int(np.argmax(likely))]
    share = np.exp(best - best.max(axis=1, keepdims=True))
    share /= share.sum(axis=1, keepdims=True)
    mean = share @ PLACES
    spread = np.sqrt(np.maximum(share @ PLACES**2 - mean**2, FINE**2))
    return (middle + mean) / rate, spread / rate


def misfit(window: Values, weight: Values, size: Values, smear: float) -> Values:
    """Return χ² of each step at each place, shape (k, places), with what is known of its size.

    Parameters
    ----------
    window : ndarray, shape (k, samples)
        The record about each step, which rises.
    weight : ndarray, shape (k, places, samples)
        One over the variance.
    size : ndarray, shape (k, 1)
        Of the steps.
    smear : float
        Standard deviation of the smear, in samples.
    """
    away = np.arange(-BESIDE, BESIDE + 1)
    step = ndtr((away[None, :] - PLACES[:, None]) / smear)
    # Level and size of the step follow linearly at each place.
    level, slope = np.sum(weight, axis=2), np.sum(weight * step, axis=2)
    steep = np.sum(weight * step**2, axis=2) + (KNOWN * size) ** -2.0
    first = np.sum(weight * window[:, None, :], axis=2)
    second = np.sum(weight * step * window[:, None, :], axis=2) + size / (KNOWN * size) ** 2
    both = np.maximum(level * steep - slope**2, 1e-300)
    gained = (first**2 * steep - 2 * first * second * slope + second**2 * level) / both
    whole = np.sum(weight * window[:, None, :] ** 2, axis=2)
    made: Values = whole - gained + np.log(both)
    return made


__all__ = ["SMEARED", "instants", "smooth_of", "steps_in"]
