"""The identification of a pendulum from a record of displacement or velocity.

A flight of a pendulum has no closed form, so the motion is run from the release through all
impacts. Each impact has a restitution of its own.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iva.identification.adequacy import contact_law, law_of_restitution, lines_of
from iva.identification.around import about, combinations_of, drawn, gauss_of, sampled, untied
from iva.identification.beginnings import let_go, onset, rough_frequency
from iva.identification.fits import Found
from iva.identification.kinks import SIDE, kinks_in
from iva.identification.priors import Bell, Between, Exactly, Prior
from iva.identification.records import Recording
from iva.identification.responses import Values
from iva.identification.searching import candidates
from iva.identification.shooting import UNFIT, Shot, Target, grown, shot
from iva.identification.stages import FOUND, INTERRUPTED, LOOKED, SAMPLED, Tell
from iva.identification.stated import Stated
from iva.identification.swings import HEAD, LOGARITHMS, NUMBERS, Rig
from iva.identification.widths import over_widths

#: Impacts in the first window.
FIRST = 3
#: Candidates that are followed, and those of a shorter window if none of them fits.
FOLLOWED, AGAIN = 24, 8
#: χ² a sample below which a first window may lack no more than impacts without a kink that is seen.
NEAR = 10.0
#: Width of what is thought possible of a logarithm of which nothing is known.
WIDE = 2.0


def identified(
    recording: Recording,
    clock: float,
    floor: float,
    known: Stated,
    seed: int,
    tell: Tell,
) -> Found:
    """Return what a record says of a pendulum.

    Parameters
    ----------
    recording : Recording
        Displacement or velocity; its time begins with 0.
    clock : float
        Instant of the first sample on the clock of the record in s.
    floor : float
        Least standard deviation of the noise.
    known : Stated
        What is known beforehand.
    seed : int
        Of search and sampler.
    tell : callable
        Told how many stages have ended.

    Raises
    ------
    ValueError
        If no impact is found, no motion comes near the record, it begins in motion without a known
        release, or it is an acceleration.
    """
    if recording.order == 2:
        raise ValueError(
            "record.quantity = 'acceleration': of a pendulum give a displacement or a velocity"
        )
    target, times, jumps, spread, hertz = beginning(recording, clock, floor, known)
    tell(LOOKED)
    begun = nearest(target, times, jumps, spread, hertz, known, seed)
    made = grown(target, begun, steps=8)
    if made.misfit > UNFIT:
        raise ValueError(
            "record: no motion of a pendulum comes near it; give another absorber, or what is known"
        )
    rest = target.values[: made.motion.values.size] - made.motion.values
    # Each number of the fit takes its share of the noise along.
    left = max(rest.size - made.numbers.size - made.restitutions.size, 1)
    noise = max(float(np.sqrt(rest @ rest / left)), floor)
    smooth = target.noise
    target = replace(target, noise=noise)
    scatter = float(np.clip(np.std(made.restitutions) / np.mean(made.restitutions), 0.02, 0.3))
    made = shot(target, made.numbers, made.restitutions, made.until, steps=4, scatter=scatter)
    # First from derivatives at one point, which tell how wide to look.
    first = gauss_of(target, made)
    made = over_widths(target, made, first, float(np.mean(made.restitutions)), scatter)
    gauss = gauss_of(target, made)
    belief = known.priors.get("restitution", Between(0.0, 1.0))
    notes, reasons = [], []
    try:
        tell(FOUND)
        hyper = sampled(gauss, belief, seed)
        tell(SAMPLED)
    except KeyboardInterrupt:
        hyper = about(made.restitutions, scatter, seed)
        reasons.append(INTERRUPTED)
    draws, each = drawn(target, made, gauss, hyper, clock, seed)
    end = float(target.time[-1])
    if made.until < end:
        notes.append(
            f"the record was used up to {made.until + clock:.4g} s: what follows does not fit"
        )
        later = np.sum(times > made.until)
        if later > len(made.motion.times):
            reasons.append("most of the record does not follow from its beginning")
    use = made.motion.values.size
    rest = target.values[:use] - made.motion.values
    reasons += lines_of(rest, np.full(use, 1 / noise), recording.sampling_hz, hertz)
    middle, variances = untied(gauss, float(np.median(hyper[:, 0])))
    count = min(middle.size, len(made.motion.times))
    reasons += law_of_restitution(
        np.abs(made.motion.approaches[:count]),
        np.array(made.motion.times[:count]),
        middle[:count],
        variances[:count],
    )
    reasons += contact_law(float(np.quantile(hyper[:, 1], 0.1)), 0.0)
    if noise > 1.25 * smooth:
        reasons.append("the residual is larger than the noise")
    prediction = np.full(target.time.size, np.nan)
    prediction[:use] = made.motion.values
    own = np.full(target.time.size, np.nan)
    covariance = gauss.covariance(float(np.median(hyper[:, 0])), float(np.median(hyper[:, 1])))[1]
    own[:use] = np.sqrt(np.maximum(np.einsum("ij,ij->i", made.slopes @ covariance, made.slopes), 0))
    return Found(
        draws=draws,
        each=each,
        walls=np.sign(made.motion.approaches[:count]),
        prediction=prediction,
        own=own,
        sigma=np.full(target.time.size, noise),
        mask=target.time <= made.until,
        noise=noise,
        combinations=combinations_of(target, gauss, hyper, known),
        reasons=tuple(reasons),
        notes=tuple(notes),
    )


def beginning(
    recording: Recording, clock: float, floor: float, known: Stated
) -> tuple[Target, Values, Values, float, float]:
    """Return the target, instants and jumps of impacts, their deviation, and the frequency in Hz.

    Raises
    ------
    ValueError
        If no impact is found, or the record begins in motion without a known release.
    """
    rate, values = recording.sampling_hz, recording.values
    given = known.exactly("release")
    start = onset(values, rate, recording.order)
    if given is None and start is None:
        raise ValueError(
            "start.time = None: the record begins in motion; give the instant of the release"
        )
    release = given - clock if given is not None else float(start or 0.0)
    after = max(int(release * rate), 0)
    hertz = known.exactly("frequency_hz") or rough_frequency(values[after:], rate, recording.order)
    offset = float(np.mean(values[-values.size // 4 :]))
    size = known.exactly("displacement")
    if size is None and recording.order == 0:
        lead = values[: max(after - 2, 1)] if after > 3 else values[: after + 2]
        size = float(np.median(lead)) - offset
        if given is None:
            release = let_go(values - offset, rate, release, size, hertz)
    elif size is None:
        swing_speed = float(np.quantile(np.abs(values[after : after + int(rate / hertz)]), 0.95))
        sign = -np.sign(np.median(values[after : after + max(int(0.2 * rate / hertz), 3)]))
        size = float(sign * swing_speed / (2 * np.pi * hertz))
    assert size is not None
    edge = int((release + SIDE / hertz) * rate) + 2
    times, jumps, deviations, noise = kinks_in(
        values, rate, hertz, recording.order, closed=((0, edge),)
    )
    if not times.size:
        raise ValueError(
            "record: no impact is found in it; give a record in which the absorber strikes"
        )
    taken = known.taken
    ratio_set = "length" in taken and "frequency_ratio" not in known.priors
    rig = Rig(
        sign=float(np.sign(size)),
        gravity=taken.get("gravity", 9.80665),
        inertia_ratio=taken.get("inertia_ratio", 1.0),
        length=taken["length"] if ratio_set else None,
        contact_distance=taken.get("contact_distance"),
        gap_velocity=taken.get("gap_velocity", 0.0),
        place=known.exactly("gap_displacement") or 0.0,
    )
    mean, deviation = np.zeros(HEAD), np.full(HEAD, np.inf)
    for place, name in enumerate(NUMBERS):
        belief(known.priors.get(name), place, mean, deviation, clock)
    if ratio_set:
        deviation[NUMBERS.index("frequency_ratio")] = 0.0
    if recording.order == 1:
        deviation[NUMBERS.index("offset")] = np.inf
    mean[NUMBERS.index("displacement")] = np.log(abs(size))
    if known.exactly("displacement") is None and not np.isfinite(deviation[4]):
        deviation[4] = WIDE
    if not np.isfinite(deviation[1]):
        mean[1], deviation[1] = np.log(0.08), WIDE
    target = Target(
        recording.time, values, recording.order, max(noise, floor), mean, deviation, rig
    )
    return (
        with_begin(target, release, offset, hertz),
        times - release,
        jumps,
        float(deviations[0]),
        hertz,
    )


def with_begin(target: Target, release: float, offset: float, hertz: float) -> Target:
    """Return the target with rough values where nothing is known, as places to begin."""
    mean = target.mean.copy()
    for name, value in (("release", release), ("offset", offset), ("frequency_hz", np.log(hertz))):
        place = NUMBERS.index(name)
        if not np.isfinite(target.deviation[place]):
            mean[place] = value
    return replace(target, mean=mean)


def belief(prior: Prior | None, place: int, mean: Values, deviation: Values, clock: float) -> None:
    """Write mean and deviation of a number into their places, as logarithms where these stand."""
    if prior is None:
        return
    shift = clock if NUMBERS[place] == "release" else 0.0
    middle = prior.at(0.5) - shift
    logarithm = place < LOGARITHMS
    mean[place] = np.log(abs(middle)) if logarithm else middle
    if isinstance(prior, Exactly):
        deviation[place] = 0.0
    elif isinstance(prior, Bell):
        relative = prior.width if prior.by_logarithm else prior.width / abs(middle)
        absolute = prior.width * abs(middle) if prior.by_logarithm else prior.width
        deviation[place] = relative if logarithm else absolute
    else:
        width = (prior.at(0.84) - prior.at(0.16)) / 2
        deviation[place] = width / abs(middle) if logarithm else width


def nearest(
    target: Target,
    times: Values,
    jumps: Values,
    spread: float,
    hertz: float,
    known: Stated,
    seed: int,
) -> Shot:
    """Return the best agreement in the first window."""
    release = float(target.mean[NUMBERS.index("release")])
    size = target.rig.sign * float(np.exp(target.mean[4]))
    found = candidates(hertz, size, times, jumps, spread, known.priors, target.rig.place, seed)
    hits = min(FIRST, times.size)
    ends = float(target.time[-1])
    until = min(release + times[hits] - 0.02 / hertz if times.size > hits else ends, ends)
    until = min(until, release + times[hits - 1] + 1.0 / hertz)
    rows = spread_out(found)[:FOLLOWED]
    best = followed(target, rows, hits, until)
    if best is None or best.misfit > UNFIT:
        # An impact that is too small to be seen may lie between the last one and the end.
        until = min(until, release + times[hits - 1] + 0.2 / hertz)
        best = followed(target, rows[:AGAIN], hits, until) or best
    if best is None:
        raise ValueError(
            "record: no motion of a pendulum comes near it; give another absorber, or what is known"
        )
    return best


def followed(target: Target, rows: Values, hits: int, until: float) -> Shot | None:
    """Return the best agreement up to an instant from candidates, if any leads to one.

    Parameters
    ----------
    target : Target
        What is to be met.
    rows : ndarray, shape (n, 5)
        As :func:`candidates` returns them.
    hits : int
        Number of impacts that are seen up to the instant.
    until : float
        The instant from the first sample, in s.
    """
    best: Shot | None = None
    for row in rows:
        numbers = target.mean.copy()
        begin = [np.log(row[0]), np.log(row[1]), np.log(row[2]), np.log(row[3])]
        for place, value in enumerate(begin):
            if target.deviation[place] > 0:
                numbers[place] = value
        if target.deviation[LOGARITHMS] > 0:
            numbers[LOGARITHMS] = 0.01
        try:
            made = shot(target, numbers, np.full(hits, row[4]), until, steps=12)
            unseen = len(made.motion.times) - hits
            if unseen > 0 and made.misfit < NEAR:
                # Each has a restitution of its own, also where it is too small to be seen.
                each = np.append(made.restitutions, np.full(unseen, made.restitutions[-1]))
                made = shot(target, made.numbers, each, until, steps=12)
        except (ValueError, np.linalg.LinAlgError):
            continue
        if best is None or made.misfit < best.misfit:
            best = made
        if made.misfit < 1.3:
            break
    return best


def spread_out(found: Values) -> Values:
    """Return the same candidates, those first that are unlike all before them, shape (n, 5)."""
    width = np.maximum(np.std(found, axis=0), 1e-12)
    order, left = [0], list(range(1, len(found)))
    while left:
        gaps = [
            min(float(np.max(np.abs(found[a] - found[b]) / width)) for b in order) for a in left
        ]
        fresh = next((index for index, gap in enumerate(gaps) if gap > 0.7), 0)
        order.append(left.pop(fresh))
    made: Values = found[order]
    return made


__all__ = ["identified"]
