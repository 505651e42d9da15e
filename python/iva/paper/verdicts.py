"""Claims and verdicts.

The paper says "damping ratio" and "settling time" without a definition, and leaves base parameters
open. So a claim is put to the model in several views (a measure, an assumption); the verdict
follows from how many of them it holds in, by one rule for all claims.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum


class Verdict(Enum):
    """What became of a claim."""

    HOLDS = "holds"
    UNDER_A_MEASURE = "holds under a stated measure"
    DOES_NOT_HOLD = "does not hold"
    UNDECIDED = "cannot be decided"


@dataclass(frozen=True, slots=True)
class View:
    """One way to put a claim to the model.

    Parameters
    ----------
    name : str
        The measure or assumption.
    holds : bool or None
        Whether the claim holds in it; ``None`` where the model gives no number.
    value : str
        The number that decides.
    """

    name: str
    holds: bool | None
    value: str


@dataclass(frozen=True, slots=True)
class Finding:
    """A claim of the paper, and what the model says of it.

    Parameters
    ----------
    claim : str
        Its name in the table of claims, such as ``S4``.
    figure : str
        Where the paper shows or says it.
    paper : str
        What the paper says, in short.
    views : sequence of View
        How it was put to the model.
    model : str
        What the model says.
    """

    claim: str
    figure: str
    paper: str
    views: Sequence[View]
    model: str

    @property
    def verdict(self) -> Verdict:
        """True in all views that the model has a number for, in some, in none, or no such view."""
        decided = [view.holds for view in self.views if view.holds is not None]
        if not decided:
            return Verdict.UNDECIDED
        if all(decided):
            return Verdict.HOLDS
        return Verdict.UNDER_A_MEASURE if any(decided) else Verdict.DOES_NOT_HOLD

    @property
    def share(self) -> str:
        """In how many of the views that the model has a number for it holds, as ``8 of 36``."""
        decided = [view.holds for view in self.views if view.holds is not None]
        return f"{sum(decided)} of {len(decided)}"

    @property
    def measures(self) -> str:
        """The views in which it holds, if that are some of them; else nothing."""
        if self.verdict is not Verdict.UNDER_A_MEASURE:
            return ""
        return "; ".join(view.name for view in self.views if view.holds)
