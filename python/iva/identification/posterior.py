"""Draws of the absorber's numbers, given what the impacts say.

The sampler is nested sampling (Skilling, Bayesian Analysis 1 (2006) 833) by ``dynesty``, made for
several modes and for long valleys such as a record with few impacts has. The restitution of each
impact and all numbers of the record are integrated out in closed form.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from iva.identification.growing import settled
from iva.identification.needs import sampler
from iva.identification.priors import Between, Exactly, Prior
from iva.identification.responses import Values
from iva.identification.valleys import Valleys
from iva.identification.walls import Absorber, Contacts, log_likelihood

#: Scatter of restitution from impact to impact that is thought possible, relative. Impacts that
#: repeat to better than a hundredth have not been seen: Montaine et al., arXiv 1104.0049.
SCATTER = Between(0.01, 0.3, by_logarithm=True)
#: How far a wall is from where it was at the other impacts, relative to the clearance.
PLAY = Between(2e-4, 0.03, by_logarithm=True)
#: Live points of the sampler.
LIVE = 100
#: Half width of the sampled box in standard deviations, where the record determines all.
WIDTH = 7.0
#: Standard deviation (relative) up to which a number counts as determined for that box.
NARROW = 0.06
#: Points of which one must be possible.
TRIED = 400
#: Logarithm of a density that stands for impossible.
NEVER = -1e100


@dataclass(frozen=True)
class Beliefs:
    """Priors of mass ratio, clearance (m), restitution and gap displacement (m).

    Without one the absorber may rest anywhere between the walls.
    """

    mass_ratio: Prior
    clearance: Prior
    restitution: Prior
    place: Prior | None

    def log_density(self, absorber: Absorber) -> float:
        """Return the logarithm of the density by 1/μ, d, y₀, e and logarithms of the others."""
        d = absorber.clearance
        if d <= 0 or absorber.heaviness <= 0 or abs(absorber.place) > d:
            return NEVER
        made = (
            self.mass_ratio.log_density(1 / absorber.heaviness)
            - 2 * np.log(absorber.heaviness)
            + self.clearance.log_density(d)
            + self.restitution.log_density(absorber.restitution)
        )
        made += -np.log(2 * d) if self.place is None else self.place.log_density(absorber.place)
        return float(made) if np.isfinite(made) else NEVER


@dataclass(frozen=True)
class Draws:
    """Equally likely absorbers: columns 1/μ, d, y₀, e, scatter, play, shape (n, 6).

    ``possible`` is False where no absorber makes the impacts: then they are those of the priors.
    """

    numbers: Values
    calls: int
    possible: bool = True

    def absorber(self, row: int) -> Absorber:
        """Return one of them."""
        return Absorber(*map(float, self.numbers[row]))


def fixed_of(beliefs: Beliefs) -> list[bool]:
    """Return which of 1/μ, d, y₀ and e are set."""
    each = (beliefs.mass_ratio, beliefs.clearance, beliefs.place, beliefs.restitution)
    return [isinstance(one, Exactly) for one in each]


def best_scatter(
    found: Contacts, absorber: Absorber, pull: tuple[Values, Values]
) -> tuple[Absorber, Values]:
    """Return the most likely absorber with its scatter and play, and the information on it."""

    def at(logarithms: Values) -> Absorber:
        scatter = float(np.clip(np.exp(logarithms[0]), SCATTER.low, SCATTER.high))
        play = float(np.clip(np.exp(logarithms[1]), PLAY.low, PLAY.high))
        return replace(absorber, scatter=scatter, play=play)

    def cost(logarithms: Values) -> float:
        made, _, _ = settled(found, at(logarithms), pull, rounds=4)
        return -log_likelihood(found, made)

    begin = np.log([0.05, 2e-3])
    best = minimize(
        cost, begin, method="Nelder-Mead", options={"maxfev": 60, "xatol": 0.05, "fatol": 0.05}
    )
    made, _, information = settled(found, at(best.x), pull)
    return made, information


def sampled(
    found: Contacts,
    beliefs: Beliefs,
    start: Absorber,
    pull: tuple[Values, Values],
    seed: int,
) -> Draws:
    """Return draws from the posterior.

    Parameters
    ----------
    found : Contacts
        Of the impacts that count.
    beliefs : Beliefs
        The priors.
    start : Absorber
        From the growing window.
    pull : tuple of ndarray, shape (4,)
        As for :func:`iva.identification.growing.settled`.
    seed : int
        The same seed gives the same draws.

    Raises
    ------
    ImportError
        If ``dynesty`` is not installed.
    """
    dynesty = sampler()
    middle, information = best_scatter(found, start, pull)
    fixed = np.array(fixed_of(beliefs))
    scale = np.array(
        [middle.heaviness, middle.clearance, middle.clearance, max(middle.restitution, 0.1)]
    )
    scaled = (information * np.outer(scale, scale))[np.ix_(~fixed, ~fixed)]
    eigenvalues = np.linalg.eigvalsh(scaled) if scaled.size else np.array([np.inf])
    if eigenvalues.min(initial=np.inf) > NARROW**-2:
        # One round mode fills that box.
        how = {"bound": "single", "sample": "unif"}
        size = int((~fixed).sum()) + 2
        inside = box(middle, scaled, scale, fixed)

        def draw(cube: Values) -> tuple[Values, float]:
            numbers = inside(cube)
            return numbers, beliefs.log_density(Absorber(*numbers))

    else:
        how = {"bound": "multi", "sample": "rwalk"}
        valleys = Valleys(
            found,
            beliefs.mass_ratio,
            beliefs.clearance,
            beliefs.restitution,
            beliefs.place,
            SCATTER,
            PLAY,
        )
        size, draw = valleys.size, valleys.at

    def density(cube: Values) -> float:
        numbers, prior = draw(cube)
        if not prior > NEVER:
            return NEVER
        made = prior + log_likelihood(found, Absorber(*numbers))
        return max(made, NEVER) if np.isfinite(made) else NEVER

    random = np.random.default_rng(seed)
    if not max(density(cube) for cube in random.random((TRIED, size))) > NEVER / 2:
        return from_priors(beliefs, seed)
    run = dynesty.NestedSampler(
        density, lambda cube: cube, size, nlive=LIVE, bootstrap=0, rstate=random, **how
    )
    with warnings.catch_warnings():
        # It warns of a density that is the same everywhere, which is said below.
        warnings.simplefilter("ignore", UserWarning)
        run.run_nested(dlogz=0.1, print_progress=False)
    results = run.results
    if not np.max(results.logl) > NEVER / 2:
        return from_priors(beliefs, seed)
    cubes = results.samples_equal(rstate=random)
    return Draws(np.array([draw(cube)[0] for cube in cubes]), int(np.sum(results.ncall)))


def about(
    found: Contacts, beliefs: Beliefs, middle: Absorber, pull: tuple[Values, Values], seed: int
) -> Draws:
    """Return draws of a normal distribution about the most likely absorber; as :func:`sampled`."""
    best, _, information = settled(found, middle, pull)
    free = ~np.array(fixed_of(beliefs))
    weight = np.where(pull[1] > 0, 1 / np.maximum(pull[1], 1e-12), 0.0) ** 2
    curved = (information + np.diag(weight))[np.ix_(free, free)]
    scale = np.sqrt(np.maximum(np.diag(curved), 1e-300))
    values, axes = np.linalg.eigh(curved / np.outer(scale, scale))
    root = axes / np.sqrt(np.maximum(values, 1e-12))
    centre = np.array([best.heaviness, best.clearance, best.place, best.restitution])
    made = np.tile(np.concatenate([centre, [middle.scatter, middle.play]]), (TRIED, 1))
    random = np.random.default_rng(seed)
    moves = random.standard_normal((TRIED, int(free.sum()))) @ root.T / scale
    made[:, np.flatnonzero(free)] += moves
    made[:, :2] = np.maximum(made[:, :2], 0.1 * centre[:2])
    made[:, 2] = np.clip(made[:, 2], -made[:, 1], made[:, 1])
    made[:, 3] = np.clip(made[:, 3], 1e-3, 1.0)
    return Draws(made, 0)


def from_priors(beliefs: Beliefs, seed: int) -> Draws:
    """Return draws of what was known before, for impacts that no absorber makes."""
    shares = np.random.default_rng(seed).random((TRIED, 6))
    made = np.empty((TRIED, 6))
    for row, cube in zip(made, shares, strict=True):
        clearance = beliefs.clearance.at(cube[1])
        middle = clearance * (2 * cube[2] - 1)
        place = middle if beliefs.place is None else beliefs.place.at(cube[2])
        mass_ratio, e = beliefs.mass_ratio.at(cube[0]), beliefs.restitution.at(cube[3])
        row[:] = 1 / mass_ratio, clearance, place, e, SCATTER.at(cube[4]), PLAY.at(cube[5])
    return Draws(made, 0, possible=False)


def box(middle: Absorber, scaled: Values, scale: Values, fixed: NDArray[np.bool_]) -> Any:
    """Return the map of a cube to a box along the axes of the posterior, wide enough for it."""
    values, axes = np.linalg.eigh(scaled) if scaled.size else (np.zeros(0), np.zeros((0, 0)))
    reach = axes * (WIDTH / np.sqrt(values))
    centre = np.array([middle.heaviness, middle.clearance, middle.place, middle.restitution])

    def draw(cube: Values) -> Values:
        made = centre.copy()
        made[~fixed] += scale[~fixed] * (reach @ (2 * cube[:-2] - 1))
        return np.concatenate([made, [SCATTER.at(cube[-2]), PLAY.at(cube[-1])]])

    return draw


__all__ = ["Beliefs", "Draws", "about", "best_scatter", "from_priors", "sampled"]
