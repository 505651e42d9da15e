"""One number for a measure that differs from case to case, and how well it is known.

All functions take values of which large ones are bad; a missing one is infinite, the worst of all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from iva.parameters import number
from iva.sampling import whole

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers: TypeAlias = NDArray[np.float64]

#: Probability that an interval holds the number; half of the rest lies on either side.
CONFIDENCE = 0.9
#: Standard normal quantile of (1 + CONFIDENCE)/2.
NORMAL_QUANTILE = 1.6448536269514722
#: Most cases of which somebody may ask for the worst.
MOST_WORST = 10_000


@dataclass(frozen=True)
class Criterion:
    """How a measure over many cases becomes one number."""

    @property
    def words(self) -> str:
        """What the number is, for tables and pictures."""
        raise NotImplementedError

    def of(self, values: Numbers) -> Numbers:
        """Return the number of the values along the last axis, shape (…, n) to (…)."""
        raise NotImplementedError

    def interval(self, values: Numbers) -> tuple[float, float]:
        """Return the bounds between which the number of the population lies with 90 %.

        Parameters
        ----------
        values : numpy.ndarray, shape (n,)
            Of independent cases.
        """
        raise NotImplementedError


@dataclass(frozen=True)
class Quantile(Criterion):
    """The value that a share of the cases stays at or below.

    Parameters
    ----------
    share : float
        In (0, 1).
    """

    share: float

    @property
    def words(self) -> str:
        """What the number is."""
        return f"{100 * self.share:g} % quantile"

    def of(self, values: Numbers) -> Numbers:
        """Return the smallest value that a share of all lies at or below."""
        count = values.shape[-1]
        # The product may lie above a whole number by rounding alone.
        rank = max(math.ceil(self.share * count * (1 - 1e-15)), 1)
        return np.asarray(np.partition(values, rank - 1, axis=-1)[..., rank - 1])

    def interval(self, values: Numbers) -> tuple[float, float]:
        """Return two order statistics: the number of values below a quantile is binomial.

        Whatever the distribution is, the interval holds the quantile with at least 90 % (H. A.
        David and H. N. Nagaraja, Order Statistics, 3rd ed., 2003, section 7.1). With too few cases
        a bound is infinite.
        """
        from scipy.stats import binom

        tail = (1 - CONFIDENCE) / 2
        ordered = np.sort(values)
        below = int(binom.ppf(tail, values.size, self.share))
        above = int(binom.ppf(1 - tail, values.size, self.share)) + 1
        low = ordered[below - 1] if below >= 1 else -math.inf
        high = ordered[above - 1] if above <= values.size else math.inf
        return float(low), float(high)


@dataclass(frozen=True)
class WorstOf(Quantile):
    """The median of the worst of a number of cases: the quantile 2^(−1/count)."""

    count: int = 1

    @property
    def words(self) -> str:
        """What the number is."""
        return f"worst of {self.count}"


@dataclass(frozen=True)
class Mean(Criterion):
    """The mean; infinite if a value is missing."""

    @property
    def words(self) -> str:
        """What the number is."""
        return "mean"

    def of(self, values: Numbers) -> Numbers:
        """Return the mean."""
        return np.asarray(values.mean(axis=-1))

    def interval(self, values: Numbers) -> tuple[float, float]:
        """Return the mean and less and more its standard error times the normal quantile."""
        if not np.isfinite(values).all():
            return math.inf, math.inf
        if values.size < 2:
            return -math.inf, math.inf
        half = NORMAL_QUANTILE * float(values.std(ddof=1)) / math.sqrt(values.size)
        mean = float(values.mean())
        return mean - half, mean + half


@dataclass(frozen=True)
class TailMean(Criterion):
    """The mean of the worst cases: the conditional value at risk (CVaR).

    Parameters
    ----------
    share : float
        In (0, 1): the mean is over the 1 − share worst ones.
    """

    share: float

    @property
    def words(self) -> str:
        """What the number is."""
        return f"mean of the worst {100 * (1 - self.share):.4g} %"

    def of(self, values: Numbers) -> Numbers:
        """Return the mean of the worst values; at least one."""
        count = values.shape[-1]
        worst = max(round((1 - self.share) * count), 1)
        return np.asarray(np.partition(values, count - worst, axis=-1)[..., -worst:].mean(axis=-1))

    def interval(self, values: Numbers) -> tuple[float, float]:
        """Return the mean and less and more its standard error times the normal quantile.

        The variance is that of (X − q)⁺/(1 − share), q the quantile (A. A. Trindade, S. Uryasev,
        A. Shapiro and G. Zrazhevsky, J. Banking & Finance 31 (2007) 3524–3538).
        """
        mean = float(self.of(values))
        if not math.isfinite(mean):
            return math.inf, math.inf
        if values.size < 2:
            return -math.inf, math.inf
        quantile = float(Quantile(self.share).of(values))
        beyond = np.maximum(values - quantile, 0.0) / (1 - self.share)
        half = NORMAL_QUANTILE * float(beyond.std(ddof=1)) / math.sqrt(values.size)
        return mean - half, mean + half


def criterion_of(
    quantile: float | None, mean: bool, worst_of: int | None, cvar: float | None
) -> Criterion:
    """Return the criterion that was asked for; without any the 90 % quantile.

    Raises
    ------
    TypeError
        If one is no number.
    ValueError
        If one is out of range, or two are given.
    """
    found: list[Criterion] = []
    for field, share, kind in (("quantile", quantile, Quantile), ("cvar", cvar, TailMean)):
        if share is not None:
            if not 0 < number(field, share) < 1:
                raise ValueError(f"{field} = {share}: give a number between 0 and 1")
            found.append(kind(float(share)))
    if worst_of is not None:
        whole("worst_of", worst_of, 1, MOST_WORST)
        found.append(WorstOf(2.0 ** (-1.0 / worst_of), worst_of))
    if not isinstance(mean, bool):
        raise TypeError(f"mean = {mean!r}: give True or False")
    if mean:
        found.append(Mean())
    if len(found) > 1:
        raise ValueError("quantile, mean, worst_of, cvar: give one of them")
    return found[0] if found else Quantile(0.9)
