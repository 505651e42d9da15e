"""What may be chosen: numbers between two bounds, or sizes that can be bought."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from iva.parameters import number, numbers, shown

if TYPE_CHECKING:
    from iva.optimisation.criteria import Numbers

RULE = (
    "give (low, high), a list of at least three sizes, {'low': …, 'high': …, 'step': …} or "
    "{'sizes': […]}"
)
#: Most sizes of one number.
MOST_SIZES = 100_000


@dataclass(frozen=True)
class Choice:
    """Any number from `low` to `high`, or one of `sizes`."""

    low: float
    high: float
    sizes: tuple[float, ...] = ()

    def at(self, unit: Numbers) -> Numbers:
        """Return the numbers at coordinates from 0 to 1, which share them out evenly."""
        inside = np.clip(unit, 0.0, 1.0)
        if not self.sizes:
            # Neither bound is passed by rounding.
            return np.clip(self.low + inside * (self.high - self.low), self.low, self.high)
        index = np.minimum((inside * len(self.sizes)).astype(int), len(self.sizes) - 1)
        return np.asarray(np.array(self.sizes)[index])

    def unit(self, value: float) -> float:
        """Return the coordinate of a number."""
        if self.sizes:
            return (self.sizes.index(value) + 0.5) / len(self.sizes)
        return (value - self.low) / (self.high - self.low)


def choices_of(choose: object) -> dict[str, Choice]:
    """Return what may be chosen, by field name.

    Raises
    ------
    TypeError
        If something is of the wrong class.
    ValueError
        If nothing may be chosen, or bounds or sizes are none.
    """
    if not isinstance(choose, Mapping):
        raise TypeError(f"choose = {shown(choose)}: give a mapping of field names to bounds")
    if not choose:
        raise ValueError("choose = {}: give at least one, for example {'gap_mm': (2, 14)}")
    for key in choose:
        if not isinstance(key, str):
            raise TypeError(f"choose has the key {shown(key)}: give field names")
    return {key: choice_of(f"choose[{key!r}]", value) for key, value in choose.items()}


def choice_of(field: str, given: object) -> Choice:
    """Return one choice.

    Raises
    ------
    TypeError
        If it is of the wrong class.
    ValueError
        If bounds or sizes are none.
    """
    if isinstance(given, Mapping):
        return of_mapping(field, given)
    if isinstance(given, tuple) and len(given) == 2:
        return box(field, *given)
    if given is None or isinstance(given, (int, float)):
        raise TypeError(f"{field} = {shown(given)}: {RULE}")
    values = numbers(field, given)
    if len(values) < 3:
        raise ValueError(f"{field} = {shown(given)}: {RULE}")
    return sizes(field, values)


def of_mapping(field: str, given: Mapping[str, Any]) -> Choice:
    """Return the choice of a mapping, as study files have them."""
    keys = set(given)
    if keys == {"sizes"}:
        return sizes(field, numbers(f"{field}['sizes']", given["sizes"]))
    if keys == {"low", "high"}:
        return box(field, given["low"], given["high"])
    if keys == {"low", "high", "step"}:
        bounds = box(field, given["low"], given["high"])
        step = number(f"{field}['step']", given["step"])
        if not 0 < step <= bounds.high - bounds.low:
            raise ValueError(
                f"{field}['step'] = {step}: give a number greater than 0, up to high − low"
            )
        # The last is there although its number of steps may be short by rounding.
        count = int((bounds.high - bounds.low) / step + 1e-9) + 1
        if count > MOST_SIZES:
            raise ValueError(f"{field}['step'] = {step}: there are {count} sizes; leave out step")
        return sizes(field, [bounds.low + step * index for index in range(count)])
    raise ValueError(f"{field} = {shown(given)}: {RULE}")


def box(field: str, low: object, high: object) -> Choice:
    """Return all numbers between two bounds."""
    least, most = number(f"{field} low", low), number(f"{field} high", high)
    if not (np.isfinite(least) and np.isfinite(most) and least < most):
        raise ValueError(f"{field} = ({low}, {high}): give two finite numbers, the smaller first")
    return Choice(least, most)


def sizes(field: str, values: list[float]) -> Choice:
    """Return some sizes, smallest first."""
    distinct = tuple(sorted(set(values)))
    if len(distinct) < 2 or not np.isfinite(distinct).all():
        raise ValueError(f"{field}: give at least two finite sizes that differ")
    return Choice(distinct[0], distinct[-1], distinct)
