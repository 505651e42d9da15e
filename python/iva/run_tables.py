"""The tables of one run, and what can stand in the places of their numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from iva import _iva
from iva.frames import Frames, from_arrow

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    import polars as pl

    from iva._iva import ArrowTable
    from iva.parameters import Spec


class RunTables:
    """Tables of one run as polars frames, made on first use."""

    def __init__(self, frames: Frames) -> None:
        self._frames = frames

    @property
    def summary(self) -> pl.DataFrame:
        """Outcome, counts, damping measures and energy ledger, in one row.

        ``outcome`` is ``finished``, ``impact_limit``, ``work_limit`` or ``not_finite``. A measure
        that is not defined for the run, or was not asked for, is null.
        """
        return self._frames["summary"]

    @property
    def impacts(self) -> pl.DataFrame:
        """Time, wall (±1), both states, energy loss and ``effective``, a row an impact."""
        return self._frame("impacts")

    @property
    def episodes(self) -> pl.DataFrame:
        """One row a chatter that ends in stick, a plastic stick, or a start at rest on a wall."""
        return self._frame("episodes")

    @property
    def envelope(self) -> pl.DataFrame:
        """One row a peak of the primary displacement."""
        return self._frame("envelope")

    @property
    def stroboscope(self) -> pl.DataFrame:
        """One row a cycle of the harmonic force (of several, the first), after `discard`.

        The state at the instants Ωt + phase = 2πk, with the largest |x| and the impacts of the
        cycle that ends there. Empty without a harmonic force.
        """
        return self._frame("stroboscope")

    @property
    def absorbers(self) -> pl.DataFrame:
        """Impacts, energy loss, time stuck and largest impulse, a row an absorber."""
        return self._frame("absorbers")

    def _frame(self, name: str) -> pl.DataFrame:
        if name not in self._frames.names:
            raise AttributeError(f"no table {name!r}: ask for it with tables=({name!r},)")
        return self._frames[name]


class _Instead(RunTables):
    """Tables of one run with something else in the places of their numbers."""

    def __init__(self, made: Mapping[str, ArrowTable]) -> None:
        super().__init__(from_arrow(made))
        self._units = {name: dict(table.units) for name, table in made.items()}

    @property
    def units(self) -> Mapping[str, Mapping[str, str]]:
        """Table → column → unit."""
        return MappingProxyType(self._units)

    def __eq__(self, other: object) -> bool:
        """Compare all tables."""
        if type(other) is not type(self):
            return NotImplemented
        return self._frames == other._frames and self._units == other._units

    __hash__ = None  # type: ignore[assignment]


class Verification(_Instead):
    """Errors of a run, found by a second run in numbers of twice the precision.

    The tables are those of the run, each number replaced by its error (value minus truth, in the
    same unit): null where there is no number, or where the two runs no longer have the same
    events. Words, walls and counts are those of the run.

    Attributes
    ----------
    findings : polars.DataFrame
        For each table ``table``, ``rows`` and ``rows_exact`` (of the run, and of the second run),
        ``alike`` (how many tell of the same events, from the first on), ``largest_error`` among
        them and its ``column``.

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     start=iva.Start(displacement=1.0),
    ...     periods=3,
    ...     verify=True,
    ... )
    >>> run.verification.agrees
    True
    >>> run.verification.impacts["time"].abs().max() < 1e-14
    True
    """

    def __init__(
        self,
        made: Mapping[str, ArrowTable],
        findings: list[tuple[str, int, int, int, float | None, str | None]],
    ) -> None:
        super().__init__(made)
        self._findings = findings

    @property
    def findings(self) -> pl.DataFrame:
        """What was found, table by table."""
        import polars as pl

        schema = {
            "table": pl.String,
            "rows": pl.Int64,
            "rows_exact": pl.Int64,
            "alike": pl.Int64,
            "largest_error": pl.Float64,
            "column": pl.String,
        }
        return pl.DataFrame(self._findings, schema=schema, orient="row")

    @property
    def agrees(self) -> bool:
        """True if both runs have the same events; then every number has its error."""
        return all(rows == exact == alike for _, rows, exact, alike, _, _ in self._findings)

    def __repr__(self) -> str:
        """Show what was found."""
        lines = ["Verification: the same events" if self.agrees else "Verification: events differ"]
        for table, rows, exact, alike, error, column in self._findings:
            if rows == exact == 0:
                continue
            unit = self._units[table].get(column or "", "")
            most = "" if error is None else f", largest error {error:.2g} {unit} ({column})"
            lines.append(f"  {table}: {alike} of {rows} rows alike{most}")
        return "\n".join(lines)


class Gradient(_Instead):
    """Derivatives of all numbers of a run by one parameter.

    The tables are those of the run, each number replaced by its derivative, in its unit per unit of
    the parameter. Words, walls and counts are those of the run, but for ``near_grazing`` of the
    impacts: it is true from the first impact on that a relative change of the parameter of a
    thousandth could turn into a grazing. There results bend too sharply for a derivative to tell
    much.

    Examples
    --------
    How the first impact moves with the clearance (without damping it is at arccos(1 − γ), with the
    derivative 1/√(1 − (1 − γ)²)):

    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    ...     iva.Primary(),
    ...     start=iva.Start(displacement=1.0),
    ...     periods=3,
    ...     gradients=("relative_clearance",),
    ... )
    >>> round(run.gradients["relative_clearance"].impacts["time"][0], 6)
    1.091089
    """

    def __init__(self, made: Mapping[str, ArrowTable], parameter: str) -> None:
        super().__init__(made)
        self.parameter = parameter

    def __repr__(self) -> str:
        """Show the parameter and the tables."""
        return f"Gradient by {self.parameter}: {', '.join(self._frames.names)}"


class Gradients(Mapping[str, Gradient]):
    """The gradients of a run, by the names of the parameters."""

    def __init__(self, gradients: Mapping[str, Gradient]) -> None:
        self._gradients = dict(gradients)

    def __getitem__(self, parameter: str) -> Gradient:
        """Return the gradient by a parameter.

        Raises
        ------
        KeyError
            If it was not asked for.
        """
        if parameter not in self._gradients:
            raise KeyError(f"no gradient by {parameter!r}: ask for it with gradients=(…,)")
        return self._gradients[parameter]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the parameters."""
        return iter(self._gradients)

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self._gradients)

    def __repr__(self) -> str:
        """Show the parameters."""
        return f"Gradients by {', '.join(self._gradients) or 'nothing'}"


def verified(spec: Spec, measures: list[str] | None, tables: list[str] | None) -> Verification:
    """Run a scene in doubles and in numbers of twice the precision."""
    made, findings = _iva.verify(spec, measures, tables)
    return Verification(made, findings)


def differentiated(
    spec: Spec, parameters: list[str], measures: list[str] | None, tables: list[str] | None
) -> Gradients:
    """Run a scene once for each parameter, with derivatives by it."""
    return Gradients(
        {
            parameter: Gradient(_iva.gradients(spec, parameter, measures, tables), parameter)
            for parameter in parameters
        }
    )
