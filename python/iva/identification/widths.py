"""Derivatives of a pendulum's record over the width of what is possible, not at one point.

A sample beside an impact lies before it for some of the numbers that are possible, and after it for
others: its derivatives at one point are those of one side, and may be off by all that the impact
changes. Half the difference of two motions one deviation to either side has both.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iva.identification.around import Gauss
from iva.identification.responses import Values
from iva.identification.shooting import Shot, Target, told
from iva.identification.swings import HEAD, Swing, swing

#: Most that a number or its logarithm is moved, where the record tells little of it.
FAR = 0.3


def over_widths(
    target: Target, made: Shot, gauss: Gauss, restitution: float, scatter: float
) -> Shot:
    """Return the mean of what is possible, with derivatives over its width.

    Parameters
    ----------
    target : Target
        What is met.
    made : Shot
        The best agreement.
    gauss : Gauss
        The record about it.
    restitution, scatter : float
        Mean restitution of the impacts, and its scatter.
    """
    mean, covariance = gauss.covariance(restitution, scatter)
    mean = bounded(np.clip(mean, gauss.at - FAR, gauss.at + FAR))
    free = np.flatnonzero(gauss.free)
    deviation = np.sqrt(np.diag(covariance)[free])
    variances, turned = np.linalg.eigh(
        covariance[np.ix_(free, free)] / np.outer(deviation, deviation)
    )
    lengths = np.sqrt(np.maximum(variances, 1e-24))
    ways = deviation[:, None] * turned * lengths  # a deviation along each axis of the ellipsoid
    parts = np.minimum(1.0, FAR / np.max(np.abs(ways), axis=0))

    def flown(at: Values) -> Swing:
        use = made.motion.values.size
        return swing(target.time[:use], target.order, at[:HEAD], at[HEAD:], target.rig, made.until)

    motion = flown(mean)
    slopes = np.zeros((motion.values.size, free.size))
    changes, few = [], min(made.restitutions.size, len(motion.times))
    for way, part in enumerate(parts):
        move = np.zeros(mean.size)
        move[free] = part * ways[:, way]
        ahead, behind = flown(bounded(mean + move)), flown(bounded(mean - move))
        slopes[:, way] = (ahead.values - behind.values) / (2 * part)
        few = min(few, len(ahead.times), len(behind.times))
        changes.append(
            (np.array(told(ahead))[:, :few] - np.array(told(behind))[:, :few]) / (2 * part)
        )
    back = (turned / lengths).T / deviation  # from numbers to parts of those axes
    whole = np.zeros((motion.values.size, mean.size))
    whole[:, free] = slopes @ back
    by_impact = made.by_impact.copy()
    by_impact[:, :few, free] = np.stack([change[:, :few] for change in changes], axis=-1) @ back
    return replace(
        made,
        numbers=mean[:HEAD],
        restitutions=mean[HEAD:],
        motion=motion,
        slopes=whole,
        by_impact=by_impact,
    )


def bounded(at: Values) -> Values:
    """Return the same numbers with restitutions that a scene may have."""
    return np.concatenate([at[:HEAD], np.clip(at[HEAD:], 0.02, 0.99)])


__all__ = ["over_widths"]
