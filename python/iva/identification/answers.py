"""What was found, as the tables of a fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from iva.identification.fits import Fit, Found
from iva.identification.priors import Between, Exactly
from iva.identification.records import Recording
from iva.identification.responses import Values
from iva.identification.stated import Stated
from iva.parameters import Piva, Primary, Siva, Start

if TYPE_CHECKING:
    import polars as pl

#: Names of the rows, and the factor from SI units to the unit that the name ends with.
ROWS = {
    "frequency_hz": ("frequency_hz", 1.0),
    "damping_ratio": ("damping_ratio", 1.0),
    "mass_ratio": ("mass_ratio", 1.0),
    "restitution": ("restitution", 1.0),
    "gap": ("gap_mm", 1e3),
    "frequency_ratio": ("frequency_ratio", 1.0),
    "displacement": ("displacement_mm", 1e3),
    "velocity": ("velocity", 1.0),
    "impulse_velocity": ("impulse_velocity", 1.0),
    "gap_displacement": ("gap_displacement_mm", 1e3),
    "release": ("release_s", 1.0),
    "restitution_scatter": ("restitution_scatter", 1.0),
}
#: Half width of an interval of 90 % over the standard deviation.
NORMAL_90 = 1.6449
#: Width of an interval over that of the prior from which the prior is said to determine a number.
HARDLY = 0.6


def fit_of(
    found: Found,
    recording: Recording,
    facts: Stated,
    kind: Siva | Piva | None,
    clock: float,
    quantity: str,
) -> Fit:
    """Return all that was found as a Fit."""
    import polars as pl

    width = NORMAL_90 * np.hypot(found.own, found.sigma)
    frame = table(found.draws, facts)
    middle = {row["parameter"]: row["value"] for row in frame.iter_rows(named=True)}
    release = middle["release_s"]
    draws = {ROWS[name][0]: values * ROWS[name][1] for name, values in found.draws.items()}
    begin = {"time": release} if release >= 0 else {}
    return Fit(
        parameters=frame,
        impacts=impacts_table(found.each, found.walls),
        combinations=found.combinations,
        reasons=found.reasons,
        notes=found.notes,
        time=recording.time + clock,
        values=recording.values,
        prediction=found.prediction,
        low=found.prediction - width,
        high=found.prediction + width,
        mask=found.mask,
        noise=found.noise,
        draws=pl.DataFrame(draws),
        quantity=quantity,
        absorber=None if kind is None else absorber_of(kind, middle, facts),
        primary=Primary(
            frequency_hz=middle["frequency_hz"], damping_ratio=max(middle["damping_ratio"], 0.0)
        ),
        start=begun(middle, kind is not None, begin),
        duration=float(recording.time[-1] + clock - release),
        chain=found.chain,
    )


def begun(middle: dict[str, float], has_absorber: bool, begin: dict[str, float]) -> Start:
    """Return the state after the release, or after a blow, which leaves the mass at rest."""
    place = middle["gap_displacement_mm"] / 1e3 if has_absorber else None
    if "impulse_velocity" in middle:
        speed = middle["impulse_velocity"]
        return Start(velocity=speed, gap_velocity=-speed, gap_displacement=place, **begin)
    return Start(
        displacement=middle["displacement_mm"] / 1e3,
        velocity=middle.get("velocity"),
        gap_displacement=place,
        **begin,
    )


def absorber_of(kind: Siva | Piva, middle: dict[str, float], facts: Stated) -> Siva | Piva:
    """Return the absorber at the values that were found."""
    fields = {
        "mass_ratio": middle["mass_ratio"],
        "restitution": middle["restitution"],
        "gap": middle["gap_mm"] / 1e3,
    }
    if isinstance(kind, Siva):
        return Siva(**fields)
    ratio = middle["frequency_ratio"]
    inertia = facts.taken.get("inertia_ratio", 1.0)
    gravity = facts.taken.get("gravity", 9.80665)
    omega = 2 * np.pi * middle["frequency_hz"]
    return Piva(
        mass_ratio=fields["mass_ratio"],
        restitution=fields["restitution"],
        gap=fields["gap"],
        frequency_ratio=ratio,
        length=gravity / (inertia * (ratio * omega) ** 2),
        inertia_ratio=inertia,
        contact_distance=facts.taken.get("contact_distance"),
    )


def table(draws: dict[str, Values], facts: Stated) -> pl.DataFrame:
    """Return value, interval and origin of each number."""
    import polars as pl

    rows = []
    for name, values in draws.items():
        label, factor = ROWS[name]
        low, middle, high = np.quantile(values, (0.05, 0.5, 0.95)) * factor
        prior = facts.priors.get(name)
        by = "record"
        if isinstance(prior, Exactly):
            low = middle = high = prior.value * factor
            by = "given"
        else:
            expected = width_before(name, draws, facts)
            if expected is not None and high - low > HARDLY * expected * factor:
                by = "prior"
        rows.append((label, float(middle), float(low), float(high), by))
    columns = ("parameter", "value", "low", "high", "determined_by")
    return pl.DataFrame(rows, schema=columns, orient="row")


def width_before(name: str, draws: dict[str, Values], facts: Stated) -> float | None:
    """Return the width of the interval (90 %) that a number had before the record, if any."""
    prior = facts.priors.get(name)
    if prior is not None:
        return prior.at(0.95) - prior.at(0.05)
    if name == "restitution":
        return Between(0.0, 1.0).at(0.95) - Between(0.0, 1.0).at(0.05)
    if name == "gap_displacement":
        return 0.9 * float(np.median(draws["gap"]))
    if name in ("mass_ratio", "gap"):
        # Nothing was known but the order of size: a factor of two is hardly determined.
        return float(np.median(draws[name]))
    return None


def impacts_table(each: Values, walls: Values) -> pl.DataFrame:
    """Return instant, jump, approach speed and restitution of each impact, with intervals.

    Parameters
    ----------
    each : ndarray, shape (n, 4, k)
        Draws.
    walls : ndarray, shape (k,)
        +1 or −1.
    """
    import polars as pl

    low, middle, high = np.quantile(each, (0.05, 0.5, 0.95), axis=0)
    columns: dict[str, object] = {
        "impact": np.arange(1, walls.size + 1),
        "wall": walls.astype(int),
    }
    for row, name in enumerate(("time", "jump", "approach_speed", "restitution")):
        columns[name] = middle[row]
        columns[f"{name}_low"], columns[f"{name}_high"] = low[row], high[row]
    return pl.DataFrame(columns)


__all__ = ["fit_of"]
