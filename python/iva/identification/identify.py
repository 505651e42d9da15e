"""Parameters of an absorber from a measured decay."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

import numpy as np

from iva.identification.explaining import MAINS
from iva.identification import free_mass, pendulum
from iva.identification.fits import Fit, Found
from iva.identification.posterior import sampler
from iva.identification.priors import Between, Exactly
from iva.identification.records import Recording
from iva.identification.responses import ORDERS, Values
from iva.identification.stated import Stated, stated
from iva.parameters import Piva, Primary, Siva, Start, shown
from iva.sampling import Distribution, whole
from iva.spelling import spell_checked

if TYPE_CHECKING:
    import polars as pl

#: Least number of samples, and of periods, of a record that is looked at.
LEAST = 200
#: Names of the rows, and the factor from SI units to the unit that the name ends with.
ROWS = {
    "frequency_hz": ("frequency_hz", 1.0),
    "damping_ratio": ("damping_ratio", 1.0),
    "mass_ratio": ("mass_ratio", 1.0),
    "restitution": ("restitution", 1.0),
    "gap": ("gap_mm", 1e3),
    "frequency_ratio": ("frequency_ratio", 1.0),
    "displacement": ("displacement_mm", 1e3),
    "gap_displacement": ("gap_displacement_mm", 1e3),
    "release": ("release_s", 1.0),
    "restitution_scatter": ("restitution_scatter", 1.0),
}
#: Half width of an interval of 90 % over the standard deviation.
NORMAL_90 = 1.6449
#: Width of an interval over that of the prior from which the prior is said to determine a number.
HARDLY = 0.6


class Record(Protocol):
    """What is needed of a record; :class:`iva.Measured` has it."""

    @property
    def time(self) -> Values:
        """Instants in s, evenly spaced, shape (n,)."""

    @property
    def values(self) -> Values:
        """What was measured, in SI units, shape (n,)."""

    @property
    def quantity(self) -> str:
        """Displacement, velocity or acceleration."""

    @property
    def sampling_hz(self) -> float:
        """Sampling rate."""


@spell_checked
def identify(
    record: Record,
    absorber: Siva | Piva,
    primary: Primary,
    *,
    start: Start | None = None,
    known: Mapping[str, Distribution] | None = None,
    seed: int = 0,
) -> Fit:
    """Identify structure and absorber from a measured free decay; needs dynesty.

    The structure is let go from rest. With the instants and jumps of the impacts as inputs the
    record is linear but for a few numbers; they follow by least squares, and from them where the
    walls are, how heavy the absorber is and how it rebounds. Restitution may scatter from impact to
    impact.

    Parameters
    ----------
    record : iva.Measured
        The structure's displacement, velocity or acceleration.
    absorber : Siva or Piva
        Its kind. What is set in it is known exactly.
    primary : Primary
        As `absorber`.
    start : Start, optional
        As `absorber`; ``time`` is the instant of the release on the clock of the record.
    known : mapping of str to distribution of :mod:`iva.sampling`, optional
        What is known of further numbers, by the names of their fields.
    seed : int, default 0
        Of the sampler. The same seed gives the same fit.

    Returns
    -------
    Fit

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If the record is too short, shows no impact, or begins in motion without a known release.
    ImportError
        If dynesty is not installed.

    Examples
    --------
    >>> fit = iva.identify(record, iva.Siva(), iva.Primary())  # doctest: +SKIP
    >>> fit.parameters  # doctest: +SKIP
    """
    if not isinstance(absorber, Siva | Piva):
        raise TypeError(f"absorber = {shown(absorber)}: give an iva.Siva or an iva.Piva")
    if not isinstance(primary, Primary):
        raise TypeError(f"primary = {shown(primary)}: give an iva.Primary")
    start = Start() if start is None else start
    if not isinstance(start, Start):
        raise TypeError(f"start = {shown(start)}: give an iva.Start")
    whole("seed", seed, 0, 1 << 53)
    sampler()
    facts = stated(absorber, primary, start, known)
    recording, clock, floor = conditioned(record)
    find = pendulum.identified if isinstance(absorber, Piva) else free_mass.identified
    found = find(recording, clock, floor, facts, seed)
    return fit_of(found, recording, facts, absorber, clock, record.quantity)


def conditioned(record: Record) -> tuple[Recording, float, float]:
    """Return the record with time from its first sample, that instant, and the noise of rounding.

    Raises
    ------
    TypeError
        If it is no record.
    ValueError
        If it is too short, not of numbers, or of an unknown quantity.
    """
    for name in ("time", "values", "quantity", "sampling_hz"):
        if not hasattr(record, name):
            raise TypeError(f"record = {shown(record)}: give an iva.Measured")
    time, values = np.asarray(record.time, float), np.asarray(record.values, float)
    if record.quantity not in ORDERS:
        raise ValueError(f"record.quantity = {shown(record.quantity)}: give one of {', '.join(ORDERS)}")
    if values.size < LEAST:
        raise ValueError(f"record: it has {values.size} samples; give at least {LEAST}")
    if not np.all(np.isfinite(values)):
        raise ValueError("record.values: some are not finite; give numbers only")
    rate = float(record.sampling_hz)
    steps = np.abs(np.diff(np.unique(values)))
    bit = float(steps.min()) if steps.size else 0.0
    if not steps.size:
        raise ValueError("record.values: they are all the same; give a decay")
    evenly = np.arange(values.size) / rate
    order = ORDERS[record.quantity]
    mains = tuple(hertz for hertz in MAINS if hertz < 0.45 * rate)
    return Recording(evenly, values, order, rate, mains), float(time[0]), bit / np.sqrt(12)


def fit_of(
    found: Found,
    recording: Recording,
    facts: Stated,
    kind: Siva | Piva,
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
        absorber=absorber_of(kind, middle, facts),
        primary=Primary(
            frequency_hz=middle["frequency_hz"], damping_ratio=max(middle["damping_ratio"], 0.0)
        ),
        start=Start(
            displacement=middle["displacement_mm"] / 1e3,
            gap_displacement=middle["gap_displacement_mm"] / 1e3,
            **begin,
        ),
        duration=float(recording.time[-1] + clock - release),
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
    fields |= {
        "frequency_ratio": ratio,
        "length": gravity / (inertia * (ratio * omega) ** 2),
        "inertia_ratio": inertia,
    }
    if "contact_distance" in facts.taken:
        fields["contact_distance"] = facts.taken["contact_distance"]
    return Piva(**fields)


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
        elif (expected := width_before(name, draws, facts)) is not None:
            if high - low > HARDLY * expected * factor:
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


__all__ = ["identify"]
