"""Whether a record can be that of a decay with impacts, before anything is fitted."""

from __future__ import annotations

import numpy as np

from iva.identification.adequacy import unexplained
from iva.identification.beginnings import onset, rough_frequency
from iva.identification.detection import pulses_in
from iva.identification.kinks import SIDE, kinks_in
from iva.identification.modes import decay_of
from iva.identification.pulses import REACH
from iva.identification.records import Recording
from iva.identification.responses import Values

#: Share of the first amplitudes that the last ones of a decay do not reach.
STEADY = 0.85
#: Least number of periods of a record that is looked at, and of one that tells a decay.
LEAST = 1.2
PERIODS = 6
#: How often as large as before, and as at first, the motion of a second event is, over some
#: periods.
AGAIN, LARGE, WINDOW = 3.0, 0.3, 3
#: Share of a record that a structure alone may leave over.
SMALL = 0.15
#: Most impacts a period of a mass between two walls.
MOST = 10
NO_IMPACT = (
    "record: no impact is found in it; give a record in which the absorber strikes, an "
    "acceleration with the pulses of its contacts"
)


def check(recording: Recording, release: float | None, clock: float, floor: float) -> None:
    """Refuse a record that shows something else than one decay with impacts.

    Parameters
    ----------
    recording : Recording
        The record.
    release : float or None
        Instant of the release from the first sample in s, where it is known.
    clock : float
        Instant of the first sample on the clock of the record in s.
    floor : float
        Standard deviation of what is noise at any rate.

    Raises
    ------
    ValueError
        If the motion is that of the structure alone, does not decay, or begins anew.
    """
    rate = recording.sampling_hz
    begin = onset(recording.values, rate, recording.order) if release is None else release
    first = int(max(begin or 0.0, 0.0) * rate) + (REACH if recording.order == 2 else 2)
    values = recording.values[first:]
    if values.size < 100:
        raise ValueError("record: it ends at the release; give a longer one")
    hertz = rough_frequency(values, rate, recording.order)
    if not values.size / rate * hertz > LEAST:
        return  # It is too short to tell, which is said where it is fitted.
    made = decay_of(recording, first, floor, (None, None))
    small = made.omegas.size and made.noise < SMALL * float(np.std(values))
    if small and made.dampings[0] > 0 and not struck(recording, made.rest, hertz, floor):
        if unexplained(values, made.rest, np.ones(values.size, bool), floor):
            raise ValueError(NO_IMPACT)
        told = f"{made.omegas[0] / 2 / np.pi:.4g} Hz, damping ratio {made.dampings[0]:.2g}"
        raise ValueError(
            f"{NO_IMPACT}: the motion is that of the structure alone ({told}), which "
            "absorber = None identifies"
        )
    size = amplitudes(values, rate, hertz)
    if size.size < PERIODS:
        return
    quarter = max(size.size // 4, 1)
    mean = np.convolve(size, np.full(WINDOW, 1 / WINDOW), mode="valid")
    before, later = mean[:-WINDOW], mean[WINDOW:]
    jumps = np.flatnonzero((later > AGAIN * before) & (later > LARGE * mean[0]))
    if jumps.size:
        at = clock + first / rate + (int(jumps[0]) + WINDOW) / hertz
        raise ValueError(
            f"record: its motion begins anew at about {at:.4g} s, as in a second event; give one "
            "decay, up to there or from there on"
        )
    if np.mean(size[-quarter:]) > STEADY * np.mean(size[:quarter]):
        raise ValueError(
            "record: it is not a decay, its motion is as large at the end as at the beginning; "
            "give one"
        )


def struck(recording: Recording, rest: Values, hertz: float, floor: float) -> bool:
    """Return whether impacts stand out of what the structure alone leaves over."""
    noise = float(np.sqrt(np.mean(rest**2)))
    if noise < 2 * floor:
        return False
    rate = recording.sampling_hz
    if recording.order == 2:
        assert recording.shape is not None
        return bool(pulses_in(rest, rate, recording.shape)[0].size)
    side = int(SIDE * rate / hertz)
    return bool(kinks_in(rest, rate, hertz, recording.order, closed=((0, side),))[0].size)


def amplitudes(values: Values, sampling_hz: float, hertz: float) -> Values:
    """Return the amplitude of the oscillation at a frequency, period by period, shape (k,)."""
    each = max(round(sampling_hz / hertz), 2)
    count = values.size // each
    rows = values[: count * each].reshape(count, each)
    rows = rows - rows.mean(axis=1, keepdims=True)
    turning = np.exp(-2j * np.pi * np.arange(each) / each)
    made: Values = 2 * np.abs(rows @ turning) / each
    return made


def few_enough(count: int, periods: float) -> bool:
    """Return whether a mass between two walls may strike as often."""
    return count <= MOST * (periods + 1)


__all__ = ["NO_IMPACT", "amplitudes", "check", "few_enough"]
