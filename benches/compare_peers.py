"""Sweeps of 1000 scenes: iva and the tools that a user would otherwise take, on one core.

Usage: compare_peers.py [--quick]

Prints for each of the grids of :mod:`sweep_peers.grid` the CPU seconds per 1000 scenes, their ratio
to those of iva with all measures, and how many of the scenes without chatter end with another
number of impacts than iva's. Under a force some motions are chaotic: they forget their start, and
no tool in doubles knows their number of impacts.

The rows of iva differ in the measures asked for; chatter is always included. Their column
"heyoka's over it" is the time of heyoka's fastest complete mode over that of the row; complete is a
mode that runs every scene to its end. The others count impacts and keep the last state.

Then a sweep under a recorded force, the speed-up by a second thread against that of an empty loop,
and the time of one call from Python. Needs the extra ``bench``.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from sweep_peers import recorded, with_heyoka, with_numba, with_scipy
from sweep_peers.grid import GRIDS, UNFINISHED, Grid

import iva

#: Slow tools run so many points, spread over the grid.
FEW = 20
ROUNDS = 5
PAIRS = 20

#: Takes a grid and the numbers of its points, and returns the impacts of each, in order. That of
#: iva always runs all points; its list is empty where it was not asked for impacts.
Sweep = Callable[[Grid, np.ndarray], list[int]]


@dataclass(frozen=True)
class Tool:
    """A way to run some of the grids, on all their points or on a few."""

    name: str
    sweep: Sweep
    grids: tuple[str, ...] = tuple(GRIDS)
    few: bool = False


def of_iva(*measures: str, tolerance: float | None = None) -> Sweep:
    """Return iva's sweep on one thread, with all measures unless some are named."""

    def sweep(grid: Grid, points: np.ndarray) -> list[int]:
        del points  # always the whole grid
        result = iva.sweep(
            **grid.scene(),
            over=grid.over,
            measures=measures or None,
            tolerance=tolerance,
            threads=1,
        )
        return result.summary["impacts"].drop_nulls().to_list()

    return sweep


#: The row that ratios and counts refer to.
BASE = "iva, all measures"

#: The scenes that SciPy runs too.
WITHOUT_SPRING = ("siva", "piva", "siva driven", "piva driven")

TOOLS = (
    Tool(BASE, of_iva()),
    Tool("iva, impacts", of_iva("impacts"), ("siva", "siva driven")),
    Tool("iva, settling_time_5", of_iva("settling_time_5"), ("siva",)),
    Tool("iva, amplitude_max", of_iva("amplitude_max"), ("siva driven",)),
    Tool("iva, fast, all measures", of_iva(tolerance=1e-9), ("siva", "siva driven")),
    Tool("iva, fast, impacts", of_iva("impacts", tolerance=1e-9), ("siva", "siva driven")),
    Tool("iva, fast, settling_time_5", of_iva("settling_time_5", tolerance=1e-9), ("siva",)),
    Tool("iva, fast, amplitude_max", of_iva("amplitude_max", tolerance=1e-9), ("siva driven",)),
    Tool("iva, all measures, tolerance 1e-9", of_iva(tolerance=1e-9), ("piva", "piva driven")),
    Tool("iva, impacts, pendulum", of_iva("impacts"), ("piva", "piva spring")),
    Tool("heyoka batch of 8, 1e-9", with_heyoka.batch(1e-9, 8)),
    Tool("heyoka batch of 4, 1e-16", with_heyoka.batch(1e-16, 4)),
    Tool("heyoka one by one, 1e-9", with_heyoka.scalar(1e-9)),
    Tool("heyoka one by one, 1e-16", with_heyoka.scalar(1e-16)),
    Tool("numba, closed form each 0.05", with_numba.sweep, ("siva", "siva driven")),
    Tool("SciPy DOP853 1e-9", with_scipy.sweep, WITHOUT_SPRING, few=True),
)


@dataclass
class Trial:
    """What a tool took, in CPU seconds per 1000 scenes, and found on its points of a grid."""

    tool: Tool
    points: np.ndarray
    times: list[float] = field(default_factory=list)
    counts: np.ndarray = field(default_factory=lambda: np.empty(0, int))

    def run(self, grid: Grid) -> None:
        """Run the points once more."""
        begin = time.process_time()
        counts = self.tool.sweep(grid, self.points)
        self.times.append(1000 * (time.process_time() - begin) / len(self.points))
        self.counts = np.array(counts)

    def seconds(self) -> float:
        """Return the median of the times."""
        return statistics.median(self.times)

    def complete(self) -> bool:
        """Return whether every scene was run to its end."""
        return not self.tool.few and bool((self.counts != UNFINISHED).all())

    def others(self, truth: np.ndarray, judged: np.ndarray) -> str:
        """Say how many of the judged scenes have another number of impacts than the true one."""
        if not len(self.counts):
            return "–"
        chosen = judged[self.points]
        wrong = (self.counts != truth[self.points])[chosen].sum()
        return f"{wrong} of {chosen.sum()}"


