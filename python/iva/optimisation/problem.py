"""What is asked for: a scene, what may be chosen in it, and which measures shall be how."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from iva import _iva
from iva.optimisation.choices import Choice
from iva.parameters import number, numbers, shown
from iva.spelling import no_column

if TYPE_CHECKING:
    from iva.optimisation.cases import Uncertain
    from iva.optimisation.criteria import Criterion, Numbers
    from iva.parameters import Spec

#: Measures that may be named in millimetres end so.
MILLIMETRES = "_mm"
#: Most values of what the worst is taken over.
MOST_WORST = 10_000


@dataclass(frozen=True)
class Goal:
    """A measure, or a chosen field, that shall be small or large.

    Parameters
    ----------
    name : str
        As it was given.
    column : str
        Column of the summary, or the chosen field.
    larger : bool
        Large values are good.
    scale : float
        Values as shown over values of the column: 1000 for millimetres.
    chosen : bool
        It is a chosen field.
    """

    name: str
    column: str
    larger: bool
    scale: float = 1.0
    chosen: bool = False

    @property
    def sign(self) -> float:
        """Value as shown over its badness, of which small is good."""
        return -self.scale if self.larger else self.scale


@dataclass(frozen=True)
class Limit:
    """A bound that a measure must keep: at most, or at least where large values are good."""

    goal: Goal
    bound: float

    @property
    def bad(self) -> float:
        """The largest badness that is allowed."""
        return self.bound / self.goal.sign

    def excess(self, bad: Numbers) -> Numbers:
        """Return by how much of the bound a measure passes it; 0 where it keeps it."""
        size = abs(self.bad) or 1.0
        return np.asarray(np.maximum(bad - self.bad, 0.0) / size)


@dataclass(frozen=True)
class Variant:
    """One absorber with what may be chosen of its scene."""

    label: str
    spec: Spec
    choices: Mapping[str, Choice]


@dataclass(frozen=True)
class Problem:
    """All that determines the answer.

    Parameters
    ----------
    variants : sequence of Variant
        Absorbers to choose among, one or more.
    uncertain : sequence of Uncertain
        What differs from case to case, for each variant.
    worst_over : dict
        Field → values; in every case each measure is the worst over all their combinations.
    goals : sequence of Goal
        One, or several for a front.
    limits : sequence of Limit
        Bounds.
    criterion : Criterion
        How cases become a number.
    seed : int
        Of all that is random.
    """

    variants: Sequence[Variant]
    uncertain: Sequence[Uncertain]
    worst_over: Mapping[str, Sequence[float]]
    goals: Sequence[Goal]
    limits: Sequence[Limit]
    criterion: Criterion
    seed: int

    @property
    def measured(self) -> list[Goal]:
        """The goals and bounds that are columns of the summary, each column once."""
        found: dict[str, Goal] = {}
        for goal in (*self.goals, *(limit.goal for limit in self.limits)):
            if not goal.chosen:
                found.setdefault(goal.column, goal)
        return list(found.values())

    @property
    def runs_a_case(self) -> int:
        """Runs of one design in one case."""
        return math.prod(len(values) for values in self.worst_over.values())

    @property
    def is_certain(self) -> bool:
        """There is one case only."""
        return all(one.is_empty for one in self.uncertain)


def goals_of(minimise: object, maximise: object, chosen: Sequence[str]) -> list[Goal]:
    """Return the goals.

    Raises
    ------
    TypeError
        If something is no name.
    ValueError
        If there is none, one is unknown, or its good direction is the other one.
    """
    goals = []
    for field, given, larger in (("minimise", minimise, False), ("maximise", maximise, True)):
        names = [] if given is None else [given] if isinstance(given, str) else given
        if not isinstance(names, Sequence):
            raise TypeError(f"{field} = {shown(given)}: give a measure or a list of them")
        goals += [goal_of(field, name, larger, chosen) for name in names]
    if not goals:
        raise ValueError("minimise and maximise are missing: give one, such as 'settling_time_5'")
    for index, goal in enumerate(goals):
        if goal.column in (earlier.column for earlier in goals[:index]):
            raise ValueError(f"{goal.name} is given twice; give it once")
    return goals


def goal_of(field: str, name: object, larger: bool, chosen: Sequence[str]) -> Goal:
    """Return one goal."""
    if not isinstance(name, str):
        raise TypeError(f"{field} = {shown(name)}: give the name of a measure")
    if name in chosen:
        return Goal(name, name, larger, chosen=True)
    column, scale = column_of(field, name, chosen)
    if not larger and column in _iva.larger_is_better():
        raise ValueError(f"{field} = {name!r}: the larger it is the better; give it as `maximise`")
    return Goal(name, column, larger, scale)


def limits_of(within: object) -> list[Limit]:
    """Return the bounds.

    Raises
    ------
    TypeError
        If it is no mapping of names to numbers.
    ValueError
        If a measure is unknown or a bound is not finite.
    """
    if within is None:
        return []
    if not isinstance(within, Mapping):
        raise TypeError(f"within = {shown(within)}: give a mapping of measures to bounds")
    limits = []
    for name, bound in within.items():
        if not isinstance(name, str):
            raise TypeError(f"within has the key {shown(name)}: give measures")
        column, scale = column_of("within", name, ())
        value = number(f"within[{name!r}]", bound)
        if not math.isfinite(value):
            raise ValueError(f"within[{name!r}] = {value}: give a finite number")
        limits.append(Limit(Goal(name, column, column in _iva.larger_is_better(), scale), value))
    return limits


def column_of(field: str, name: str, chosen: Sequence[str]) -> tuple[str, float]:
    """Return the column of the summary that a name means, and the scale of its values.

    Raises
    ------
    ValueError
        If there is no such column of numbers.
    """
    columns = {
        column: unit
        for column, unit in _iva.column_units("si", [])[1]["summary"].items()
        if unit and column != "point"
    }
    if name in columns:
        return name, 1.0
    bare = name.removesuffix(MILLIMETRES)
    if bare != name and columns.get(bare) == "m":
        return bare, 1000.0
    raise ValueError(f"{field} = {name!r}: {no_column(name, (*chosen, *columns))}")


def worst_over_of(given: object) -> dict[str, list[float]]:
    """Return the fields and values over which the worst is taken.

    Raises
    ------
    TypeError
        If it is no mapping of names to numbers.
    ValueError
        If a list is empty, or there are too many combinations.
    """
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise TypeError(f"worst_over = {shown(given)}: give a mapping of fields to values")
    found = {}
    for key, values in given.items():
        if not isinstance(key, str):
            raise TypeError(f"worst_over has the key {shown(key)}: give field names")
        found[key] = numbers(f"worst_over[{key!r}]", values)
        if not found[key]:
            raise ValueError(f"worst_over[{key!r}] = []: give at least one value")
    count = math.prod(len(values) for values in found.values())
    if count > MOST_WORST:
        raise ValueError(f"worst_over: {count} combinations; give at most {MOST_WORST}")
    return found
