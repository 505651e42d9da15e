"""The identification of a pendulum from a record of displacement or velocity.

Flights of a pendulum are no closed form, so its motion is run, from the release through all impacts.
Each impact has a restitution of its own; the numbers and these restitutions are Gaussian about the
best agreement, and the mean and the scatter of restitution, which are not, are sampled.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iva.identification.adequacy import contact_law, law_of_restitution, lines_of
from iva.identification.beginnings import let_go, onset, rough_frequency
from iva.identification.combinations import in_words, null_directions
from iva.identification.fits import Found
from iva.identification.kinks import SIDE, kinks_in
from iva.identification.posterior import LIVE, NEVER, SCATTER, sampler
from iva.identification.priors import Bell, Between, Exactly, Prior
from iva.identification.records import Recording
from iva.identification.responses import Values
from iva.identification.searching import candidates
from iva.identification.shooting import UNFIT, Shot, Target, grown, shot
from iva.identification.stated import Stated
from iva.identification.swings import HEAD, LOGARITHMS, NUMBERS, Rig, swing

#: Draws of all numbers.
DRAWS = 1000
#: Impacts in the first window.
FIRST = 3
#: Candidates that are followed.
FOLLOWED = 6
#: Scatter with which the restitution of each impact is looked at by itself.
UNTIED = 0.4
#: Width of what is thought possible of a logarithm of which nothing is known.
WIDE = 2.0


def identified(
    recording: Recording, clock: float, floor: float, known: Stated, seed: int
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
    begun = beginning(recording, clock, floor, known)
    target, times, jumps, spread, hertz = begun
    numbers, restitution, hits = nearest(target, times, jumps, spread, hertz, known, seed)
    made = grown(target, numbers, restitution, hits, steps=8)
    if made.misfit > UNFIT:
        raise ValueError(
            "record: no motion of a pendulum comes near it; give another absorber, or what is known"
        )
    rest = target.values[: made.motion.values.size] - made.motion.values
    noise = max(float(np.std(rest)), floor)
    target = replace(target, noise=noise)
    scatter = float(np.clip(np.std(made.restitutions) / np.mean(made.restitutions), 0.02, 0.3))
    made = shot(target, made.numbers, made.restitutions, made.until, steps=4, scatter=scatter)
    gauss = gauss_of(target, made)
    belief = known.priors.get("restitution", Between(0.0, 1.0))
    hyper = sampled(gauss, belief, seed)
    draws, each = drawn(target, made, gauss, hyper, clock, seed)
    notes, reasons = [], []
    end = float(target.time[-1])
    if made.until < end:
        notes.append(f"the record was used up to {made.until + clock:.4g} s: what follows does not fit")
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
    if made.misfit * (noise / floor_of(target, begun)) ** 2 > 1.5:
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


def floor_of(target: Target, begun: tuple[Target, Values, Values, float, float]) -> float:
    """Return the noise that smooth stretches of the record have."""
    return max(begun[0].noise, 1e-300) if target.noise else 1.0


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
    start = onset(values, rate)
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
        with_begin(target, release, offset, hertz), times - release, jumps,
        float(deviations[0]), hertz,
    )


def with_begin(target: Target, release: float, offset: float, hertz: float) -> Target:
    """Return the target with rough values where nothing is known, as places to begin."""
    mean = target.mean.copy()
    for name, value in (("release", release), ("offset", offset), ("frequency_hz", np.log(hertz))):
        place = NUMBERS.index(name)
        if not np.isfinite(target.deviation[place]):
            mean[place] = value
    return replace(target, mean=mean)


def belief(
    prior: Prior | None, place: int, mean: Values, deviation: Values, clock: float
) -> None:
    """Write mean and deviation of a number into their places, a logarithm where it stands as one."""
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
) -> tuple[Values, float, int]:
    """Return numbers and restitution that meet the first window best, and its impacts."""
    release = float(target.mean[NUMBERS.index("release")])
    size = target.rig.sign * float(np.exp(target.mean[4]))
    found = candidates(
        hertz, size, times, jumps, spread, known.priors, target.rig.place, seed
    )
    hits = min(FIRST, times.size)
    ends = float(target.time[-1])
    until = min(release + times[hits] - 0.02 / hertz if times.size > hits else ends, ends)
    until = min(until, release + times[hits - 1] + 1.0 / hertz)
    best: tuple[float, Values, float] | None = None
    for row in found[:FOLLOWED]:
        numbers = target.mean.copy()
        begin = [np.log(row[0]), np.log(row[1]), np.log(row[2]), np.log(row[3])]
        for place, value in enumerate(begin):
            if target.deviation[place] > 0:
                numbers[place] = value
        if target.deviation[LOGARITHMS] > 0:
            numbers[LOGARITHMS] = 0.01
        try:
            made = shot(target, numbers, np.full(hits, row[4]), until, steps=12)
        except (ValueError, np.linalg.LinAlgError):
            continue
        if best is None or made.misfit < best[0]:
            best = (made.misfit, made.numbers, float(np.mean(made.restitutions)))
        if made.misfit < 1.3:
            break
    if best is None:
        raise ValueError(
            "record: no motion of a pendulum comes near it; give another absorber, or what is known"
        )
    return best[1], best[2], hits


@dataclass(frozen=True)
class Gauss:
    """Record and priors of the numbers, to second order, in natural form.

    ``precision`` (p, p) and ``pull`` (p,): the logarithm of the density is −½ xᵀPx + bᵀx.
    ``free`` (p,) marks what is not set, ``at`` (p,) is where it was expanded.
    """

    precision: Values
    pull: Values
    free: Values
    at: Values

    def covariance(self, restitution: float, scatter: float) -> tuple[Values, Values]:
        """Return mean (p,) and covariance (p, p), given mean and scatter of restitution."""
        tie = np.zeros(self.at.size)
        tie[HEAD:] = (scatter * restitution) ** -2.0
        free = np.flatnonzero(self.free)
        curved = (self.precision + np.diag(tie))[np.ix_(free, free)]
        scale = np.sqrt(np.diag(curved))
        inverse = np.linalg.inv(curved / np.outer(scale, scale)) / np.outer(scale, scale)
        whole = np.zeros_like(self.precision)
        whole[np.ix_(free, free)] = inverse
        mean = self.at.copy()
        mean[free] = inverse @ (self.pull + tie * restitution)[free]
        return mean, whole


def gauss_of(target: Target, made: Shot) -> Gauss:
    """Return the record about the best agreement, with the priors of the numbers."""
    at = np.concatenate([made.numbers, made.restitutions])
    slopes = made.slopes / target.noise
    rest = (target.values[: made.motion.values.size] - made.motion.values) / target.noise
    free = np.concatenate([target.deviation > 0, np.ones(made.restitutions.size, bool)])
    weight = np.zeros(at.size)
    finite = np.isfinite(target.deviation) & (target.deviation > 0)
    weight[:HEAD][finite] = target.deviation[finite] ** -2.0
    mean = np.zeros(at.size)
    mean[:HEAD] = target.mean
    information = slopes.T @ slopes
    pull = information @ at + slopes.T @ rest + weight * mean
    precision = information + np.diag(weight)
    # What is set does not move: its part of the exponent is that at its value.
    pull = pull - precision @ np.where(free, 0.0, at)
    return Gauss(precision, pull, free, at)


def alone(gauss: Gauss) -> tuple[Values, Values]:
    """Return precision (k, k) and pull (k,) of the restitutions, the other numbers integrated."""
    head = np.flatnonzero(gauss.free[:HEAD])
    rest = np.arange(HEAD, gauss.at.size)
    inner = gauss.precision[np.ix_(head, head)]
    cross = gauss.precision[np.ix_(rest, head)]
    scale = np.sqrt(np.diag(inner))
    solved = np.linalg.solve(
        inner / np.outer(scale, scale), np.column_stack([cross.T, gauss.pull[head]]) / scale[:, None]
    ) / scale[:, None]
    precision = gauss.precision[np.ix_(rest, rest)] - cross @ solved[:, :-1]
    return (precision + precision.T) / 2, gauss.pull[rest] - cross @ solved[:, -1]


def untied(gauss: Gauss, restitution: float) -> tuple[Values, Values]:
    """Return restitution of each impact and its variance, hardly tied to the others."""
    precision, pull = alone(gauss)
    tie = (UNTIED * restitution) ** -2.0
    inverse = np.linalg.inv(precision + tie * np.eye(pull.size))
    mean = inverse @ (pull + tie * restitution)
    variances: Values = np.diag(inverse).copy()
    # Where the record is silent the tie speaks: let such impacts count for nothing.
    variances[variances > 0.5 / tie] = 1.0
    return mean, variances


def sampled(gauss: Gauss, prior: Prior, seed: int) -> Values:
    """Return draws of mean restitution and its scatter, shape (n, 2)."""
    precision, pull = alone(gauss)
    hits = pull.size

    def density(pair: Values) -> float:
        e, scatter = pair
        tie = (scatter * e) ** -2.0
        try:
            root = np.linalg.cholesky(precision + tie * np.eye(hits))
        except np.linalg.LinAlgError:
            return NEVER
        white = np.linalg.solve(root, pull + tie * e)
        made = 0.5 * white @ white - np.sum(np.log(np.diag(root)))
        return float(made + 0.5 * hits * np.log(tie) - 0.5 * hits * tie * e**2)

    def draw(cube: Values) -> Values:
        return np.array([max(prior.at(cube[0]), 1e-3), SCATTER.at(cube[1])])

    random = np.random.default_rng(seed)
    run = sampler().NestedSampler(
        lambda cube: density(draw(cube)), lambda cube: cube, 2, nlive=LIVE, bound="multi",
        sample="unif", bootstrap=0, rstate=random,
    )
    run.run_nested(dlogz=0.1, print_progress=False)
    return np.array([draw(cube) for cube in run.results.samples_equal(rstate=random)])


def drawn(
    target: Target, made: Shot, gauss: Gauss, hyper: Values, clock: float, seed: int
) -> tuple[dict[str, Values], Values]:
    """Return draws of all numbers, and of the impacts (n, 4, k)."""
    random = np.random.default_rng(seed + 1)
    chosen = hyper[random.integers(len(hyper), size=DRAWS)]
    x = np.empty((DRAWS, gauss.at.size))
    for row, (e, scatter) in enumerate(chosen):
        mean, covariance = gauss.covariance(e, scatter)
        values, vectors = np.linalg.eigh(covariance)
        root = vectors * np.sqrt(np.maximum(values, 0))
        x[row] = mean + root @ random.standard_normal(mean.size)
    hits = min(made.restitutions.size, len(made.motion.times))
    told = np.array(
        [made.motion.times[:hits], made.motion.jumps[:hits], made.motion.approaches[:hits]]
    )
    change = np.einsum("rkp,np->nrk", made.by_impact[:, :hits], x - gauss.at)
    each = np.empty((DRAWS, 4, hits))
    each[:, :3] = told + change
    each[:, 0] += clock
    each[:, 2] = np.abs(each[:, 2])
    each[:, 3] = x[:, HEAD : HEAD + hits]
    draws = {name: np.exp(x[:, place]) for place, name in enumerate(NUMBERS[:LOGARITHMS])}
    draws["displacement"] *= target.rig.sign
    if target.rig.length is not None:
        omega = 2 * np.pi * draws["frequency_hz"]
        rig = target.rig
        draws["frequency_ratio"] = np.sqrt(rig.gravity / (rig.inertia_ratio * rig.length)) / omega
    draws["damping_ratio"] = x[:, NUMBERS.index("damping_ratio")]
    draws["release"] = x[:, NUMBERS.index("release")] + clock
    draws["gap_displacement"] = np.full(DRAWS, target.rig.place)
    draws["restitution"], draws["restitution_scatter"] = chosen.T
    order = (
        "frequency_hz", "damping_ratio", "mass_ratio", "restitution", "gap", "frequency_ratio",
        "displacement", "gap_displacement", "release", "restitution_scatter",
    )
    return {name: draws[name] for name in order}, each


def combinations_of(
    target: Target, gauss: Gauss, hyper: Values, known: Stated
) -> tuple[str, ...]:
    """Return what the record leaves open, in words."""
    e, scatter = np.median(hyper, axis=0)
    tie = (scatter * e) ** -2.0
    size = gauss.at.size
    joint = np.zeros((size + 1, size + 1))
    joint[:size, :size] = gauss.precision
    weight = np.where(target.deviation > 0, target.deviation, np.inf) ** -2.0
    joint[np.arange(HEAD), np.arange(HEAD)] -= np.where(np.isfinite(weight), weight, 0.0)
    rest = np.arange(HEAD, size)
    joint[rest, rest] += tie
    joint[rest, size] = joint[size, rest] = -tie
    joint[size, size] = tie * rest.size
    kept = [place for place in (1, 2, 3) if gauss.free[place]]
    names = [NUMBERS[place] for place in kept]
    if not isinstance(known.priors.get("restitution"), Exactly):
        kept.append(size)
        names.append("restitution")
    other = [p for p in range(size) if p not in kept and (p >= HEAD or gauss.free[p])]
    inner = joint[np.ix_(other, other)]
    cross = joint[np.ix_(kept, other)]
    scale = np.sqrt(np.maximum(np.diag(inner), 1e-300))
    inverse = np.linalg.pinv(inner / np.outer(scale, scale), hermitian=True, rcond=1e-12)
    information = joint[np.ix_(kept, kept)] - cross @ (inverse / np.outer(scale, scale)) @ cross.T
    if names and names[-1] == "restitution":
        information[-1] *= e
        information[:, -1] *= e
    directions = null_directions(information)
    chosen = tuple(names)
    return tuple(in_words(directions[:, column], chosen) for column in range(directions.shape[1]))


__all__ = ["identified", "swing"]