def compare(name: str, rounds: int) -> list[Trial]:
    """Run all tools of a grid in turns."""
    grid = GRIDS[name]
    everything = np.arange(len(grid))
    spread = np.linspace(0, len(grid) - 1, FEW).astype(int)
    trials = [
        Trial(tool, spread if tool.few else everything) for tool in TOOLS if name in tool.grids
    ]
    for turn in range(rounds):
        for trial in trials:
            if turn == 0:
                trial.tool.sweep(grid, everything[:8])  # compiles
            if turn == 0 or not trial.tool.few:
                trial.run(grid)
    return trials


def table(name: str, trials: list[Trial]) -> Iterator[str]:
    """Yield the lines of the table of a grid."""
    grid = GRIDS[name]
    base = next(trial for trial in trials if trial.tool.name == BASE)
    heyoka = min(
        (trial for trial in trials if trial.tool.name.startswith("heyoka") and trial.complete()),
        key=Trial.seconds,
        default=None,
    )
    columns = ("CPU s per 1000", "over iva", "heyoka's over it", "other counts")
    yield f"| {name}, {len(grid)} scenes | {' | '.join(columns)} |"
    yield "|---|--:|--:|--:|--:|"
    for trial in trials:
        spent = trial.seconds()
        gain = "–"
        if heyoka is not None and trial.tool.name.startswith("iva"):
            gain = f"{heyoka.seconds() / spent:.2f}"
        others = trial.others(base.counts, ~grid.chatters())
        ratio = spent / base.seconds()
        yield f"| {trial.tool.name} | {spent:.4f} | {ratio:.2f} | {gain} | {others} |"
    fastest = "none" if heyoka is None else heyoka.tool.name.removeprefix("heyoka ")
    yield ""
    yield f"heyoka's fastest complete mode: {fastest}."


def wall(work: Callable[[], object]) -> float:
    """Return the wall time of some work."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def threads(pairs: int) -> str:
    """Compare the speed-up of a sweep by a second thread with that of an empty compiled loop."""
    grid = GRIDS["siva"]
    over = {**grid.over, "mass_ratio": np.linspace(0.02, 0.2, 100)}
    scene = grid.scene()

    def gain(one: Callable[[], object], two: Callable[[], object]) -> float:
        return wall(one) / wall(two)

    def sweep(count: int) -> Callable[[], object]:
        return lambda: iva.sweep(**scene, over=over, threads=count)

    loop = with_numba.empty_loop
    loop(1)
    with ThreadPoolExecutor(2) as pool:

        def both() -> object:
            return list(pool.map(loop, [LOOPS, LOOPS]))

        def one_after_the_other() -> object:
            return [loop(LOOPS), loop(LOOPS)]

        found = []
        for _ in range(pairs):
            found.append((gain(sweep(1), sweep(2)), gain(one_after_the_other, both)))
    ratio = statistics.median(ours / empty for ours, empty in found)
    ours, empty = (statistics.median(column) for column in zip(*found, strict=True))
    return (
        f"A second thread makes a sweep {ours:.2f} times and two empty loops {empty:.2f} times as "
        f"fast; the ratio is {ratio:.3f}, the median of {pairs} pairs in turns."
    )


#: Rounds of an empty loop, a tenth of a second.
LOOPS = 300_000_000


def call() -> str:
    """Time one call from Python."""
    primary = iva.Primary(damping_ratio=0.01)
    absorber = iva.Siva(mass_ratio=0.15, clearance=0.6, restitution=0.5)
    start = iva.Start(displacement=1.0)

    def once() -> object:
        return iva.simulate(
            primary=primary,
            absorber=absorber,
            start=start,
            periods=30,
            tables=("impacts", "summary"),
        )

    once()
    times = [wall(once) for _ in range(2000)]
    median = 1e6 * statistics.median(times)
    return f"A call of iva.simulate, 30 periods, impacts and summary: {median:.0f} µs."


def frame() -> str:
    """Time a sweep of one point that lasts a tenth of a period, with its summary."""
    scene = GRIDS["siva"].scene() | {"duration": 0.6}
    over = {"mass_ratio": [0.1]}

    def once() -> object:
        return iva.sweep(**scene, over=over, measures=("impacts",), threads=1).summary

    once()
    median = 1e6 * statistics.median(wall(once) for _ in range(2000))
    return f"A call of iva.sweep with one point of no work, and its summary: {median:.0f} µs."


def conversion() -> str:
    """Time what makes a polars frame of a table: it changes hands without a copy."""
    results = [
        iva.sweep(
            primary=iva.Primary(damping_ratio=0.01),
            absorber=iva.Siva(mass_ratio=0.1, clearance=0.6, restitution=0.5),
            start=iva.Start(displacement=1.0),
            periods=1,
            over={"mass_ratio": np.linspace(0.02, 0.2, 100_000)},
        )
        for _ in range(10)
    ]
    times = [wall(lambda result=result: result.summary) for result in results]  # type: ignore[misc]
    rows, median = results[0].summary.height, 1e6 * statistics.median(times)
    return f"A summary of {rows:,} rows becomes a polars frame in {median:.0f} µs."


def main() -> None:
    """Print everything."""
    quick = "--quick" in sys.argv[1:]
    for name in GRIDS:
        for line in table(name, compare(name, 1 if quick else ROUNDS)):
            print(line, flush=True)
        print()
    print(recorded.table(1 if quick else ROUNDS))
    print()
    print(threads(2 if quick else PAIRS))
    print(call())
    print(frame())
    print(conversion())


if __name__ == "__main__":
    main()
