"""How the runs of a search are shared out among its stages.

The shares were found by trial on the structure of docs/design-a-damper.md, and hardly matter: after
some hundred designs every search has found the good region, and what then decides is how well its
designs are told apart.
"""

from __future__ import annotations

from dataclasses import dataclass

#: Cases of a design in the first look, in the search, and in the two rounds of the race.
FIRST, SEARCHED, ROUND, LAST = 16, 64, 256, 1024
#: Fresh cases by which designs are compared with the best.
COMPARED = 256
#: Shares of all cases that the stages take: first look, search, two rounds of the race, comparison
#: with the best. What is left judges the best by fresh cases, a sixth or more.
EXPLORE, SEARCH, RACE, FINAL, COMPARE = 0.14, 0.2, 0.18, 0.2, 0.12
#: The same where there is a single case, and nothing to race: first look and search. What is left
#: is for a local search.
CERTAIN_EXPLORE, CERTAIN_SEARCH = 0.3, 0.5
#: Cases in all for which these counts are. With more, the counts grow with the power 2/3, and the
#: number of designs with what is left: a search by few cases finds what suits these alone, the
#: better the longer it searches.
USUAL = 60_000
GROWTH = 2 / 3
#: Members of the population for each chosen field, and at least.
MEMBERS, LEAST_MEMBERS = 8, 16


@dataclass(frozen=True)
class Plan:
    """How many designs each stage takes.

    Parameters
    ----------
    first, searched, last : int
        Cases of a design in the first look, in the search, and at the end of the race.
    explored : int
        Designs of the first look.
    kept : int
        Those of them that the search begins with.
    generations : int
        Generations of the search, in all.
    raced : int
        Designs in the first round of the race.
    finalists : int
        Designs in its last round.
    compared : int
        Designs compared with the best by fresh cases.
    with_best : int
        Cases of each of them.
    """

    first: int
    searched: int
    round: int
    last: int
    explored: int
    kept: int
    generations: int
    raced: int
    finalists: int
    compared: int
    with_best: int


def plan_of(cases: int, fields: int, variants: int, goals: int, certain: bool) -> Plan:
    """Return the plan for a number of cases of one design.

    Parameters
    ----------
    cases : int
        Cases of one design that can be run in all.
    fields : int
        Number of chosen fields.
    variants : int
        Number of absorbers to choose among; each has its own search.
    goals : int
        Number of goals; a front needs more finalists, and no comparison with the best.
    certain : bool
        There is one case only; then there is nothing to race, and all is search.
    """
    members = max(LEAST_MEMBERS, MEMBERS * fields)
    each = cases / variants
    if certain:
        explored = power_of_two(CERTAIN_EXPLORE * each, 4)
        generations = max(int(CERTAIN_SEARCH * each / members), 1)
        return Plan(1, 1, 1, 1, explored, members, generations, 1, 1, 0, 1)
    scale = (cases / USUAL) ** GROWTH
    first, searched, one_round, last, with_best = (
        max(round(count * scale), least)
        for count, least in ((FIRST, 4), (SEARCHED, 8), (ROUND, 16), (LAST, 32), (COMPARED, 16))
    )
    explored = power_of_two(EXPLORE * each / first, 4)
    generations = max(int(SEARCH * each / (members * searched)), 1)
    raced = max(int(RACE * cases / one_round), 2)
    finalists = max(int(FINAL * cases / last), 2)
    compared = max(int(COMPARE * cases / with_best), 2)
    if goals > 1:
        last = 2 * one_round
        finalists = max(int((FINAL + COMPARE) * cases / last), 2)
    return Plan(
        first=first,
        searched=searched,
        round=one_round,
        last=last,
        explored=explored,
        kept=members,
        generations=generations,
        raced=raced,
        finalists=finalists,
        compared=compared,
        with_best=with_best,
    )


def power_of_two(count: float, least: int) -> int:
    """Return the largest power of two up to a number, at least `least`."""
    return max(1 << max(int(count), 1).bit_length() - 1, least)
