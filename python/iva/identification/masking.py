"""Which samples of a record count, and how much."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from iva.identification.kinks import SIDE
from iva.identification.pulses import REACH
from iva.identification.records import OMEGA, RELEASE, Inputs, Recording
from iva.identification.responses import Values

#: Samples beside the release, at least, and part of a period, in which an acceleration does not
#: count and no impact is looked for: a filter smears the step.
NEAR, DEAD = 8, 0.12
#: Part of a period on each side of a blow in which its own pulse hides all else.
BLOW = 0.06
#: Part of a period that is masked beside an impact of a velocity at first, and the deviations of
#: the noise above which samples are masked later.
SMEAR, SMEARED = 0.03, 6.0
#: How far pulses are from one shape at least, relative. Without a filter few samples show a pulse,
#: and how one sees it hangs on where it falls between them.
ROUGH, UNFILTERED = 1e-3, 0.03


def dead_time(sampling_hz: float, hertz: float) -> int:
    """Return for how many samples the release is not told apart from an impact of its own."""
    return min(REACH, max(NEAR, int(DEAD * sampling_hz / hertz)))


def masked(
    recording: Recording, inputs: Inputs, begins_in_motion: bool, smear: int
) -> NDArray[np.bool_]:
    """Return which samples count: not those that the filter of the recorder has smeared."""
    rate, release = recording.sampling_hz, inputs.head[RELEASE]
    hertz = inputs.head[OMEGA] / 2 / np.pi
    edge = 2 if recording.order < 2 else dead_time(rate, hertz)
    edge = int(BLOW * rate / hertz) if recording.blow else edge
    mask: NDArray[np.bool_] = np.abs(recording.time - release) > edge / rate
    if begins_in_motion:
        mask &= recording.time > release
    if recording.order < 2:
        # So near the end no impact is seen, and what it does would be taken for something else.
        mask &= recording.time < recording.time[-1] - 2 * np.pi / inputs.head[OMEGA] * SIDE
        smeared = 2 if recording.order == 0 else smear
        for time in inputs.times:
            mask &= np.abs(recording.time - time) > smeared / rate
    return mask


def smeared(recording: Recording, inputs: Inputs, rest: Values, noise: float) -> int:
    """Return how many samples beside an impact of a velocity the recorder has smeared.

    What is left at a distance from all impacts, each over its jump, is averaged with jump² as
    weight: where it stands out of the noise, samples do not show the motion.
    """
    places = np.rint(inputs.times * recording.sampling_hz).astype(int)
    away = np.arange(-REACH, REACH + 1)
    samples = places[:, None] + away
    inside = (samples >= 0) & (samples < rest.size)
    # A neighbour's own smear is no sign of this one's.
    apart = np.abs(samples[:, :, None] - places[None, None, :]).min(axis=2) == np.abs(away)
    use = (inside & apart) * inputs.jumps[:, None] ** 2
    energy = np.maximum(use.sum(axis=0), 1e-300)
    left = np.where(inside, rest[np.clip(samples, 0, rest.size - 1)], 0.0)
    mean = np.sum(use * left / inputs.jumps[:, None], axis=0) / energy
    stands = np.abs(mean) * np.sqrt(energy) > SMEARED * noise
    return int(np.max(np.abs(away)[stands], initial=0)) + 2


def closed_by(
    recording: Recording, inputs: Inputs, dead: float, smear: int
) -> list[tuple[int, int]]:
    """Return the samples around impacts and release at which no further impact is looked for."""
    rate = recording.sampling_hz
    places = np.rint(inputs.times * rate).astype(int)
    beside = 3 if recording.order == 2 else smear + 3
    near = [(int(place) - beside, int(place) + beside) for place in places]
    release, edge = int(inputs.head[RELEASE] * rate), int(dead * rate)
    return [*near, (release - edge, release + edge)]


def weighted(
    recording: Recording, inputs: Inputs, mask: NDArray[np.bool_], noise: float, roughness: float
) -> Values:
    """Return 1/σ of each sample, 0 where it is masked."""
    sigma = np.sqrt(noise**2 + (roughness * recording.reach(inputs)) ** 2)
    made: Values = np.where(mask, 1 / sigma, 0.0)
    return made


def spread(
    recording: Recording, inputs: Inputs, rest: Values, mask: NDArray[np.bool_], floor: float
) -> tuple[float, float]:
    """Return the standard deviation of the noise, and how far pulses are from one shape."""
    reach = recording.reach(inputs)
    scale = float(np.std(rest[mask]))
    far = mask & (reach < 0.1 * scale)
    noise = max(float(np.sqrt(np.mean(rest[far] ** 2))) if far.sum() > 20 else scale, floor)
    near = mask & (reach > 3 * noise)
    unfiltered = recording.shape is not None and recording.shape.chain.kind == "none"
    least = UNFILTERED if unfiltered else ROUGH
    if near.sum() < 10:
        return noise, max(0.02, least)
    # The largest pulses say most: elsewhere the noise hides what is left over.
    more = np.sum(reach[near] ** 2 * (rest[near] ** 2 - noise**2))
    over = float(more / np.sum(reach[near] ** 4))
    return noise, max(float(np.sqrt(max(over, 0.0))), least)


__all__ = ["BLOW", "SMEAR", "closed_by", "dead_time", "masked", "smeared", "spread", "weighted"]
