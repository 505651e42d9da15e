"""The two laws of impact of the pendulum: a claim is judged by one, and told of both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from iva.paper.assumptions import Assumptions
from iva.paper.verdicts import Finding


def under_both_laws(claim: Callable[[Assumptions], Finding], a: Assumptions) -> Finding:
    """Judge a claim by the law assumed, and say what the other makes of it."""
    found = claim(a)
    if a.impact_law == "consistent":
        other, name = claim(replace(a, impact_law="printed")), "Eqs. 16 and 17 as printed"
    else:
        other, name = claim(replace(a, impact_law="consistent")), "the consistent law"
    said = f"With {name}: {other.verdict.value} ({other.share} views)."
    return replace(found, model=f"{found.model} {said}".strip())


def told(a: Assumptions) -> str:
    """Return what the line of parameters of a pendulum says of angles and law."""
    law = "" if a.impact_law == "consistent" else "; law of impact as printed"
    return f"g/(x₀ωn²) = {a.gravity:g}{law}"
