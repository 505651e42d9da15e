"""Sweeps of 1000 scenes: iva and the tools that a user would otherwise take, on one core.

Usage: compare_peers.py [--quick]

Prints CPU seconds per 1000 scenes of 30 periods over mass ratio, clearance and restitution, the
ratio to iva's, and how many of the scenes without chatter end with another number of impacts than
iva's. iva computes its summary with all measures, chatter included; the others count impacts and
keep the last state. Then the speed-up by a second thread against that of an empty loop, and the
time of one call from Python. Needs the extra ``bench``.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from sweep_peers import with_heyoka, with_numba, with_scipy
from sweep_peers.grid import GRIDS, Grid

import iva

#: Slow tools run so many points, spread over the grid.
FEW = 20
ROUNDS = 5
PAIRS = 20

#: The impacts of each point, in order.
Sweep = Callable[[Grid, np.ndarray], list[int]]


@dataclass(frozen=True)
class Tool:
    """A way to run a grid, on all its points or on a few."""

    name: str
    sweep: Sweep
    kinds: tuple[str, ...] = ("siva", "piva")
    few: bool = False


def of_iva(tolerance: float) -> Sweep:
    """Return iva's sweep, on one thread."""

    def sweep(grid: Grid, points: np.ndarray) -> list[int]:
        del points  # always the whole grid
        result = iva.sweep(**grid.scene(tolerance), over=grid.over(), threads=1)
        return result.summary["impacts"].to_list()

    return sweep


TOOLS = (
    Tool("iva", of_iva(0.0)),
    Tool("iva, tolerance 1e-9", of_iva(1e-9), ("piva",)),
    Tool("heyoka batch of 8, 1e-9", with_heyoka.batch(1e-9, 8)),
    Tool("heyoka batch of 4, 1e-16", with_heyoka.batch(1e-16, 4)),
    Tool("heyoka one by one, 1e-9", with_heyoka.scalar(1e-9)),
    Tool("heyoka one by one, 1e-16", with_heyoka.scalar(1e-16)),
    Tool("numba, closed form each 0.05", with_numba.sweep, ("siva",)),
    Tool("SciPy DOP853 1e-9", with_scipy.sweep, few=True),
)


def seconds(work: Callable[[], object]) -> float:
    """Return the CPU time of some work."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def compare(grid: Grid, rounds: int) -> Iterator[str]:
    """Run all tools in turns and yield the lines of a table."""
    tools = [tool for tool in TOOLS if grid.kind in tool.kinds]
    everything = np.arange(len(grid))
    points = {
        tool.name: everything[:: len(grid) // FEW] if tool.few else everything for tool in tools
    }
    times: dict[str, list[float]] = {tool.name: [] for tool in tools}
    counts: dict[str, list[int]] = {}
    for turn in range(rounds):
        for tool in tools:
            if tool.few and turn > 0:
                continue
            if turn == 0:
                tool.sweep(grid, everything[:8])  # compiles
            chosen = points[tool.name]
            spent = seconds(lambda: counts.update({tool.name: tool.sweep(grid, chosen)}))  # noqa: B023
            of_thousand = len(grid) if tool.name.startswith("iva") else len(chosen)
            times[tool.name].append(1000 * spent / of_thousand)
    truth = np.array(counts["iva"])
    chatters = grid.chatters()
    base = statistics.median(times["iva"])
    yield f"| {grid.kind}, {len(grid)} scenes | CPU s per 1000 | over iva | other counts |"
    yield "|---|--:|--:|--:|"
    for tool in tools:
        spent = statistics.median(times[tool.name])
        chosen = points[tool.name]
        judged = chosen[~chatters[chosen]]
        found = np.array(counts[tool.name])[~chatters[chosen]]
        wrong = int((found != truth[judged]).sum())
        yield f"| {tool.name} | {spent:.4f} | {spent / base:.1f} | {wrong} of {len(judged)} |"


def wall(work: Callable[[], object]) -> float:
    """Return the wall time of some work."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def threads(pairs: int) -> str:
    """Compare the speed-up of a sweep by a second thread with that of an empty compiled loop."""
    grid = GRIDS["siva"]
    over = {**grid.over(), "mass_ratio": np.linspace(0.02, 0.2, 100)}
    scene = grid.scene(0.0)

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
    for grid in GRIDS.values():
        for line in compare(grid, 1 if quick else ROUNDS):
            print(line, flush=True)
        print()
    print(threads(2 if quick else PAIRS))
    print(call())
    print(conversion())


if __name__ == "__main__":
    main()
