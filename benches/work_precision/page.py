"""The tables of ``docs/work-precision.md``."""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from work_precision.runs import Row

#: Rounding units up to which a run is as accurate as double precision allows.
CLOSE = 10
BEGIN, END = "<!-- begin of what the benchmark writes -->", "<!-- end -->"
PACKAGES = {
    "iva": "iva-dynamics",
    "heyoka": "heyoka",
    "numba": "numba",
    "diffsol": "pydiffsol",
    "SciPy": "scipy",
    "CVODE": "scikit-sundae",
}
#: Columns of the table by scene: series to title.
COLUMNS = {
    "heyoka": "heyoka",
    "numba closed": "numba closed",
    "numba rk4": "numba rk4",
    "diffsol": "diffsol",
    "SciPy": "SciPy",
    "CVODE": "CVODE",
}


def machine() -> str:
    """Name the processor and its cores."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = names[0].partition(":")[2].strip() if names else model
    return (
        f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"
    )


def seconds(value: float) -> str:
    """Write a time with two or three digits."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if value >= size or unit == "µs":
            break
    digits = f"{value / size:.2g}" if value < 99.5 * size else f"{value / size:.0f}"
    return f"{digits} {unit}"


def small(value: float | None) -> str:
    """Write an error or a ratio with one or two digits."""
    if value is None:
        return "–"
    if 10 <= value < 1000:
        return f"{value:.0f}"
    return f"{value:.1f}" if 0.05 <= value < 10 else "0" if value == 0 else f"{value:.0e}"


def error_of(row: Row) -> float:
    """Return the largest error for ranking: rounding units, else the final state in 2⁻⁵³."""
    if row.errors.units:
        return row.errors.units[0]
    return math.inf if row.errors.final is None else row.errors.final / 2**-53


def best(rows: list[Row]) -> Row | None:
    """Return the most accurate complete row."""
    return min((row for row in rows if row.errors.complete), key=error_of, default=None)


def by_scene(scenes: dict[str, list[Row]]) -> list[str]:
    """Return the table of the most accurate complete run of every tool."""
    lines = [
        f"| scene | events | iva | iva without Python | {' | '.join(COLUMNS.values())} |",
        "|---|--:|--:|--:|" + "--:|" * len(COLUMNS),
    ]
    for name, rows in scenes.items():
        own = next(row for row in rows if row.name == "iva 0")
        cells = [name, str(own.errors.matched + own.errors.missed), cell(own)]
        cells.append("–" if own.bare is None else seconds(own.bare))
        for start in COLUMNS:
            members = [row for row in rows if row.name.startswith(f"{start} ")]
            if not members:
                cells.append("")
                continue
            row = best(members)
            cells.append(cell(row) if row else "none complete")
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def cell(row: Row) -> str:
    """Return error and run time."""
    lost = "" if row.errors.complete else " (incomplete)"
    return f"{small(error_of(row))}; {seconds(row.median)}{lost}"


