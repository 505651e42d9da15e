"""Error against run time, a panel a scene."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from work_precision.runs import Row

mpl.use("Agg")

#: Series (the setting without its last word) to colour and marker.
STYLES = {
    "iva": ("#000000", "*"),
    "heyoka": ("#d62728", "o"),
    "numba closed": ("#17a05d", "D"),
    "numba rk4": ("#8fce6a", "D"),
    "diffsol tsit45": ("#9467bd", "s"),
    "diffsol bdf": ("#c9b3e0", "s"),
    "SciPy DOP853": ("#1f77b4", "^"),
    "SciPy RK45": ("#7fb8e0", "^"),
    "SciPy LSODA": ("#17becf", "v"),
    "CVODE Adams": ("#ff7f0e", "P"),
    "CVODE BDF": ("#ffc182", "P"),
}
LIMITED = " max_step=0.1"
#: Errors below this are drawn here.
LEAST = {"units": 1e-2, "final": 1e-17}


def series(row: Row) -> tuple[str, bool]:
    """Return the series of a row, and whether its steps were limited."""
    words = row.setting.split()
    name = f"{row.tool} {words[0]}" if len(words) > 1 else row.tool
    return name, row.setting.endswith(LIMITED)


def height(row: Row, measure: str) -> float | None:
    """Return the error to draw."""
    if measure == "final":
        value = row.errors.final
    else:
        value = row.errors.units[0] if row.errors.units else None
    return None if value is None else max(value, LEAST[measure])


def draw(axes: Axes, rows: list[Row], measure: str) -> None:
    """Draw a scene: filled where all events were found, hollow where not."""
    lines: dict[tuple[str, bool], list[Row]] = {}
    for row in rows:
        lines.setdefault(series(row), []).append(row)
    for (name, limited), members in lines.items():
        colour, marker = STYLES[name]
        points = [(r.median, y, r) for r in members if (y := height(r, measure)) is not None]
        if not points:
            continue
        front = 4 if name == "iva" else 3
        axes.plot(
            [x for x, _, _ in points],
            [y for _, y, _ in points],
            color=colour,
            linewidth=1,
            linestyle=":" if limited else "-",
            zorder=2,
        )
        for x, y, row in points:
            size = (150 if name == "iva" else 38) * (0.55 if limited else 1)
            face = colour if row.errors.complete else "white"
            axes.scatter(x, y, size, face, marker, edgecolors=colour, linewidths=1.2, zorder=front)
            if row.bare:
                axes.scatter(row.bare, y, 60, "#888888", "*", linewidths=0, zorder=front)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(which="major", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_title(rows[0].scene, fontsize=10, family="monospace")


def legend(present: set[str]) -> list[Line2D]:
    """Return what the marks stand for, of the series that are there."""
    names = [name for name in STYLES if name in present]
    marks = [
        Line2D([], [], color=colour, marker=marker, markersize=size, label=name)
        for name in names
        for (colour, marker), size in [(STYLES[name], 12 if name == "iva" else 6)]
    ]
    grey = Line2D([], [], color="#888888", marker="*", markersize=8, linestyle="")
    grey.set_label("iva, without Python")
    dotted = Line2D([], [], color="#555555", linestyle=":", marker="^", markersize=4)
    dotted.set_label("SciPy, max_step=0.1")
    hollow = Line2D([], [], color="#555555", marker="o", markerfacecolor="white", linestyle="")
    hollow.set_label("events missed or invented")
    return [*marks[:1], grey, *marks[1:], dotted, hollow]


def picture(group: str, scenes: dict[str, list[Row]], folder: Path) -> Path:
    """Draw a group of scenes and return the file."""
    measure = "final" if group == "grazing" else "units"
    columns = 3 if len(scenes) == 3 else 2
    lines = -(-len(scenes) // columns)
    figure = Figure(figsize=(5 * columns, 3.6 * lines + 1.3), layout="constrained")
    grid = figure.subplots(lines, columns, squeeze=False)
    for axes, rows in zip(grid.flat, scenes.values(), strict=False):
        draw(axes, rows, measure)
    for axes in list(grid.flat)[len(scenes) :]:
        axes.set_visible(False)
    label = "largest error / rounding units" if measure == "units" else "error of the final state"
    for row in grid:
        row[0].set_ylabel(label)
    for axes in list(grid.flat)[max(0, len(scenes) - columns) : len(scenes)]:
        axes.set_xlabel("run time / s")
    present = {series(row)[0] for rows in scenes.values() for row in rows}
    figure.legend(
        handles=legend(present), loc="outside lower center", ncols=5, fontsize=8, frameon=False
    )
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"work_precision_{group}.png"
    figure.savefig(path, dpi=110, metadata={"Software": None})
    return path
