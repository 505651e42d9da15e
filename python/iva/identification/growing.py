"""Absorber numbers from a window that grows impact by impact."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iva.identification.responses import Values
from iva.identification.walls import Absorber, Contacts, mixed, residuals

#: Scatter of restitution and play of the walls that do not yet end the window.
LOOSE_SCATTER = 0.15
LOOSE_PLAY = 0.01
#: Rise of χ² by the two conditions of one impact that ends the window.
BROKEN = 40.0


@dataclass(frozen=True)
class Grown:
    """The best absorber, how many impacts agree with it, and χ² of their conditions."""

    absorber: Absorber
    hits: int
    misfit: float


def first(found: Contacts, hits: int) -> Contacts:
    """Return the same of the first `hits` impacts only."""
    every = found.walls.size
    blocks = found.blocks.reshape(25, every, every)[:, :hits, :hits]
    return Contacts(
        found.walls[:hits],
        found.values[:, :hits],
        np.ascontiguousarray(blocks.reshape(25, hits * hits)),
        found.slopes[:, :hits],
    )


def settled(
    found: Contacts, absorber: Absorber, pull: tuple[Values, Values], rounds: int = 12
) -> tuple[Absorber, float, Values]:
    """Return the absorber at which the conditions are met best, χ², and the information.

    Parameters
    ----------
    found : Contacts
        Of the impacts that count.
    absorber : Absorber
        Where to begin; its scatter and its play are kept.
    pull : tuple of ndarray, shape (4,)
        Mean and deviation of 1/μ, d, y₀ and e beforehand.

    Returns
    -------
    absorber : Absorber
    misfit : float
    information : ndarray, shape (4, 4)
        Of 1/μ, d, y₀ and e, from the record alone.
    """
    mean, deviation = pull
    weight = np.where(deviation > 0, 1 / np.maximum(deviation, 1e-12), 1e12) ** 2
    _, way, lost, speed, jump = found.values
    hits = found.walls.size
    information = np.zeros((4, 4))
    misfit = np.inf
    for _ in range(rounds):
        rest, covariance = residuals(found, absorber)
        slopes = np.zeros((2 * hits, 4))
        e, nu = absorber.restitution, absorber.heaviness
        slopes[:hits, 0], slopes[:hits, 1], slopes[:hits, 2] = -way, -found.walls, 1.0
        slopes[hits:, 0] = jump + (1 + e) * lost
        slopes[hits:, 3] = -(speed - nu * lost)
        solved = np.linalg.solve(covariance, np.column_stack([slopes, rest]))
        information = slopes.T @ solved[:, :4]
        misfit = float(rest @ solved[:, 4])
        now = np.array([nu, absorber.clearance, absorber.place, e])
        curvature = information + np.diag(weight)
        scale = np.sqrt(np.diag(curvature))
        downhill = slopes.T @ solved[:, 4] + weight * (now - mean)
        move = np.linalg.solve(curvature / np.outer(scale, scale), -downhill / scale) / scale
        nu, clearance, place, e = now + move
        clearance = max(clearance, 0.2 * absorber.clearance)
        nu = min(max(nu, 0.3 * absorber.heaviness), 3 * absorber.heaviness)
        absorber = replace(
            absorber,
            heaviness=nu,
            clearance=clearance,
            place=float(np.clip(place, -clearance, clearance)),
            restitution=min(max(e, 0.01), 1.0),
        )
        if np.all(np.abs(move) < 1e-7 * np.abs(now) + 1e-12):
            break
    return absorber, misfit, information


def grown(found: Contacts, start: Absorber, pull: tuple[Values, Values]) -> Grown:
    """Return the absorber from as many impacts as follow each other as those of one free mass."""
    loose = replace(start, scatter=LOOSE_SCATTER, play=LOOSE_PLAY)
    best = Grown(loose, 0, 0.0)
    for hits in range(1, found.walls.size + 1):
        part = first(found, hits)
        absorber, misfit, _ = settled(part, best.absorber if best.hits else loose, pull)
        if hits > 2 and misfit - best.misfit > BROKEN:
            break
        best = Grown(absorber, hits, misfit)
    return best


__all__ = ["Grown", "first", "grown", "mixed", "settled"]
