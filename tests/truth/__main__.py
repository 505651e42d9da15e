"""Print what `iva.dynamics` computes beside references to 30 digits: run by ``make truth``.

Each line has a quantity, how far the worst of its kind is from the reference, and how far it may
be. The exit code is 1 if one is farther.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

from attractors import attractors
from basins import basins
from branches import branches, curves
from exponents import exponents
from orbits import orbits
from pendulums import pendulums
from report import Report
from scenes import scenes
from speeds import speeds


def sections(count: int) -> dict[str, Callable[[Report], None]]:
    """Return the sections by their names, that of the random scenes with their number."""
    return {
        "orbits": orbits,
        "branches": branches,
        "curves": curves,
        "pendulums": pendulums,
        "exponents": exponents,
        "basins": basins,
        "attractors": attractors,
        "scenes": lambda report: scenes(report, count),
        "speeds": speeds,
    }


def main() -> int:
    """Print all, and return the exit code."""
    parser = argparse.ArgumentParser(description="Compare iva.dynamics with its references.")
    parser.add_argument("--only", choices=sections(0), action="append", help="only this section")
    parser.add_argument(
        "--scenes", type=int, default=10_000, metavar="N", help="number of random scenes"
    )
    given = parser.parse_args()
    report = Report()
    every = sections(given.scenes)
    for name in given.only or every:
        every[name](report)
    return 0 if report.well else 1


if __name__ == "__main__":
    sys.exit(main())
