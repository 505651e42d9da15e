"""Instants of impacts from the one to three samples that a short contact leaves without a filter.

One sample alone tells how far it is from the middle of the contact, not to which side, and only if
the size of the jump and the length of the contact are known. The motion tells the jumps, and all
pulses together the length: that at which they are the most likely. Instants and jumps are handed on
as means and deviations, and the samples of the pulses count no more.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from iva.identification.chains import SensorChain, pulse_of
from iva.identification.pulses import Shape
from iva.identification.records import HEAD, Inputs, Recording
from iva.identification.refining import Known, Refined
from iva.identification.responses import Values

#: Longest contact, in samples, of which a pulse may be a single sample or nearly so.
SHORT = 2.5
#: Samples on each side of the brightest one that show a pulse.
BESIDE = 3
#: Contacts in samples, and how far heights may be from a half sine (relative), that are compared.
LENGTHS = np.geomspace(0.8, SHORT, 14)
CLOSER = np.geomspace(0.92, 1.09, 9)
ROUGH = (0.01, 0.03, 0.1)
#: Instants that are compared, in samples from the brightest one.
PLACES = np.linspace(-1.6, 1.6, 161)
#: How far in samples a pulse may be from its place, so that its edge is not taken at its word.
BLUR = 0.06
#: What is known at first of a jump that was seen, relative, and at most of one from the motion.
SEEN, MOVED = 0.3, 0.002
#: Deviation of an instant at least, in samples: the grid is as fine.
FINE = 0.01


@dataclass(frozen=True)
class Seen:
    """What pulses say: contact in samples, roughness, means and deviations (2, k) of t and Δv."""

    contact: float
    roughness: float
    times: Values
    jumps: Values


@dataclass(frozen=True)
class Table:
    """Pulses of unit jumps (m, s) at each of :data:`PLACES`, and how large they are nearby."""

    heights: Values
    about: Values

    @classmethod
    def of(cls, length: float) -> Table:
        """Return those of a contact in samples."""
        pulse = pulse_of(SensorChain("none", 0.5, float(length)))
        away = np.arange(-BESIDE, BESIDE + 1)[None, :] - PLACES[:, None]
        return cls(pulse.height(away), pulse.height(np.maximum(np.abs(away) - BLUR, 0.0)))


def short(recording: Recording) -> bool:
    """Return whether pulses are too short to be fitted as they are."""
    shape = recording.shape
    return shape is not None and shape.chain.kind == "none" and shape.chain.contact < SHORT


def covered(recording: Recording, inputs: Inputs) -> NDArray[np.bool_]:
    """Return which samples show a pulse, shape (n,)."""
    made = np.zeros(recording.time.size, dtype=bool)
    middle = np.rint(inputs.times * recording.sampling_hz).astype(int)
    samples = middle[:, None] + np.arange(-BESIDE, BESIDE + 1)
    made[samples[(samples >= 0) & (samples < made.size)]] = True
    return made


def seen(recording: Recording, inputs: Inputs, noise: float, by_motion: Values | None) -> Seen:
    """Return what the pulses of a record say of contact, instants and jumps.

    Parameters
    ----------
    recording : Recording
        The record.
    inputs : Inputs
        Its numbers.
    noise : float
        Standard deviation of a sample.
    by_motion : ndarray, shape (2, k), optional
        Means and deviations of the jumps from the motion alone.
    """
    rate, sign = recording.sampling_hz, np.sign(inputs.jumps)
    jumps, spread = np.abs(inputs.jumps), SEEN * np.abs(inputs.jumps)
    if by_motion is not None and by_motion.shape[1] == jumps.size:
        jumps = np.maximum(by_motion[0] * sign, 0.1 * jumps)
        spread = np.maximum(by_motion[1], MOVED * jumps)
    middle, windows = windows_of(recording, inputs)
    windows = windows * sign[:, None] / rate

    def likeliest(lengths: Values, roughs: tuple[float, ...]) -> tuple[float, float]:
        best = (-np.inf, 0.0, 0.0)
        for length in lengths:
            table = Table.of(length)
            for rough in roughs:
                weights = densities(windows, table, jumps, spread, noise / rate, rough)
                told = float(np.sum(np.logaddexp.reduce(weights, axis=1)))
                best = max(best, (told, float(length), rough))
        return best[1], best[2]

    length, _ = likeliest(LENGTHS, ROUGH[1:2])
    length, rough = likeliest(np.minimum(length * CLOSER, 0.999 * SHORT), ROUGH)
    table = Table.of(length)
    by_both = shares_of(densities(windows, table, jumps, spread, noise / rate, rough))
    times = np.array([by_both @ PLACES, np.sqrt(by_both @ PLACES**2 - (by_both @ PLACES) ** 2)])
    times[0] += middle
    times[1] = np.maximum(times[1], FINE)
    # A jump by its pulse alone, so that the motion is not heard twice.
    alone = densities(windows, table, jumps, np.inf * jumps, noise / rate, rough)
    each, own = sizes_of(windows, table, jumps, noise / rate, rough)
    by_pulse = shares_of(alone)
    mean = np.sum(by_pulse * each, axis=1)
    over = np.sum(by_pulse * (own + each**2), axis=1) - mean**2
    made = np.array([mean * sign, np.sqrt(np.maximum(over, 0.0))])
    return Seen(length, rough, times / rate, made)


def windows_of(recording: Recording, inputs: Inputs) -> tuple[NDArray[np.intp], Values]:
    """Return the brightest sample of each impact (k,) and what pulses add about it (k, 7)."""
    rest = recording.values - recording.model(inputs)
    places = inputs.times * recording.sampling_hz
    near = np.clip(np.rint(places).astype(int), BESIDE + 1, rest.size - 2 - BESIDE)
    assert recording.shape is not None
    away = np.arange(-BESIDE - 1, BESIDE + 2)
    samples = near[:, None] + away
    own = pulse_of(recording.shape.chain).height(samples - places[:, None])
    added = rest[samples] + own * inputs.jumps[:, None] * recording.sampling_hz
    beside = added[:, BESIDE : BESIDE + 3] * np.sign(inputs.jumps)[:, None]
    first = np.argmax(beside, axis=1)
    picked = first[:, None] + np.arange(2 * BESIDE + 1)
    return near + first - 1, np.take_along_axis(added, picked, axis=1)


def sizes_of(
    windows: Values, table: Table, jumps: Values, noise: float, rough: float
) -> tuple[Values, Values]:
    """Return the jump that fits best at each instant, and its variance, shape (k, m) each."""
    precise = 1 / (noise**2 + (rough * jumps[:, None, None] * table.about) ** 2)
    energy = np.maximum(np.sum(precise * table.heights**2, axis=2), 1e-300)
    match = np.sum(precise * table.heights * windows[:, None, :], axis=2)
    return match / energy, 1 / energy


def densities(
    windows: Values, table: Table, jumps: Values, spread: Values, noise: float, rough: float
) -> Values:
    """Return the logarithm of the density of windows at each instant, shape (k, m).

    Parameters
    ----------
    windows : ndarray, shape (k, s)
        What pulses add at samples, over the sampling rate.
    table : Table
        Pulses of unit jumps at each instant.
    jumps, spread : ndarray, shape (k,)
        Mean and deviation of each jump; an infinite one leaves it free.
    noise : float
        Of a sample, over the sampling rate.
    rough : float
        How far heights are from those of the shape, relative.
    """
    precise = 1 / (noise**2 + (rough * jumps[:, None, None] * table.about) ** 2)
    each, own = sizes_of(windows, table, jumps, noise, rough)
    left = np.sum(precise * windows[:, None, :] ** 2, axis=2) - each**2 / own
    made = 0.5 * np.sum(np.log(precise), axis=2) - 0.5 * left
    free = ~np.isfinite(spread)
    wide = own + np.where(free, 1.0, spread)[:, None] ** 2
    tied = -0.5 * (each - jumps[:, None]) ** 2 / wide - 0.5 * np.log(wide / own)
    loose = 0.5 * np.log(own)
    made = made + np.where(free[:, None], loose, tied)
    return np.asarray(made, dtype=np.float64)


def shares_of(weights: Values) -> Values:
    """Return probabilities from logarithms of densities, shape (k, m)."""
    made = np.exp(weights - np.max(weights, axis=1, keepdims=True))
    shares: Values = made / np.sum(made, axis=1, keepdims=True)
    return shares


def with_seen(
    recording: Recording, inputs: Inputs, known: Known, told: Seen
) -> tuple[Recording, Inputs, Known]:
    """Return record, numbers and what is known of them, with what the pulses say."""
    hits = inputs.times.size
    mean, deviation = known.mean.copy(), known.deviation.copy()
    places = slice(HEAD, HEAD + hits), slice(HEAD + hits, HEAD + 2 * hits)
    for place, (middle, width) in zip(places, (told.times, told.jumps), strict=True):
        mean[place], deviation[place] = middle, width
    # Shape and width of pulses show nowhere.
    deviation[mean.size - inputs.pulse.size - inputs.widths.size :] = 0.0
    assert recording.shape is not None
    chain = replace(recording.shape.chain, contact=told.contact)
    half = float(np.max(recording.shape.splines))
    recording = replace(recording, shape=Shape(chain, half))
    inputs = replace(inputs, times=told.times[0].copy())
    return recording, inputs, Known(mean, deviation)


def without(refined: Refined, told: Seen) -> Values:
    """Return means and deviations (2, k) of the jumps as the motion alone has them."""
    hits = refined.inputs.times.size
    every = np.diag(refined.covariance)[HEAD + hits : HEAD + 2 * hits]
    precise = np.maximum(1 / every - 1 / told.jumps[1] ** 2, 1e-4 / every)
    mean = (refined.inputs.jumps / every - told.jumps[0] / told.jumps[1] ** 2) / precise
    return np.array([mean, 1 / np.sqrt(precise)])


__all__ = ["Seen", "covered", "seen", "short", "with_seen", "without"]
