"""The plateau: designs that cannot be told from the best.

They are compared with it by fresh cases, which none of them was chosen by, and in pairs: both under
the same cases. What is resampled is the cases. Where one case in ten decides, few cases hardly tell
a design that fails in all of these from one that does not; so a design of the plateau must be as
good as the best may be, too: its own value must lie within the interval of the best.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from iva.optimisation.criteria import CONFIDENCE
from iva.optimisation.evaluation import Candidate, Evaluation
from iva.optimisation.search import distinct

if TYPE_CHECKING:
    from iva.optimisation.criteria import Numbers

#: Resamples of the cases.
RESAMPLES = 400
#: Half widths of the box around the best over the mean distance of the finalists from it.
REACH = 2.5
#: Half width of that box where all finalists are the same, in units of the box of all choices.
LEAST_REACH = 0.02


def around(
    evaluation: Evaluation,
    best: Candidate,
    finalists: Sequence[Candidate],
    count: int,
    rng: np.random.Generator,
) -> list[Candidate]:
    """Return the finalists and new designs around the best, at Sobol points of a box."""
    from scipy.stats import qmc

    same = [one for one in finalists if one.variant == best.variant and one is not best]
    known = same[: count // 2]
    distance = np.abs(np.array([one.unit for one in same] or [best.unit]) - best.unit).mean(axis=0)
    reach = np.maximum(REACH * distance, LEAST_REACH)
    low, high = np.maximum(best.unit - reach, 0.0), np.minimum(best.unit + reach, 1.0)
    more = count - len(known)
    points = qmc.Sobol(best.unit.size, scramble=True, rng=rng)
    some = points.random(1 << max(more - 1, 1).bit_length())[:more]
    units = [one.unit for one in known] + list(low + some * (high - low))
    return distinct(evaluation.candidate(best.variant, unit, fresh=True) for unit in units)


def told_apart(
    evaluation: Evaluation, best: Candidate, others: Sequence[Candidate], seed: int
) -> list[bool]:
    """Return for each design whether it is worse than the best, as far as its cases tell.

    Worse with 95 %: in that share of the resamples of the cases the best is better. A design that
    passes a bound, which the best keeps, is worse as well, and so is one whose value lies beyond
    the interval of the best.
    """
    problem = evaluation.problem
    column = problem.goals[0].column
    found = []
    rng = np.random.default_rng(seed)
    place = next((at for at, goal in enumerate(problem.measured) if goal.column == column), None)
    kept = evaluation.passed(evaluation.numbers(best, slice(0, others[0].cases))) if others else 0.0
    picked = rng.integers(others[0].cases, size=(RESAMPLES, others[0].cases)) if others else None
    of_best = None if place is None else problem.criterion.of(best.bad[place][picked])
    worst = math.inf
    if place is not None and others and others[0].cases > 1:
        worst = problem.criterion.interval(best.bad[place][: others[0].cases])[1]
    for other in others:
        passed = evaluation.passed(evaluation.numbers(other))
        if passed > kept:
            found.append(True)
        elif place is None or of_best is None:
            found.append(bool(other.values != best.values))
        else:
            own = float(problem.criterion.of(other.bad[place]))
            of_other = problem.criterion.of(other.bad[place][picked])
            found.append(own > worst or bool(lowest_difference(of_other, of_best) > 0))
    return found


def lowest_difference(of_other: Numbers, of_best: Numbers) -> float:
    """Return what the difference is above in 95 % of the resamples; of two missing ones it is 0."""
    with np.errstate(invalid="ignore"):
        difference = of_other - of_best
    difference = np.where(np.isnan(difference), 0.0, difference)
    share = (1 - CONFIDENCE) / 2
    rank = max(math.ceil(share * difference.size) - 1, 0)
    return float(np.partition(difference, rank)[rank])
