"""The box that random starts are drawn from."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain

from iva.dynamics.search import NAMES, members
from iva.parameters import numbers, shown

#: The range of a number of the start.
Range = tuple[float, float]
#: Largest seed.
MOST_SEED = 2**64 - 1
#: Most starts.
MOST_STARTS = 10**6


def box_of(given: Mapping[str, object] | None, absorber: object) -> tuple[Range, ...] | None:
    """Return a box that was given by the names of its numbers, or ``None`` for the usual one.

    A range of the gaps is that of all absorbers and units; a list has one for each.

    Raises
    ------
    TypeError
        If it is no mapping of pairs of numbers.
    ValueError
        If a number of the start is missing, or there is another, or a list has no range for each.
    """
    if given is None:
        return None
    if not isinstance(given, Mapping):
        raise TypeError(f"box = {shown(given)}: give a range for each of {', '.join(NAMES)}")
    if set(given) != set(NAMES):
        raise ValueError(
            f"box of {shown(list(given))}: give a range for each of {', '.join(NAMES)}"
        )
    own = [range_of(f"box.{name}", given[name]) for name in NAMES[:2]]
    count = members(absorber)
    places, speeds = (ranges_of(f"box.{name}", given[name], count) for name in NAMES[2:])
    return (*own, *chain.from_iterable(zip(places, speeds, strict=True)))


def ranges_of(field: str, given: object, count: int) -> list[Range]:
    """Return the range of each of so many absorbers and units.

    Raises
    ------
    TypeError
        If it is neither a pair of numbers nor a list of pairs.
    ValueError
        If there is not one for each.
    """
    listed = isinstance(given, (list, tuple)) and given and isinstance(given[0], (list, tuple))
    if not listed:
        return [range_of(field, given)] * count
    assert isinstance(given, (list, tuple))
    if len(given) != count:
        raise ValueError(f"{field} has {len(given)} ranges: give a range, or a list of {count}")
    return [range_of(f"{field}[{place}]", one) for place, one in enumerate(given)]


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


def boxed(made: list[list[float]]) -> tuple[Range, ...]:
    """Return a box that the compiled part describes."""
    return tuple((low, high) for low, high in made)


def names_of(count: int) -> list[str]:
    """Return the names of so many numbers of a start, of several absorbers with their indices."""
    if count == len(NAMES):
        return list(NAMES)
    each = (f"{name}.{k}" for k in range(count // 2 - 1) for name in NAMES[2:])
    return [*NAMES[:2], *each]


def is_name(name: object, absorber: object) -> bool:
    """Return whether a number of the start has a name; of several absorbers with an index."""
    count = members(absorber)
    return name in NAMES or (count > 1 and name in names_of(2 + 2 * count))
