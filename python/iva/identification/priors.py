"""What is known of each number before the record is looked at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.special import log_ndtr, ndtr, ndtri

from iva.parameters import shown
from iva.sampling import Distribution, LogNormal, Normal, Uniform


class Prior(Protocol):
    """A distribution of one number."""

    def at(self, share: float) -> float:
        """Return the number below which this share of the probability lies."""

    def log_density(self, value: float) -> float:
        """Return the logarithm of the density, −inf outside."""


@dataclass(frozen=True)
class Exactly:
    """A number that is set."""

    value: float

    def at(self, share: float) -> float:  # noqa: ARG002 (all shares lie at one place)
        """Return the number."""
        return self.value

    def log_density(self, value: float) -> float:  # noqa: ARG002 (never sampled)
        """Return 0: a constant."""
        return 0.0


@dataclass(frozen=True)
class Between:
    """Of equal density between two bounds, or of equal density of its logarithm."""

    low: float
    high: float
    by_logarithm: bool = False

    def at(self, share: float) -> float:
        """Return the number below which this share of the probability lies."""
        if self.by_logarithm:
            return float(self.low * (self.high / self.low) ** share)
        return float(self.low + (self.high - self.low) * share)

    def log_density(self, value: float) -> float:
        """Return the logarithm of the density, −inf outside."""
        if not self.low <= value <= self.high:
            return -np.inf
        if self.by_logarithm:
            return -float(np.log(value * np.log(self.high / self.low)))
        return -float(np.log(self.high - self.low))


@dataclass(frozen=True)
class Bell:
    """Normal, or with a normal logarithm; truncated to bounds."""

    middle: float
    width: float
    low: float
    high: float
    by_logarithm: bool = False

    def _scaled(self, value: float) -> float:
        if self.by_logarithm:
            if value <= 0:
                return -np.inf
            return float((np.log(value) - np.log(self.middle)) / self.width)
        return (value - self.middle) / self.width

    def at(self, share: float) -> float:
        """Return the number below which this share of the probability lies."""
        first, last = ndtr(self._scaled(self.low)), ndtr(self._scaled(self.high))
        bent = float(ndtri(first + share * (last - first)))
        made = self.middle * np.exp(self.width * bent) if self.by_logarithm else 0.0
        made = made if self.by_logarithm else self.middle + self.width * bent
        return float(np.clip(made, self.low, self.high))

    def log_density(self, value: float) -> float:
        """Return the logarithm of the density, −inf outside."""
        if not self.low <= value <= self.high:
            return -np.inf
        first, last = log_ndtr(self._scaled(self.low)), log_ndtr(self._scaled(self.high))
        scaled = self._scaled(value)
        made = -0.5 * scaled**2 - np.log(self.width) - np.log(2 * np.pi) / 2
        made -= last + np.log1p(-np.exp(first - last))
        return float(made - np.log(value) if self.by_logarithm else made)


def prior_of(name: str, given: Distribution, factor: float, low: float, high: float) -> Prior:
    """Return the prior that a distribution of :mod:`iva.sampling` stands for.

    Parameters
    ----------
    name : str
        For the message.
    given : Distribution
        In the unit of the field that the user named.
    factor : float
        By which that is multiplied.
    low, high : float
        Bounds that physics sets, in the unit after that.

    Raises
    ------
    TypeError
        If it is no distribution.
    ValueError
        If nothing of it is allowed.
    """
    if isinstance(given, Uniform):
        made: Prior = Between(max(given.low * factor, low), min(given.high * factor, high))
        ends = (given.low * factor, given.high * factor)
    elif isinstance(given, Normal | LogNormal):
        least = low if given.low is None else max(low, given.low * factor)
        most = high if given.high is None else min(high, given.high * factor)
        ends = (least, most)
        if isinstance(given, Normal):
            made = Bell(given.mean * factor, given.deviation * factor, least, most)
        else:
            made = Bell(given.median * factor, given.sigma, least, most, by_logarithm=True)
    else:
        raise TypeError(
            f"known[{name!r}] = {shown(given)}: give a distribution of iva.sampling, or set the "
            "number in the absorber, the primary system or the start"
        )
    if not max(ends[0], low) < min(ends[1], high):
        raise ValueError(f"known[{name!r}] = {shown(given)}: give one that allows possible values")
    return made


__all__ = ["Bell", "Between", "Exactly", "Prior", "prior_of"]
