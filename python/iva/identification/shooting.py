"""Least squares of a record through the motion of a pendulum, in a window that grows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from iva.identification.responses import Values
from iva.identification.swings import HEAD, LOGARITHMS, Rig, Swing, swing

#: Makes a motion from numbers, resumed from another one where it may be.
Flown = Callable[[Values, "tuple[Swing, int] | None"], Swing]
#: Steps of the differences that stand for derivatives.
STEPS = np.array([1e-6, 1e-5, 1e-5, 1e-5, 1e-6, 1e-5, 1e-6, 1e-6])
STEP_OF_RESTITUTION = 1e-4
#: Scatter of restitution while the window grows, relative.
LOOSE = 0.1
#: χ² a sample above which a window does not fit.
UNFIT = 2.5
#: Deviations of chance by which χ² of what a window has gained is more than noise.
CHANCE = 2.0


@dataclass(frozen=True)
class Shot:
    """Where a record and a motion agree best.

    Attributes
    ----------
    numbers : ndarray, shape (8,)
    restitutions : ndarray, shape (k,)
    motion : Swing
    misfit : float
        χ² a sample.
    slopes : ndarray, shape (n, 8 + k)
        Derivatives of the record by all numbers.
    by_impact : ndarray, shape (3, k, 8 + k)
        Derivatives of instant, jump and approach velocity of the impacts.
    until : float
        End of the window from the first sample in s.
    """

    numbers: Values
    restitutions: Values
    motion: Swing
    misfit: float
    slopes: Values
    by_impact: Values
    until: float


@dataclass(frozen=True)
class Target:
    """The record, its noise, and what is known of the numbers: mean and deviation (8,)."""

    time: Values
    values: Values
    order: int
    noise: float
    mean: Values
    deviation: Values
    rig: Rig


def shot(
    target: Target,
    numbers: Values,
    restitutions: Values,
    until: float,
    steps: int = 8,
    scatter: float = LOOSE,
) -> Shot:
    """Return the best agreement up to an instant, by damped Gauss–Newton steps.

    Parameters
    ----------
    target : Target
        What is to be met.
    numbers : ndarray, shape (8,)
        Where to begin.
    restitutions : ndarray, shape (k,)
        The same of the impacts up to the instant.
    until : float
        End of the window from the first sample, in s.
    steps : int
        Most steps.
    scatter : float
        Of restitution about its mean, relative.

    Raises
    ------
    ValueError
        If no step leads anywhere but to numbers of no scene.
    """
    use = int(np.searchsorted(target.time, until, side="right"))
    time, values = target.time[:use], target.values[:use]
    free = target.deviation > 0
    weight = np.where(
        np.isfinite(target.deviation) & free, 1 / np.maximum(target.deviation, 1e-300), 0
    )
    hits = restitutions.size
    every = np.concatenate([free, np.ones(hits, bool)])

    def pulls(at: Values) -> tuple[Values, Values]:
        e = at[HEAD:]
        middle = float(np.mean(e)) if hits else 0.5
        rest = [weight * (at[:HEAD] - target.mean), (e - middle) / (scatter * middle)]
        slopes = np.zeros((HEAD + hits, HEAD + hits))
        slopes[:HEAD, :HEAD] = np.diag(weight)
        slopes[HEAD:, HEAD:] = (np.eye(hits) - 1 / max(hits, 1)) / (scatter * middle)
        return np.concatenate(rest), slopes

    def flown(at: Values, resumed: tuple[Swing, int] | None = None) -> Swing:
        return swing(time, target.order, at[:HEAD], at[HEAD:], target.rig, until, resumed)

    def cost_of(motion: Swing, at: Values) -> float:
        rest = (values - motion.values) / target.noise
        pull, _ = pulls(at)
        return float(rest @ rest + pull @ pull)

    at = np.concatenate([numbers, restitutions])
    motion = flown(at)
    cost = cost_of(motion, at)
    damping = 1e-3
    raw, by_impact = np.zeros((use, at.size)), np.zeros((3, hits, at.size))
    for _ in range(steps):
        raw, by_impact = derivatives(at, motion, flown, every)
        slopes = raw / target.noise
        rest = (values - motion.values) / target.noise
        pull, pull_slopes = pulls(at)
        information = slopes.T @ slopes
        curvature = (information + pull_slopes.T @ pull_slopes)[np.ix_(every, every)]
        downhill = (slopes.T @ rest - pull_slopes.T @ pull)[every]
        scale = np.sqrt(np.maximum(np.diag(curvature), 1e-300))
        better = False
        for _ in range(6):
            lifted = curvature / np.outer(scale, scale) + damping * np.eye(scale.size)
            move = np.linalg.solve(lifted, downhill / scale) / scale
            trial = at.copy()
            trial[every] += move
            trial[:HEAD] = np.clip(trial[:HEAD], at[:HEAD] - 0.3, at[:HEAD] + 0.3)
            trial[LOGARITHMS] = max(trial[LOGARITHMS], 0.0)
            trial[HEAD:] = np.clip(trial[HEAD:], 0.02, 0.99)
            try:
                new = flown(trial)
            except ValueError:
                damping = max(10 * damping, 1e-3)
                continue
            new_cost = cost_of(new, trial)
            if new_cost < cost:
                better = True
                break
            damping = max(10 * damping, 1e-3)
        if not better:
            break
        gain = cost - new_cost
        at, motion, cost = trial, new, new_cost
        damping = max(damping / 10, 1e-9)
        if gain < 0.01 + 1e-5 * cost:
            break
    rest = (values - motion.values) / target.noise
    misfit = float(rest @ rest) / use
    return Shot(at[:HEAD], at[HEAD:], motion, misfit, raw, by_impact, until)


def derivatives(
    at: Values, motion: Swing, flown: Flown, every: NDArray[np.bool_]
) -> tuple[Values, Values]:
    """Return the derivatives by all numbers, of the record (n, p) and of its impacts (3, k, p).

    Parameters
    ----------
    at : ndarray, shape (p,)
        Numbers and restitutions.
    motion : Swing
        Their motion.
    flown : callable
        The motion of other numbers, resumed from this one where it may be.
    every : ndarray of bool, shape (p,)
        Which numbers are free.
    """
    made = np.zeros((motion.values.size, at.size))
    hits = at.size - HEAD
    by_impact = np.zeros((3, hits, at.size))
    for index in np.flatnonzero(every):
        if index == HEAD - 1:
            made[:, index] = 1.0
            continue
        other = at.copy()
        hit = int(index) - HEAD
        step = STEPS[index] if hit < 0 else STEP_OF_RESTITUTION
        other[index] += step
        if hit >= len(motion.times):
            continue  # this impact lies beyond the window
        moved = flown(other, (motion, hit) if hit >= 0 else None)
        made[:, index] = (moved.values - motion.values) / step
        few = min(hits, len(motion.times), len(moved.times))
        for row, (new, old) in enumerate(zip(told(moved), told(motion), strict=True)):
            change = np.array(new[:few]) - np.array(old[:few])
            by_impact[row, :few, index] = change / step
    return made, by_impact


def told(motion: Swing) -> tuple[list[float], list[float], list[float]]:
    """Return instants, jumps and approach velocities of the impacts."""
    return motion.times, motion.jumps, motion.approaches


def grown(target: Target, begun: Shot, steps: int) -> Shot:
    """Return the agreement after the window has grown as far as it fits.

    Parameters
    ----------
    target : Target
        What is to be met.
    begun : Shot
        The agreement in the first window.
    steps : int
        Most steps in each window.
    """
    end = float(target.time[-1])
    best, growth, failed = begun, 3, 0
    hits = begun.restitutions.size
    while True:
        # The impacts that come next say where the window ends.
        ahead = swing(target.time[:1], 0, best.numbers, best.restitutions, target.rig, end)
        last = len(ahead.times) <= hits
        until = end if last else max(ahead.times[hits] - 1e-3, best.until)
        mean = float(np.mean(best.restitutions))
        more = max(min(hits, len(ahead.times)) - best.restitutions.size, 0)
        begin = np.concatenate([best.restitutions, np.full(more, mean)])
        made = shot(target, best.numbers, begin, until, steps if growth > 1 else 4 * steps)
        if made.misfit > UNFIT and growth == 1:
            return best
        if growth > 1 and (made.misfit > UNFIT or worse(best, made)):
            # By single impacts, and with patience, over what is hard.
            growth, failed = 1, hits
            hits = best.restitutions.size + (begun is not best)
            continue
        best = made
        if last:
            return made
        growth = 1 if hits < failed else 3
        hits += 1 if growth == 1 else max(1, hits // 3)


def worse(best: Shot, made: Shot) -> bool:
    """Return whether a larger window fits worse than the one that it has grown from.

    A motion that passes over a small impact makes up for it by what follows, and fits not badly.
    The noise is that of the smaller window, so that a rough estimate of it does not matter.
    """
    before, use = best.motion.values.size, made.motion.values.size
    fresh, sure = use - before, before - best.numbers.size - best.restitutions.size
    if fresh < 1 or sure < 1:
        return False
    level = best.misfit * before / sure
    gained = (made.misfit * use - best.misfit * before) / fresh
    return gained > level * (1 + CHANCE * float(np.sqrt(2 / fresh + 2 / sure)))


__all__ = ["Shot", "Target", "grown", "shot", "worse"]
