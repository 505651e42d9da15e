"""What every tool returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

from work_precision.scenes import Scene

FINISHED = "finished"


@dataclass(frozen=True, slots=True)
class Event:
    """An impact, a stick or a release.

    `approach` is the gap velocity just before an impact, in size; 0 for the other two.
    """

    kind: str
    time: float
    wall: int
    approach: float


@dataclass(slots=True)
class Motion:
    """One run: events in order, state (x, ẋ, y, w) at the end, run time and how it ended.

    `largest_gap` is the largest |y| over d among all sampled states, 0 where none was sampled.
    """

    events: list[Event] = field(default_factory=list)
    final: tuple[float, float, float, float] | None = None
    seconds: float = 0.0
    outcome: str = FINISHED
    largest_gap: float = 0.0


class Tool(Protocol):
    """A module of this package that stands for a tool."""

    SETTINGS: Sequence[str]

    @staticmethod
    def solve(scene: Scene, setting: str, spacing: float | None = None) -> Motion:
        """Run a scene.

        Parameters
        ----------
        scene : Scene
            What to run.
        setting : str
            One of ``SETTINGS``: method and tolerance or step, separated by blanks.
        spacing : float, optional
            Sample the gap displacement at least so densely in τ. Such a run is not timed.

        Returns
        -------
        Motion
            ``seconds`` covers the simulation alone: neither compilation nor the translation of
            the result into events.
        """
        ...
