"""Uniform sampling: the rate that instants follow, and whether they follow it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from iva.parameters import number, shown

#: How far an instant may be from its place, in steps, besides what it is rounded by. A sample that
#: is missing puts those behind it a whole step away.
TOLERANCE = 0.1

#: Instants may be rounded to so many steps, unless the rate is given.
ROUNDED = 0.5

#: Decimal places that instants are looked through for.
PLACES = 9

#: Instants in s are smaller than that, and steps are longer: clocks of recorders know no others.
LATEST, SHORTEST = 1e15, 1e-12

#: Samples that a record must have.
FEWEST = 16

#: How far begin and end of a cut may miss an instant and still take it, in steps.
AT = 1e-6


def rate(sampling_hz: object) -> float | None:
    """Return the sampling rate that was given in Hz, if one was.

    Raises
    ------
    TypeError
        If it is not a number.
    ValueError
        If it is not positive and finite.
    """
    if sampling_hz is None:
        return None
    value = number("sampling_hz", sampling_hz)
    if not 0.0 < value < math.inf:
        raise ValueError(f"sampling_hz = {shown(sampling_hz)}: give a finite number greater than 0")
    return value


def evenly(begin: float, step: float, count: int) -> NDArray[np.float64]:
    """Return instants at equal steps in s, shape (count,)."""
    return begin + step * np.arange(count, dtype=np.float64)


def uniform(
    times: NDArray[np.float64], sampling_hz: float | None
) -> tuple[NDArray[np.float64], float]:
    """Return instants at equal steps from the first one, and their rate.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Instants in s, n ≥ 2. Besides what its last decimal place rounds it by, none may be further
        than a tenth of a step from its place. They may be rounded to half a step at most.
    sampling_hz : float, optional
        The rate in Hz if it is known. Then they may be rounded so far that some are the same.

    Returns
    -------
    times : ndarray, shape (n,)
        Instants in s.
    sampling_hz : float
        The rate in Hz. Unless it was given it is that of the straight line through the instants, or
        the nearest whole number if this moves no instant by more than they scatter about the line.

    Raises
    ------
    ValueError
        If the instants are not finite, do not increase, or are not at equal steps.
    """
    known = np.abs(times) < LATEST
    if not known.all():
        at = int(np.argmin(known))
        raise ValueError(f"time: sample {at} is at {times[at]:.6g} s; give finite times in s")
    steps = np.diff(times)
    increasing(times, steps, may_repeat=sampling_hz is not None)
    if times[-1] - times[0] < SHORTEST * len(steps):
        raise ValueError(f"time: the steps are {steps.max():.2g} s; give times in s")
    places = np.arange(len(times), dtype=np.float64)
    hz = fitted(times, places) if sampling_hz is None else sampling_hz
    rounded = rounding(times, hz) * hz
    if sampling_hz is None and rounded > ROUNDED:
        raise ValueError(
            f"time: instants are rounded to {rounded / hz:.1g} s, which is {rounded:.2g} steps; "
            "give sampling_hz"
        )
    away = times * hz - places
    if away.max() - away.min() <= rounded + 2.0 * TOLERANCE:
        return times[0] + places / hz, hz
    if rounded <= ROUNDED:
        equal(times, steps)
    mean = (len(times) - 1) / (times[-1] - times[0])
    raise ValueError(
        f"{'time' if sampling_hz is None else f'sampling_hz = {sampling_hz:.9g}'}: instants are up "
        f"to {away.max() - away.min():.2g} steps apart from equal ones, with {mean:.9g} samples a "
        "second; give a record sampled at equal steps, and its rate"
    )


def increasing(times: NDArray[np.float64], steps: NDArray[np.float64], *, may_repeat: bool) -> None:
    """Check that instants increase, or with `may_repeat` that none is earlier than the one before.

    Raises
    ------
    ValueError
        If one is, or all are the same.
    """
    wrong = steps < 0.0 if may_repeat else steps <= 0.0
    if times[-1] == times[0]:
        wrong[0] = True
    if wrong.any():
        at = int(np.argmax(wrong))
        advice = "" if may_repeat else "; give sampling_hz if they are rounded"
        raise ValueError(
            f"time: {times[at]:.9g} s is followed by {times[at + 1]:.9g} s (sample {at + 1}); give "
            f"times that increase{advice}"
        )


def rounding(times: NDArray[np.float64], hz: float) -> float:
    """Return what instants are rounded to in s, 0 if that moves none.

    It is the largest power of ten that all are multiples of. If the step is a multiple of it as
    well, nothing was rounded off.
    """
    steps = np.diff(times)
    least = float(steps[steps > 0.0].min())
    for place in range(PLACES + 1):
        # What float64 leaves of a decimal number is far less than a thousandth of its last place,
        # and of a step: all of a short record is near to whole seconds.
        scaled = times * 10.0**place
        if np.abs(scaled - np.round(scaled)).max() < 1e-3 * min(1.0, least * 10.0**place):
            ratio = 10.0**place / hz
            return 0.0 if abs(ratio - round(ratio)) * len(times) < 1e-3 else 10.0**-place
    return 0.0


def equal(times: NDArray[np.float64], steps: NDArray[np.float64]) -> None:
    """Check that no step differs from the median of all by half of it.

    Raises
    ------
    ValueError
        If one does: a sample is missing, or there twice.
    """
    step = float(np.median(steps))
    odd = np.abs(steps - step)
    at = int(np.argmax(odd))
    if odd[at] > 0.5 * step:
        raise ValueError(
            f"time: from {times[at]:.9g} s to {times[at + 1]:.9g} s the step is {steps[at]:.4g} s, "
            f"elsewhere {step:.4g} s; give a record sampled at equal steps without dropouts, or "
            "cut it with begin and end"
        )


def fitted(times: NDArray[np.float64], places: NDArray[np.float64]) -> float:
    """Return the rate of the straight line through instants, rounded as :func:`uniform` says."""
    centred = places - places.mean()
    step = float(centred @ (times - times.mean()) / (centred @ centred))
    scatter = float(np.abs(times - times.mean() - centred * step).max())
    # Instants themselves are rounded to 53 bits.
    scatter += float(np.spacing(np.abs(times).max()))
    whole = float(round(1.0 / step))
    if whole > 0.0 and abs(1.0 / whole - step) * len(times) <= scatter:
        return whole
    return 1.0 / step


def cut(times: NDArray[np.float64], begin: object, end: object) -> slice:
    """Return which samples lie from `begin` to `end`, both included.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Instants in s.
    begin, end : float or None
        In s on the same clock; ``None`` for the ends of the record.

    Raises
    ------
    TypeError
        If one is not a number.
    ValueError
        If one is not finite, or fewer than 16 samples are left.
    """
    bounds = []
    for field, value in (("begin", begin), ("end", end)):
        bound = None if value is None else number(field, value)
        if bound is not None and not math.isfinite(bound):
            raise ValueError(f"{field} = {shown(value)}: give a finite time in s")
        bounds.append(bound)
    first, last = 0, len(times)
    # Instants that are missing or out of order are refused later, if they are not cut away.
    known = times[np.abs(times) < LATEST]
    near = AT * float(np.ptp(known)) / len(known) if len(known) else 0.0
    if bounds[0] is not None:
        later = times >= bounds[0] - near
        first = int(np.argmax(later)) if later.any() else len(times)
    if bounds[1] is not None:
        earlier = times <= bounds[1] + near
        last = len(times) - int(np.argmax(earlier[::-1])) if earlier.any() else 0
    count = max(last - first, 0)
    if count < FEWEST:
        kept = "" if begin is None and end is None else " from begin to end"
        extent = f" of {times[0]:.6g} to {times[-1]:.6g} s" if kept and len(times) else ""
        raise ValueError(f"the record{extent} has {count} samples{kept}; give at least {FEWEST}")
    return slice(first, last)
