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
#: Impacts between those that may be too small to be found.
UNSEEN = 3
#: Most that one impact counts.
MOST = 50.0
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
        max_impacts=few + UNSEEN,
    )
    impacts = table.impacts
    point, which = impacts["point"].to_numpy(), impacts["impact"].to_numpy()
    which = which - which.min()
    inside = which < few + UNSEEN
    seen_time = np.full((POINTS, few + UNSEEN), np.nan)
    seen_jump = np.full((POINTS, few + UNSEEN), np.nan)
    jump = (impacts["velocity_after"] - impacts["velocity_before"]).to_numpy()
    seen_time[point[inside], which[inside]] = impacts["time"].to_numpy()[inside]
    seen_jump[point[inside], which[inside]] = jump[inside]
    score = np.zeros(POINTS)
    # Small impacts are not found, so each that is found is compared with the one most like it.
    lonely = np.full(seen_time.shape, MOST)
    for time, jump in zip(times[:few], jumps[:few], strict=True):
        by_time = ((seen_time - time) * hertz / OFF_TIME) ** 2
        by_jump = ((seen_jump - jump) / (OFF_JUMP * abs(jump) + 2 * deviation)) ** 2
        score += np.min(np.nan_to_num(np.minimum(by_time + by_jump, MOST), nan=MOST), axis=1)
        lonely = np.fmin(lonely, by_time)
    # And none of those that should be seen may be left over before the last one.
    lonely = np.fmin(lonely, (seen_jump / (4 * deviation)) ** 2)
    score += np.sum(np.where(seen_time < times[few - 1], lonely, 0.0), axis=1)
    best = np.argsort(score)[:FEW]
    return np.column_stack([columns[name][best] for name in names])


def shares(sample: Sobol, names: tuple[str, ...]) -> dict[str, Values]:
    """Return points of the unit cube, by name, shape (n,) each."""
    from iva.sampling import points

    frame = points({name: Uniform(1e-9, 1.0) for name in names}, sample)
    return {name: frame[name].to_numpy() for name in names}


__all__ = ["candidates"]
