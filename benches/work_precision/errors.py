"""How far a run is from the reference."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from decimal import Decimal

from work_precision.flights import STICK
from work_precision.results import Event, Motion
from work_precision.scenes import Expected, Scene

#: Farther apart than this in τ two events are not the same.
WINDOW = 1e-2
#: |y| over d beyond which the absorber has left the gap.
OUTSIDE = 1 + 1e-9


@dataclass(frozen=True, slots=True)
class Errors:
    """Events missed and invented, and the errors of those found.

    `units` and `times` are largest and median over the matched impacts and releases, in rounding
    units |Δτ| / (2⁻⁵³ (max(condition, 1) + τ)) and in τ; None where nothing was matched. Sticks
    are not among them: all tools but iva only estimate their time, by the rule of :mod:`.flights`.
    `final` is the largest error of x, ẋ, y, w at the end, None where the run did not get there.
    """

    matched: int
    missed: int
    false: int
    units: tuple[float, float] | None
    times: tuple[float, float] | None
    final: float | None
    left_the_gap: bool

    @property
    def complete(self) -> bool:
        """Whether every event was found, none invented, and the end reached inside the gap."""
        return not (self.missed or self.false or self.left_the_gap or self.final is None)


def compare(scene: Scene, motion: Motion) -> Errors:
    """Match events in their order, each kind and wall for itself.

    Impacts of an approach at or below ``STICK`` need not be found and are no mistake: where a
    chatter is cut off is a matter of the tool.
    """
    pairs: list[tuple[Expected, Event]] = []
    missed = false = 0
    for kind, wall in ((k, w) for k in ("impact", "stick", "release") for w in (1, -1)):
        expected = [e for e in scene.events if (e.kind, e.wall) == (kind, wall)]
        found = [e for e in motion.events if (e.kind, e.wall) == (kind, wall)]
        i = j = 0
        while i < len(expected) or j < len(found):
            apart = (
                float(Decimal(found[j].time) - expected[i].time)
                if i < len(expected) and j < len(found)
                else (-1.0 if j < len(found) else 1.0)
            )
            if i < len(expected) and j < len(found) and abs(apart) <= WINDOW:
                if counts(expected[i]):
                    pairs.append((expected[i], found[j]))
                i, j = i + 1, j + 1
            elif apart > 0:
                missed += counts(expected[i])
                i += 1
            else:
                false += counts(found[j])
                j += 1
    judged = [(wanted, event) for wanted, event in pairs if wanted.kind != "stick"]
    times = [abs(float(Decimal(event.time) - wanted.time)) for wanted, event in judged]
    units = [
        time / (2**-53 * (max(wanted.condition, 1) + float(wanted.time)))
        for time, (wanted, _) in zip(times, judged, strict=True)
    ]
    final = None
    if motion.final is not None:
        both = zip(motion.final, scene.final, strict=True)
        final = max(abs(float(Decimal(value) - wanted)) for value, wanted in both)
    return Errors(
        matched=len(pairs),
        missed=missed,
        false=false,
        units=(max(units), statistics.median(units)) if units else None,
        times=(max(times), statistics.median(times)) if times else None,
        final=final,
        left_the_gap=motion.largest_gap > OUTSIDE,
    )


def counts(event: Expected | Event) -> bool:
    """Return whether an event has to be found."""
    return event.kind != "impact" or event.approach > STICK
