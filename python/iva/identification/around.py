"""All numbers of a pendulum about the best agreement: Gaussian, but for how restitution scatters.

Given its mean and its scatter, the numbers and the restitution of each impact are Gaussian, so they
are integrated in closed form and only these two are sampled.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iva.identification.combinations import in_words, null_directions
from iva.identification.needs import sampler
from iva.identification.posterior import LIVE, NEVER, SCATTER
from iva.identification.priors import Exactly, Prior
from iva.identification.responses import Values
from iva.identification.shooting import Shot, Target
from iva.identification.stated import Stated
from iva.identification.swings import HEAD, LOGARITHMS, NUMBERS

#: Draws of all numbers.
DRAWS = 1000
#: Scatter with which the restitution of each impact is looked at by itself.
UNTIED = 0.4


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
    solved = (
        np.linalg.solve(
            inner / np.outer(scale, scale),
            np.column_stack([cross.T, gauss.pull[head]]) / scale[:, None],
        )
        / scale[:, None]
    )
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
        lambda cube: density(draw(cube)),
        lambda cube: cube,
        2,
        nlive=LIVE,
        bound="multi",
        sample="unif",
        bootstrap=0,
        rstate=random,
    )
    run.run_nested(dlogz=0.1, print_progress=False)
    return np.array([draw(cube) for cube in run.results.samples_equal(rstate=random)])


def about(restitutions: Values, scatter: float, seed: int) -> Values:
    """Return rough draws of mean restitution and its scatter, shape (n, 2), from those found."""
    random = np.random.default_rng(seed)
    mean = float(np.mean(restitutions))
    each = mean * (1 + scatter / np.sqrt(restitutions.size) * random.standard_normal(DRAWS))
    return np.column_stack([np.clip(each, 1e-3, 1.0), np.full(DRAWS, scatter)])


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
        own = target.rig.gravity / (target.rig.inertia_ratio * target.rig.length)
        draws["frequency_ratio"] = np.sqrt(own) / omega
    draws["damping_ratio"] = x[:, NUMBERS.index("damping_ratio")]
    draws["release"] = x[:, NUMBERS.index("release")] + clock
    draws["gap_displacement"] = np.full(DRAWS, target.rig.place)
    draws["restitution"], draws["restitution_scatter"] = chosen.T
    order = (
        "frequency_hz",
        "damping_ratio",
        "mass_ratio",
        "restitution",
        "gap",
        "frequency_ratio",
        "displacement",
        "gap_displacement",
        "release",
        "restitution_scatter",
    )
    return {name: draws[name] for name in order}, each


def combinations_of(target: Target, gauss: Gauss, hyper: Values, known: Stated) -> tuple[str, ...]:
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


__all__ = ["Gauss", "about", "combinations_of", "drawn", "gauss_of", "sampled", "untied"]