def by_setting(scenes: dict[str, list[Row]]) -> list[str]:
    """Return the table of all settings over all their scenes."""
    lines = [
        "| tool and setting | scenes complete | missed | invented | left the gap | not finished "
        "| worst units | median units | worst Δτ | median Δτ | time / iva | set-up |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    base = {
        name: next(row.median for row in rows if row.name == "iva 0")
        for name, rows in scenes.items()
    }
    every: dict[str, list[Row]] = {}
    for row in (row for rows in scenes.values() for row in rows):
        every.setdefault(row.name, []).append(row)
    order = list(PACKAGES)
    for name, rows in sorted(every.items(), key=lambda pair: order.index(pair[1][0].tool)):
        found = [row.errors for row in rows if row.errors.units and row.errors.times]
        middle = sorted(errors.units[1] for errors in found if errors.units)
        middle_times = sorted(errors.times[1] for errors in found if errors.times)
        ratio = sum(math.log(row.median / base[row.scene]) for row in rows) / len(rows)
        cells = [
            f"{sum(row.errors.complete for row in rows)} of {len(rows)}",
            sum(row.errors.missed for row in rows),
            sum(row.errors.false for row in rows),
            sum(row.errors.left_the_gap for row in rows),
            sum(row.errors.final is None for row in rows),
            small(max(errors.units[0] for errors in found if errors.units)),
            small(middle[len(middle) // 2]),
            f"{max(errors.times[0] for errors in found if errors.times):.0e}",
            f"{middle_times[len(middle_times) // 2]:.0e}",
            small(math.exp(ratio)),
            seconds(max(row.set_up for row in rows)),
        ]
        lines.append(f"| {name} | {' | '.join(str(value) for value in cells)} |")
    return lines


def not_first(scenes: dict[str, list[Row]]) -> list[str]:
    """Return where a complete run of another tool is more accurate or faster than iva 0."""
    lines = [
        "| scene | more accurate than iva | faster than `iva.simulate` "
        "| faster than iva without Python | faster than `iva.simulate`, less accurate |",
        "|---|---|---|---|---|",
    ]
    for name, rows in scenes.items():
        own = next(row for row in rows if row.name == "iva 0")
        others = [row for row in rows if row.errors.complete and row.tool != "iva"]
        better = [row for row in others if error_of(row) < error_of(own)]
        good = [row for row in others if error_of(row) <= CLOSE]
        rest = [row for row in others if error_of(row) > CLOSE]
        cells = [
            leaders(better, key=error_of),
            leaders([row for row in good if row.median < own.median]),
            leaders([row for row in good if row.median < (own.bare or 0.0)]),
            leaders([row for row in rest if row.median < own.median]),
        ]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return lines


def leaders(rows: list[Row], key: Callable[[Row], float] = lambda row: row.median) -> str:
    """Write the best run of every tool."""
    first: dict[str, Row] = {}
    for row in sorted(rows, key=key):
        first.setdefault(row.tool, row)
    return "; ".join(f"{row.name}: {cell(row)}" for row in first.values()) or "–"


def write(
    page: Path,
    scenes: dict[str, list[Row]],
    pictures: dict[str, Path],
    load: tuple[float, float],
) -> None:
    """Put tables and pictures between the two marks of the page.

    Raises
    ------
    ValueError
        If the page has not got the marks.
    """
    text = page.read_text()
    if BEGIN not in text or END not in text:
        raise ValueError(f"{page} has no marks {BEGIN!r} and {END!r}")
    present = {row.tool for rows in scenes.values() for row in rows}
    packages = ", ".join(f"{PACKAGES[t]} {version(PACKAGES[t])}" for t in PACKAGES if t in present)
    lines = [
        f"Machine: {machine()}; load {load[0]:.1f} at the begin, {load[1]:.1f} at the end (this "
        "benchmark alone makes 1.0).",
        f"Packages: {packages}.",
        "",
        "### Scene by scene",
        "",
        "Largest error in rounding units and median run time, of each tool at the setting that is "
        "most accurate with no event missed, none invented and the gap never left. Without events "
        "the error is that of the final state, in 2⁻⁵³.",
        "",
        *by_scene(scenes),
        "",
        "### Where iva is not first",
        "",
        "Against iva at tolerance 0, of each tool the best of its complete runs: error; run time. "
        f"“Faster” is among the runs that are good to {CLOSE} units, the last column among the "
        "others.",
        "",
        *not_first(scenes),
        "",
        "### Setting by setting",
        "",
        "Sums over all scenes; time over that of `iva.simulate` at tolerance 0 is a geometric "
        "mean. “Worst” and “median” are over matched events: a run that is lost has few of them. "
        "Set-up is what the first call took longer, at most; a compilation that settings share "
        "is with the first of them.",
        "",
        *by_setting(scenes),
        "",
        "### Pictures",
        "",
        *(f"![{group}]({path.relative_to(page.parent)})" for group, path in pictures.items()),
    ]
    before, _, rest = text.partition(BEGIN)
    after = rest.partition(END)[2]
    page.write_text("\n".join([f"{before}{BEGIN}", "", *lines, "", f"{END}{after}"]))
