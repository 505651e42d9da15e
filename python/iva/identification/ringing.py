"""Further modes of the structure that ring after each impact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from iva.identification.pulses import REACH
from iva.identification.records import OMEGA, Inputs, Recording
from iva.identification.responses import Values

#: Power of a line of the answer to impacts, over the median, that makes it a further mode.
LINE = 60.0


def further_mode(
    recording: Recording, inputs: Inputs, rest: Values, mask: NDArray[np.bool_]
) -> Values | None:
    """Return a mode that rings after impacts and is not in the model yet, or ``None``.

    What follows all impacts, each divided by its jump and averaged with jump² as weight, is the
    answer to an impact; a line in its spectrum far above the others is a mode.
    """
    rate = recording.sampling_hz
    length = int(min(0.25 * rate, 0.5 * rest.size))
    shown = np.where(mask, rest, 0.0)
    answer = np.zeros(length)
    weight = 0.0
    for time, jump in zip(inputs.times, inputs.jumps, strict=True):
        first = int(time * rate) + REACH
        if first < 0 or first + length >= rest.size:
            continue
        answer += jump * shown[first : first + length]
        weight += jump**2
    if weight == 0.0:
        return None
    answer /= weight
    size = 4 * length
    spectrum = np.fft.rfft(answer * np.hanning(length), size)
    power = np.abs(spectrum) ** 2
    frequencies = np.fft.rfftfreq(size, 1 / rate)
    inside = (frequencies > 3 * inputs.head[OMEGA] / 2 / np.pi) & (frequencies < 0.4 * rate)
    power = np.where(inside, power, 0.0)
    best = int(np.argmax(power))
    if power[best] < LINE * np.median(power[inside]):
        return None
    height = 4 * np.abs(spectrum[best]) / length
    return np.array([height, 0.0, 2 * np.pi * frequencies[best], 0.02])


__all__ = ["further_mode"]
