"""Measures of the orbits of a branch: columns of the summary of a run over one cycle."""

from __future__ import annotations

import warnings

from iva import _iva
from iva.dynamics.orbits import Missed, Orbit, in_units_of
from iva.parameters import shown, spec
from iva.spelling import hint

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Sequence

    import polars as pl

    from iva.dynamics.branches import Branch

#: Mean power over a cycle → the energy that it is the rate of.
POWERS = {
    "mean_power": "energy_work",
    "mean_power_impacts": "energy_impacts",
    "mean_power_viscous": "energy_viscous",
}


def measured(branch: Branch, names: Sequence[str]) -> pl.DataFrame:
    """Return the frame of :meth:`iva.dynamics.Branch.measures`.

    Raises
    ------
    TypeError
        If a name is no text.
    ValueError
        If there is no name, or no such measure.

    Warns
    -----
    UserWarning
        If orbits cannot be run.
    """
    import polars as pl

    check(branch, names)
    wanted = sorted({POWERS.get(name, name) for name in names})
    schema: dict[str, pl.DataType] = {"value": pl.Float64(), "arclength": pl.Float64()}
    schema |= {"outcome": pl.String(), **dict.fromkeys(names, pl.Float64())}
    rows = []
    for index, row in enumerate(branch.rows):
        outcome, summary = of_orbit(branch.orbit(index), wanted)
        values: dict[str, object] = {}
        if summary is not None:
            schema |= {name: summary.schema[name] for name in names}
            values = summary.row(0, named=True)
        rows.append((row.value, row.arclength, outcome, *(values.get(name) for name in names)))
    without = sum(row[2] != "finished" for row in rows)
    if without:
        text = f"{without} of {len(rows)} orbits cannot be run: their measures are null"
        warnings.warn(text, UserWarning, stacklevel=3)
    return pl.DataFrame(rows, schema, orient="row")


def of_orbit(orbit: Orbit | Missed, wanted: Sequence[str]) -> tuple[str, pl.DataFrame | None]:
    """Return how a run over one cycle ends, or why there is none, and its summary with powers."""
    import polars as pl

    if isinstance(orbit, Missed):
        return orbit.reason, None
    summary = orbit.run(measures=wanted, tables=()).summary
    outcome: str = summary["outcome"].item()
    powers = {name: pl.col(energy) / orbit.period for name, energy in POWERS.items()}
    return outcome, summary.with_columns(**powers) if outcome == "finished" else None


def check(branch: Branch, names: Sequence[str]) -> None:
    """Check the names of measures.

    Raises
    ------
    TypeError
        If one is no text.
    ValueError
        If there is none, or no such measure.
    """
    _, units = _iva.column_units(_iva.unit_system(spec(in_units_of(branch.scene.primary))), [])
    known = [name for name in (*units["summary"], *POWERS) if name not in ("point", "outcome")]
    if not names:
        raise ValueError("measures: give at least one, such as 'amplitude_rms' or 'mean_power'")
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"measures has {shown(name)} in it: give names")
        if name not in known:
            near = hint(name, known)
            there = f"here are the columns of run.summary, and {', '.join(POWERS)}"
            rule = f"no such measure{near} T{there}" if near else f"no such measure; t{there}"
            raise ValueError(f"measures has {shown(name)} in it: {rule}")
    if len(set(names)) != len(names):
        raise ValueError(f"measures = {shown(names)}: give each once")
