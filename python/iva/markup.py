"""What notebooks show of results: small tables in HTML."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from iva.forces import Force, listed
from iva.parameters import Part
from iva.scene_lines import carried_along, with_frequency
from iva.scenes import absorbers
from iva.simulation import Run
from iva.structures import Structure
from iva.tables import Table
from iva.units import given_in_mm


def of_run(run: Run) -> str:
    """Return parameters, outcome and all measures of a run, with their units."""
    told = run.in_mm if given_in_mm(run._spec) else run
    row = told.summary.row(0, named=True)
    units = told.units["summary"]
    named: tuple[tuple[str, Part | Force | Structure | None], ...] = (
        *(("absorber", absorber) for absorber in absorbers(run.absorber)),
        ("primary", run.primary),
        *(("force", force) for force in listed(run.force)),
        ("start", run.start),
    )
    parts = [part for _, part in named]
    parameters = [
        (name, "none" if part is None else with_frequency(part, parts), "") for name, part in named
    ]
    parameters += [("", line, "") for line in carried_along(parts)]
    values = [
        (name, text(value), units[name])
        for name, value in row.items()
        if name not in ("point", "outcome") and value is not None
    ]
    return page(f"Run: {row['outcome']}", [*parameters, *values], run.units.sentence)


def of_table(table: Table) -> str:
    """Return axes, number of points, outcomes and tables of a sweep, with the units."""
    rows: list[tuple[str, str, str]] = []
    if "summary" in table.tables:
        summary = table.summary
        units = table.units["summary"]
        for key in table.swept:
            values = summary[key]
            ends = " … ".join(text(value) for value in (values.min(), values.max()))
            rows.append((key, f"{ends}, {values.n_unique()} values", units[key]))
        rows.append(("points", str(summary.height), "1"))
        counts = summary["outcome"].value_counts(sort=True)
        rows += [(f"outcome {name}", str(count), "1") for name, count in counts.iter_rows()]
    rows.append(("tables", ", ".join(table.tables), ""))
    over = " × ".join(table.swept) or "no axis"
    return page(f"Table over {over}", rows, table.units.sentence)


def text(value: object) -> str:
    """Return a value to six figures."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def page(title: str, rows: Iterable[tuple[str, str, str]], note: str) -> str:
    """Return a heading, a table of (name, value, unit) and a note; nothing in it is markup."""
    lines = "".join(
        f"<tr><th>{escape(name)}</th><td>{escape(value)}</td>"
        f"<td>{escape('' if unit == '1' else unit)}</td></tr>"
        for name, value, unit in rows
    )
    return (
        f"<div><strong>{escape(title)}</strong><table>{lines}</table>"
        f"<small>{escape(note)}</small></div>"
    )
