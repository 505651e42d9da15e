"""Misspelt keywords: what is called names the one that was meant."""

from __future__ import annotations

import dataclasses
import inspect
import pickle
import re
from collections.abc import Callable
from typing import Any

import pytest

import iva
from iva import paper, plots, sampling, theory
from iva.spelling import nearest, spell_checked

# Made by the package alone.
RESULTS = {"Gradient", "Run", "Scan", "Table", "Units", "Verification"}
# What users call, by the names that messages give it.
CALLED: dict[str, Callable[..., object]] = {
    name: found
    for home, names in (
        (iva, set(iva.__all__) - RESULTS - {"IvaError"}),
        (sampling, "points Sample Sobol LatinHypercube Random Uniform Normal LogNormal".split()),
        (theory, ["masri_caughey", "slow_manifold"]),
        (paper, ["Assumptions", "reproduce"]),
        (plots, plots.__all__),
    )
    for name in sorted(names)
    if callable(found := getattr(home, name))
} | {
    "Recorded.read": iva.Recorded.read,
    "Run.trajectory": iva.Run.trajectory,
    "Run.write_mat": iva.Run.write_mat,
    "Run.write_uff": iva.Run.write_uff,
}
KEYWORDS = [
    (name, parameter.name)
    for name, called in CALLED.items()
    for parameter in inspect.signature(called).parameters.values()
    if parameter.kind in (parameter.KEYWORD_ONLY, parameter.POSITIONAL_OR_KEYWORD)
    and len(parameter.name) > 2
    and parameter.name != "self"
    # Of `displacements` that is another keyword.
    and parameter.name[:-1] not in inspect.signature(called).parameters
]


def test_all_that_has_keywords_is_looked_at() -> None:
    assert len(KEYWORDS) > 150
    assert {name for name in CALLED if name not in dict(KEYWORDS)} == {"show_versions", "style"}


@pytest.mark.parametrize(("name", "keyword"), KEYWORDS)
def test_a_keyword_without_its_last_letter(name: str, keyword: str) -> None:
    said = f"{keyword[:-1]} = 0.5: {name} has no such argument; did you mean `{keyword}`?"
    with pytest.raises(TypeError, match=f"^{re.escape(said)}$") as caught:
        CALLED[name](**{keyword[:-1]: 0.5})
    assert caught.value.__suppress_context__


# what is called, what it says
SLIPS: list[tuple[Callable[..., Any], str]] = [
    (lambda: iva.Siva(mas=0.3), "mas = 0.3: Siva has no such argument; did you mean `mass`?"),  # type: ignore[call-arg]
    (lambda: iva.Start(dispalcement=1), "did you mean `displacement`?"),  # type: ignore[call-arg]
    (lambda: iva.Primary(Mass=3.0), "did you mean `mass`?"),  # type: ignore[call-arg]
    (lambda: iva.Harmonic(freq=2), "did you mean `frequency`?"),  # type: ignore[call-arg]
    (
        lambda: dataclasses.replace(iva.Siva(), restituton=0.5),  # type: ignore[call-arg]
        "restituton = 0.5: Siva has no such argument; did you mean `restitution`?",
    ),
    (
        lambda: iva.simulate(None, iva.Primary(), strat=iva.Start(), periods=3),  # type: ignore[call-arg]
        "strat = Start(): simulate has no such argument; did you mean `start`?",
    ),
    # Where nothing is like it, all that there is.
    (
        lambda: iva.Impulse(zeta=1),  # type: ignore[call-arg]
        "zeta = 1: Impulse has no such argument; give some of velocity, impulse, time",
    ),
]


@pytest.mark.parametrize(("call", "said"), SLIPS)
def test_slips(call: Callable[..., Any], said: str) -> None:
    with pytest.raises(TypeError, match=f"{re.escape(said)}$"):
        call()


def test_other_errors_of_type_stay() -> None:
    with pytest.raises(TypeError, match=r"absorber\.mass = 'a': give a number, not str"):
        iva.Siva(mass="a")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="takes 1 positional argument but 2 were given"):
        iva.Siva(0.3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="missing 1 required keyword-only argument: 'start'"):
        iva.simulate(None, iva.Primary(), periods=3)  # type: ignore[call-arg]


def test_what_is_checked_stays_what_it_was() -> None:
    assert list(inspect.signature(iva.Start).parameters) == [
        field.name for field in dataclasses.fields(iva.Start)
    ]
    assert iva.simulate.__name__ == iva.simulate.__qualname__ == "simulate"
    assert iva.simulate.__module__ == "iva.simulation"
    assert pickle.loads(pickle.dumps(iva.simulate)) is iva.simulate

    @spell_checked
    def all_kinds(first: int, /, *more: int, last: int = 0, **others: int) -> int:
        return first + sum(more) + last + sum(others.values())

    assert all_kinds(1, 2, last=3, lst=4) == 10


def test_the_nearest_name() -> None:
    assert nearest("settling_time", ["settling_time_10", "settling_time_5"]) == "settling_time_5"
    assert nearest("gap", ["gap_offset_mm", "gap_mm", "age"]) == "gap_mm"
    assert nearest("REDUCTION", ["reduction_rms", "reduction"]) == "reduction"
    assert nearest("cots", ["Cost", "Time"]) == "Cost"
    assert nearest("zeta", ["Cost", "Time"]) is None
    assert nearest("", ["mass"]) is None
    assert nearest("mass", []) is None
