"""Parameters of an absorber from a measured decay."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Protocol

import numpy as np

from iva.identification.fits import Fit
from iva.identification.needs import sampler
from iva.identification.records import Recording
from iva.identification.responses import ORDERS, Values
from iva.identification.stages import STAGES, telling
from iva.parameters import Piva, Primary, Siva, Start, shown
from iva.progress import Progress, reporting
from iva.sampling import Distribution, whole
from iva.spelling import spell_checked

#: Frequencies of the mains in Hz.
MAINS = (50.0, 60.0)
#: Noise that is assumed at least, over the standard deviation of the record.
LITTLE = 1e-4
#: Least number of samples, and of periods, of a record that is looked at.
LEAST = 200


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
    absorber: Siva | Piva | None,
    primary: Primary,
    *,
    start: Start | None = None,
    known: Mapping[str, Distribution] | None = None,
    seed: int = 0,
    progress: bool | Progress = False,
) -> Fit:
    """Identify structure and absorber from a measured free decay; needs dynesty.

    The structure is let go from rest, or a blow sets it in motion. With the instants and jumps of
    the impacts as inputs the record is linear but for a few numbers; they follow by least squares,
    and from them where the walls are, how heavy the absorber is and how it rebounds. Restitution
    may scatter from impact to impact.

    Parameters
    ----------
    record : iva.Measured
        What the structure does: with a free mass its acceleration or velocity, with a pendulum its
        displacement or velocity.
    absorber : Siva, Piva or None
        Its kind. What is set in it is known exactly. ``None``: there is none, as on a rig before
        one is built; any quantity will do, and the record may begin in motion.
    primary : Primary
        As `absorber`.
    start : Start, optional
        As `absorber`; ``time`` is the instant of the release on the clock of the record. With
        ``impulse``, ``impulse_velocity``, or the latter in `known`, the structure is at rest until
        a blow, shorter than a tenth of a period, and a free mass stays at rest through it.
    known : mapping of str to distribution of :mod:`iva.sampling`, optional
        What is known of further numbers, by the names of their fields.
    seed : int, default 0
        Of the sampler. The same seed gives the same fit.
    progress : bool or callable, default False
        Told (done, total) when one of its stages has ended: the record is looked at, impacts are
        found, the absorber is sampled, all is done. True: a bar on a terminal or in a notebook.

    Returns
    -------
    Fit

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If the record is too short, is no decay or more than one, shows no impact though there is an
        absorber, begins in motion without a known release, or is of a quantity that does not tell.
    ImportError
        If dynesty is not installed.
    KeyboardInterrupt
        If it is interrupted before impacts were found that follow each other. After that the fit so
        far is returned; it is not adequate, and its reasons say so.

    Examples
    --------
    >>> fit = iva.identify(record, iva.Siva(), iva.Primary())  # doctest: +SKIP
    >>> fit.parameters  # doctest: +SKIP

    The structure alone:

    >>> bare = iva.identify(record, None, iva.Primary())  # doctest: +SKIP
    """
    if not isinstance(absorber, Siva | Piva | None):
        raise TypeError(
            f"absorber = {shown(absorber)}: give an iva.Siva, an iva.Piva, or None for the "
            "structure alone"
        )
    if not isinstance(primary, Primary):
        raise TypeError(f"primary = {shown(primary)}: give an iva.Primary")
    start = Start() if start is None else start
    if not isinstance(start, Start):
        raise TypeError(f"start = {shown(start)}: give an iva.Start")
    whole("seed", seed, 0, 1 << 53)
    sampler()
    # What is imported here needs SciPy, which may be missing up to this point.
    from iva.identification import alone, free_mass, pendulum
    from iva.identification.answers import fit_of
    from iva.identification.stated import stated

    facts = stated(absorber, primary, start, known)
    recording, clock, floor = conditioned(record)
    finds = {Siva: free_mass.identified, Piva: pendulum.identified}
    find = alone.identified if absorber is None else finds[type(absorber)]
    try:
        with np.errstate(all="ignore"), reporting(progress) as report:
            tell = telling(report)
            found = find(recording, clock, floor, facts, seed, tell)
            with suppress(KeyboardInterrupt):  # All is found.
                tell(STAGES)
    except np.linalg.LinAlgError:
        raise ValueError(
            "record: the fit broke down, its numbers do not determine a model; give a longer "
            "record, a higher sampling rate, or what is known"
        ) from None
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
        raise ValueError(
            f"record.quantity = {shown(record.quantity)}: give one of {', '.join(ORDERS)}"
        )
    if values.size < LEAST:
        raise ValueError(f"record: it has {values.size} samples; give at least {LEAST}")
    if not np.all(np.isfinite(values)):
        raise ValueError("record.values: some are not finite; give numbers only")
    rate = float(record.sampling_hz)
    steps = np.abs(np.diff(np.unique(values)))
    if not steps.size:
        raise ValueError("record.values: they are all the same; give a decay")
    # A record without noise is explained to within what is left out here at any rate.
    floor = max(float(steps.min()) / np.sqrt(12), LITTLE * float(np.std(values)))
    evenly = np.arange(values.size) / rate
    order = ORDERS[record.quantity]
    mains = tuple(hertz for hertz in MAINS if hertz < 0.45 * rate)
    return Recording(evenly, values, order, rate, mains), float(time[0]), floor


__all__ = ["identify"]
