"""The cases that every design is judged by: what is not known exactly, drawn from distributions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from iva import _iva
from iva.parameters import numbers, percentage, shown
from iva.sampling import Distribution, Uniform, of_frame, variable

if TYPE_CHECKING:
    from iva.optimisation.criteria import Numbers

#: Cases that are drawn at once.
DRAWN = 1 << 10


@dataclass
class Draw:
    """A sequence of cases: the same for every design, longer the more are asked for.

    Parameters
    ----------
    uncertain : Uncertain
        What differs from case to case.
    method : {"sobol", "random"}
        Sobol points are the more even, random ones independent, as intervals need them.
    seed : int
        Seed.
    """

    uncertain: Uncertain
    method: str
    seed: int
    _drawn: dict[str, Numbers] = field(default_factory=dict)
    _count: int = 0

    def cases(self, first: int, last: int) -> dict[str, Numbers]:
        """Return the variables of the cases from `first` to below `last` by name, shape (n,)."""
        if not self.uncertain.variables:
            return {}
        if last > self._count:
            # A longer sample begins with the shorter one.
            self._count = max(DRAWN, 1 << (last - 1).bit_length())
            sample = ("sample", self.uncertain.variables, self.method, self._count, self.seed, True)
            drawn = [np.array(values) for _, values in _iva.sampled(sample)]
            self._drawn = dict(zip(self.uncertain.names, drawn, strict=True))
        return {name: values[first:last] for name, values in self._drawn.items()}


@dataclass(frozen=True)
class Uncertain:
    """What is not known exactly.

    Parameters
    ----------
    variables : list of tuple
        Name of a field, distribution and its numbers, for the compiled part.
    names : list of str
        A name for each, of its own.
    lists : dict
        Field name → (name of the variable that picks a place in it, equally likely values).
    offsets : dict
        Name of a chosen field → (name of its variable, whether it is relative).
    """

    variables: list[tuple[str, str, dict[str, float]]]
    names: list[str]
    lists: dict[str, tuple[str, Numbers]]
    offsets: dict[str, tuple[str, bool]]

    @property
    def is_empty(self) -> bool:
        """Nothing differs: there is one case."""
        return not self.variables

    def values(self, cases: Mapping[str, Numbers]) -> dict[str, Numbers]:
        """Return the fields that differ from case to case, without what is chosen."""
        found = {}
        for name in self.names:
            if name.startswith("over "):
                found[name.removeprefix("over ")] = cases[name]
        for key, (name, values) in self.lists.items():
            index = np.minimum((cases[name] * values.size).astype(int), values.size - 1)
            found[key] = values[index]
        return found

    @property
    def medians(self) -> dict[str, float]:
        """The median of each field that differs from case to case, without what is chosen."""
        found = {
            key: median(distribution, numbers)
            for name, (key, distribution, numbers) in zip(self.names, self.variables, strict=True)
            if name == f"over {key}"
        }
        return found | {key: float(np.median(values)) for key, (_, values) in self.lists.items()}

    def offset(self, key: str, chosen: Numbers, cases: Mapping[str, Numbers]) -> Numbers:
        """Return a chosen field in all cases, shapes (k,) and (n,) to (k, n)."""
        if key not in self.offsets:
            length = next(iter(cases.values())).size if cases else 1
            return np.repeat(chosen[:, None], length, axis=1)
        name, relative = self.offsets[key]
        by = cases[name][None, :]
        return chosen[:, None] * (1.0 + by) if relative else chosen[:, None] + by


def median(distribution: str, numbers: Mapping[str, float]) -> float:
    """Return the median of a distribution, that of the compiled part with the same name."""
    from scipy.special import ndtr, ndtri

    low, high = numbers.get("low", -np.inf), numbers.get("high", np.inf)
    if distribution == "uniform":
        return (low + high) / 2
    if distribution == "normal":
        mean, deviation = numbers["mean"], numbers["deviation"]
        ends = (np.array([low, high]) - mean) / deviation if deviation else np.array([0.0, 0.0])
        return float(mean + deviation * ndtri(ndtr(ends).mean()))
    middle, sigma = numbers["median"], numbers["sigma"]
    with np.errstate(divide="ignore"):
        logarithms = np.log(np.maximum([low, high], 0.0) / middle)
    ends = logarithms / sigma if sigma else np.array([0.0, 0.0])
    return float(middle * np.exp(sigma * ndtri(ndtr(ends).mean())))


def uncertain_of(over: object, off: object, chosen: Iterable[str]) -> Uncertain:
    """Return what is not known exactly, as it was given.

    Raises
    ------
    TypeError
        If something is of the wrong class.
    ValueError
        If a field is given both here and among the chosen ones, or a value is out of range.
    """
    variables: list[tuple[str, str, dict[str, float]]] = []
    names: list[str] = []
    lists: dict[str, tuple[str, Numbers]] = {}
    offsets: dict[str, tuple[str, bool]] = {}
    known = list(chosen)

    def enter(name: str, key: str, distribution: Distribution) -> None:
        variables.append(variable(key, distribution))
        names.append(name)

    # Fields of a frame are drawn together, row by row; lists one by one.
    if over is not None and not isinstance(over, Mapping):
        for key, rows in of_frame(over, "grid")[1]:
            if not lists:
                enter("row", key, Uniform(0.0, 1.0))
            lists[key] = ("row", np.array(rows))
    for key, given in (over if isinstance(over, Mapping) else {}).items():
        if isinstance(given, Distribution):
            enter(f"over {key}", key, given)
            continue
        if given is None or isinstance(given, (str, int, float)):
            raise TypeError(
                f"over[{key!r}] = {shown(given)}: give a distribution of iva.sampling, or a list "
                "of values that are equally likely"
            )
        if isinstance(given, tuple) and len(given) == 2:
            rule = "for a range give iva.sampling.Uniform, for two cases a list"
            raise ValueError(f"over[{key!r}] = {shown(given)}: {rule}")
        values = np.array(numbers(f"over[{key!r}]", given))
        if not values.size:
            raise ValueError(f"over[{key!r}] = []: give at least one value")
        enter(f"list {key}", key, Uniform(0.0, 1.0))
        lists[key] = (f"list {key}", values)
    for key in (*lists, *(name.removeprefix("over ") for name in names)):
        if key in known:
            raise ValueError(f"over[{key!r}]: it is chosen; give how far it may be off in `off`")
    if off is not None and not isinstance(off, Mapping):
        raise TypeError(f"off = {shown(off)}: give a mapping of chosen fields to distributions")
    for key, given in (off or {}).items():
        if key not in known:
            raise ValueError(
                f"off[{key!r}]: it is not chosen; give its distribution in `over` (chosen are "
                f"{', '.join(known)})"
            )
        distribution, relative = offset_of(f"off[{key!r}]", given)
        enter(f"off {key}", key, distribution)
        offsets[key] = (f"off {key}", relative)
    return Uncertain(variables, names, lists, offsets)


def offset_of(field: str, given: object) -> tuple[Distribution, bool]:
    """Return the distribution of an offset, and whether it is relative.

    Raises
    ------
    TypeError
        If it is neither a distribution nor a text.
    ValueError
        If a text is no percentage.
    """
    if isinstance(given, Distribution):
        return given, False
    if isinstance(given, str):
        share = percentage(field, given)
        return Uniform(-share, share), True
    raise TypeError(
        f"{field} = {shown(given)}: give a distribution of iva.sampling that is added, or a "
        "percentage such as '5%' for a uniform one of both signs"
    )
