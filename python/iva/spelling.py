"""Misspelt names, and the names that were meant."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from types import FunctionType

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any, TypeVar

    T = TypeVar("T", bound=Callable[..., Any])

#: Symbols of the field → the name of the field.
SYMBOLS = {
    "c": "damping",
    "d": "clearance",
    "e": "restitution",
    "fn": "frequency_hz",
    "gamma": "relative_clearance",
    "k": "stiffness",
    "m": "mass",
    "mu": "mass_ratio",
    "omega": "natural_frequency",
    "v0": "velocity",
    "x0": "displacement",
    "zeta": "damping_ratio",
}

#: So many columns are listed behind the one that was meant; the swept ones are the first of all.
FEW = 8


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that is the most like a misspelt one, if any is like it.

    One that goes on where the misspelt name ends comes before all others.

    Examples
    --------
    >>> nearest("freq", ["force", "frequency"]), nearest("restituton", ["restitution"])
    ('frequency', 'restitution')
    >>> nearest("e", ["mass", "restitution", "clearance"])
    'restitution'
    >>> nearest("zeta", ["mass", "damping"]) is None
    True
    """
    # Only here, for who spells right is not to wait for it.
    from difflib import get_close_matches

    small = name.lower()
    if (meant := SYMBOLS.get(small)) in (listed := list(known)):
        return meant
    names = {one.lower(): one for one in listed}
    longer = [one for one in names if small and one.startswith(small)]
    near = get_close_matches(small, longer or names, n=1, cutoff=0.0 if longer else 0.6)
    return names[near[0]] if near else None


def hint(name: str, known: Iterable[str]) -> str:
    """Return the end of a sentence about an unknown name, empty where none is like it.

    Examples
    --------
    >>> hint("mas", ["mass_ratio", "mass"])
    '; did you mean `mass`?'
    """
    near = nearest(name, known)
    return "" if near is None else f"; did you mean `{near}`?"


def no_column(name: str, known: Iterable[str]) -> str:
    """Return what to say of a column that is not there: which one was meant, and what there is.

    Examples
    --------
    >>> no_column("mas_ratio", ["point", "mass_ratio", "impacts"])
    'no such column; did you mean `mass_ratio`? Others are point, impacts'
    >>> no_column("zeta", ["point", "mass_ratio", "impacts"])
    'no such column; there is point, mass_ratio, impacts'
    """
    there = list(known)
    near = nearest(name, there)
    if near is None:
        return f"no such column; there is {', '.join(there) or 'none'}"
    others = [one for one in there if one != near]
    said = f"no such column; did you mean `{near}`?"
    if not others:
        return said
    more = f" and {len(others) - FEW} more" if len(others) > FEW else ""
    return f"{said} Others are {', '.join(others[:FEW])}{more}"


def spell_checked(called: T) -> T:
    """Let a function or a class answer a misspelt keyword with the one that was meant.

    Examples
    --------
    >>> @spell_checked
    ... def run(*, periods):
    ...     return periods
    >>> run(perods=3)
    Traceback (most recent call last):
    TypeError: perods = 3: run has no such argument; did you mean `periods`?
    """
    if not isinstance(called, type):
        checked: T = watched(called, called.__qualname__)
        return checked
    # The class itself stays what it is: a dataclass, found by pickle under its name.
    called.__init__ = watched(called.__init__, called.__qualname__)  # type: ignore[misc]
    return called


def watched(function: Callable[..., Any], owner: str) -> Any:
    """Return a function that does the same, but for what it says of unknown keywords."""
    # A name of this function, for its globals are not those of this module.
    check = check_keywords

    def checked(*arguments: object, **keywords: object) -> object:
        try:
            return function(*arguments, **keywords)
        except TypeError:
            check(function, owner, keywords)
            raise

    # With the globals of `function`: by these doctest knows whose examples it has before it.
    same = FunctionType(
        checked.__code__, function.__globals__, function.__name__, None, checked.__closure__
    )
    return wraps(function)(same)


def check_keywords(
    function: Callable[..., object], owner: str, keywords: Mapping[str, object]
) -> None:
    """Check that a function has all keywords that it was given.

    Raises
    ------
    TypeError
        If it has not, which Python says in the same class of error.
    """
    # Both only here: most calls are right, and `parameters` needs this module.
    from inspect import Parameter, signature

    from iva.parameters import shown

    parameters = signature(function).parameters
    if any(one.kind is Parameter.VAR_KEYWORD for one in parameters.values()):
        return
    by_place = (Parameter.POSITIONAL_ONLY, Parameter.VAR_POSITIONAL)
    known = [
        name
        for name, one in parameters.items()
        if one.kind not in by_place and name not in ("self", "cls")
    ]
    for name, value in keywords.items():
        if name not in known:
            rule = hint(name, known) or f"; give some of {', '.join(known)}"
            raise TypeError(
                f"{name} = {shown(value)}: {owner} has no such argument{rule}"
            ) from None
