"""Where a decay begins in its record, and roughly how fast and how damped the structure rings."""

from __future__ import annotations

import numpy as np

from iva.identification.chains import pulse_of
from iva.identification.masking import BLOW, dead_time
from iva.identification.pulses import places_of
from iva.identification.records import TREND, Recording
from iva.identification.responses import Values, to_jump, to_release

#: Samples of quiet that show where a record was at rest.
QUIET = 12
#: Share of the largest swing that says that the structure moves.
MOVES = 0.25


def onset(values: Values, sampling_hz: float, order: int) -> float | None:
    """Return the instant from the first sample at which motion sets in, in s, rough.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The record.
    sampling_hz : float
        Sampling rate.
    order : int
        0 for a displacement, 1 for a velocity, 2 for an acceleration.

    Returns
    -------
    float or None
        ``None`` if the record begins in motion.
    """
    width = 3
    smooth = np.convolve(np.pad(values, width, mode="edge"), np.ones(width) / width, mode="same")
    smooth = smooth[width:-width]
    base = float(np.median(smooth[:QUIET]))
    away = np.abs(smooth - base)
    # The highest values are pulses of impacts: a swing is what a tenth of all samples exceed.
    swing = float(np.quantile(away, 0.9))
    moves = np.convolve(away > MOVES * swing, np.ones(2 * width), mode="full")[2 * width - 1 :]
    first = int(np.argmax(moves > 2 * width - 0.5))  # for some samples, which noise does not
    if first < QUIET:
        return None
    # Of neighbours noise is independent, and motion next to nothing.
    noise = 1.4826 * float(np.median(np.abs(np.diff(values[:first])))) / np.sqrt(2)
    edge = max(0.03 * swing, 4.0 * noise)
    back = first
    while back > 0 and away[back] > edge:
        back -= 1
    if back < QUIET:
        return None
    lead = values[: back - width]
    unquiet = np.std(lead) > 1.5 * noise + 0.02 * swing
    # At rest there is neither velocity nor acceleration: what a sensor shows then is its offset.
    off = order > 0 and abs(base - float(np.mean(values))) > 0.2 * swing
    return None if unquiet or off else back / sampling_hz


def let_go(values: Values, sampling_hz: float, start: float, level: float, hertz: float) -> float:
    """Return the instant of the release in a displacement, from the parabola that follows it.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Displacement.
    sampling_hz : float
        Sampling rate.
    start : float
        Rough instant from the first sample in s.
    level : float
        Where the record stands before.
    hertz : float
        Rough frequency.
    """
    first = int(start * sampling_hz)
    last = first + max(int(0.15 * sampling_hz / hertz), 4)
    way = np.abs(values[first:last] - level)
    time = np.arange(first, first + way.size) / sampling_hz
    good = way > 0.02 * abs(level)
    if good.sum() < 3:
        return start
    slope, rest = np.polyfit(time[good], np.sqrt(way[good]), 1)
    return float(-rest / slope) if slope > 0 else start


def rough_frequency(values: Values, sampling_hz: float, order: int) -> float:
    """Return the frequency in Hz of the strongest line of the spectrum of the acceleration.

    In a displacement a slow pendulum may be larger than the structure that it hangs on.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The record after the release.
    sampling_hz : float
        Sampling rate.
    order : int
        0 for a displacement, 1 for a velocity, 2 for an acceleration.
    """
    if order == 2:
        # Pulses of impacts are far higher than the motion, and have all frequencies.
        middle = float(np.median(values))
        limit = 2 * float(np.quantile(np.abs(values - middle), 0.9))
        values = np.clip(values, middle - limit, middle + limit)
    window = np.hanning(values.size)
    size = 4 * values.size
    height = np.abs(np.fft.rfft((values - values.mean()) * window, size))
    frequencies = np.fft.rfftfreq(size, 1 / sampling_hz)
    height[frequencies < sampling_hz / values.size] = 0.0
    # The weight would lift noise and the tails of kinks above every line.
    height[height < max(10 * np.median(height), 0.05 * height.max())] = 0.0
    return float(frequencies[int(np.argmax(height * frequencies ** (2 - order)))])


def tails(recording: Recording, times: Values, jumps: Values) -> Values:
    """Return the pulses of impacts as their chain has them, shape (n,)."""
    made = np.zeros(recording.time.size + 1)
    if recording.shape is not None and times.size:
        samples, offset = places_of(times, recording.sampling_hz, recording.time.size)
        heights = pulse_of(recording.shape.chain).height(offset)
        np.add.at(made, samples, heights * jumps[:, None] * recording.sampling_hz)
    return made[:-1]


def scanned(
    recording: Recording,
    hertz: float,
    release: float,
    times: Values,
    jumps: Values,
) -> tuple[float, float, float, float, float]:
    """Return ω, ζ, instant and size of the release, and the cost, the best of a grid.

    At each point of the grid the record is linear in the size of the release, in a velocity at the
    release, which tells how far its instant is off, in a common factor of all jumps, and in trend
    and hum.
    """
    step = max(1, recording.time.size // 3000)
    hidden = BLOW / hertz if recording.blow else 1 / recording.sampling_hz
    use = recording.time > release + hidden
    near = dead_time(recording.sampling_hz, hertz)
    for time in times if recording.order else ():
        use &= np.abs(recording.time - time) > near / recording.sampling_hz
    picked = np.flatnonzero(use)[::step]
    time, values = (
        recording.time[picked],
        (recording.values - tails(recording, times, jumps))[picked],
    )
    trends = recording.trends[picked]
    trends = np.delete(trends, np.arange(recording.powers, TREND), axis=1)
    span = float(recording.time[-1] - release)
    fine = max(0.25 / span / hertz / 1.2, 0.001)
    # A line of few periods is broad.
    wide = 1.25 if span * hertz > 4 else 1.8
    fine = min(fine, 0.03)
    best = (np.inf, 0.0, 0.0, 0.0, 0.0)
    for ratio in np.arange(1 / wide, wide, fine):
        for zeta in (0.002, 0.008, 0.025):
            omega = 2 * np.pi * hertz * ratio
            jump = to_jump(omega, zeta, 0.0, recording.order)
            free = to_release(omega, zeta, 0.0, recording.order)
            at = np.array([release])
            columns = [free.total(time, at, np.ones(1)), jump.total(time, at, np.ones(1))]
            if times.size:
                columns.append(jump.total(time, times, jumps))
            design = np.column_stack([*columns, trends])
            inner = design.T @ design
            inner += np.diag(1e-10 * np.diag(inner) + 1e-300)
            answer = np.linalg.solve(inner, design.T @ values)
            rest = values - design @ answer
            cost = float(rest @ rest)
            if cost < best[0]:
                size, speed = answer[0], answer[1]
                # x0 cos ωt + (v/ω) sin ωt is a release somewhat later.
                if recording.blow:
                    # And a blow where the displacement is 0.
                    sign = 1.0 if speed >= 0 else -1.0
                    shift = float(np.arctan2(-sign * size, sign * speed / omega) / omega)
                    most = sign * float(np.hypot(size * omega, speed))
                    best = (cost, omega, zeta, release + shift, most)
                    continue
                shift = float(np.arctan2(speed / omega, size) / omega)
                best = (cost, omega, zeta, release + shift, float(np.hypot(size, speed / omega)))
                if size < 0:
                    shift = float(np.arctan2(-speed / omega, -size) / omega)
                    best = (cost, omega, zeta, release + shift, -best[4])
    cost, omega, zeta, instant, size = best
    return omega, zeta, instant, size, cost
