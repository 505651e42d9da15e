"""The stages one after the other: look, search, race, and a fresh judgement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from iva.optimisation.cases import Draw
from iva.optimisation.evaluation import Candidate, Evaluation, Weighing
from iva.optimisation.plan import Plan, plan_of
from iva.optimisation.plateau import around, told_apart
from iva.optimisation.points import check
from iva.optimisation.race import raced
from iva.optimisation.search import (
    by_directions,
    directions,
    distinct,
    evolved,
    explored,
    ranked,
    refined,
    weighing_of,
)

#: Fewest members of a population that SciPy takes.
LEAST_POPULATION = 5
#: Most fresh cases of one design.
MOST_FRESH = 1 << 16


@dataclass
class Judged:
    """What came of a search.

    Parameters
    ----------
    searched : Candidate
        The best, under the cases of the search.
    fresh : Candidate or None
        The best, under fresh cases; ``None`` if the search was stopped before.
    as_good : list of Candidate
        Designs that fresh cases cannot tell from the best.
    front : list of Candidate
        For several goals, under fresh cases: designs that no other beats.
    is_complete : bool
        Not stopped before the end.
    """

    searched: Candidate
    fresh: Candidate | None = None
    as_good: list[Candidate] = field(default_factory=list)
    front: list[Candidate] = field(default_factory=list)
    is_complete: bool = False


def judged(evaluation: Evaluation) -> Judged:
    """Search, and judge what was found.

    Ctrl-C ends it with the best so far; before anything was run it goes through.

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C before there is any design.
    """
    problem = evaluation.problem
    widest = max(len(variant.choices) for variant in problem.variants)
    counts = (widest, len(problem.variants), len(problem.goals))
    plan = plan_of(evaluation.left, *counts, problem.is_certain)
    seeds = np.random.SeedSequence(problem.seed)
    rng = np.random.default_rng(seeds)
    search, fresh = (
        [Draw(one, method, 2 * problem.seed + odd) for one in problem.uncertain]
        for odd, method in enumerate(("sobol", "random"))
    )
    check(problem, search)
    try:
        finalists = found(evaluation, search, plan, rng)
        best = middle(evaluation, finalists)
    except KeyboardInterrupt:
        most = max((one.cases for one in evaluation.candidates), default=0)
        known = [one for one in evaluation.candidates if one.cases == most > 0]
        if not known:
            raise
        return Judged(middle(evaluation, known))
    result = Judged(best)
    try:
        judge(evaluation, result, finalists, fresh, plan, rng)
    except KeyboardInterrupt:
        return result
    result.is_complete = True
    return result


def found(
    evaluation: Evaluation, draws: Sequence[Draw], plan: Plan, rng: np.random.Generator
) -> list[Candidate]:
    """Return the designs that lead after look, search and race."""
    problem = evaluation.problem
    weights = directions(len(problem.goals))
    tried: list[Candidate] = []
    for variant in range(len(problem.variants)):
        first = explored(evaluation, draws, variant, plan, rng)
        weighings = [weighing_of(evaluation, first, row) for row in weights]
        kept = by_directions(evaluation, first, weighings, plan.kept * len(weighings))
        evaluation.extend(kept, draws, plan.searched)
        tried += kept
        generations = max(plan.generations // len(weighings), 1)
        for weighed in weighings:
            begin = ranked(evaluation, kept, weighed)[: plan.kept]
            if len(begin) >= LEAST_POPULATION:
                tried += evolved(evaluation, draws, begin, weighed, plan.searched, generations, rng)
    weighings = [weighing_of(evaluation, tried, row) for row in weights]
    if problem.is_certain:
        if len(weighings) == 1:
            best = ranked(evaluation, tried, weighings[0])[0]
            tried += refined(evaluation, draws, best, weighings[0])
        return distinct(tried)
    return raced(evaluation, draws, tried, weighings, plan)


def middle(evaluation: Evaluation, candidates: Sequence[Candidate]) -> Candidate:
    """Return the best candidate; of several goals the best in the middle of the front."""
    goals = len(evaluation.problem.goals)
    weighed = weighing_of(evaluation, candidates, np.full(goals, 1.0 / goals))
    return ranked(evaluation, candidates, weighed)[0]


def judge(
    evaluation: Evaluation,
    result: Judged,
    finalists: Sequence[Candidate],
    draws: Sequence[Draw],
    plan: Plan,
    rng: np.random.Generator,
) -> None:
    """Judge the best, and those that may be as good or on the front, by fresh cases."""
    problem, best = evaluation.problem, result.searched
    if problem.is_certain:
        result.fresh = best
        result.front = unbeaten(evaluation, finalists) if len(problem.goals) > 1 else []
        return
    fresh = evaluation.candidate(best.variant, best.unit, fresh=True)
    if len(problem.goals) > 1:
        some = unbeaten(evaluation, finalists)
        others = [
            evaluation.candidate(one.variant, one.unit, fresh=True)
            for one in some
            if one is not best
        ]
        count = max(min(evaluation.left // (len(others) + 1), MOST_FRESH), plan.round)
        evaluation.extend([fresh, *others], draws, count)
        result.fresh = fresh
        result.front = unbeaten(evaluation, [fresh, *others])
        return
    weighed = Weighing(np.ones(1), np.zeros(1), np.ones(1))
    order = ranked(evaluation, finalists, weighed)
    # The best comes first: Ctrl-C after it leaves a judgement of it.
    evaluation.extend([fresh], draws, plan.with_best)
    result.fresh = fresh
    others = around(evaluation, best, order, plan.compared, rng)
    others = [one for one in others if (one.variant, one.values) != (fresh.variant, fresh.values)]
    evaluation.extend(others, draws, plan.with_best)
    worse = told_apart(evaluation, fresh, others, problem.seed)
    result.as_good = [fresh] + [one for one, apart in zip(others, worse, strict=True) if not apart]
    more = min(fresh.cases + evaluation.left, MOST_FRESH)
    if more > fresh.cases:
        evaluation.extend([fresh], draws, more)


def unbeaten(evaluation: Evaluation, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates that keep all bounds and that no other such one beats.

    One beats another if it is better in a goal and worse in none. Where none keeps all bounds, or
    all goals are missing, there is none.
    """
    goals = len(evaluation.problem.goals)
    numbers = [evaluation.numbers(one) for one in candidates]
    keeping = [
        (one, row[:goals])
        for one, row in zip(candidates, numbers, strict=True)
        if evaluation.passed(row) == 0 and np.isfinite(row[:goals]).all()
    ]
    if not keeping:
        return []
    values = np.array([row for _, row in keeping])
    order = np.lexsort(values.T[::-1])
    front: list[int] = []
    for index in order:
        # In this order nothing later beats an earlier one.
        against = values[front]
        beats = (against <= values[index]).all(axis=1) & (against < values[index]).any(axis=1)
        if not beats.any():
            front.append(int(index))
    return [keeping[index][0] for index in front]
