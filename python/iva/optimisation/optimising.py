"""The function that users call."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from iva import _iva
from iva.forces import Force
from iva.optimisation.cases import uncertain_of
from iva.optimisation.choices import choices_of
from iva.optimisation.criteria import criterion_of
from iva.optimisation.evaluation import Evaluation
from iva.optimisation.folders import prepared, saved
from iva.optimisation.logbook import Logbook
from iva.optimisation.optimum import Optimum, optimum
from iva.optimisation.problem import Problem, Variant, goals_of, limits_of, worst_over_of
from iva.optimisation.stages import judged
from iva.parameters import Absorber, Primary, Start, shown
from iva.progress import Progress, reporting
from iva.sampling import Over, whole
from iva.scenes import scene
from iva.simulation import truth
from iva.spelling import spell_checked
from iva.structures import Structure

if TYPE_CHECKING:
    from iva.parameters import Spec

#: Runs that a search may spend unless told otherwise, and the range.
RUNS, LEAST_RUNS, MOST_RUNS = 60_000, 500, 1 << 32
#: Largest seed; twice it is one of the seeds of the cases.
MOST_SEED = (1 << 52) - 1


@spell_checked
def optimise(
    absorber: Absorber | Sequence[Absorber | Sequence[Absorber]] | None,
    primary: Primary | Structure,
    *,
    choose: Mapping[str, Any] | Sequence[Mapping[str, Any]],
    minimise: str | Sequence[str] | None = None,
    maximise: str | Sequence[str] | None = None,
    over: Over | None = None,
    off: Mapping[str, Any] | None = None,
    quantile: float | None = None,
    mean: bool = False,
    worst_of: int | None = None,
    cvar: float | None = None,
    within: Mapping[str, float] | None = None,
    worst_over: Mapping[str, Iterable[float]] | None = None,
    start: Start | None = None,
    force: Force | Sequence[Force] | None = None,
    periods: float | None = None,
    duration: float | None = None,
    cycles: float | None = None,
    discard: float | None = None,
    max_impacts: float | None = None,
    max_work: float | None = None,
    chatter_floor: float | None = None,
    tolerance: float | None = None,
    runs: int = RUNS,
    seed: int = 0,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
    progress: bool | Progress = False,
) -> Optimum:
    """Choose the numbers of a design so that it does well although much is not known exactly.

    Parameters
    ----------
    absorber, primary, start, force
        As in :func:`iva.simulate`. What is chosen or varies may be left out. A list of absorbers is
        one to choose among; what stands in it as a list are several on one structure.
    choose : mapping of str to bounds
        Field name, as in ``over`` of :func:`iva.sweep` → ``(low, high)`` for any number between
        two bounds, a list of at least three sizes that can be had, or
        ``{"low": …, "high": …, "step": …}``. With a list of absorbers a list of such mappings, or
        one for all.
    minimise, maximise : str or sequence of str
        A column of the summary (its name with ``_mm`` for lengths in millimetres), or a chosen
        field. Several give a front of designs that no other beats.
    over : mapping of str to distribution, or a frame of polars or pandas, optional
        What is not known exactly: field name → distribution of :mod:`iva.sampling`, or a list of
        equally likely values. Of a frame each row is an equally likely case, so that columns may
        depend on each other.
    off : mapping of str to distribution, optional
        How far what is chosen will be off: chosen field → distribution of what is added to it, or
        a percentage such as ``"5%"`` (uniform, of both signs, of the chosen value).
    quantile : float, default 0.9
        A design is judged by the value that this share of its cases stays at or below; of what is
        maximised, at or above.
    mean : bool, optional
        Instead: by the mean over its cases.
    worst_of : int, optional
        Instead: by the median of the worst among so many cases, the quantile 2^(−1/n).
    cvar : float, optional
        Instead: by the mean of the worst cases, those beyond this quantile (conditional value at
        risk).
    within : mapping of str to float, optional
        Bounds: a measure → the largest value allowed (of damping ratios and reductions the
        smallest), of the same quantile, mean or worst cases.
    worst_over : mapping of str to sequence of float, optional
        In every case each measure is the worst over all combinations of these values: a band of
        frequencies; two starts, at rest and far above, for both ends of a hysteresis.
    periods, duration, cycles, discard, max_impacts, max_work, chatter_floor, tolerance
        As in :func:`iva.simulate`.
    runs : int, default 60000
        Number of runs that may be spent.
    seed : int, default 0
        Seed of all that is random, 0 to 2⁵² − 1. The same seed gives the same bits with any number
        of threads, as long as NumPy and SciPy are the same.
    out : str or path, optional
        Folder to write the tables into, and every batch of runs as it is done.
    resume : bool, default False
        Take the runs that `out` holds from there.
    overwrite : bool, default False
        Replace what an optimisation wrote into `out`.
    threads : int, optional
        Worker threads, one a core by default.
    progress : bool or callable, default False
        As in :func:`iva.sweep`; told the runs spent, and those that may be.

    Returns
    -------
    Optimum
        ``best``, ``fresh``, ``as_good``, ``front``, ``table``, ``scene``. Ctrl-C gives the best so
        far, with ``is_complete`` false.

    Raises
    ------
    TypeError
        If an argument is of the wrong type.
    ValueError
        If a name is unknown, a value is out of range, or `out` holds something else.
    ImportError
        If SciPy is not installed.
    iva.IvaError
        If a file cannot be written.
    KeyboardInterrupt
        On Ctrl-C before any design was judged.

    Notes
    -----
    Sobol points of the box, differential evolution from the best of them, all under the same cases;
    then a race under more and more cases. What is reported comes from fresh cases that nothing was
    chosen by. A case in which a measure is null counts as worse than any value.

    Examples
    --------
    >>> found = iva.optimise(
    ...     iva.Siva(mass_ratio=0.1), iva.Primary(damping_ratio=0.01),
    ...     choose={"relative_clearance": (0.2, 1.2)},
    ...     over={"restitution": iva.sampling.Normal(0.6, 0.05)},
    ...     maximise="damping_ratio_3", start=iva.Start(displacement=1.0), periods=20, runs=5000)
    >>> 0.2 <= found.best["relative_clearance"] <= 1.2
    True
    >>> found.fresh["measure"].to_list()
    ['damping_ratio_3']
    """
    run = {
        "periods": periods,
        "duration": duration,
        "cycles": cycles,
        "discard": discard,
        "max_impacts": max_impacts,
        "max_work": max_work,
        "chatter_floor": chatter_floor,
        "tolerance": tolerance,
    }
    absorbers = list(absorber) if isinstance(absorber, Sequence) else [absorber]
    if not absorbers:
        raise ValueError("absorber = []: give at least one")
    specs = [scene(one, primary, start or Start(), force, run, several=True) for one in absorbers]
    asked = {
        "choose": choose,
        "minimise": minimise,
        "maximise": maximise,
        "over": over,
        "off": off,
        "quantile": quantile,
        "mean": mean,
        "worst_of": worst_of,
        "cvar": cvar,
        "within": within,
        "worst_over": worst_over,
        "seed": seed,
    }
    problem = problem_of(specs, asked)
    return solved(problem, runs, out, resume, overwrite, threads, progress)


def problem_of(specs: Sequence[Spec], asked: Mapping[str, Any]) -> Problem:
    """Return the problem of some scenes, one an absorber, and of what is asked about them.

    Raises
    ------
    TypeError, ValueError
        As :func:`optimise`.
    """
    given = asked["choose"]
    if isinstance(given, Sequence) and not isinstance(given, str):
        if len(given) != len(specs):
            raise ValueError(
                f"choose has {len(given)} mappings for {len(specs)} absorbers: give one for each"
            )
        chosen = [choices_of(one) for one in given]
    else:
        chosen = [choices_of(given)] * len(specs)
    variants = [
        Variant(f"{spec.get('absorber.kind', 'siva')} {number}", spec, choices)
        for number, (spec, choices) in enumerate(zip(specs, chosen, strict=True))
    ]
    whole("seed", asked["seed"], 0, MOST_SEED)
    everywhere = [key for key in chosen[0] if all(key in choices for choices in chosen)]
    off = asked["off"]
    if isinstance(off, Mapping) and len(chosen) > 1:
        of_each = [{key: by for key, by in off.items() if key in choices} for choices in chosen]
        strange = [key for key in off if not any(key in one for one in chosen)]
        of_each[0] |= {key: off[key] for key in strange}
    else:
        of_each = [off] * len(chosen)
    return Problem(
        variants=variants,
        uncertain=[
            uncertain_of(asked["over"], one, choices)
            for one, choices in zip(of_each, chosen, strict=True)
        ],
        worst_over=worst_over_of(asked["worst_over"]),
        goals=goals_of(asked["minimise"], asked["maximise"], everywhere),
        limits=limits_of(asked["within"]),
        criterion=criterion_of(asked["quantile"], asked["mean"], asked["worst_of"], asked["cvar"]),
        seed=asked["seed"],
    )


def solved(
    problem: Problem,
    runs: int,
    out: str | os.PathLike[str] | None,
    resume: bool,
    overwrite: bool,
    threads: int | None,
    progress: bool | Progress,
) -> Optimum:
    """Return the optimum of a problem, and write it where that is asked for."""
    try:
        import scipy as _scipy  # noqa: F401 (only whether it is there)
    except ModuleNotFoundError as missing:
        raise ImportError(
            "iva.optimise needs SciPy: pip install 'iva-dynamics[optimise]'"
        ) from missing
    whole("runs", runs, LEAST_RUNS, MOST_RUNS)
    for name, value in (("resume", resume), ("overwrite", overwrite)):
        if truth(name, value) and out is None:
            raise ValueError(f"{name} = True: it is about a folder; give out")
    mark = digest_of(problem, runs)
    folder = None if out is None else prepared(Path(out), mark, resume, overwrite)
    with reporting(progress) as report:
        evaluation = Evaluation(problem, runs, Logbook(folder, mark), threads, report)
        found = optimum(evaluation, judged(evaluation))
    if folder is not None:
        saved(folder, found)
    return found


def digest_of(problem: Problem, runs: int) -> str:
    """Return a digest of all that determines the answer."""

    def plain(value: object) -> object:
        if isinstance(value, _iva.Record):
            return value.__reduce__()[1]
        if hasattr(value, "tolist"):
            return value.tolist()
        return shown(value)

    told = [
        _iva.VERSION,
        runs,
        problem.seed,
        problem.criterion.words,
        problem.worst_over,
        [repr(goal) for goal in problem.goals],
        [repr(limit) for limit in problem.limits],
        [
            [one.spec, [[key, repr(by)] for key, by in one.choices.items()]]
            for one in problem.variants
        ],
        [[one.variables, one.lists, one.offsets] for one in problem.uncertain],
    ]
    return hashlib.sha256(json.dumps(told, default=plain).encode()).hexdigest()
