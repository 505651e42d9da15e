"""The box that random starts are drawn from."""

from __future__ import annotations

from collections.abc import Mapping

from iva.dynamics.search import NAMES
from iva.parameters import numbers, shown

#: The range of a number of the start.
Range = tuple[float, float]
#: The ranges of displacement, velocity, gap displacement and gap velocity.
Box = tuple[Range, Range, Range, Range]
#: Largest seed.
MOST_SEED = 2**64 - 1
#: Most starts.
MOST_STARTS = 10**6


def box_of(given: Mapping[str, object] | None) -> Box | None:
    """Return a box that was given by the names of its numbers, or ``None`` for the usual one.

    Raises
    ------
    TypeError
        If it is no mapping of pairs of numbers.
    ValueError
        If a number of the start is missing, or there is another.
    """
    if given is None:
        return None
    if not isinstance(given, Mapping):
        raise TypeError(f"box = {shown(given)}: give a range for each of {', '.join(NAMES)}")
    if set(given) != set(NAMES):
        raise ValueError(
            f"box of {shown(list(given))}: give a range for each of {', '.join(NAMES)}"
        )
    one, two, three, four = (range_of(f"box.{name}", given[name]) for name in NAMES)
    return one, two, three, four


def range_of(field: str, given: object) -> Range:
    """Return a range.

    Raises
    ------
    TypeError
        If it is no sequence of numbers.
    ValueError
        If it is not a pair.
    """
    values = numbers(field, given)
    if len(values) != 2:
        raise ValueError(f"{field} = {shown(given)}: give two numbers, the smaller one first")
    return values[0], values[1]


def boxed(made: list[list[float]]) -> Box:
    """Return a box that the compiled part describes."""
    one, two, three, four = ((low, high) for low, high in made)
    return one, two, three, four
