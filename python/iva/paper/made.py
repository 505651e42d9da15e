"""What a figure's study gives: tables, findings, and how it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from iva.paper.verdicts import Finding

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    import polars as pl
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class Made:
    """Result of the study behind one figure.

    Parameters
    ----------
    parameters : str
        What was run.
    tables : mapping of str to polars.DataFrame
        The data, by name.
    findings : sequence of Finding
        The claims that the figure carries.
    draw : callable
        Makes the matplotlib figure.
    shown : mapping of str to polars.DataFrame
        Small tables for the report, by their headings.
    """

    parameters: str
    tables: Mapping[str, pl.DataFrame]
    findings: Sequence[Finding]
    draw: Callable[[], Figure] = field(repr=False)
    shown: Mapping[str, pl.DataFrame] = field(default_factory=dict)
