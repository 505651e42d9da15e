"""Where to begin with a pendulum: points of a wide search whose first impacts fit."""

from __future__ import annotations

import numpy as np

from iva.identification.priors import Between, Prior
from iva.identification.responses import Values
from iva.parameters import Piva, Primary, Start
from iva.sampling import Sobol, Uniform
from iva.sweeping import sweep

#: Points of the search.
POINTS = 1 << 16
#: How many are returned.
FEW = 60
#: Impacts that are compared.
COMPARED = 5
#: What an instant may be off, in periods, and a jump, relative.
OFF_TIME = 0.03
OFF_JUMP = 0.2


def candidates(
    hertz: float,
    size: float,
    times: Values,
    jumps: Values,
    deviation: float,
    priors: dict[str, Prior],
    place: float,
    seed: int,
) -> Values:
    """Return frequency (Hz), mass ratio, gap, frequency ratio, restitution, best first, (n, 5).

    Parameters
    ----------
    hertz : float
        Frequency of the motion, rough.
    size : float
        Displacement at the release, with its sign.
    times, jumps : ndarray, shape (k,)
        Of the impacts that were found, from the release.
    deviation : float
        Of the jumps.
    priors : dict
        By number; what is not in it is searched widely.
    place : float
        Gap displacement at the release.
    seed : int
        Of the points.
    """
    few = min(times.size, COMPARED)
    wide = {
        "frequency_hz": Between(0.88 * hertz, 1.3 * hertz),
        "mass_ratio": Between(0.02, 0.3, by_logarithm=True),
        "gap": Between(0.2 * abs(size), 8.0 * abs(size), by_logarithm=True),
        "frequency_ratio": Between(0.1, 1.5),
        "restitution": Between(0.1, 0.95),
    }
    names = tuple(wide)
    unit = Sobol(POINTS, seed=seed)
    cubes = shares(unit, names)
    columns = {}
    for name in names:
        prior = priors.get(name, wide[name])
        low, high = prior.at(0.001), prior.at(0.999)
        grid = np.array([prior.at(share) for share in np.linspace(0.001, 0.999, 257)])
        columns[name] = np.interp(cubes[name], np.linspace(0, 1, 257), grid)
        columns[name] = np.clip(columns[name], min(low, high), max(low, high))
    table = sweep(
        Piva(angles="small"),
        Primary(damping_ratio=0.01),
        over=columns,
        sampling="zip",
        start=Start(displacement=size, gap_displacement=place),
        duration=float(times[few - 1]) + 0.3 / hertz,
        tables=["impacts"],
        threads=1,
        max_impacts=few + 3,
    )
    impacts = table.impacts
    point, which = impacts["point"].to_numpy(), impacts["impact"].to_numpy()
    which = which - which.min()
    inside = which < few
    seen_time = np.full((POINTS, few), np.nan)
    seen_jump = np.full((POINTS, few), np.nan)
    jump = (impacts["velocity_after"] - impacts["velocity_before"]).to_numpy()
    seen_time[point[inside], which[inside]] = impacts["time"].to_numpy()[inside]
    seen_jump[point[inside], which[inside]] = jump[inside]
    by_time = (seen_time - times[:few]) * hertz / OFF_TIME
    by_jump = (seen_jump - jumps[:few]) / (OFF_JUMP * np.abs(jumps[:few]) + 2 * deviation)
    each = np.minimum(by_time**2 + by_jump**2, 50.0)
    score = np.sum(np.where(np.isnan(each), 50.0, each), axis=1)
    best = np.argsort(score)[:FEW]
    return np.column_stack([columns[name][best] for name in names])


def shares(sample: Sobol, names: tuple[str, ...]) -> dict[str, Values]:
    """Return points of the unit cube, by name, shape (n,) each."""
    from iva.sampling import points

    frame = points({name: Uniform(1e-9, 1.0) for name in names}, sample)
    return {name: frame[name].to_numpy() for name in names}


__all__ = ["candidates"]
