"""The grids: free decays of 30 periods, and 60 periods under a harmonic force; M = ωn = 1."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np

import iva

#: Stands for the impacts of a run that stopped before its end.
UNFINISHED = -1


class Point(NamedTuple):
    """What can differ from scene to scene."""

    mass_ratio: float
    clearance: float
    restitution: float
    frequency: float


@dataclass(frozen=True, eq=False)
class Grid:
    """The scenes over three axes, and what all of them have in common.

    The `amplitude` is that of a harmonic force on the structure; without one it is a free decay.
    A free mass has neither `frequency_ratio` nor `length` nor `spring_ratio`.
    """

    over: dict[str, np.ndarray]
    damping_ratio: float
    displacement: float
    end: float
    amplitude: float = 0.0
    frequency_ratio: float = 0.0
    length: float = 0.0
    spring_ratio: float = 0.0

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.points())

    @lru_cache  # noqa: B019 - there are few grids
    def points(self) -> list[Point]:
        """Return all points, the last axis fastest; the mass ratio is 0.1 where no axis says it."""
        found = []
        for values in product(*self.over.values()):
            point = dict(zip(self.over, map(float, values), strict=True))
            found.append(
                Point(
                    point.get("mass_ratio", 0.1),
                    point["clearance"],
                    point["restitution"],
                    point.get("force.frequency", 1.0),
                )
            )
        return found

    def scene(self) -> dict[str, Any]:
        """Return what all points have in common, as arguments of :func:`iva.sweep`."""
        first = self.points()[0]
        absorber: dict[str, Any] = first._asdict()
        frequency = absorber.pop("frequency")
        names = ("frequency_ratio", "length", "spring_ratio")
        pendulum: dict[str, Any] = {name: getattr(self, name) for name in names}
        force = iva.Harmonic(amplitude=self.amplitude, frequency=frequency)
        return {
            "primary": iva.Primary(damping_ratio=self.damping_ratio),
            "absorber": iva.Piva(**absorber, **pendulum) if self.length else iva.Siva(**absorber),
            "start": iva.Start(displacement=self.displacement),
            "force": force if self.amplitude else None,
            "duration": self.end,
            "tables": ("summary",),
        }

    @lru_cache  # noqa: B019 - there are few grids
    def chatters(self) -> np.ndarray:
        """Return which points have a chatter that ends in stick: others cannot run these."""
        result = iva.sweep(**self.scene(), over=self.over)
        return result.summary["episodes"].to_numpy() > 0


def decays(clearances: tuple[float, float], **pendulum: float) -> Grid:
    """Return 1000 free decays over mass ratio, clearance and restitution."""
    over = {
        "mass_ratio": np.linspace(0.02, 0.2, 10),
        "clearance": np.linspace(*clearances, 10),
        "restitution": np.linspace(0.4, 0.85, 10),
    }
    return Grid(over, damping_ratio=0.01, displacement=1.0, end=60 * math.pi, **pendulum)


def driven(
    clearances: tuple[float, float],
    amplitude: float,
    restitutions: int = 10,
    frequencies: int = 10,
    **pendulum: float,
) -> Grid:
    """Return scenes under a force near resonance over 10 clearances, restitution and frequency."""
    over = {
        "clearance": np.linspace(*clearances, 10),
        "restitution": np.linspace(0.4, 0.85, restitutions),
        "force.frequency": np.linspace(0.85, 1.15, frequencies),
    }
    common = {"damping_ratio": 0.02, "displacement": 0.5, "end": 120 * math.pi}
    return Grid(over, **common, amplitude=amplitude, **pendulum)


GRIDS = {
    "siva": decays((0.4, 1.3)),
    "piva": decays((0.6, 1.95), frequency_ratio=0.4, length=10.0),
    "piva spring": decays((0.6, 1.95), frequency_ratio=0.3, length=3.0, spring_ratio=0.4),
    "siva driven": driven((0.5, 1.4), 0.1),
    "piva driven": driven((0.6, 1.95), 0.03, 4, 5, frequency_ratio=0.4, length=10.0),
}
