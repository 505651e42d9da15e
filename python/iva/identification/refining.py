"""Least squares of a record with impacts as inputs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iva.identification.records import CORNER, HEAD, OMEGA, RELEASE, SIZE, ZETA, Inputs, Recording
from iva.identification.responses import Values

#: Fall of χ² by a step after which no further one is taken.
SETTLED = 0.01


@dataclass(frozen=True)
class Known:
    """What is known of the numbers of a record before it is looked at.

    ``mean`` and ``deviation`` (p,): a deviation of 0 fixes a number, infinity leaves it free.
    """

    mean: Values
    deviation: Values


@dataclass(frozen=True)
class Refined:
    """Numbers at the best agreement and their covariance (p, p); fixed ones have rows of 0."""

    inputs: Inputs
    covariance: Values
    cost: float


def refine(recording: Recording, inputs: Inputs, known: Known, steps: int = 30) -> Refined:
    """Return the numbers at which a record is explained best, by damped Gauss–Newton steps.

    Parameters
    ----------
    recording : Recording
        Its weights are 1/σ of each sample, 0 where it is masked.
    inputs : Inputs
        Where to begin.
    known : Known
        Of the same number of numbers.
    """
    numbers = inputs.vector()
    free = known.deviation > 0
    numbers[~free] = known.mean[~free]
    pull = np.where(np.isfinite(known.deviation) & free, 1 / np.maximum(known.deviation, 1e-300), 0)
    use = np.flatnonzero(recording.weights > 0)
    weights = recording.weights[use]

    def misfit(at: Values) -> tuple[float, Values]:
        rest = (recording.values - recording.model(inputs.with_vector(at)))[use] * weights
        return float(rest @ rest + np.sum((pull * (at - known.mean)) ** 2)), rest

    cost, rest = misfit(numbers)
    damping = 1e-6
    curvature = np.eye(numbers.size)
    for _ in range(steps):
        slopes = recording.jacobian(inputs.with_vector(numbers))[use] * weights[:, None]
        slopes = slopes[:, free]
        curvature = slopes.T @ slopes + np.diag(pull[free] ** 2)
        scale = np.sqrt(np.maximum(np.diag(curvature), 1e-300))
        downhill = slopes.T @ rest - (pull**2 * (numbers - known.mean))[free]
        better = False
        for _ in range(8):
            lifted = curvature / np.outer(scale, scale) + damping * np.eye(scale.size)
            move = np.linalg.solve(lifted, downhill / scale) / scale
            trial = numbers.copy()
            trial[free] += move
            bounded(trial, inputs)
            new_cost, new_rest = misfit(trial)
            if np.isfinite(new_cost) and new_cost <= cost:
                better = True
                break
            damping = max(damping * 10, 1e-4)
        if not better:
            break
        gain = cost - new_cost
        numbers, cost, rest = trial, new_cost, new_rest
        damping = max(damping / 10, 1e-12)
        if gain < SETTLED:
            break
    inverse = np.linalg.pinv(curvature / np.outer(scale, scale), hermitian=True, rcond=1e-14)
    covariance = np.zeros((numbers.size, numbers.size))
    covariance[np.ix_(free, free)] = inverse / np.outer(scale, scale)
    return Refined(inputs.with_vector(numbers), covariance, cost)


def bounded(numbers: Values, inputs: Inputs) -> None:
    """Bring numbers that no structure has back to where one may have them."""
    numbers[ZETA] = min(max(numbers[ZETA], -0.5), 0.9)
    numbers[CORNER] = max(numbers[CORNER], -3.0)
    numbers[OMEGA] = max(numbers[OMEGA], 1e-3)
    place = HEAD + 2 * inputs.times.size + inputs.trend.size + inputs.hum.size
    for _ in inputs.modes:
        numbers[place + 3] = min(max(numbers[place + 3], 1e-4), 0.5)
        place += 4


__all__ = ["CORNER", "HEAD", "OMEGA", "RELEASE", "SIZE", "ZETA", "Known", "Refined", "refine"]
