"""The race: the more cases, the fewer designs.

Designs that few cases favour are favoured by luck as well (the winner's curse). So those that lead
are run under more cases, of which the first are those they have been under, and the ones that fall
behind are dropped. All have the same cases (common random numbers): what is left between two
designs is a difference of theirs.
"""

from __future__ import annotations

from collections.abc import Sequence

from iva.optimisation.cases import Draw
from iva.optimisation.evaluation import Candidate, Evaluation, Weighing
from iva.optimisation.plan import Plan
from iva.optimisation.search import by_directions, distinct


def raced(
    evaluation: Evaluation,
    draws: Sequence[Draw],
    candidates: Sequence[Candidate],
    weighings: Sequence[Weighing],
    plan: Plan,
) -> list[Candidate]:
    """Return the designs of the last round, in no order.

    Only designs under equally many cases are compared: of those that the first look alone has
    seen, the ones that it kept are in the search as well.
    """
    running = distinct(one for one in candidates if one.cases >= plan.searched)
    for count, cases in ((plan.raced, plan.round), (plan.finalists, plan.last)):
        running = by_directions(evaluation, running, weighings, count)
        evaluation.extend(running, draws, cases)
    return running
