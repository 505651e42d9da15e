"""Whether the model explains a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr

from iva.identification.responses import Values

#: Probability, by chance, of what is taken for a dependence of restitution.
CHANCE = 3e-4
#: Change of restitution over all impacts that does not matter.
SLIGHT = 0.01
#: Largest standard deviation of a restitution that has a say.
SURE = 0.15
#: Least number of impacts that can show it.
ENOUGH = 6
#: Power of a line of the residual, over the median, that noise does not reach.
LINE = 40.0
#: Scatter of restitution, and play of a wall, beyond which one law of contact is no model.
MOST_SCATTER = 0.2
MOST_PLAY = 0.02
#: Share of a record that may be left over, and how much louder than noise that is otherwise.
UNEXPLAINED, LOUDER = 0.03, 1.5
#: Least number of values at one end that are cut off.
CUT = 4


def law_of_restitution(
    speeds: Values, times: Values, restitutions: Values, variances: Values
) -> list[str]:
    """Return how restitution depends on speed or on time, in words; empty if it does not.

    Parameters
    ----------
    speeds, times, restitutions : ndarray, shape (k,)
        Approach speed in m/s, instant in s and restitution of each impact.
    variances : ndarray, shape (k,)
        Of the restitutions, from the noise of the record.
    """
    good = np.sqrt(variances) < SURE
    if good.sum() < ENOUGH:
        return []
    speeds, times = speeds[good], times[good]
    restitutions, variances = restitutions[good], variances[good]
    strengths = []
    for cause in (speeds, times):
        slope, error = regressed(cause, restitutions, variances)
        strengths.append((slope / error, slope))
    (by_speed, slope), (by_time, trend) = strengths
    chance = 2 * stdtr(speeds.size - 2, -max(abs(by_speed), abs(by_time)))
    by = slope * np.ptp(speeds) if abs(by_speed) >= abs(by_time) else trend * np.ptp(times)
    if chance > CHANCE or abs(by) < SLIGHT:
        return []
    if abs(by_speed) >= abs(by_time):
        way = "falls" if slope < 0 else "rises"
        low, high = speeds.min(), speeds.max()
        middle, about = np.average(restitutions, weights=1 / (variances + 1e-6)), speeds.mean()
        ends = [middle + slope * (at - about) for at in (low, high)]
        return [
            f"restitution {way} with speed, from {ends[0]:.2f} at {low:.3g} m/s to {ends[1]:.2f} "
            f"at {high:.3g} m/s"
        ]
    way = "falls" if trend < 0 else "rises"
    return [f"restitution {way} in the course of the record: a trend of {trend:+.3g} a second"]


def regressed(cause: Values, values: Values, variances: Values) -> tuple[float, float]:
    """Return slope of values over a cause and its standard deviation.

    The scatter that the variances do not explain is estimated along with the line, by repetition.
    """
    extra = 0.0
    slope, error = 0.0, np.inf
    for _ in range(30):
        weight = 1 / (variances + extra + 1e-10)
        middle = np.average(cause, weights=weight)
        mean = np.average(values, weights=weight)
        spread = np.sum(weight * (cause - middle) ** 2)
        if spread <= 0:
            return 0.0, np.inf
        slope = float(np.sum(weight * (cause - middle) * (values - mean)) / spread)
        error = float(1 / np.sqrt(spread))
        rest = values - mean - slope * (cause - middle)
        # Of variances that differ: the extra one at which χ² is what it should be, by steps.
        chi = np.sum(rest**2 * weight) / (values.size - 2)
        total = np.mean(rest**2) * values.size / (values.size - 2)
        change = extra + (chi - 1) * total / max(chi, 1.0)
        if abs(max(change, 0.0) - extra) < 1e-3 * total:
            break
        extra = max(change, 0.0)
    return slope, error


def lines_of(rest: Values, weights: Values, sampling_hz: float, frequency_hz: float) -> list[str]:
    """Return what rings in the residual, in words; empty if it is noise.

    Parameters
    ----------
    rest : ndarray, shape (n,)
        Measured less modelled.
    weights : ndarray, shape (n,)
        1/σ of each sample, 0 where it is masked.
    sampling_hz, frequency_hz : float
        Of the record and of the structure.
    """
    white = rest * weights
    spectrum = np.abs(np.fft.rfft(white * np.hanning(white.size))) ** 2
    frequencies = np.fft.rfftfreq(white.size, 1 / sampling_hz)
    used = frequencies > 2 * sampling_hz / white.size
    # The noise may have a colour: a line stands out of its neighbourhood.
    width = max(25, white.size // 60)
    padded = np.pad(spectrum, width, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * width + 1)[:: max(width // 4, 1)]
    places = np.arange(0, spectrum.size, max(width // 4, 1))[: windows.shape[0]]
    level = np.interp(np.arange(spectrum.size), places, np.median(windows, axis=1))
    # Near the motion the fit has taken much of the noise: the level is at least that of all noise.
    flat = np.log(2) * float(np.sum(np.hanning(white.size)[weights > 0] ** 2))
    height = np.where(used, spectrum / np.maximum(level, flat), 0.0)
    best = int(np.argmax(height))
    if height[best] < LINE:
        return []
    hertz = float(frequencies[best])
    if abs(hertz / frequency_hz - 1) < 0.2:
        return [f"the motion at {hertz:.3g} Hz is not that of the model"]
    return [f"something rings at {hertz:.4g} Hz that the model has not, such as a second mode"]


def noise_of(values: Values, good: NDArray[np.bool_]) -> float:
    """Return the standard deviation of noise, from differences of neighbours that both count."""
    pairs = good[1:] & good[:-1]
    if not pairs.any():
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(values)[pairs])) / np.sqrt(2))


def unexplained(values: Values, rest: Values, good: NDArray[np.bool_], floor: float) -> list[str]:
    """Return whether more is left over than noise, in words; empty if not.

    Parameters
    ----------
    values, rest : ndarray, shape (n,)
        Measured, and measured less modelled.
    good : ndarray of bool, shape (n,)
        True where a sample counts.
    floor : float
        Standard deviation of what is noise at any rate.
    """
    if good.sum() < 20:
        return []
    left, all_of_it = float(np.std(rest[good])), float(np.std(values[good]))
    if left < UNEXPLAINED * all_of_it or left < LOUDER * max(noise_of(values, good), floor):
        return []
    return [f"{left / all_of_it:.0%} of the record is neither the motion of the model nor noise"]


def cut_off(values: Values) -> list[str]:
    """Return whether a recorder has cut off the largest values, in words; empty if not."""
    spread = float(np.max(values) - np.min(values))
    step = float(np.min(np.diff(np.unique(values)), initial=spread))
    for end in (np.max(values), np.min(values)):
        flat = np.abs(values - end) <= 1e-9 * spread
        # A top that is rounded has neighbours one step of the recorder lower; one that is cut off
        # has nothing near it.
        near = (np.abs(values - end) <= max(0.02 * spread, 3 * step)) & ~flat
        if np.sum(flat) >= CUT and np.sum(flat) > 2 * np.sum(near):
            return [f"values are cut off at {end:.4g}, {np.sum(flat)} of them"]
    return []


def contact_law(scatter: float, play: float) -> list[str]:
    """Return whether the impacts are too unlike each other for one law, in words."""
    made = []
    if scatter > MOST_SCATTER:
        made.append(f"restitution scatters by {scatter:.0%} from impact to impact")
    if play > MOST_PLAY:
        made.append(f"the walls are {play:.1%} of the clearance off from impact to impact")
    return made


__all__ = ["contact_law", "cut_off", "law_of_restitution", "lines_of", "unexplained"]
