"""The grids: free decays of 30 periods from a displacement of 1, ζ = 0.01."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

import iva

END = 60 * math.pi
DAMPING_RATIO = 0.01


@dataclass(frozen=True)
class Grid:
    """10 mass ratios × 10 clearances × 10 coefficients of restitution."""

    kind: str
    clearances: tuple[float, float]
    frequency_ratio: float = 0.0
    length: float = 0.0

    def over(self) -> dict[str, np.ndarray]:
        """Return the axes."""
        return {
            "mass_ratio": np.linspace(0.02, 0.2, 10),
            "clearance": np.linspace(*self.clearances, 10),
            "restitution": np.linspace(0.4, 0.85, 10),
        }

    def __len__(self) -> int:
        """Return the number of points."""
        return 1000

    @lru_cache  # noqa: B019 - there are two grids
    def points(self) -> list[tuple[float, float, float]]:
        """Return mass ratio, clearance and restitution of each point."""
        return [tuple(map(float, point)) for point in product(*self.over().values())]  # type: ignore[misc]

    def scene(self, tolerance: float) -> dict[str, Any]:
        """Return what all points have in common, as arguments of :func:`iva.sweep`."""
        mass, clearance, restitution = self.points()[0]
        common = {"mass_ratio": mass, "clearance": clearance, "restitution": restitution}
        pendulum = {"frequency_ratio": self.frequency_ratio, "length": self.length}
        absorber = iva.Piva(**common, **pendulum) if self.length else iva.Siva(**common)
        accuracy = {"tolerance": tolerance} if self.length else {}
        return {
            "primary": iva.Primary(damping_ratio=DAMPING_RATIO),
            "absorber": absorber,
            "start": iva.Start(displacement=1.0),
            "duration": END,
            "tables": ("summary",),
            **accuracy,
        }

    @lru_cache  # noqa: B019 - there are two grids
    def chatters(self) -> np.ndarray:
        """Return which points have a chatter that ends in stick: others cannot run these."""
        result = iva.sweep(**self.scene(0.0), over=self.over())
        return result.summary["episodes"].to_numpy() > 0


GRIDS = {
    "siva": Grid("siva", (0.4, 1.3)),
    "piva": Grid("piva", (0.6, 1.95), 0.4, 10.0),
}
