"""The record of a decay with a free mass, explained by release, impacts and sensor alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from iva.identification.beginnings import onset, rough_frequency, scanned
from iva.identification.choosing import chain_of
from iva.identification.detection import pulses_in
from iva.identification.instants import Seen, covered, seen, short, with_seen, without
from iva.identification.kinks import SIDE, kinks_in
from iva.identification.masking import (
    BLOW,
    SMEAR,
    closed_by,
    dead_time,
    masked,
    smeared,
    spread,
    weighted,
)
from iva.identification.pruning import WIDTHS, pruned, spread_of_widths, with_contact
from iva.identification.pulses import REACH, Shape
from iva.identification.records import (
    CORNER,
    HEAD,
    MODE,
    OMEGA,
    RELEASE,
    TREND,
    Inputs,
    Recording,
)
from iva.identification.refining import Known, Refined, refine
from iva.identification.responses import Values
from iva.identification.ringing import further_mode
from iva.identification.steps import SMEARED, instants, smooth_of, steps_in
from iva.identification.verdicts import NO_IMPACT, few_enough

#: Width in rad/s of what is expected of the corner of a high pass: half a hertz.
CORNERS = np.pi
#: Standard deviation of the variances of contacts at first, in samples², without a filter.
UNKNOWN = 0.08
#: How far pulses may be from one shape, relative, after impacts were taken out.
LOOSE = 0.05
#: Samples that the instant at which motion is seen to set in may be off.
ONSET = 10.0
#: How far an impact may be from the middle of its pulse, in samples.
OFF_MIDDLE = 0.01
#: Least length of a record after the release, in periods.
PERIODS = 1.2
#: Rounds after which a record of which such a share is left over is not refined further.
HOPELESS, UNLIKE = 4, 0.1
#: Rounds after which noise and roughness that do not settle are taken as they are.
PATIENCE = 5
#: Most rounds of refinement.
ROUNDS = 20
#: How often impacts are looked for in what is left over, by order: in a velocity small ones show
#: only where large ones are understood.
SEARCHES = {0: 2, 1: 5, 2: 2}
#: Size of a pulse beside a larger one below which it is taken for what that one has left over.
SHARE = 0.05
#: Most impacts that are found anew where few were found before.
ANEW = 3
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
    mask: NDArray[np.bool_]
    modes_hz: tuple[float, ...]

    @property
    def hertz(self) -> float:
        """Frequency of the structure."""
        return float(self.refined.inputs.head[OMEGA] / (2 * np.pi))


def explained(
    recording: Recording,
    floor: float,
    fixed: dict[int, float],
    priors: dict[int, tuple[float, float]],
    seen_before: tuple[Values, Values] | None = None,
) -> Explained:
    """Return what explains a record of acceleration or velocity.

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
    seen_before : tuple of ndarray, shape (k,), optional
        Instants and jumps of impacts to begin with; by default they are looked for.

    Raises
    ------
    ValueError
        If no impact is found, or it cannot be told when the structure was let go.
    """
    rate, order = recording.sampling_hz, recording.order
    begin = fixed.get(RELEASE)
    start = onset(recording.values, rate, order) if begin is None else begin
    after = int(max(start or 0.0, 0.0) * rate)
    if OMEGA in fixed:
        hertz = fixed[OMEGA] / 2 / np.pi
    else:
        hertz = rough_frequency(recording.values[after:], rate, order)
    span = float(recording.time[-1]) - max(start or 0.0, 0.0)
    periods = span * hertz
    if periods < PERIODS:
        raise ValueError(
            f"record: it ends {span:.3g} s after the release, less than {PERIODS:g} periods, or "
            "nothing in it oscillates; give a longer one"
        )
    recording = replace(recording, powers=powers_of(periods))
    dead = dead_time(rate, hertz) / rate if order == 2 else SIDE / hertz
    dead = BLOW / hertz if recording.blow else dead
    first = start if start is not None else 0.0
    edge = (int((first - dead) * rate), int((first + dead) * rate) + 1)
    values = bridged(recording.values, *edge) if recording.blow else recording.values
    times, jumps = seen_before or found_in(recording, values, hertz, (edge,))
    if not times.size:
        raise ValueError(NO_IMPACT)
    if not few_enough(times.size, periods):
        raise ValueError(
            f"record: {times.size} pulses stand out of it in {periods:.3g} periods, more than "
            "a mass between two walls makes; give a record without what else strikes or rings"
        )
    omega, zeta, instant, size, _ = scanned(recording, hertz, first, times, jumps)
    if start is None and abs(instant) > 3 / rate:
        raise ValueError(
            "start.time = None: the record begins in motion; give the instant of the release"
        )
    head = np.array(
        [omega, zeta, 0.5 * (order == 2), first if begin is not None else instant, size]
    )
    for place, value in fixed.items():
        head[place] = value
    if begin is None and start is not None and RELEASE not in priors:
        # Motion is seen to set in: a release far from there would be another one.
        priors = {**priors, RELEASE: (start, ONSET / rate)}
    shape = recording.shape
    pulse = np.zeros(0 if shape is None else shape.size)
    widths = np.zeros(0 if shape is None else times.size)
    hum = np.zeros(2 * len(recording.hum_hz))
    modes = np.zeros((0, MODE))
    inputs = Inputs(head, times, jumps, np.zeros(TREND), hum, modes, pulse, widths, recording.blow)
    noise, roughness = float(np.std(recording.values)) / 10, 0.1
    width = UNKNOWN if shape is not None and shape.chain.kind == "none" else WIDTHS
    smear = min(REACH, max(int(SMEAR * rate / hertz), 2))
    searches_left = SEARCHES[order]
    by_motion: Values | None = None
    patience = PATIENCE
    for attempt in range(ROUNDS):
        mask = masked(recording, inputs, begin is None and start is None, smear)
        known = known_of(recording, inputs, fixed, priors, width)
        told = seen(recording, inputs, noise, by_motion) if short(recording) else None
        recording, inputs, known, mask = placed(recording, inputs, known, mask, noise, told)
        recording.weights = weighted(recording, inputs, mask, noise, roughness)
        refined = refine(recording, inputs, known, steps=6 if attempt < 2 else 25)
        inputs = refined.inputs
        if told is not None:
            by_motion = without(refined, told)
        else:
            recording, inputs = with_contact(recording, inputs)
        width = spread_of_widths(refined)
        rest = recording.values - recording.model(inputs)
        before = (noise, roughness)
        noise, roughness = spread(recording, inputs, rest, mask, floor)
        if order == 1 and attempt > 0:
            smear = smeared(recording, inputs, rest, noise)
        hopeless = attempt >= HOPELESS and noise > UNLIKE * float(np.std(recording.values[mask]))
        # Not all at once: sharp pulses far from where they belong find no way back.
        roughness = max(roughness, before[1] / 3)
        settling = abs(noise / before[0] - 1) > 0.05 or roughness < 0.8 * before[1]
        patience -= 1
        if attempt < 2 or (settling and patience > 0 and not hopeless):
            continue
        patience = PATIENCE
        searches = order == 2 and len(inputs.modes) < MODES
        line = further_mode(recording, inputs, rest, mask) if searches else None
        if line is not None:
            inputs = replace(inputs, modes=np.vstack([inputs.modes, line]))
            continue
        if hopeless:
            break
        inputs = pruned(recording, refined)
        if inputs.times.size < refined.inputs.times.size:
            # Pulses that move find their places only while they need not agree to the last digit.
            roughness = max(roughness, LOOSE)
            continue
        if not searches_left:
            break
        searches_left -= 1
        closed = tuple(closed_by(recording, inputs, dead, smear))
        left, share = rest, min(SHARE, 10 * roughness)
        if order == 1 or told is not None or recording.blow:
            # There is no model for samples that do not count.
            left = np.where(mask, rest, 0.0)
            share = share if order == 2 and told is None else 0.0
        more, sizes = found_in(recording, left, hertz, closed, inputs, noise, share)
        # Where as many again are found the motion is another one: those are no impacts.
        count = inputs.times.size
        if not 0 < more.size <= max(count, ANEW) or not few_enough(count + more.size, periods):
            break
        inputs = inputs.with_more(more, sizes)
    if inputs.vector().size != refined.inputs.vector().size:
        # The rounds have ended on a change.
        mask = masked(recording, inputs, begin is None and start is None, smear)
        known = known_of(recording, inputs, fixed, priors, width)
        told = seen(recording, inputs, noise, by_motion) if short(recording) else None
        recording, inputs, known, mask = placed(recording, inputs, known, mask, noise, told)
        recording.weights = weighted(recording, inputs, mask, noise, roughness)
        refined = refine(recording, inputs, known)
        inputs = refined.inputs
    if order == 2:
        places = np.arange(HEAD, HEAD + inputs.times.size)
        refined.covariance[places, places] += (OFF_MIDDLE / rate) ** 2
    modes_hz = tuple(float(mode[2]) / 2 / np.pi for mode in inputs.modes)
    return Explained(recording, refined, known, noise, roughness, mask, modes_hz)


def bridged(values: Values, first: int, last: int) -> Values:
    """Return values with a straight line between two samples."""
    made = values.copy()
    first, last = max(first, 0), min(last, values.size - 1)
    made[first : last + 1] = np.linspace(made[first], made[last], last - first + 1)
    return made


def placed(
    recording: Recording,
    inputs: Inputs,
    known: Known,
    mask: NDArray[np.bool_],
    noise: float,
    told: Seen | None,
) -> tuple[Recording, Inputs, Known, NDArray[np.bool_]]:
    """Return the same with instants of impacts where these are seen beside the motion.

    Parameters
    ----------
    recording, inputs, known
        The record, its numbers, and what is known of them.
    mask : ndarray of bool, shape (n,)
        True where a sample counts.
    noise : float
        Standard deviation of a sample.
    told : Seen or None
        What pulses say that are too short to be fitted.
    """
    if told is not None:
        recording, inputs, known = with_seen(recording, inputs, known, told)
        mask = mask & ~covered(recording, inputs)
    elif recording.order == 1:
        places = slice(HEAD, HEAD + inputs.times.size)
        known.mean[places], known.deviation[places] = instants(recording, inputs, noise)
    return recording, inputs, known, mask


def with_chain(recording: Recording, release: float | None) -> Recording:
    """Return a record of acceleration with the pulses of its chain, and any other as it is.

    Parameters
    ----------
    recording : Recording
        The record.
    release : float or None
        Instant of the release from the first sample in s, where it is known.
    """
    if recording.order != 2:
        return recording
    rate = recording.sampling_hz
    begin = onset(recording.values, rate, 2) if release is None else release
    first = int((begin or 0.0) * rate)
    chain = chain_of(recording.values, rate, ((first - REACH, first + REACH),))
    return replace(recording, shape=Shape(chain))


def powers_of(periods: float) -> int:
    """Return how many powers of time a trend may have that cannot be taken for the motion."""
    return 1 + int(np.searchsorted([3.0, 6.0, 10.0], periods))


def found_in(
    recording: Recording,
    values: Values,
    hertz: float,
    closed: tuple[tuple[int, int], ...],
    inputs: Inputs | None = None,
    noise: float | None = None,
    share: float = 0.3,
) -> tuple[Values, Values]:
    """Return instants and jumps of the impacts that stand out of values of a record.

    Parameters
    ----------
    recording : Recording
        The record.
    values : ndarray, shape (n,)
        The record, or what is left of it.
    hertz : float
        Frequency of the structure.
    closed : tuple of (first, last)
        Samples between which none is looked for.
    inputs : Inputs, optional
        What has been taken out of the values.
    noise : float, optional
        Standard deviation of a sample.
    share : float
        Size, over that of a larger one beside it, below which a pulse is taken for its remains.
    """
    if recording.order == 2:
        rate, shape = recording.sampling_hz, recording.shape
        assert shape is not None
        if inputs is None:
            return pulses_in(values, rate, shape, closed=closed)
        present = (inputs.times, inputs.jumps)
        return pulses_in(values, rate, shape, inputs.pulse, share, closed, present)
    rate, found = recording.sampling_hz, (np.zeros(0), np.zeros(0))
    if recording.order == 1:
        found = steps_in(values, rate, closed, noise or 0.0)
        if recording.blow and noise is None:
            return found  # A kink is looked for in windows that the blow would fill.
        values = smooth_of(values, rate, hertz, *found)
        beside = 2 * SMEARED
        places = np.rint(found[0] * rate).astype(int)
        closed = (*closed, *((int(at) - beside, int(at) + beside) for at in places))
    times, jumps, _, _ = kinks_in(values, rate, hertz, recording.order, noise, closed)
    order = np.argsort(np.concatenate([found[0], times]))
    return np.concatenate([found[0], times])[order], np.concatenate([found[1], jumps])[order]


def known_of(
    recording: Recording,
    inputs: Inputs,
    fixed: dict[int, float],
    priors: dict[int, tuple[float, float]],
    width: float,
) -> Known:
    """Return what is known of the numbers beforehand."""
    mean = inputs.vector()
    deviation = np.full(mean.size, np.inf)
    mean[CORNER], deviation[CORNER] = 0.0, CORNERS if recording.order == 2 else 0.0
    high = HEAD + 2 * inputs.times.size + np.arange(recording.powers, TREND)
    mean[high], deviation[high] = 0.0, 0.0
    for place, (middle, width) in priors.items():
        mean[place], deviation[place] = middle, width
    for place, value in fixed.items():
        mean[place], deviation[place] = value, 0.0
    if recording.shape is not None:
        last = mean.size - inputs.widths.size
        deviation[last - inputs.pulse.size : last] = recording.shape.deviations()
        deviation[last:] = width
        mean[last - inputs.pulse.size :] = 0.0
    return Known(mean, deviation)


__all__ = ["Explained", "explained"]
