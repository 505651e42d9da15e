"""The record of a decay with a free mass, explained by release, impacts and sensor alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iva.identification.beginnings import onset, rough_frequency, scanned
from iva.identification.detection import pulses_in
from iva.identification.pulses import REACH, first_guess
from iva.identification.records import CORNER, HEAD, MODE, OMEGA, RELEASE, SIZE, ZETA, Inputs, Recording
from iva.identification.refining import Known, Refined, refine
from iva.identification.responses import Values

#: Width in rad/s of what is expected of the corner of a high pass: half a hertz.
CORNERS = np.pi
#: How far a pulse may be from that of a usual filter.
SHAPES = 0.3
#: Frequencies of the mains in Hz.
MAINS = (50.0, 60.0)
#: Power of a line of the answer to impacts, over the median, that makes it a further mode.
LINE = 60.0
#: Most further modes.
MODES = 2


@dataclass(frozen=True)
class Explained:
    """A record and the numbers that explain it.

    ``noise`` is the standard deviation away from pulses, ``roughness`` how far pulses are from one
    shape, relative. ``mask`` (n,) is True where a sample counts.
    """

    recording: Recording
    refined: Refined
    known: Known
    noise: float
    roughness: float
    mask: Values
    modes_hz: tuple[float, ...]


def explained(
    recording: Recording,
    floor: float,
    fixed: dict[int, float],
    priors: dict[int, tuple[float, float]],
) -> Explained:
    """Return what explains a record of acceleration.

    Parameters
    ----------
    recording : Recording
        Its weights are set here.
    floor : float
        Least standard deviation of the noise, that of rounding.
    fixed : dict
        Numbers of the head that are known exactly, by place.
    priors : dict
        Mean and deviation of others.

    Raises
    ------
    ValueError
        If no impact is found, or it cannot be told when the structure was let go.
    """
    rate = recording.sampling_hz
    begin = fixed.get(RELEASE)
    start = onset(recording.values, rate) if begin is None else begin
    after = int(max(start or 0.0, 0.0) * rate)
    hertz = rough_frequency(recording.values[after:], rate, recording.order)
    if OMEGA in fixed:
        hertz = fixed[OMEGA] / 2 / np.pi
    edge = (after - REACH, after + REACH)
    times, jumps = pulses_in(recording.values, rate, closed=(edge,))
    if not times.size:
        raise ValueError(
            "record: no impact is found in it; give a record in which the absorber strikes"
        )
    omega, zeta, instant, size, _ = scanned(
        recording, hertz, start if start is not None else 0.0, times, jumps
    )
    if start is None and abs(instant - round(0.5 * omega * instant / np.pi) * 2 * np.pi / omega) > 3 / rate:
        raise ValueError(
            "start.time = None: the record begins in motion; give the instant of the release"
        )
    head = np.array([omega, zeta, 0.5, start if begin is not None else instant, size])
    for place, value in fixed.items():
        head[place] = value
    inputs = Inputs(
        head, times, jumps, np.zeros(4), np.zeros(2 * len(recording.hum_hz)),
        np.zeros((0, MODE)), first_guess(),
    )
    noise, roughness = float(np.std(recording.values)) / 10, 0.1
    mask = np.ones(recording.time.size, dtype=bool)
    modes_hz: tuple[float, ...] = ()
    searched = False
    for attempt in range(12):
        release = inputs.head[RELEASE]
        mask = np.abs(recording.time - release) > REACH / rate
        if begin is None and start is None:
            mask &= recording.time > release
        known = known_of(inputs, fixed, priors)
        recording.weights = weighted(recording, inputs, mask, noise, roughness)
        refined = refine(recording, inputs, known, steps=6 if attempt < 2 else 25)
        inputs = refined.inputs
        rest = recording.values - recording.model(inputs)
        before = noise
        noise, roughness = spread(recording, inputs, rest, mask, floor)
        if attempt < 2:
            continue
        if abs(noise / before - 1) > 0.05:
            continue
        line = further_mode(recording, inputs, rest, mask) if len(inputs.modes) < MODES else None
        if line is not None:
            inputs = replace(inputs, modes=np.vstack([inputs.modes, line]))
            modes_hz = tuple(float(mode[2]) / 2 / np.pi for mode in inputs.modes)
            continue
        if not searched:
            searched = True
            more, sizes = pulses_in(
                rest, rate, inputs.pulse, closed=tuple(closed_by(recording, inputs))
            )
            if more.size:
                inputs = inputs.with_impacts(
                    np.concatenate([inputs.times, more]), np.concatenate([inputs.jumps, sizes])
                )
                continue
        break
    return Explained(recording, refined, known, noise, roughness, mask, modes_hz)


def closed_by(recording: Recording, inputs: Inputs) -> list[tuple[int, int]]:
    """Return the samples around impacts and release at which no further impact is looked for."""
    rate = recording.sampling_hz
    places = np.rint(inputs.times * rate).astype(int)
    near = [(int(place) - 3, int(place) + 3) for place in places]
    release = int(inputs.head[RELEASE] * rate)
    return [*near, (release - REACH, release + REACH)]


def known_of(
    inputs: Inputs, fixed: dict[int, float], priors: dict[int, tuple[float, float]]
) -> Known:
    """Return what is known of the numbers beforehand."""
    mean = inputs.vector()
    deviation = np.full(mean.size, np.inf)
    mean[CORNER], deviation[CORNER] = 0.0, CORNERS
    for place, (middle, width) in priors.items():
        mean[place], deviation[place] = middle, width
    for place, value in fixed.items():
        mean[place], deviation[place] = value, 0.0
    mean[mean.size - inputs.pulse.size :] = first_guess()[: inputs.pulse.size]
    deviation[mean.size - inputs.pulse.size :] = SHAPES
    return Known(mean, deviation)


def weighted(
    recording: Recording, inputs: Inputs, mask: Values, noise: float, roughness: float
) -> Values:
    """Return 1/σ of each sample, 0 where it is masked."""
    sigma = np.sqrt(noise**2 + (roughness * recording.reach(inputs)) ** 2)
    made: Values = np.where(mask, 1 / sigma, 0.0)
    return made


def spread(
    recording: Recording, inputs: Inputs, rest: Values, mask: Values, floor: float
) -> tuple[float, float]:
    """Return the standard deviation of the noise, and how far pulses are from one shape."""
    reach = recording.reach(inputs)
    scale = float(np.std(rest[mask]))
    far = mask & (reach < 0.1 * scale)
    noise = max(float(np.sqrt(np.mean(rest[far] ** 2))) if far.sum() > 20 else scale, floor)
    near = mask & (reach > 3 * noise)
    if near.sum() < 10:
        return noise, 0.02
    over = np.mean((rest[near] ** 2 - noise**2) / reach[near] ** 2)
    return noise, float(np.sqrt(max(over, 1e-6)))


def further_mode(
    recording: Recording, inputs: Inputs, rest: Values, mask: Values
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
        if first + length >= rest.size:
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


__all__ = ["HEAD", "SIZE", "ZETA", "Explained", "explained"]
