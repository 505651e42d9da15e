"""What ``print(run)`` says: the outcome, some measures with their units, and the scene."""

from __future__ import annotations

from iva import _iva
from iva.doubts import lasts
from iva.forces import Impulse, listed
from iva.scene_lines import carried_along, scene_lines
from iva.scenes import absorbers

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from iva.simulation import Run

#: What is counted → its name.
COUNTS = {
    "impacts": "impacts",
    "effective_impacts": "effective",
    "episodes": "episodes",
    "undecided": "undecided contacts",
}
#: Measures of a free decay → why a run to its end has none.
OF_DECAYS = {
    "settling_time_5": "no settling within the run",
    "damping_ratio_3": "fewer than 3 cycles in the run",
    "residual_amplitude": "the run is shorter than a period, or nothing moves",
}
#: Measures of a driven run.
OF_DRIVEN = ("amplitude_max", "reduction", "transmissibility", "impacts_per_cycle")
#: Those of them that a structure without absorber has not.
OF_ABSORBERS = ("reduction", "impacts_per_cycle")


def run_lines(run: Run) -> list[str]:
    """Return the lines that are printed of a run."""
    row = run.summary.row(0, named=True)
    counts = [
        f"{row[name]} {label}"
        for name, label in COUNTS.items()
        if row[name] is not None and (name != "undecided" or row[name])
    ]
    first = "; ".join([f"Run: {row['outcome']}", *([", ".join(counts)] if counts else [])])
    # Without absorber there is nothing to count.
    lines = [first if run.absorber is not None else f"Run: {row['outcome']}"]
    is_driven = any(not isinstance(force, Impulse) for force in listed(run.force))
    told = of_driven(run, row) if is_driven else of_decay(run, row)
    lines += [f"  {', '.join(told)}"] if told else []
    if lasts(run._spec) and "impacts" in run._frames.names:
        events = (run.impacts[name].to_list() for name in ("time", "absorber"))
        if contacts := _iva.verdict_on_contacts(run._spec, *events):
            lines.append(f"  {contacts}")
    parts = (*absorbers(run.absorber), run.primary, *listed(run.force), run.start)
    lines += [f"  {line}" for line in (*scene_lines(*parts), *carried_along(parts))]
    return [*lines, f"  {run.units}"]


def of_decay(run: Run, row: Mapping[str, Any]) -> list[str]:
    """Return the measures of a free decay, and why one that was asked for has no value."""
    told, early = [], []
    for name, why in OF_DECAYS.items():
        if row[name] is not None:
            told.append(f"{name} {with_unit(row[name], run.units['summary'][name])}")
        elif run._measured is None or name in run._measured:
            if row["outcome"] == "finished":
                told.append(f"{name}: {why}")
            else:
                early.append(name)
    return [*told, f"the run ended early: no {', '.join(early)}"] if early else told


def of_driven(run: Run, row: Mapping[str, Any]) -> list[str]:
    """Return the measures of a driven run, with the amplitude without absorber beside its own."""
    units, told = run.units["summary"], []
    for name in OF_DRIVEN:
        if row[name] is None or (run.absorber is None and name in OF_ABSORBERS):
            continue
        told.append(f"{name} {with_unit(row[name], units[name])}")
        left = 1.0 - row["reduction"] if row["reduction"] is not None else 0.0
        if name == "amplitude_max" and run.absorber is not None and left > 0.0:
            told.append(f"without absorber {with_unit(row[name] / left, units[name])}")
    if row["amplitude_max"] is None and row["outcome"] != "finished":
        told.append("the run ended early: no amplitude_max")
    return told


def with_unit(value: float, unit: str) -> str:
    """Return a number of the summary with its unit; lengths in metres are told in mm, all of them.

    Examples
    --------
    >>> with_unit(0.02, "m"), with_unit(51.58, "1/ωn"), with_unit(0.5, "1")
    ('20 mm', '51.58/ωn', '0.5')
    """
    if unit == "m":
        return f"{1000.0 * value:.4g} mm"
    number = f"{value:.4g}"
    if unit == "1/ωn":
        return f"{number}/ωn"
    if unit == "length of displacement":
        return f"{number} {'unit' if number == '1' else 'units'} of length"
    return number if unit == "1" else f"{number} {unit}"
