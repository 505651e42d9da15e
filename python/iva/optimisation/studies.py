"""The section ``[optimise]`` of a study file."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from iva import _iva
from iva.parameters import shown
from iva.sampling import Distribution, LogNormal, Normal, Uniform
from iva.spelling import hint

if TYPE_CHECKING:
    from iva.parameters import Spec

#: The distributions by their names in a study.
DISTRIBUTIONS: dict[str, type[Distribution]] = {
    kind._name: kind for kind in (Uniform, Normal, LogNormal)
}
#: Keys of the section that are passed on as they are.
PLAIN = ("minimise", "maximise", "quantile", "mean", "worst_of", "cvar", "seed", "runs")
#: Keys that hold a table of fields or measures.
TABLES = ("choose", "over", "off", "within", "worst_over")
#: Keys of what may be chosen, and of a distribution: a table with one of them is no path.
LEAVES = frozenset({"sizes", "low", "high", "step", "distribution", "mean", "median"})


def of_study(path: Path) -> tuple[Spec, dict[str, Any]]:
    """Return the scene of a study file, and what its section ``[optimise]`` asks.

    Raises
    ------
    ValueError
        If the study is invalid.
    iva.IvaError
        If the file cannot be read.
    """
    spec = _iva.optimised_scene(path)
    section = tomllib.loads(path.read_text(encoding="utf-8"))["optimise"]
    try:
        return spec, asked_of(section)
    except (TypeError, ValueError) as wrong:
        raise ValueError(f"{path}: [optimise]: {wrong}") from None


def asked_of(section: object) -> dict[str, Any]:
    """Return what a section asks, as arguments of :func:`iva.optimise`.

    Raises
    ------
    TypeError
        If something is of the wrong type.
    ValueError
        If a key is unknown.
    """
    if not isinstance(section, Mapping):
        raise TypeError(f"optimise = {shown(section)}: give a section")
    known = (*PLAIN, *TABLES)
    for key in section:
        if key not in known:
            raise ValueError(f"{key}: no such key{hint(key, known)}; there is {', '.join(known)}")
    asked: dict[str, Any] = {key: section[key] for key in PLAIN if key in section}
    for key in TABLES:
        if key in section:
            if not isinstance(section[key], Mapping):
                raise TypeError(f"{key} = {shown(section[key])}: give a table")
            asked[key] = dict(paths(section[key]))
    for key in ("over", "off"):
        for field, given in asked.get(key, {}).items():
            if isinstance(given, Mapping):
                asked[key][field] = distribution(f"{key}.{field}", given)
    return asked


def paths(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the entries of a table by their paths, for ``absorber.mass`` is a table in TOML."""
    for key, value in table.items():
        name = f"{before}{key}"
        if isinstance(value, Mapping) and LEAVES.isdisjoint(value):
            yield from paths(value, f"{name}.")
        else:
            yield name, value


def distribution(field: str, given: Mapping[str, Any]) -> Distribution:
    """Return a distribution, as ``[sweep]`` has it; without a name it is uniform.

    Raises
    ------
    ValueError
        If its name or a number of it is unknown, or one is missing.
    """
    numbers = dict(given)
    name = numbers.pop("distribution", "uniform")
    kind = DISTRIBUTIONS.get(name) if isinstance(name, str) else None
    if kind is None:
        raise ValueError(
            f"{field}.distribution = {shown(name)}: give one of {', '.join(DISTRIBUTIONS)}"
        )
    try:
        return kind(**numbers)
    except TypeError as wrong:
        raise ValueError(f"{field}: {wrong}") from None
