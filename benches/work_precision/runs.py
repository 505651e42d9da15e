"""Every tool on every scene: errors once, run times in rounds over all tools."""

from __future__ import annotations

import statistics
import sys
import time
from dataclasses import dataclass, field
from importlib import import_module
from types import ModuleType

from work_precision.errors import Errors, compare
from work_precision.results import Motion
from work_precision.scenes import Scene

#: Modules of this package, in the order of the tables.
TOOLS = {
    "iva": "with_iva",
    "heyoka": "with_heyoka",
    "numba": "with_numba",
    "diffsol": "with_diffsol",
    "SciPy": "with_scipy",
    "CVODE": "with_sundae",
}
SPACING = 0.01
ROUNDS = 5
#: A run shorter than this is repeated in each round.
SHORT, REPEATS = 0.01, 5


@dataclass(slots=True)
class Row:
    """A tool with one setting on one scene.

    `first` is the wall time of the first call in s, compilation and all; `bare` the run time
    without Python (iva only).
    """

    scene: str
    tool: str
    setting: str
    errors: Errors
    outcome: str
    first: float
    seconds: list[float] = field(default_factory=list)
    bare: float | None = None

    @property
    def median(self) -> float:
        """Median run time in s."""
        return statistics.median(self.seconds)

    @property
    def set_up(self) -> float:
        """What the first call took longer, in s."""
        return max(self.first - self.median, 0.0)

    @property
    def name(self) -> str:
        """Tool and setting."""
        return f"{self.tool} {self.setting}"


def tools() -> dict[str, ModuleType]:
    """Import the tools that are installed."""
    found = {}
    for name, module in TOOLS.items():
        try:
            found[name] = import_module(f"work_precision.{module}")
        except ImportError as error:
            print(f"{name} is left out: {error}", file=sys.stderr)
    return found


def settings(module: ModuleType, scene: Scene) -> tuple[str, ...]:
    """Return the settings of a tool that apply to a scene."""
    return module.settings(scene) if hasattr(module, "settings") else module.SETTINGS


def attempt(module: ModuleType, scene: Scene, setting: str, spacing: float | None) -> Motion:
    """Run a scene; what a tool raises is its outcome."""
    try:
        return module.solve(scene, setting, spacing)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a panic of compiled code is no Exception
        return Motion(outcome=f"{type(error).__name__}: {error}"[:120])


def measure(scene: Scene, available: dict[str, ModuleType], quick: bool) -> list[Row]:
    """Run all tools on a scene."""
    rows, work = [], []
    for tool, module in available.items():
        chosen = settings(module, scene)
        for setting in (chosen[0], chosen[-1]) if quick and len(chosen) > 1 else chosen:
            begin = time.perf_counter()
            motion = attempt(module, scene, setting, None)
            first = time.perf_counter() - begin
            motion.largest_gap = attempt(module, scene, setting, SPACING).largest_gap
            row = Row(scene.name, tool, setting, compare(scene, motion), motion.outcome, first)
            rows.append(row)
            work.append((row, module, attempt(module, scene, setting, None).seconds))
    for _ in range(1 if quick else ROUNDS):
        for row, module, seconds in work:
            for _ in range(REPEATS if seconds < SHORT else 1):
                row.seconds.append(attempt(module, scene, row.setting, None).seconds)
    for row, module, _ in work:
        if hasattr(module, "seconds_without_python"):
            row.bare = module.seconds_without_python(scene, row.setting)
    return rows
