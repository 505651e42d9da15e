"""How far an identification is."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from iva.progress import Report

#: What a stage that has ended is told to.
Tell: TypeAlias = Callable[[int], None]
#: The stages: the record is looked at, its impacts are found, the absorber is sampled, all is told.
LOOKED, FOUND, SAMPLED, STAGES = 1, 2, 3, 4
#: Why a fit is not adequate that was interrupted after the first impacts had been found.
INTERRUPTED = "interrupted: these are the numbers that fit best so far, their intervals are rough"


def telling(report: Report | None) -> Tell:
    """Return what tells a report, if there is one, how many stages have ended."""

    def tell(done: int) -> None:
        if report is not None:
            report(done, STAGES, 0)

    return tell


__all__ = ["FOUND", "INTERRUPTED", "LOOKED", "SAMPLED", "STAGES", "Tell", "telling"]
