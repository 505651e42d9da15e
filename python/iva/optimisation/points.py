"""The points to run: designs in cases, and which of them can be run."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from iva import _iva

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from iva.optimisation.cases import Draw
    from iva.optimisation.criteria import Numbers
    from iva.optimisation.problem import Problem
    from iva.parameters import Spec

    #: A column a field: its name, and its value at each point.
    Rows = Sequence[tuple[str, Numbers]]

#: Cases that are looked at before any is run.
CHECKED = 256


def rows_of(
    problem: Problem,
    variant: int,
    values: Numbers,
    cases: dict[str, Numbers],
    shape: tuple[int, int, int],
) -> list[tuple[str, Numbers]]:
    """Return the points to run: designs, the cases of each, what the worst is taken over in each.

    Parameters
    ----------
    problem : Problem
        What is asked.
    variant : int
        Number of the variant.
    values : numpy.ndarray, shape (k, number of chosen fields)
        The designs.
    cases : dict
        The variables of n cases by name, shape (n,).
    shape : tuple of int
        k, n, and the number of runs of a design in a case.

    Returns
    -------
    list of (str, numpy.ndarray)
        A column a field.
    """
    uncertain = problem.uncertain[variant]
    columns: list[tuple[str, Numbers]] = []
    for index, key in enumerate(problem.variants[variant].choices):
        of_key = uncertain.offset(key, values[:, index], cases)
        columns.append((key, np.broadcast_to(of_key[:, :, None], shape).ravel()))
    for key, of_cases in uncertain.values(cases).items():
        columns.append((key, np.broadcast_to(of_cases[None, :, None], shape).ravel()))
    worst = problem.worst_over
    for key, axis in zip(worst, np.meshgrid(*worst.values(), indexing="ij"), strict=True):
        columns.append((key, np.broadcast_to(axis.ravel(), shape).ravel()))
    return columns


def study_of(spec: Spec, rows: Rows, names: Sequence[str]) -> _iva.Study:
    """Return the study of some points.

    Raises
    ------
    ValueError
        If a field is unknown or a value out of range, in the words of :func:`iva.optimise`.
    """
    listed = [(key, values.tolist()) for key, values in rows]
    try:
        return _iva.Study(spec, ("rows", listed, 0), ["summary"], names)
    except ValueError as wrong:
        text = re.sub(r"^sweep\.(\S+)\[\d+\] =", r"\1 =", str(wrong))
        text = re.sub(r"^sweep\.(\S+) = \d+ values", r"\1", text).replace("sweep key = ", "")
        raise ValueError(text.replace("sweep.", "")) from None


def in_range(rows: Rows) -> NDArray[np.bool_]:
    """Return which points have all fields in their ranges.

    Raises
    ------
    ValueError
        If a field is unknown.
    """
    each = [np.array(_iva.in_range(key, values.tolist())) for key, values in rows]
    return np.asarray(np.all(each, axis=0))


def some_of(rows: Rows, which: NDArray[np.bool_]) -> list[tuple[str, Numbers]]:
    """Return some of the points."""
    return [(key, values[which]) for key, values in rows]


def faults(spec: Spec, rows: Rows) -> list[str | None]:
    """Return for each point what its fields, each in its range, are together no scene for.

    A start outside of the gap is such a fault. ``None`` is a scene that can be run.
    """
    study = study_of(spec, rows, [])
    return [fault(study.scene(point)) for point in range(study.points)]


def fault(scene: Spec) -> str | None:
    """Return why a scene cannot be run; ``None`` if it can."""
    try:
        _iva.design(scene)
    except ValueError as wrong:
        return str(wrong)
    return None


def check(problem: Problem, draws: Sequence[Draw]) -> None:
    """Check what may be chosen before anything is run.

    Raises
    ------
    ValueError
        If a field is out of range at an end where all else has its median, half the cases of the
        middle of the box or more are out of range, or half the cases or more cannot be run in the
        middle and at both ends.
    """
    for variant, uncertain in enumerate(problem.uncertain):
        spec, choices = problem.variants[variant].spec, problem.variants[variant].choices
        values = {key: np.array([one.low, one.high]) for key, one in choices.items()}
        values |= {key: np.full(2, middle) for key, middle in uncertain.medians.items()}
        values |= {key: np.full(2, axis[0]) for key, axis in problem.worst_over.items()}
        study_of(spec, list(values.items()), [goal.column for goal in problem.measured])
        cases = draws[variant].cases(0, CHECKED)
        for key, choice in choices.items():
            middle = np.array([(choice.low + choice.high) / 2])
            values[key] = uncertain.offset(key, middle, cases)[0]
        values |= uncertain.values(cases)
        for key, of_cases in values.items():
            good = in_range([(key, of_cases)])
            if good.mean() <= 0.5:
                wrong = of_cases[~good][0]
                study_of(spec, [(key, np.array([wrong]))], [])
        check_scenes(problem, variant, draws[variant])


def check_scenes(problem: Problem, variant: int, draw: Draw) -> None:
    """Check that the middle of the box, or an end of it, can be run in most cases.

    Raises
    ------
    ValueError
        If half the cases or more of all three cannot be run: what is wrong in the first of them.
    """
    spec, choices = problem.variants[variant].spec, problem.variants[variant].choices
    count = 1 if problem.uncertain[variant].is_empty else max(CHECKED // problem.runs_a_case, 1)
    first: str | None = None
    for share in (0.5, 0.0, 1.0):
        design = np.array([[one.low + share * (one.high - one.low) for one in choices.values()]])
        shape = (1, count, problem.runs_a_case)
        rows = rows_of(problem, variant, design, draw.cases(0, count), shape)
        good = in_range(rows)
        found = faults(spec, some_of(rows, good)) if good.any() else []
        good[good] = [one is None for one in found]
        if good.reshape(count, -1).all(axis=1).mean() > 0.5:
            return
        first = first or next((one for one in found if one is not None), None)
    if first is not None:
        raise ValueError(first)
