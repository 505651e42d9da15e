"""What came of an optimisation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from iva import _iva
from iva.optimisation.cases import Draw
from iva.optimisation.evaluation import Candidate, Evaluation
from iva.sampling import whole
from iva.scenes import parts
from iva.spelling import spell_checked
from iva.units import Units

if TYPE_CHECKING:
    from collections.abc import Sequence

    import polars as pl

    from iva.optimisation.criteria import Numbers
    from iva.optimisation.problem import Goal, Problem
    from iva.optimisation.stages import Judged
    from iva.parameters import Spec

#: Most cases that are run at once.
MOST_CASES = 10_000_000


@spell_checked
@dataclass(frozen=True, eq=False)
class Optimum:
    """The best design that was found, what fresh cases say of it, and what does as well.

    Parameters
    ----------
    best : dict of str to float
        The chosen fields of the best design, in the units of their names; for several goals of one
        in the middle of the front.
    best_absorber : int
        Which of the absorbers it has: its place in the list, 0 for a single one.
    fresh : polars.DataFrame
        What fresh cases, by which nothing was chosen, say of the best design: a row for each goal
        and each bounded measure, with the columns ``measure``, ``criterion``, ``value``, ``low``
        and ``high`` (the bounds of a 90 % interval for the number over all cases), ``bound``,
        ``kept`` (whether `value` keeps the bound), ``missing`` (share of cases in which the measure
        is null, which counts as worse than any value), ``cases`` and ``searched`` (what the search
        believed: mostly better, because luck is chosen as well). Empty if the search was stopped
        before.
    as_good : polars.DataFrame
        Designs that fresh cases cannot tell from the best, which is the first row, and whose own
        value lies within its interval: the tolerance that a workshop gets. Columns as in `table`.
        For several goals the best alone.
    front : polars.DataFrame
        For several goals: the designs that no other beats, by fresh cases; columns as in `table`.
        Empty for one goal.
    table : polars.DataFrame
        Every design that was tried: ``absorber``, the chosen fields, each goal and bounded measure
        (null: missing), ``within`` (keeps all bounds), ``missing`` and ``cases``.
    runs : int
        Number of runs spent.
    is_complete : bool
        False if Ctrl-C ended it; then `best` is the best so far.
    """

    best: dict[str, float]
    best_absorber: int
    fresh: pl.DataFrame
    as_good: pl.DataFrame
    front: pl.DataFrame
    table: pl.DataFrame
    runs: int
    is_complete: bool
    _problem: Problem

    @cached_property
    def scene(self) -> dict[str, Any]:
        """The best design as arguments of :func:`iva.simulate`.

        What is not known exactly has its median, what the worst is taken over its first value.
        """
        return parts(self._spec)

    @cached_property
    def _spec(self) -> Spec:
        problem, variant = self._problem, self.best_absorber
        values = dict(problem.uncertain[variant].medians)
        values |= {key: axis[0] for key, axis in problem.worst_over.items()} | self.best
        rows = [(key, [value]) for key, value in values.items()]
        study = _iva.Study(problem.variants[variant].spec, ("rows", rows, 0), ["summary"])
        return study.scene(0)

    @property
    def units(self) -> Units:
        """Units of the measures and of the chosen fields, like ``units`` of :class:`iva.Table`."""
        return Units(_iva.unit_system(self._spec), tuple(self.best))

    @property
    def tolerance(self) -> dict[str, tuple[float, float]]:
        """For each chosen field the smallest and the largest value in `as_good`."""
        return {key: (self.as_good[key].min(), self.as_good[key].max()) for key in self.best}  # type: ignore[misc]

    @property
    def criterion(self) -> str:
        """How cases became a number, in words."""
        return "value" if self._problem.is_certain else self._problem.criterion.words

    @property
    def goals(self) -> tuple[str, ...]:
        """Names of what was minimised or maximised."""
        return tuple(goal.name for goal in self._problem.goals)

    def maximised(self, name: str) -> bool:
        """Return whether a goal was to be large."""
        return any(goal.larger for goal in self._problem.goals if goal.name == name)

    def of_cases(self, count: int, *, seed: int, threads: int | None = None) -> pl.DataFrame:
        """Return what other fresh cases say of the best design.

        Parameters
        ----------
        count : int
            Number of cases.
        seed : int
            Seed of the cases; they are independent of all others.
        threads : int, optional
            Worker threads.

        Returns
        -------
        polars.DataFrame
            As `fresh`, with ``searched`` null.

        Raises
        ------
        TypeError, ValueError
            If a number is no whole one, or out of range.
        """
        from iva.optimisation.logbook import Logbook

        whole("count", count, 1, MOST_CASES)
        whole("seed", seed, 0, (1 << 52) - 1)
        problem, variant = self._problem, self.best_absorber
        evaluation = Evaluation(problem, count, Logbook(None, ""), threads, None)
        # Far from the seeds of searches, which are at most twice 2⁵².
        draws = [Draw(one, "random", (1 << 53) - seed) for one in problem.uncertain]
        choices = problem.variants[variant].choices
        unit = np.array([choice.unit(self.best[key]) for key, choice in choices.items()])
        again = Candidate(
            variant, unit, tuple(self.best.values()), np.empty((len(problem.measured), 0))
        )
        evaluation.extend([again], draws, 1 if problem.is_certain else count)
        return of_fresh(evaluation, again, None)

    def at_ends(self) -> dict[str, str]:
        """Return which chosen fields of the best are at the ``lower end`` or ``upper end``.

        There a wider range of choices may have a better design.
        """
        found = {}
        for key, choice in self._problem.variants[self.best_absorber].choices.items():
            value, sizes = self.best[key], sorted(choice.sizes)
            low, high = (sizes[0], sizes[-1]) if sizes else (choice.low, choice.high)
            close = 0.0 if sizes else 0.01 * (high - low)
            if value >= high - close:
                found[key] = "upper end"
            elif value <= low + close:
                found[key] = "lower end"
        return found

    def __repr__(self) -> str:
        """Say the best, what it is worth, and what does as well."""
        cases = max(self.fresh["cases"].to_list(), default=0)
        lines = [f"Optimum by the {self.criterion}"]
        if cases > 1:
            lines[0] += f" of {cases} fresh cases, with 90 % intervals"
        lines.append("  " + ", ".join(f"{key} = {of:.4g}" for key, of in self.best.items()))
        if len(self._problem.variants) > 1:
            lines[-1] += f" ({self._problem.variants[self.best_absorber].label})"
        lines += [f"  {sentence(row)}" for row in self.fresh.iter_rows(named=True)]
        if any(row["value"] is None for row in self.fresh.iter_rows(named=True)):
            rule = "make the run longer, take another, or choose what can be run"
            lines.append(f"  a measure is missing in too many cases: {rule}")
        lines += [f"  {key} is at the {end} of its choices" for key, end in self.at_ends().items()]
        if self.fresh.is_empty():
            lines.append("  not judged by fresh cases: the search was stopped before")
        if self.as_good.height > 1:
            spans = (f"{key} {low:.4g} … {high:.4g}" for key, (low, high) in self.tolerance.items())
            lines.append(f"  as good: {self.as_good.height - 1} more designs, {', '.join(spans)}")
        if self.front.height:
            lines.append(f"  front: {self.front.height} designs")
        end = "" if self.is_complete else "; stopped before the end"
        lines.append(f"  {self.runs} runs, {self.table.height} designs{end}")
        return "\n".join(lines)


def sentence(row: dict[str, Any]) -> str:
    """Return what a row of `fresh` says."""
    value = "missing" if row["value"] is None else f"{row['value']:.4g}"
    text = f"{row['measure']} {value}"
    if row["cases"] > 1:
        low = "−∞" if row["low"] is None else f"{row['low']:.4g}"
        high = "∞" if row["high"] is None else f"{row['high']:.4g}"
        text += f" ({low} … {high})"
    if row["bound"] is not None:
        text += f", bound {row['bound']:g} {'kept' if row['kept'] else 'NOT KEPT'}"
    if row["missing"]:
        text += f"; missing in {100 * row['missing']:.3g} % of the cases, which count as worst"
    return text


def optimum(evaluation: Evaluation, judged: Judged) -> Optimum:
    """Return the result of a search."""
    problem, best = evaluation.problem, judged.searched
    keys = list(problem.variants[best.variant].choices)
    good = judged.as_good or ([judged.fresh] if judged.fresh else [best])
    return Optimum(
        best=dict(zip(keys, best.values, strict=True)),
        best_absorber=best.variant,
        fresh=of_fresh(evaluation, judged.fresh, best),
        as_good=of_candidates(evaluation, good),
        front=of_candidates(evaluation, judged.front),
        table=of_candidates(evaluation, [one for one in evaluation.candidates if one.cases]),
        runs=evaluation.spent,
        is_complete=judged.is_complete,
        _problem=problem,
    )


def of_fresh(
    evaluation: Evaluation, fresh: Candidate | None, searched: Candidate | None
) -> pl.DataFrame:
    """Return what fresh cases say of a design, a row a goal or bounded measure."""
    import polars as pl

    problem = evaluation.problem
    bounds: list[float | None] = [None] * len(problem.goals)
    goals = [*problem.goals, *(limit.goal for limit in problem.limits)]
    bounds += [limit.bound for limit in problem.limits]
    places = {goal.column: place for place, goal in enumerate(evaluation.problem.measured)}
    rows = []
    if fresh is not None:
        numbers = evaluation.numbers(fresh)
        believed = None if searched is None else evaluation.numbers(searched)
        for index, (goal, bound) in enumerate(zip(goals, bounds, strict=True)):
            low = high = numbers[index]
            missing, cases = 0.0, 1
            if not goal.chosen:
                bad = fresh.bad[places[goal.column]]
                missing, cases = float(np.isinf(bad).mean()), bad.size
                if cases > 1:
                    low, high = problem.criterion.interval(bad)
            ends = sorted((as_shown(goal, low), as_shown(goal, high)))
            passed = bound is not None and problem.limits[index - len(problem.goals)].excess(
                numbers[index]
            )
            rows.append(
                {
                    "measure": goal.name,
                    "criterion": problem.criterion.words if cases > 1 else "value",
                    "value": finite(as_shown(goal, numbers[index])),
                    "low": finite(ends[0]),
                    "high": finite(ends[1]),
                    "bound": bound,
                    "kept": None if bound is None else not passed,
                    "missing": missing,
                    "cases": cases,
                    "searched": None
                    if believed is None
                    else finite(as_shown(goal, believed[index])),
                }
            )
    schema = {
        "measure": pl.String,
        "criterion": pl.String,
        "value": pl.Float64,
        "low": pl.Float64,
        "high": pl.Float64,
        "bound": pl.Float64,
        "kept": pl.Boolean,
        "missing": pl.Float64,
        "cases": pl.UInt32,
        "searched": pl.Float64,
    }
    return pl.DataFrame(rows, schema=schema)


def as_shown(goal: Goal, bad: float) -> float:
    """Return a badness as the value that users see."""
    return float(bad * goal.sign)


def finite(value: float) -> float | None:
    """Return a value, ``None`` for one that is not finite."""
    return float(value) if math.isfinite(value) else None


def of_candidates(evaluation: Evaluation, candidates: Sequence[Candidate]) -> pl.DataFrame:
    """Return designs as a table, a row each."""
    import polars as pl

    problem = evaluation.problem
    goals = [*problem.goals, *(limit.goal for limit in problem.limits)]
    keys = list(dict.fromkeys(key for variant in problem.variants for key in variant.choices))
    measured = list(
        dict.fromkeys(goal.name for goal in goals if not (goal.chosen and goal.name in keys))
    )
    columns: dict[str, list[Any]] = {
        name: [] for name in ("absorber", *keys, *measured, "within", "missing", "cases")
    }
    for one in candidates:
        values = dict(zip(problem.variants[one.variant].choices, one.values, strict=True))
        numbers: Numbers = evaluation.numbers(one)
        shown = {
            goal.name: finite(as_shown(goal, bad)) for goal, bad in zip(goals, numbers, strict=True)
        }
        columns["absorber"].append(one.variant)
        for key in keys:
            columns[key].append(values.get(key))
        for name in measured:
            columns[name].append(shown[name])
        columns["within"].append(evaluation.passed(numbers) == 0)
        columns["missing"].append(evaluation.missing(one))
        columns["cases"].append(one.cases)
    kinds = {"absorber": pl.UInt32, "within": pl.Boolean, "cases": pl.UInt32}
    schema = {name: kinds.get(name, pl.Float64) for name in columns}
    return pl.DataFrame(columns, schema=schema)
