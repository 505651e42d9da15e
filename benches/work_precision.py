"""Accuracy against run time: iva and general integrators on the scenes of tests/reference.

Usage: work_precision.py [--quick] [--csv FILE] [--out FOLDER] [SCENE …]

Writes docs/work-precision.md (between its marks) and docs/pictures/work_precision_*.png; needs the
extra ``bench``. With --quick two settings a tool are run once, for a smoke test, and what is
written goes to a temporary folder. --out names another folder than docs.
"""

from __future__ import annotations

import argparse
import csv
import os
import shutil
import tempfile
from pathlib import Path

from work_precision.page import write
from work_precision.pictures import picture
from work_precision.runs import Row, measure, tools
from work_precision.scenes import GROUPS, scenes

DOCS = Path(__file__).parents[1] / "docs"
PAGE = "work-precision.md"


def save(rows: list[Row], path: Path) -> None:
    """Write every run as a line of CSV."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(
            "scene tool setting matched missed invented left_the_gap units_max units_median "
            "time_error_max time_error_median final_error seconds seconds_bare outcome".split()
        )
        for row in rows:
            errors = row.errors
            units, times = errors.units or ("", ""), errors.times or ("", "")
            found = (errors.matched, errors.missed, errors.false, errors.left_the_gap)
            ends = (errors.final, row.median, row.bare, row.outcome)
            writer.writerow([row.scene, row.tool, row.setting, *found, *units, *times, *ends])


def main() -> None:
    """Run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="two settings a tool, run once")
    parser.add_argument("--csv", type=Path, help="every run as a line")
    parser.add_argument("--out", type=Path, help="instead of docs")
    parser.add_argument("scene", nargs="*", help="all by default")
    arguments = parser.parse_args()
    every = scenes()
    if unknown := [name for name in arguments.scene if name not in every]:
        parser.error(f"no scene {unknown[0]!r}: one of {', '.join(every)}")
    partial = arguments.quick or arguments.scene
    out: Path = arguments.out or (Path(tempfile.mkdtemp()) if partial else DOCS)
    begin = os.getloadavg()[0]
    available = tools()
    found: dict[str, list[Row]] = {}
    for name in arguments.scene or every:
        found[name] = measure(every[name], available, arguments.quick)
        for row in found[name]:
            errors = row.errors
            units = f"{errors.units[0]:9.2e}" if errors.units else "        –"
            print(
                f"{name:24} {row.name:32} {units} units  {1e3 * row.median:9.3f} ms  missed "
                f"{errors.missed:3}  invented {errors.false:3}  {row.outcome}",
                flush=True,
            )
    pictures = {}
    for group, names in GROUPS.items():
        if chosen := {name: found[name] for name in names if name in found}:
            pictures[group] = picture(group, chosen, out / "pictures")
    if not (out / PAGE).exists():
        shutil.copy(DOCS / PAGE, out / PAGE)
    write(out / PAGE, found, pictures, (begin, os.getloadavg()[0]))
    if arguments.csv:
        save([row for rows in found.values() for row in rows], arguments.csv)
    print(f"written: {out / PAGE}")


if __name__ == "__main__":
    main()
