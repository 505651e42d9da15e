"""The chain between impacts and samples, as the strongest pulses of a record tell it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from iva.identification.chains import KINDS, SensorChain
from iva.identification.detection import HALF, above, high_pulses, pulses_in
from iva.identification.pulses import Shape
from iva.identification.responses import Values

#: Pulses that are compared, and the samples on each side of them.
MOST = 12
BESIDE = 20
#: Least distance to a neighbour that is as large, in samples.
APART = 45
#: Corners over the sampling rate, and lengths of contacts in samples, that are tried.
CORNERS = (0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45)
CONTACTS = (0.3, 1.35, 2.4)
#: Shortest and longest contact, and number of those that are tried, without a filter.
LENGTHS = (0.5, 12.0, 64)
#: What leaves less than this many times the least over is as good.
ALIKE = 2.0
#: Share of what pulses without a filter leave over that is left with one, where there is one.
PLAIN = 0.5
#: Places between two samples at which a pulse is tried.
PARTS = 10
#: The same without a filter, where pulses have edges.
SHARP = 40


def chain_of(
    values: Values, sampling_hz: float, closed: tuple[tuple[int, int], ...] = ()
) -> SensorChain:
    """Return the chain whose pulses leave the least over.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Acceleration in m/s².
    sampling_hz : float
        Sampling rate.
    closed : tuple of (first, last)
        Samples between which no impact is looked for.
    """
    times, jumps = pulses_in(values, sampling_hz, closed=closed, limit=200)
    windows = cut(above(values), times * sampling_hz, jumps)
    if not len(windows):
        return SensorChain()
    best = unfiltered(windows)
    for kind in KINDS[1:]:
        tried = [SensorChain(kind, corner, contact) for corner in CORNERS for contact in CONTACTS]
        costs = [left_over(windows, chain) for chain in tried]
        first = int(np.argmin(costs))
        cost, chain = polished(windows, tried[first], costs[first])
        # A filter above half the sampling rate passes for none where contacts are short.
        if cost < (best[0] if best[1].kind != "none" else PLAIN * best[0]):
            best = (cost, chain)
    return best[1]


def unfiltered(windows: Values) -> tuple[float, SensorChain]:
    """Return the least that pulses without a filter leave over, and their chain.

    Of contacts shorter than two samples many lengths do as well: then it is the one in their midst.
    """
    tried = [SensorChain("none", 0.5, float(contact)) for contact in np.geomspace(*LENGTHS)]
    costs = np.array([left_over(windows, chain, SHARP) for chain in tried])
    alike = np.flatnonzero(costs < ALIKE * costs.min())
    return float(costs.min()), tried[int(alike[alike.size // 2])]


def polished(windows: Values, chain: SensorChain, cost: float) -> tuple[float, SensorChain]:
    """Return the least that chains of a kind leave over, and the chain."""

    def at(logarithms: Values) -> SensorChain:
        cutoff, contact = np.exp(logarithms)
        return replace(
            chain,
            cutoff=float(np.clip(cutoff, 0.08, 0.6)),
            contact=float(np.clip(contact, 0.05, 12.0)),
        )

    found = minimize(
        lambda logarithms: left_over(windows, at(logarithms)),
        np.log([chain.cutoff, chain.contact]),
        method="Nelder-Mead",
        options={"maxfev": 40, "xatol": 3e-3, "fatol": 1e-4 * cost},
    )
    return float(found.fun), at(found.x)


def cut(high: Values, places: Values, jumps: Values) -> Values:
    """Return the samples about the strongest pulses that stand apart, shape (k, 2 BESIDE + 1)."""
    chosen: list[Values] = []
    for index in np.argsort(-np.abs(jumps)):
        middle = int(np.rint(places[index]))
        near = np.abs(places - places[index]) < APART
        alone = np.sum(near & (np.abs(jumps) > 0.1 * np.abs(jumps[index]))) == 1
        inside = BESIDE + HALF < middle < high.size - BESIDE - HALF
        if inside and alone:
            chosen.append(high[middle - BESIDE : middle + BESIDE + 1])
        if len(chosen) == MOST:
            break
    return np.array(chosen).reshape(len(chosen), 2 * BESIDE + 1)


def left_over(windows: Values, chain: SensorChain, parts: int = PARTS) -> float:
    """Return the sum of squares that pulses of a chain leave of all windows.

    Each has a place, within three samples, and a size: the best place of a grid, and from there
    linear in the rest.
    """
    shape = Shape(chain)
    table = high_pulses(shape, None, np.arange(-3 * parts, 3 * parts + 1) / parts)
    middle = table.shape[1] // 2
    table = table[:, middle - BESIDE : middle + BESIDE + 1]
    energy = np.sum(table**2, axis=1)
    energy = np.maximum(energy, 1e-9 * energy.max())
    match = windows @ table.T
    best = np.argmax(match**2 / energy, axis=1)
    slopes = np.gradient(table, 1 / parts, axis=0)[best]
    table = table[best]
    # Between two places of the grid, to first order, and no further.
    across = np.sum(table * slopes, axis=1)
    steep = np.maximum(np.sum(slopes**2, axis=1) - across**2 / energy[best], 1e-300)
    size = match[np.arange(best.size), best] / energy[best]
    step = (np.sum(windows * slopes, axis=1) - size * across) / steep
    table = table + np.clip(step / size, -0.5 / parts, 0.5 / parts)[:, None] * slopes
    size = np.sum(windows * table, axis=1) / np.sum(table**2, axis=1)
    return float(np.sum((windows - size[:, None] * table) ** 2))
