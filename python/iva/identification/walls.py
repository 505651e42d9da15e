"""What the impacts say of a free mass in a gap.

Between impacts the mass flies straight, and each impact takes −Δv/μ from its velocity. So at the
k-th impact, with s = ±1 the wall,

    y₀ + x₀ + (v₀ + w₀)τ_k − x(t_k) − (1/μ) Σ_{j<k} Δv_j (t_k − t_j) = s_k d ,
    Δv_k (1 + 1/μ) = (1 + e_k) w_k ,   w_k = v₀ + w₀ − (1/μ) Σ_{j<k} Δv_j − ẋ(t_k⁻) ,

τ from the release. For given numbers of the record both are linear in d, 1/μ, y₀ and in 1 + e.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from iva.identification.records import HEAD, OMEGA, RELEASE, SIZE, ZETA, Inputs
from iva.identification.responses import Values


@dataclass(frozen=True)
class Contacts:
    """What the wall conditions need of the record, to first order, for the first k impacts.

    Parameters
    ----------
    walls : ndarray, shape (k,)
        +1 or −1.
    values : ndarray, shape (5, k)
        x₀ + v τ − x(t_k), Σ Δv_j (t_k − t_j), Σ Δv_j before, v − ẋ(t_k⁻), Δv_k, with v the start
        velocity of the absorber.
    blocks : ndarray, shape (25, k²)
        Their covariance, block by block.
    slopes : ndarray, shape (5, k, p)
        Their derivatives by the numbers of the record that matter.
    """

    walls: Values
    values: Values
    blocks: Values
    slopes: Values


def kinematics(numbers: Values, hits: int, gap_velocity: float, blow: bool = False) -> Values:
    """Return the values of :class:`Contacts`, shape (5, k), from head, instants and jumps.

    Parameters
    ----------
    numbers : ndarray, shape (..., 5 + 2 k)
        The beginning of the vector of :class:`Inputs`.
    hits : int
        Number of impacts k.
    gap_velocity : float
        Velocity of the absorber at the release, of which the structure has none.
    blow : bool
        Whether a blow has given the structure a velocity, and the mass none.
    """
    omega, zeta = numbers[..., OMEGA], numbers[..., ZETA]
    release, size = numbers[..., RELEASE], numbers[..., SIZE]
    times = numbers[..., HEAD : HEAD + hits]
    jumps = numbers[..., HEAD + hits : HEAD + 2 * hits]
    own = omega * np.sqrt(1 - zeta**2)
    decay, own = (zeta * omega)[..., None], own[..., None]

    def displacement(since: Values) -> Values:
        return np.exp(-decay * since) * np.sin(own * since) / own

    def velocity(since: Values) -> Values:
        wave = np.cos(own * since) - decay / own * np.sin(own * since)
        made: Values = np.exp(-decay * since) * wave
        return made

    since = times - release[..., None]
    if blow:
        begin = np.zeros_like(size)
        x, v = size[..., None] * displacement(since), size[..., None] * velocity(since)
    else:
        begin = size
        x = size[..., None] * (velocity(since) + 2 * decay * displacement(since))
        v = -(size * omega**2)[..., None] * displacement(since)
    way, lost = np.zeros_like(times), np.zeros_like(times)
    for later in range(1, hits):
        ago = times[..., later : later + 1] - times[..., :later]
        x[..., later] += np.sum(jumps[..., :later] * displacement(ago), axis=-1)
        v[..., later] += np.sum(jumps[..., :later] * velocity(ago), axis=-1)
        way[..., later] = np.sum(jumps[..., :later] * ago, axis=-1)
        lost[..., later] = np.sum(jumps[..., :later], axis=-1)
    place = begin[..., None] + gap_velocity * since - x
    return np.stack([place, way, lost, gap_velocity - v, jumps], axis=-2)


def contacts(
    inputs: Inputs,
    covariance: Values,
    hits: int,
    gap_velocity: float = 0.0,
    about: Values | None = None,
) -> Contacts:
    """Return what the first `hits` impacts say, to first order about the numbers of the record.

    Parameters
    ----------
    inputs : Inputs
        The numbers as the record has them.
    covariance : ndarray, shape (p, p)
        Of all of them.
    hits : int
        Number of impacts k.
    gap_velocity : float
        Velocity of the absorber at the release.
    about : ndarray, shape (p,), optional
        The numbers about which the conditions are linearised; by default those of the record.
    """
    keep = kept(inputs.times.size, hits)
    measured = inputs.vector()[keep]
    numbers = measured if about is None else about[keep]
    spread = covariance[np.ix_(keep, keep)]
    scale = np.maximum(np.abs(numbers) * 1e-6, 1e-9)
    scale[HEAD : HEAD + hits] = 1e-7
    blow = inputs.blow
    ahead = kinematics(numbers + np.diag(scale), hits, gap_velocity, blow)
    back = kinematics(numbers - np.diag(scale), hits, gap_velocity, blow)
    slopes = ((ahead - back) / (2 * scale[:, None, None])).reshape(numbers.size, -1).T
    values = kinematics(numbers, hits, gap_velocity, blow)
    values = values + (slopes @ (measured - numbers)).reshape(5, hits)
    blocks = (slopes @ spread @ slopes.T).reshape(5, hits, 5, hits).transpose(0, 2, 1, 3)
    return Contacts(
        np.sign(inputs.jumps[:hits]),
        values,
        np.ascontiguousarray(blocks.reshape(25, hits * hits)),
        slopes.reshape(5, hits, -1),
    )


def kept(every: int, hits: int) -> np.ndarray:
    """Return the places of head, instants and jumps of the first `hits` of all impacts."""
    first = np.arange(HEAD)
    times = HEAD + np.arange(hits)
    return np.concatenate([first, times, HEAD + every + np.arange(hits)])


@dataclass(frozen=True)
class Absorber:
    """Numbers of the absorber: 1/μ, d, y₀, e, scatter of e (relative), play of the walls (of d)."""

    heaviness: float
    clearance: float
    place: float
    restitution: float
    scatter: float
    play: float


def residuals(found: Contacts, absorber: Absorber) -> tuple[Values, Values]:
    """Return how far the conditions are from met, shape (2 k,), and their covariance.

    The first k are those of the walls, in m, the others those of the rebounds, in m/s.
    """
    at, way, lost, speed, jump = found.values
    nu, e = absorber.heaviness, absorber.restitution
    hits = at.size
    walls = at + absorber.place - nu * way - found.walls * absorber.clearance
    approach = speed - nu * lost
    rebounds = jump * (1 + nu) - (1 + e) * approach
    wall, rebound = mixed(nu, e)
    pairs = np.stack(
        [np.outer(wall, wall), np.outer(wall, rebound), np.outer(rebound, rebound)]
    ).reshape(3, 25)
    same, cross, other = (pairs @ found.blocks).reshape(3, hits, hits)
    covariance = np.empty((2 * hits, 2 * hits))
    covariance[:hits, :hits], covariance[hits:, hits:] = same, other
    covariance[:hits, hits:], covariance[hits:, :hits] = cross, cross.T
    extra = np.empty(2 * hits)
    extra[:hits] = (absorber.play * absorber.clearance) ** 2
    extra[hits:] = (absorber.scatter * e * approach) ** 2
    covariance.flat[:: 2 * hits + 1] += extra + 1e-24
    return np.concatenate([walls, rebounds]), covariance


def mixed(nu: float, e: float) -> tuple[Values, Values]:
    """Return how wall and rebound conditions are put together from the five values, (5,) each."""
    wall = np.array([1.0, -nu, 0.0, 0.0, 0.0])
    rebound = np.array([0.0, 0.0, (1 + e) * nu, -(1 + e), 1 + nu])
    return wall, rebound


def log_likelihood(found: Contacts, absorber: Absorber) -> float:
    """Return the logarithm of the density of the record, but for a constant.

    The motion maps the numbers of the absorber and the restitution of each impact to instants and
    jumps. So the density has the determinant of the conditions by instants and jumps as a factor,
    (1 + 1/μ) |w_k| for each impact.
    """
    rest, covariance = residuals(found, absorber)
    try:
        root = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        return -np.inf
    white = solve_triangular(root, rest, lower=True, check_finite=False)
    _, _, lost, speed, _ = found.values
    approach = speed - absorber.heaviness * lost
    volume = found.walls.size * np.log1p(absorber.heaviness) + np.sum(
        np.log(np.abs(approach) + 1e-12)
    )
    return float(volume - 0.5 * white @ white - np.sum(np.log(np.diag(root))))
