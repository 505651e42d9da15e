"""The search: a first look at even points, then differential evolution from the best of them.

Differential evolution is SciPy's (R. Storn and K. Price, J. Global Optim. 11 (1997) 341–359). All
designs are judged by the same cases, so that what differs between two of them is not luck alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from iva.optimisation.cases import Draw
from iva.optimisation.evaluation import Candidate, Evaluation, Weighing, energy
from iva.optimisation.plan import Plan

if TYPE_CHECKING:
    from iva.optimisation.criteria import Numbers

#: Directions in which a front is sought, for two goals; twice as many for more.
DIRECTIONS = 8
#: Power of ten below every weight, so that no goal is forgotten.
LEAST_WEIGHT = 0.02


def explored(
    evaluation: Evaluation,
    draws: Sequence[Draw],
    variant: int,
    plan: Plan,
    rng: np.random.Generator,
) -> list[Candidate]:
    """Return candidates at Sobol points of the box, looked at under few cases."""
    from scipy.stats import qmc

    fields = len(evaluation.problem.variants[variant].choices)
    points = qmc.Sobol(fields, scramble=True, rng=rng).random(plan.explored)
    found = distinct(evaluation.candidate(variant, unit) for unit in points)
    evaluation.extend(found, draws, plan.first)
    return found


def distinct(candidates: Iterable[Candidate]) -> list[Candidate]:
    """Return the first of those candidates that are the same design, as sizes make them."""
    found: dict[tuple[int, tuple[float, ...]], Candidate] = {}
    for one in candidates:
        found.setdefault((one.variant, one.values), one)
    return list(found.values())


def weighing_of(
    evaluation: Evaluation, candidates: Sequence[Candidate], weights: Numbers
) -> Weighing:
    """Return one number for several goals, by the values that some candidates have."""
    goals = len(evaluation.problem.goals)
    if goals == 1:
        return Weighing(weights, np.zeros(1), np.ones(1))
    values = np.array([evaluation.numbers(one) for one in candidates])
    keeps = np.array([evaluation.passed(row) == 0 for row in values])
    good = values[keeps, :goals] if keeps.any() else values[:, :goals]
    good = good[np.isfinite(good).all(axis=1)]
    if not len(good):
        return Weighing(weights, np.zeros(goals), np.ones(goals))
    ideal = good.min(axis=0)
    span = np.quantile(good, 0.5, axis=0) - ideal
    return Weighing(weights, ideal, np.where(span > 0, span, 1.0))


def directions(goals: int) -> Numbers:
    """Return weights of the goals, shape (directions, goals): one direction for a single goal."""
    if goals == 1:
        return np.ones((1, 1))
    if goals == 2:
        share = np.linspace(LEAST_WEIGHT, 1 - LEAST_WEIGHT, DIRECTIONS)
        return np.stack([share, 1 - share], axis=1)
    from scipy.stats import qmc

    # Spacings of even points are even on the simplex.
    cuts = np.sort(qmc.Sobol(goals - 1, scramble=False).random(2 * DIRECTIONS), axis=1)
    ends = np.pad(cuts, ((0, 0), (1, 1)), constant_values=((0, 0), (0, 1)))
    return np.maximum(np.diff(ends, axis=1), LEAST_WEIGHT)


def evolved(
    evaluation: Evaluation,
    draws: Sequence[Draw],
    begin: Sequence[Candidate],
    weighed: Weighing,
    cases: int,
    generations: int,
    rng: np.random.Generator,
) -> list[Candidate]:
    """Return all candidates that differential evolution tries from some first ones."""
    from scipy.optimize import differential_evolution

    tried: list[Candidate] = []
    variant = begin[0].variant
    first = np.array([one.unit for one in begin])

    def energies(units: Numbers) -> Numbers:
        # SciPy hands over columns; the first are the candidates that are known.
        members = [evaluation.candidate(variant, unit) for unit in units.T]
        unlike = distinct(members)
        evaluation.extend(unlike, draws, cases)
        tried.extend(unlike)
        by_values = {one.values: one for one in unlike}
        found = [energy(evaluation, by_values[one.values], weighed) for one in members]
        return np.array(found)

    differential_evolution(
        energies,
        [(0.0, 1.0)] * first.shape[1],
        init=first,
        maxiter=generations,
        tol=0.0,
        atol=-1.0,  # the number of generations is the plan's
        mutation=(0.4, 0.9),
        recombination=0.9,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=rng,
    )
    return tried


def refined(
    evaluation: Evaluation,
    draws: Sequence[Draw],
    best: Candidate,
    weighed: Weighing,
) -> list[Candidate]:
    """Return the candidates of a local search from the best one, where there is a single case.

    The simplex of J. A. Nelder and R. Mead (Comput. J. 7 (1965) 308–313), which needs no
    derivatives: a measure jumps where the sequence of impacts changes, and a simplex does not
    believe that it goes on. Sizes stay as they are.
    """
    from scipy.optimize import minimize

    choices = list(evaluation.problem.variants[best.variant].choices.values())
    free = [index for index, choice in enumerate(choices) if not choice.sizes]
    tried: list[Candidate] = []
    if not free:
        return tried

    def value(part: Numbers) -> float:
        unit = best.unit.copy()
        unit[free] = np.clip(part, 0.0, 1.0)
        one = evaluation.candidate(best.variant, unit)
        evaluation.extend([one], draws, 1)
        tried.append(one)
        return energy(evaluation, one, weighed)

    begin = best.unit[free]
    inwards = np.where(begin < 0.5, 0.01, -0.01)
    simplex = np.vstack([begin, begin + np.diag(inwards)])
    most = max(evaluation.left, 1)
    minimize(
        value,
        begin,
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "maxfev": most, "xatol": 1e-9, "fatol": 0.0},
    )
    return tried


def ranked(
    evaluation: Evaluation, candidates: Sequence[Candidate], weighed: Weighing
) -> list[Candidate]:
    """Return candidates, the best first; of equal ones that which was tried first."""
    return sorted(candidates, key=lambda one: energy(evaluation, one, weighed))


def by_directions(
    evaluation: Evaluation,
    candidates: Sequence[Candidate],
    weighings: Sequence[Weighing],
    count: int,
) -> list[Candidate]:
    """Return some candidates: in turn the best that is left in each direction."""
    ranks = [iter(ranked(evaluation, candidates, weighed)) for weighed in weighings]
    taken: dict[int, Candidate] = {}
    most = min(count, len(candidates))
    while len(taken) < most:
        for rank in ranks:
            following = next((one for one in rank if id(one) not in taken), None)
            if following is not None and len(taken) < most:
                taken[id(following)] = following
    return list(taken.values())
