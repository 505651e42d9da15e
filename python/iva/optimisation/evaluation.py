"""Designs under cases: what is run, once, and what is known of a design so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from iva.frames import to_polars
from iva.optimisation.cases import Draw
from iva.optimisation.points import faults, in_range, rows_of, some_of, study_of

if TYPE_CHECKING:
    import polars as pl

    from iva.optimisation.criteria import Numbers
    from iva.optimisation.logbook import Logbook
    from iva.optimisation.problem import Problem
    from iva.parameters import Spec
    from iva.progress import Report

#: Runs of one batch, so that their rows stay small.
BATCH = 1 << 16
#: Above every value of a measure: what passes a bound is worse than all that keep them.
PASSES = 1e60
#: Above every value as well, but below :data:`PASSES`: a number that is missing.
MISSING = 1e40


@dataclass(eq=False)
class Candidate:
    """A design and what is known of it.

    Parameters
    ----------
    variant : int
        Number of the variant.
    unit : numpy.ndarray, shape (k,)
        Its coordinates, each from 0 to 1.
    values : tuple of float
        The chosen fields.
    bad : numpy.ndarray, shape (m, n)
        Each measure in each case so far; large values are bad, infinite ones missing.
    """

    variant: int
    unit: Numbers
    values: tuple[float, ...]
    bad: Numbers = field(repr=False)

    @property
    def cases(self) -> int:
        """Number of cases so far."""
        return int(self.bad.shape[1])


class Evaluation:
    """Runs candidates under cases, within a number of runs.

    Parameters
    ----------
    problem : Problem
        What is asked.
    budget : int
        Number of runs that may be spent.
    logbook : Logbook
        Keeps what was run.
    threads : int or None
        Worker threads.
    report : callable or None
        Told how far it is.
    """

    def __init__(
        self,
        problem: Problem,
        budget: int,
        logbook: Logbook,
        threads: int | None,
        report: Report | None,
    ) -> None:
        self.problem = problem
        self.budget = budget
        self.spent = 0
        self._known: dict[tuple[int, tuple[float, ...]], Candidate] = {}
        self._logbook = logbook
        self._threads = threads
        self._report = report
        self._measured = problem.measured

    @property
    def candidates(self) -> list[Candidate]:
        """All candidates that were searched, in the order in which they were tried."""
        return list(self._known.values())

    @property
    def left(self) -> int:
        """Cases of one design that can still be run."""
        return (self.budget - self.spent) // self.problem.runs_a_case

    def candidate(self, variant: int, unit: Numbers, *, fresh: bool = False) -> Candidate:
        """Return the candidate at some coordinates: of sizes that are known the known one.

        A `fresh` one is always new, and not among those searched.
        """
        choices = self.problem.variants[variant].choices.values()
        values = tuple(
            float(choice.at(np.asarray(place))) for choice, place in zip(choices, unit, strict=True)
        )
        made = Candidate(variant, unit, values, np.empty((len(self._measured), 0)))
        return made if fresh else self._known.setdefault((variant, values), made)

    def extend(self, candidates: Sequence[Candidate], draws: Sequence[Draw], count: int) -> None:
        """Run candidates under the first `count` cases, but for those they have been under.

        Raises
        ------
        ValueError
            If a scene is invalid.
        KeyboardInterrupt
            On Ctrl-C; what was run before is kept.
        """
        groups: dict[tuple[int, int], list[Candidate]] = {}
        for one in candidates:
            if one.cases < count:
                groups.setdefault((one.variant, one.cases), []).append(one)
        for (variant, first), group in groups.items():
            each = max(BATCH // ((count - first) * self.problem.runs_a_case), 1)
            for begin in range(0, len(group), each):
                some = group[begin : begin + each]
                values = np.array([one.values for one in some])
                for one, bad in zip(
                    some, self.run(variant, values, draws[variant], first, count), strict=True
                ):
                    one.bad = np.concatenate([one.bad, bad], axis=1)

    def run(self, variant: int, values: Numbers, draw: Draw, first: int, last: int) -> Numbers:
        """Return the measures of designs in some cases.

        Parameters
        ----------
        variant : int
            Number of the variant.
        values : numpy.ndarray, shape (k, number of chosen fields)
            The designs.
        draw : Draw
            The cases.
        first, last : int
            The cases from `first` to below `last`.

        Returns
        -------
        numpy.ndarray, shape (k, m, last − first)
        """
        problem = self.problem
        shape = (len(values), last - first, problem.runs_a_case)
        rows = rows_of(problem, variant, values, draw.cases(first, last), shape)
        found = self._logbook.entry(rows, lambda: self.measures(variant, rows), len(self._measured))
        self.spent += int(np.prod(shape))
        if self._report is not None:
            self._report(self.spent, max(self.budget, self.spent), 0)
        worst = found.reshape(len(self._measured), *shape).max(axis=-1)
        return np.moveaxis(worst, 0, 1)

    def measures(self, variant: int, rows: list[tuple[str, Numbers]]) -> Numbers:
        """Run some points; return the badness of every measure in each, shape (m, n).

        A point with a field out of its range, or with fields that do not fit each other, cannot be
        run, and has no value.
        """
        names = [goal.column for goal in self._measured]
        good = in_range(rows)
        found = np.full((len(names), good.size), np.inf)
        if not good.any():
            return found
        spec = self.problem.variants[variant].spec
        try:
            summary = self.summary(spec, some_of(rows, good), names)
        except ValueError:
            # Only now, for to look at every point takes some time.
            good[good] = [one is None for one in faults(spec, some_of(rows, good))]
            if not good.any():
                return found
            summary = self.summary(spec, some_of(rows, good), names)
        for place, goal in enumerate(self._measured):
            values = summary[goal.column].cast(float).fill_null(np.nan).to_numpy()
            bad = -values if goal.larger else values
            found[place, good] = np.where(np.isnan(bad), np.inf, bad)
        return found

    def summary(
        self, spec: Spec, rows: list[tuple[str, Numbers]], names: list[str]
    ) -> pl.DataFrame:
        """Return the measures of some points that can be run, a row a point."""
        return to_polars(study_of(spec, rows, names).run(self._threads)["summary"])

    def numbers(self, candidate: Candidate, cases: slice = slice(None)) -> Numbers:
        """Return the badness of each goal, then of each bounded measure, over some of its cases."""
        problem = self.problem
        places = {goal.column: place for place, goal in enumerate(self._measured)}
        choices = list(problem.variants[candidate.variant].choices)
        found = []
        for goal in (*problem.goals, *(limit.goal for limit in problem.limits)):
            if goal.chosen:
                found.append(candidate.values[choices.index(goal.column)] / goal.sign)
            else:
                found.append(float(problem.criterion.of(candidate.bad[places[goal.column], cases])))
        return np.array(found)

    def missing(self, candidate: Candidate) -> float:
        """Return the share of the cases in which a goal is missing."""
        places = [
            place
            for place, goal in enumerate(self._measured)
            if goal.column in (one.column for one in self.problem.goals)
        ]
        if not places:
            return 0.0
        return float(np.isinf(candidate.bad[places]).any(axis=0).mean())

    def passed(self, numbers: Numbers) -> float:
        """Return by how much bounds are passed, as shares of them; 0 where all are kept."""
        limits = self.problem.limits
        bad = numbers[len(self.problem.goals) :]
        return float(sum(limit.excess(one) for limit, one in zip(limits, bad, strict=True)))


def energy(evaluation: Evaluation, candidate: Candidate, weighed: Weighing) -> float:
    """Return what the search makes small.

    What keeps all bounds comes before what passes one, and that in the order of how far (K. Deb,
    Comput. Methods Appl. Mech. Eng. 186 (2000) 311–338); designs without a number come in the
    order of how many cases lack one.
    """
    numbers = evaluation.numbers(candidate)
    passed = evaluation.passed(numbers)
    if passed > 0:
        return PASSES * min(1.0 + passed, 1e60)
    value = weighed.of(numbers[: len(evaluation.problem.goals)])
    return value if np.isfinite(value) else MISSING * (1.0 + evaluation.missing(candidate))


@dataclass(frozen=True)
class Weighing:
    """One number for several goals: how far the worst of them lies above the best values known.

    The augmented Chebyshev function of R. E. Steuer and E.-U. Choo (Math. Programming 26 (1983)
    326–344), whose smallest values are on the front. A single goal is left as it is.

    Parameters
    ----------
    weights : numpy.ndarray, shape (g,)
        Weight of each goal.
    ideal : numpy.ndarray, shape (g,)
        The best value known of each.
    span : numpy.ndarray, shape (g,)
        How far good values of each reach.
    """

    weights: Numbers
    ideal: Numbers
    span: Numbers

    def of(self, goals: Numbers) -> float:
        """Return the one number."""
        if goals.size == 1:
            return float(goals[0])
        parts = self.weights * (goals - self.ideal) / self.span
        return float(parts.max() + 0.01 * parts.sum())
