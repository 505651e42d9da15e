"""What a study file says of a structure before it is identified."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from iva import _iva
from iva.optimisation.studies import distribution, paths
from iva.parameters import Piva, Primary, Siva, Start, shown
from iva.sampling import Distribution
from iva.spelling import hint

#: The kind of no absorber, and all kinds.
ALONE = "none"
KINDS = (Siva._kind, Piva._kind, ALONE)
#: The sections that are read.
SECTIONS = ("primary", "absorber", "start", "known")


@dataclass(frozen=True)
class Known:
    """What is known beforehand."""

    absorber: Siva | Piva | None
    primary: Primary = field(default_factory=Primary)
    start: Start = field(default_factory=Start)
    distributions: dict[str, Distribution] = field(default_factory=dict)


def of_kind(kind: str, **fields: Any) -> Known:
    """Return an absorber of a kind, of which nothing else is known, or none at all.

    Raises
    ------
    ValueError
        If there is none and fields of it are given.
    """
    if kind == ALONE:
        if fields:
            raise ValueError(f"absorber.{next(iter(fields))}: there is none; leave it out")
        return Known(None)
    return Known(Piva(**fields) if kind == Piva._kind else Siva(**fields))


def of_study(path: Path) -> Known:
    """Return what a study file says.

    Raises
    ------
    ValueError
        If something in it cannot be used.
    iva.IvaError
        If it cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as fault:
        raise _iva.IvaError(f"{path} cannot be read: {fault}") from None
    try:
        return of_sections(tomllib.loads(text))
    except (tomllib.TOMLDecodeError, TypeError, ValueError) as wrong:
        raise ValueError(f"{path}: {wrong}") from None


def of_sections(study: Mapping[str, Any]) -> Known:
    """Return what the sections of a study say."""
    for name, section in study.items():
        if name == "version":
            continue
        if name not in SECTIONS:
            raise ValueError(
                f"[{name}]: it is not read here{hint(name, SECTIONS)}; there is "
                f"{', '.join(SECTIONS)}"
            )
        if not isinstance(section, Mapping):
            raise ValueError(f"{name} = {shown(section)}: give a section")
    absorber = dict(study.get("absorber", {}))
    kind = absorber.pop("kind", Siva._kind)
    if kind not in KINDS:
        raise ValueError(f"absorber.kind = {shown(kind)}: give siva, piva or none")
    distributions = {
        name: distribution(f"known.{name}", given)
        if isinstance(given, Mapping)
        else refused(name, given)
        for name, given in paths(study.get("known", {}))
    }
    return Known(
        of_kind(kind, **absorber).absorber,
        Primary(**study.get("primary", {})),
        Start(**study.get("start", {})),
        distributions,
    )


def refused(name: str, given: object) -> Distribution:
    """Refuse what is no distribution.

    Raises
    ------
    ValueError
        Always.
    """
    raise ValueError(
        f'known.{name} = {shown(given)}: give a distribution such as {{ distribution = "normal", '
        f"mean = …, deviation = … }}, or the number in its own section"
    )
